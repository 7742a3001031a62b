//! Tables: plates, their outlines, vents, rivers. Columns with units, all of one length.

/// A column's values.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers.
    Number(Vec<f64>),
    /// Words.
    Text(Vec<String>),
}

impl Values {
    /// Number of rows.
    pub fn len(&self) -> usize {
        match self {
            Values::Number(v) => v.len(),
            Values::Text(v) => v.len(),
        }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A named column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name, with the unit in it where it could be doubted.
    pub name: String,
    /// Unit; "1" for pure numbers, "" for words.
    pub unit: String,
    /// One value a row.
    pub values: Values,
}

/// A named table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Name in the store.
    pub name: String,
    /// Columns of equal length.
    pub columns: Vec<Column>,
}

impl Table {
    /// An empty table.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), columns: Vec::new() }
    }

    /// Adds a column of numbers.
    pub fn number(mut self, name: &str, unit: &str, values: Vec<f64>) -> Self {
        self.columns.push(Column { name: name.to_owned(), unit: unit.to_owned(), values: Values::Number(values) });
        self
    }

    /// Adds a column of words.
    pub fn text(mut self, name: &str, values: Vec<String>) -> Self {
        self.columns.push(Column { name: name.to_owned(), unit: String::new(), values: Values::Text(values) });
        self
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// A column of numbers by name.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|c| c.name == name).and_then(|c| match &c.values {
            Values::Number(v) => Some(v.as_slice()),
            Values::Text(_) => None,
        })
    }

    /// A column of words by name.
    pub fn words(&self, name: &str) -> Option<&[String]> {
        self.columns.iter().find(|c| c.name == name).and_then(|c| match &c.values {
            Values::Text(v) => Some(v.as_slice()),
            Values::Number(_) => None,
        })
    }
}

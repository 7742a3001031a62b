//! A report in Markdown, with its plots as SVG files beside it.

use std::fmt::Write as _;

use super::{CAVEATS, METRICS, Spread, Subject, facts, figures::figures, headline, many_row, rows, title};

/// The report's text and its plots, `(name, SVG)`; the text looks for them in the folder `plots`.
pub fn markdown(subjects: &[Subject], plots: &str) -> (String, Vec<(String, String)>) {
    let many = subjects.len() > 1;
    let mut page = format!("# {}\n\n{}.\n\n", title(subjects), headline(subjects));
    for subject in subjects {
        let _ = writeln!(page, "- {}: {}", subject.name, facts(subject));
    }
    page.push_str(if many {
        "\n| metric | median | 5 to 95 % | on Earth | inside |\n|---|---:|---:|---|---|\n"
    } else {
        "\n| metric | value | on Earth | |\n|---|---:|---|---|\n"
    });
    for row in rows(subjects) {
        let range = if many { format!(" {} |", row.range) } else { String::new() };
        let _ = writeln!(page, "| {} | {} |{range} {} | {} |", row.title, row.value, row.band, row.standing);
    }
    let mut files = Vec::new();
    for figure in figures(subjects) {
        let file = format!("{}.svg", figure.name);
        // A folder may have spaces in its name; a link may not.
        let link = format!("{}/{file}", plots.replace(' ', "%20"));
        let _ = write!(page, "\n## {}\n\n![{}]({link})\n\n{}\n", figure.title, figure.title, figure.caption);
        files.push((file, figure.plot.svg_file(figure.name, figure.title)));
    }
    page.push_str("\n## How to read this\n\n");
    CAVEATS.iter().for_each(|caveat| page.push_str(&format!("- {caveat}\n")));
    let _ = write!(page, "\n## Methods and sources\n\n{}", metrics_table());
    (page, files)
}

/// The metrics, their bands and where those come from, as a table.
pub fn metrics_table() -> String {
    let mut table =
        "| metric | on Earth | cells, m | how it is computed | who says so |\n|---|---|---|---|---|\n".to_owned();
    for m in METRICS {
        let band = m.band.map_or("–".to_owned(), |band| band.to_string());
        let cells = m.cells_m.map_or("any".to_owned(), |cells| cells.to_string());
        let unit = if m.unit == "1" { String::new() } else { format!(", {}", m.unit) };
        let _ = writeln!(table, "| {}{unit} | {band} | {cells} | {} | {} |", m.title, m.method, m.source);
    }
    table
}

/// How the metrics of many worlds spread, as a table.
pub fn spreads_table(spreads: &[Spread]) -> String {
    let mut table = "| metric | median | 5 to 95 % | on Earth | inside |\n|---|---:|---:|---|---|\n".to_owned();
    for row in spreads.iter().map(many_row) {
        let _ = writeln!(table, "| {} | {} | {} | {} | {} |", row.title, row.value, row.range, row.band, row.standing);
    }
    table
}

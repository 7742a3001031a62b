//! What a recording says of itself before its first frame.

use serde::{Deserialize, Serialize};

/// Raised when older readers cannot read a recording any more.
pub const FORMAT: u16 = 1;
/// The first bytes of a recording.
pub(super) const MAGIC: &[u8; 6] = b"UPBAKE";
/// Slowest and fastest rate, frames a second.
pub const RATES_PER_S: [f64; 2] = [1e-3, 1000.0];
/// Bytes of a header's JSON, at most: no honest one comes near.
pub(super) const MOST_JSON: u32 = 1 << 24;
/// Columns at most.
pub(super) const MOST_COLUMNS: usize = 64;

/// A column of the frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
}

impl Column {
    /// From both.
    pub fn new(name: &str, unit: &str) -> Self {
        Self { name: name.to_owned(), unit: unit.to_owned() }
    }
}

/// The header.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Program that wrote it, with its version.
    pub program: String,
    /// The recipe's short name.
    pub recipe: String,
    /// SHA-256 of the recipe as it ran, flags included, as hexadecimal digits.
    pub recipe_sha256: String,
    /// The recipe's seed.
    pub seed: u64,
    /// The stage's name.
    pub stage: String,
    /// Its kind.
    pub kind: String,
    /// Its parameters.
    pub parameters: serde_json::Value,
    /// West-east and north-south extent of the map, m. Places count from the north-west corner, to the east, to the south, and
    /// up from the world's datum.
    pub extent_m: [f64; 2],
    /// Whether who leaves the map comes back on the other side.
    pub wraps: bool,
    /// Radius of a ball with a particle's volume, m.
    pub radius_m: f64,
    /// What is known of each particle besides its number; the first three are its place.
    pub columns: Vec<Column>,
    /// Frames to a second; frame k is the moment k over this.
    pub frames_per_s: f64,
    /// How many there are.
    pub frames: u64,
    /// How long the stage lasts, s.
    pub duration_s: f64,
}

impl Header {
    /// What keeps it from being true.
    pub(super) fn check(&self) -> Result<(), String> {
        let [slow, fast] = RATES_PER_S;
        if !(slow..=fast).contains(&self.frames_per_s) {
            return Err(format!("frames_per_s is {}, and can be from {slow} to {fast}", self.frames_per_s));
        }
        if !(3..=MOST_COLUMNS).contains(&self.columns.len()) {
            return Err(format!("it has {} columns, and can have 3 to {MOST_COLUMNS}", self.columns.len()));
        }
        let numbers = [self.extent_m[0], self.extent_m[1], self.radius_m, self.duration_s];
        if numbers.iter().any(|number| !number.is_finite() || *number < 0.0) {
            return Err("extent_m, radius_m and duration_s must be numbers of at least 0".to_owned());
        }
        if self.frames > u64::from(u32::MAX) {
            return Err(format!("{} frames are more than fit", self.frames));
        }
        if self.frames != super::frames_by(self.duration_s, self.frames_per_s) {
            return Err(format!("{} frames do not fill {} s", self.frames, self.duration_s));
        }
        Ok(())
    }

    /// The last frame's moment, s.
    pub fn last_s(&self) -> f64 {
        super::due_s(self.frames.saturating_sub(1), self.frames_per_s)
    }

    /// Which column has this name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// The bytes that stand before the first chunk.
    pub(super) fn bytes(&self) -> Vec<u8> {
        // Plain strings, finite numbers, and what came out of JSON: there is nothing in it that JSON cannot say.
        let json = serde_json::to_vec_pretty(self).unwrap_or_default();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(FORMAT.to_le_bytes());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(super::chunk::sha256(&[&json]));
        bytes.extend(json);
        bytes
    }
}

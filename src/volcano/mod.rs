//! Volcanoes: what they pour and throw out, and what becomes of it.
//!
//! Builds no pictures, and knows other stages only by what they leave in the world.

pub mod ash;
mod outlet;
pub mod sheet;

pub use ash::AshParams;
pub use sheet::{LavaSheetParams, SheetKey, SheetVent};

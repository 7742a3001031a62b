//! What the stages have in common.

mod beside;

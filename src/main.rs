//! The `upthrust` command.

fn main() {}

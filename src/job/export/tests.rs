//! What an export writes, read back.

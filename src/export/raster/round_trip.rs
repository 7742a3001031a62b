//! Written, read back by other decoders, compared.

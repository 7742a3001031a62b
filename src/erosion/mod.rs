//! What wears land away: streams over geologic time, hillslopes, and what they lay down elsewhere.

//! The stage `rivers`: rain gathered to rivers and lakes, their layers, and rivers as lines.

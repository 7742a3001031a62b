//! Weather: wind, rain, temperature and the snow line. Writes layers; carves nothing.

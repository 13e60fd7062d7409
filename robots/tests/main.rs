//! Robots, from the outside.

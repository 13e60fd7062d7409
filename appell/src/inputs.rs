//! Inputs of a simulation: the sum of expressions, feedback laws and recordings.

pub mod controller;
pub mod feedback;
pub mod tabulated;

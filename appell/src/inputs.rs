//! What drives the inputs of a simulation: expressions, feedback laws and recordings; they add up.

pub mod controller;
pub mod feedback;
pub mod tabulated;

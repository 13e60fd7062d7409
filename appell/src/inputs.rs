//! Inputs of a simulation: the sum of expressions, feedback laws and recordings.

pub use appell_runtime::inputs::InputSource;

mod by_model;
pub(crate) mod closed_loop;
pub mod controller;
pub mod feedback;
mod law;
mod switching;
pub mod tabulated;

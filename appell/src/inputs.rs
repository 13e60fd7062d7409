//! Inputs of a simulation: the sum of expressions, feedback laws and recordings.

pub use appell_runtime::inputs::InputSource;

pub(crate) mod closed_loop;
pub mod controller;
pub mod feedback;
pub mod law;
mod switching;
pub mod tabulated;

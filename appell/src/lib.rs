//! appell: from a mechanism spec to equations of motion, motions, gains and diagnoses.
//!
//! Whatever a command does, a program does with one call.

pub mod cases;
pub mod conditions;
pub mod control;
pub mod engine;
mod error;
pub mod files;
pub mod formula;
pub mod inputs;
pub mod recording;
pub mod setup;
pub mod source;
pub mod steady;

pub use error::Error;

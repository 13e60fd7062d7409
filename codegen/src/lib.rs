//! Gibbs-Appell derivation and code generation.

pub mod audit;
pub mod build;
pub mod c;
pub mod compile;
pub mod emit;
pub mod fmu;
pub mod formulations;
pub mod interpreted;
#[cfg(feature = "jit")]
pub mod jit;
pub mod linearisation;
pub mod mechanics;
pub mod model;
pub mod program;
pub mod python;
pub mod schedule;
pub mod symbolic;
pub mod tape;
pub mod tapes;
mod text;

pub use build::build;
pub use compile::{Derived, audited, compile, derived};

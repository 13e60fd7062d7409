//! Gibbs-Appell derivation and code generation.

pub mod compile;
pub mod interpreted;
#[cfg(feature = "jit")]
pub mod jit;
pub mod mechanics;
pub mod program;
pub mod schedule;
pub mod symbolic;

pub use compile::{Derived, compile, derived};

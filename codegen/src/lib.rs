//! Gibbs-Appell derivation and code generation.

#[cfg(feature = "jit")]
pub mod jit;
pub mod mechanics;
pub mod program;
pub mod schedule;
pub mod symbolic;

//! Gibbs-Appell derivation and code generation.

pub mod program;
pub mod schedule;
pub mod symbolic;

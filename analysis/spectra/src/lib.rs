//! Eigenvalues and singular values of dense matrices, to rounding and with typed failures.
//!
//! - [`spectrum`]: eigenvalues, eigenvectors, characteristic polynomials;
//! - [`singular`]: singular values and vectors, ranks, shortest solutions.

pub mod singular;
pub mod spectrum;

//! Models, integration and trajectories for appell.
//!
//! With the feature `std`:
//!
//! - [`model`]: the trait that emitted models and models made at run time implement;
//! - [`signal`]: tabulated functions of time; derivatives of noisy samples with their covariance;
//! - [`inputs`]: what drives a model;
//! - [`integrate`]: initial value problems, events, typed failures;
//! - [`linearise`]: A and B in the independent states;
//! - [`simulate`] and [`trajectory`]: motions of a model and their files;
//! - [`differences`]: derivatives that a model has no formulas for;
//! - [`contact`] and [`condition`]: where a model stops being valid;
//! - [`figure`]: plots as SVG.
//!
//! With the feature `analysis`, the default, also what needs matrices of any size:
//!
//! - [`spectrum`]: eigenvalues, eigenvectors, characteristic polynomials;
//! - [`singular`]: singular values and vectors, ranks, shortest solutions;
//! - [`analysis`]: steady motions, their families and stability;
//! - [`control`]: controllability, pole placement, optimal feedback, sampled loops;
//! - [`inverse`]: the inputs of a measured motion, and what it must satisfy whatever they were;
//! - [`estimate`]: filters, likelihoods with gradients, fits to recordings.
//!
//! Without either the crate is `no_std` and holds what emitted code needs: the scalar trait [`Real`],
//! dual numbers and lanes that implement it, small dense systems in [`dense`], and the arithmetic of
//! structs in [`vector!`]. `f32` and
//! `f64` are then scalars with the feature `libm`. Both are checked by
//!
//! ```text
//! cargo check -p appell-runtime --no-default-features
//! cargo test  -p appell-runtime --no-default-features --features libm
//! ```

#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "analysis")]
pub mod analysis;
#[cfg(feature = "std")]
pub mod condition;
#[cfg(feature = "std")]
pub mod contact;
#[cfg(feature = "analysis")]
pub mod control;
pub mod dense;
#[cfg(feature = "std")]
pub mod differences;
#[cfg(feature = "analysis")]
pub mod estimate;
#[cfg(feature = "std")]
pub mod figure;
#[cfg(feature = "std")]
pub mod inputs;
#[cfg(feature = "std")]
pub mod integrate;
#[cfg(feature = "analysis")]
pub mod inverse;
#[cfg(feature = "std")]
pub mod linearise;
#[cfg(feature = "std")]
pub mod model;
#[cfg(feature = "std")]
pub mod positions;
pub mod real;
#[cfg(feature = "std")]
pub mod signal;
#[cfg(feature = "std")]
pub mod simulate;
#[cfg(feature = "analysis")]
pub mod singular;
#[cfg(feature = "analysis")]
pub mod spectrum;
#[cfg(feature = "std")]
pub mod trajectory;
mod vector;

#[cfg(any(feature = "std", feature = "libm"))]
pub use real::Lanes;
pub use real::{Dual, Real};
#[cfg(feature = "std")]
pub use signal::Signal;
#[cfg(feature = "std")]
pub use simulate::Simulation;
#[cfg(feature = "std")]
pub use trajectory::Trajectory;

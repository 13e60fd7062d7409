//! Models, integration and trajectories for appell.
//!
//! With the feature `std`, the default:
//!
//! - [`model`]: the trait that emitted models and models made at run time implement;
//! - [`signal`]: tabulated functions of time;
//! - [`inputs`]: inputs of a model as functions of time and state;
//! - [`integrate`]: initial value problems, events, typed failures;
//! - [`lanes`]: blocks of eight evaluation points;
//! - [`interval`]: interval arithmetic, to locate all switches; [`switching`]: numbers of switching functions;
//! - [`linearise`]: A and B in the independent states;
//! - [`positions`]: states consistent with position constraints;
//! - [`simulate`] and [`trajectory`]: motions of a model and their files;
//! - [`differences`]: derivatives and inverse dynamics by differences, for models without formulas;
//! - [`contact`] and [`condition`]: contact forces and condition numbers, to check validity.
//!
//! Without it the crate is `no_std` and holds what emitted code needs: the scalar trait [`Real`], dual
//! numbers that implement it, small dense systems in [`dense`], and the arithmetic of structs in
//! [`vector!`]. With the feature `libm`, `f32`, `f64` and lanes are scalars too, with the functions of
//! [`elementary`]. Both are checked by
//!
//! ```text
//! cargo check -p appell-runtime --no-default-features
//! cargo test  -p appell-runtime --no-default-features --features libm
//! ```

#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
pub mod condition;
#[cfg(feature = "std")]
pub mod contact;
pub mod dense;
#[cfg(feature = "std")]
pub mod differences;
#[cfg(any(feature = "std", feature = "libm"))]
pub mod elementary;
#[cfg(feature = "std")]
pub mod inputs;
#[cfg(feature = "std")]
pub mod integrate;
#[cfg(feature = "std")]
pub mod interval;
#[cfg(feature = "std")]
pub mod lanes;
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
#[cfg(feature = "std")]
pub mod switching;
#[cfg(feature = "std")]
pub mod trajectory;
mod vector;

#[cfg(feature = "std")]
pub use real::Enclosure;
#[cfg(any(feature = "std", feature = "libm"))]
pub use real::Lanes;
pub use real::{Dual, Real};
#[cfg(feature = "std")]
pub use signal::Signal;
#[cfg(feature = "std")]
pub use simulate::Simulation;
#[cfg(feature = "std")]
pub use trajectory::Trajectory;

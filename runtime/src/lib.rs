//! Models, integration and trajectories for appell.
//!
//! Without the feature `std` this crate is `no_std` and holds what emitted code needs: the scalar
//! trait [`Real`], dual numbers and lanes that implement it, and small dense factorisations.

#![cfg_attr(not(feature = "std"), no_std)]

pub mod dense;
#[cfg(feature = "std")]
pub mod inputs;
#[cfg(feature = "std")]
pub mod integrate;
#[cfg(feature = "std")]
pub mod model;
pub mod real;
#[cfg(feature = "std")]
pub mod signal;
#[cfg(feature = "std")]
pub mod simulate;
#[cfg(feature = "std")]
pub mod trajectory;

#[cfg(any(feature = "std", feature = "libm"))]
pub use real::Lanes;
pub use real::{Dual, Real};
#[cfg(feature = "std")]
pub use signal::Signal;
#[cfg(feature = "std")]
pub use simulate::Simulation;
#[cfg(feature = "std")]
pub use trajectory::Trajectory;

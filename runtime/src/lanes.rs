//! Eight places at once.
//!
//! A *block* is [`LANES`] places that are evaluated together, component by component: component i of
//! place l lies at `x[i][l]`. The processor does a block as one vector of eight numbers, as two of
//! four, or number by number; what it has is found out when the program runs. A block has eight places in
//! all cases, and every lane goes the same way, so that no result depends on the processor. Where
//! places are left over, repeat the last one.
//!
//! Emitted models evaluate blocks with the functions of [`crate::elementary`], and
//! [`Model::rates_own`](crate::model::Model::rates_own) and its like evaluate one place with
//! the same bits. Functions with linear systems that are solved with pivoting go place by place there.
//! Other models go place by place with the functions of the standard library, bit for bit: the *plain mode*.
//!
//! The files: [`dispatch`] finds the processor's vectors, [`lane`] is what a lane holds, [`fast`] the scalar of
//! one, [`written_out`] makes equations from emitted functions, [`evaluate`] runs equations over blocks and places,
//! [`functions`] single functions over blocks, and [`plain`] goes place by place.

// What is not inlined is not compiled for the vectors of the processor.
#![allow(clippy::inline_always)]

#[cfg(any(feature = "std", feature = "libm"))]
mod dispatch;
#[cfg(any(feature = "std", feature = "libm"))]
mod evaluate;
#[cfg(any(feature = "std", feature = "libm"))]
mod fast;
#[cfg(any(feature = "std", feature = "libm"))]
pub mod functions;
mod lane;
#[cfg(feature = "std")]
mod plain;
mod written_out;

#[cfg(any(feature = "std", feature = "libm"))]
pub use dispatch::{Level, dispatch};
#[cfg(any(feature = "std", feature = "libm"))]
pub use evaluate::Equations;
pub use lane::Lane;
#[cfg(feature = "std")]
pub use plain::place_by_place;

/// How many places a block has.
pub const LANES: usize = 8;

/// Where a model is evaluated, several places at once. All numbers in SI, in the order of the
/// model's vectors.
#[derive(Debug, Clone, Copy)]
pub struct AtLanes<'a, const N: usize = LANES> {
    /// Times in seconds.
    pub t: &'a [f64; N],
    /// States: pseudo-velocities, coordinates.
    pub x: &'a [[f64; N]],
    /// Inputs, then signals.
    pub u: &'a [[f64; N]],
    /// Parameters.
    pub p: &'a [[f64; N]],
}

//! Elementary functions with bitwise reproducible results on every machine and for any number of lanes.
//!
//! The functions of the standard library are scalar calls into the platform: loops around them are not vectorised,
//! and results may differ in the last digit between machines. The functions here are branch-free polynomials without
//! tables, which compilers vectorise. They use only sums, products, quotients, square roots and fused multiply-adds,
//! which IEEE 754 defines to the last bit.
//!
//! The error of every function is at most one unit in the last place for all arguments; a test compares them with
//! values to fifty digits (`tests/tests/elementary.rs`). Sine, cosine and tangent of arguments beyond
//! [`ORDINARY_ANGLE`] are computed by `libm`, which reduces them with as many digits of π as they need.
//!
//! The files: [`arithmetic`] implements double-double arithmetic, [`trigonometric`], [`inverse`], [`exponential`],
//! [`hyperbolic`], [`logarithm`] and [`power`] contain the functions.

// All functions must be inlined to be vectorised over lanes. Special values are compared exactly and selected without
// branches.
#![allow(
    clippy::inline_always,
    clippy::float_cmp,
    clippy::needless_bitwise_bool
)]

mod arithmetic;
mod exponential;
mod hyperbolic;
mod inverse;
mod logarithm;
mod power;
mod trigonometric;

pub use exponential::exp;
pub use hyperbolic::{cosh, sinh, tanh};
pub use inverse::{acos, asin, atan, atan2};
pub use logarithm::ln;
pub use power::powf;
pub use trigonometric::{ORDINARY_ANGLE, cos, ordinary_sin_cos, sin, sin_cos, tan};

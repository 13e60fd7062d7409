//! Elementary functions that give the same bits on every machine and in any number of lanes.
//!
//! The standard library calls what the platform has, one number at a time: no loop around it becomes
//! vector code, and two machines may differ in the last digit. These are polynomials in straight
//! code without branches or tables, which compilers turn into vector code. They use sums, products,
//! quotients, square roots and fused multiply-adds alone, all of which IEEE 754 defines to the last bit.
//!
//! Every function is within one unit in the last place over all its arguments; a test holds them
//! against values with fifty digits (`tests/tests/elementary.rs`). Arguments of sine, cosine and
//! tangent beyond [`ORDINARY_ANGLE`] go to `libm`, which reduces them with as many digits of π as
//! they need.
//!
//! The files: [`arithmetic`] computes with pairs of numbers, [`trigonometric`], [`inverse`],
//! [`exponential`], [`hyperbolic`], [`logarithm`] and [`power`] hold the functions.

// A function that is not inlined has no lanes: it would be called once for each of them. Special values
// are told exactly, without branches.
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

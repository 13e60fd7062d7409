//! The scalar type of emitted code.

mod dual;
#[cfg(feature = "std")]
mod enclosure;
#[cfg(any(feature = "std", feature = "libm"))]
mod float;
#[cfg(any(feature = "std", feature = "libm"))]
mod functions;
#[cfg(any(feature = "std", feature = "libm"))]
mod lanes;

pub use dual::Dual;
#[cfg(feature = "std")]
pub use enclosure::Enclosure;
#[cfg(any(feature = "std", feature = "libm"))]
pub use functions::{Functions, Own, Standard};
#[cfg(any(feature = "std", feature = "libm"))]
pub use lanes::Lanes;

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A real number, or a type with the same arithmetic: `f32`, `f64`, dual numbers, lanes.
///
/// Emitted equations are generic in it, so the same source serves simulation, embedded targets, automatic
/// differentiation and batches.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// The nearest number to a constant.
    #[must_use]
    fn constant(value: f64) -> Self;
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self);
    /// Sine.
    #[must_use]
    fn sin(self) -> Self;
    /// Cosine.
    #[must_use]
    fn cos(self) -> Self;
    /// Tangent.
    #[must_use]
    fn tan(self) -> Self;
    /// Inverse sine.
    #[must_use]
    fn asin(self) -> Self;
    /// Inverse cosine.
    #[must_use]
    fn acos(self) -> Self;
    /// Inverse tangent.
    #[must_use]
    fn atan(self) -> Self;
    /// Angle of the point (`x`, `self`).
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    #[must_use]
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    #[must_use]
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;
    /// Exponential.
    #[must_use]
    fn exp(self) -> Self;
    /// Natural logarithm.
    #[must_use]
    fn ln(self) -> Self;
    /// Square root.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Absolute value.
    #[must_use]
    fn abs(self) -> Self;
    /// −1, 0 or 1; unlike `f64::signum`, zero has the sign zero.
    #[must_use]
    fn sign(self) -> Self;
    /// Power with a real exponent.
    #[must_use]
    fn powf(self, exponent: Self) -> Self;
    /// `then` where `a < b`, `otherwise` elsewhere, lane by lane.
    #[must_use]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// `then` where `a <= b`, `otherwise` elsewhere, lane by lane.
    #[must_use]
    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
}

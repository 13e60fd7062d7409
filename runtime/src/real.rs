//! The scalar of emitted code.

use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A real number, or something that computes like one: `f32`, `f64`, dual numbers, lanes.
///
/// Emitted equations ask for nothing else, so one text serves simulation, embedded targets,
/// automatic differentiation and batches.
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
    fn constant(value: f64) -> Self;
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self);
    /// Sine.
    fn sin(self) -> Self;
    /// Cosine.
    fn cos(self) -> Self;
    /// Tangent.
    fn tan(self) -> Self;
    /// Inverse sine.
    fn asin(self) -> Self;
    /// Inverse cosine.
    fn acos(self) -> Self;
    /// Inverse tangent.
    fn atan(self) -> Self;
    /// Angle of the point (`x`, `self`).
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// −1, 0 or 1; unlike `f64::signum`, zero has the sign zero.
    fn sign(self) -> Self;
    /// Power with a real exponent.
    fn powf(self, exponent: Self) -> Self;
    /// `then` where `a < b`, `otherwise` elsewhere, lane by lane.
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
    /// `then` where `a <= b`, `otherwise` elsewhere, lane by lane.
    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self;
}

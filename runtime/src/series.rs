//! Equations that expand their motions in time, order by order.
//!
//! A motion near t is Σ xₖ (τ − t)ᵏ. The coefficients of order zero are a state; those of order k + 1 follow from
//! the ones up to k by a [`Series::sweep`], which is linear in the coefficients of order k: its factors are the
//! values *kept* at order zero, and what lower orders contribute to products comes in sums over pairs of
//! coefficients, Σ aⱼ bₖ₋ⱼ for 1 ≤ j < k, which the caller takes.

use crate::lanes::{AtLanes, LANES};
use crate::real::{Enclosure, Real};
use std::borrow::Cow;

/// Equations ẋ = f(t, x, u, p) with the recurrences of their Taylor coefficients.
pub trait Series: Send + Sync {
    /// Lengths of what the methods read and write.
    fn shape(&self) -> &Shape;
    /// Order zero.
    fn start(&self, from: Start<'_>, to: Started<'_>);
    /// Order k ≥ 1.
    fn sweep(&self, from: Sweep<'_>, to: Swept<'_>);
}

/// A [`Series`] of eight motions at once: every array has a block of eight numbers in the place of a number.
pub trait SeriesInLanes: Send + Sync {
    /// Lengths of what the methods read and write.
    fn shape(&self) -> &Shape;
    /// Order zero; writes what [`Started`] has, in its order.
    fn start(&self, at: AtLanes<'_>, to: [&mut [[f64; LANES]]; 3]);
    /// Order k ≥ 1. The time is k; the inputs are followed by the numbers of [`OrderNumber`], the parameters are what
    /// order zero kept; writes what [`Swept`] has, in its order.
    fn sweep(&self, at: AtLanes<'_>, sums: &[[f64; LANES]], to: [&mut [[f64; LANES]]; 4]);
}

/// An input as a polynomial of the time since some moment, up to the third power.
pub type Cubic = [f64; 4];

/// Bounds on a polynomial over an interval of the time since its moment.
pub fn enclosed(cubic: Cubic, since: Enclosure) -> Enclosure {
    let [a, b, c, d] = cubic.map(Enclosure::constant);
    a + since * (b + since * (c + since * d))
}

/// The derivative of a polynomial of some order.
pub fn differentiated(polynomial: Cubic, order: u8) -> Cubic {
    (0..order).fold(polynomial, |[_, b, c, d], _| [b, 2.0 * c, 3.0 * d, 0.0])
}

/// Lengths of what a [`Series`] reads and writes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shape {
    /// States.
    pub states: usize,
    /// Inputs.
    pub inputs: usize,
    /// Parameters.
    pub parameters: usize,
    /// Values kept from order zero.
    pub kept: usize,
    /// Pairs of series whose products are summed.
    pub products: usize,
    /// What the signs of the guards decide.
    pub guards: Cow<'static, [Guard]>,
}

/// How a value g decides what the equations are. Where its answer changes, a series ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guard {
    /// By g < 0.
    Negative,
    /// By g ≤ 0.
    NotPositive,
    /// By the sign of g, which may be zero.
    Sign,
}

impl Guard {
    /// What a value decides.
    pub fn answer(self, value: f64) -> i8 {
        match self {
            Self::Negative => i8::from(value < 0.0),
            Self::NotPositive => i8::from(value <= 0.0),
            Self::Sign => i8::from(value > 0.0) - i8::from(value < 0.0),
        }
    }
}

/// Numbers that depend on the order k alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OrderNumber {
    /// The coefficient of time: 1 for k = 1, otherwise 0.
    Time,
    /// 1/k.
    Inverse,
    /// 1/(k + 1).
    NextInverse,
}

impl OrderNumber {
    /// How many there are.
    pub const COUNT: usize = 3;

    /// All of them, in their order.
    pub fn all(order: usize) -> [f64; Self::COUNT] {
        let k = order as f64;
        [f64::from(u8::from(order == 1)), 1.0 / k, 1.0 / (k + 1.0)]
    }
}

/// What order zero reads, all in SI.
#[derive(Debug, Clone, Copy)]
pub struct Start<'a> {
    /// Time in s.
    pub t: f64,
    /// State.
    pub x: &'a [f64],
    /// Inputs.
    pub u: &'a [f64],
    /// Parameters.
    pub p: &'a [f64],
}

/// What order zero writes.
#[derive(Debug)]
pub struct Started<'a> {
    /// The rates: coefficients of order 1 of the states.
    pub next: &'a mut [f64],
    /// Values that sweeps need.
    pub kept: &'a mut [f64],
    /// Values whose signs decide what the equations are.
    pub guards: &'a mut [f64],
}

/// What a sweep reads.
#[derive(Debug, Clone, Copy)]
pub struct Sweep<'a> {
    /// The order k.
    pub k: f64,
    /// Coefficients of order k of the states.
    pub x: &'a [f64],
    /// Of the inputs, then the numbers of [`OrderNumber`].
    pub u: &'a [f64],
    /// What order zero kept.
    pub kept: &'a [f64],
    /// The sums of all products.
    pub sums: &'a [f64],
}

/// What a sweep writes.
#[derive(Debug)]
pub struct Swept<'a> {
    /// Coefficients of order k + 1 of the states.
    pub next: &'a mut [f64],
    /// Coefficients of order k of the first factor of each product.
    pub left: &'a mut [f64],
    /// Of the second one.
    pub right: &'a mut [f64],
    /// Coefficients of order k of the guards.
    pub guards: &'a mut [f64],
}

//! Many scalars at once.

use super::Real;
use core::array::from_fn;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// `N` independent numbers that pass through the same equations together.
///
/// Every operation acts lane by lane and gives bit for bit what `f64` gives. The loops have a
/// fixed length, so the compiler turns sums, products and selections into vector instructions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lanes<const N: usize>(pub [f64; N]);

impl<const N: usize> Lanes<N> {
    /// The same number in every lane.
    #[inline]
    pub fn splat(value: f64) -> Self {
        Self([value; N])
    }
}

impl<const N: usize> From<[f64; N]> for Lanes<N> {
    #[inline]
    fn from(lanes: [f64; N]) -> Self {
        Self(lanes)
    }
}

macro_rules! lanewise_operator {
    ($($trait:ident $method:ident $operator:tt),+) => {$(
        impl<const N: usize> $trait for Lanes<N> {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|lane| self.0[lane] $operator other.0[lane]))
            }
        }
    )+};
}
lanewise_operator!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const N: usize> Neg for Lanes<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(self.0.map(|lane| -lane))
    }
}

impl<const N: usize> AddAssign for Lanes<N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

macro_rules! lanewise {
    ($($method:ident),+) => {$(
        #[inline]
        fn $method(self) -> Self {
            Self(self.0.map(<f64 as Real>::$method))
        }
    )+};
}

impl<const N: usize> Real for Lanes<N> {
    #[inline]
    fn constant(value: f64) -> Self {
        Self::splat(value)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let pairs = self.0.map(<f64 as Real>::sin_cos);
        (
            Self(pairs.map(|(sin, _)| sin)),
            Self(pairs.map(|(_, cos)| cos)),
        )
    }
    lanewise!(
        sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, exp, ln, sqrt, abs, sign
    );
    #[inline]
    fn atan2(self, x: Self) -> Self {
        Self(from_fn(|lane| {
            <f64 as Real>::atan2(self.0[lane], x.0[lane])
        }))
    }
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        Self(from_fn(|lane| {
            <f64 as Real>::powf(self.0[lane], exponent.0[lane])
        }))
    }
    #[inline]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Self(from_fn(|i| {
            if a.0[i] < b.0[i] {
                then.0[i]
            } else {
                otherwise.0[i]
            }
        }))
    }
    #[inline]
    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Self(from_fn(|i| {
            if a.0[i] <= b.0[i] {
                then.0[i]
            } else {
                otherwise.0[i]
            }
        }))
    }
}

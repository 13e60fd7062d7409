//! The scalar of a lane.

use super::lane::Lane;
use crate::Real;
use crate::elementary::{self, ORDINARY_ANGLE};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A number that is computed without branches, so that a loop over lanes becomes vector code.
///
/// It has the functions of [`crate::elementary`], and NaN where they would have to leave the straight
/// way. Whatever depends on such a NaN is NaN as well, choices and powers included: a result that is
/// a number is right, and one that is not has to be computed again by [`crate::real::Own`] functions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fast(pub(super) f64);

macro_rules! operator {
    ($($trait:ident $method:ident $operator:tt),+) => {$(
        impl $trait for Fast {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
    )+};
}
operator!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Lane for Fast {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self(value)
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.0
    }
}

impl Neg for Fast {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Fast {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

macro_rules! functions {
    ($($method:ident),+) => {$(
        #[inline(always)]
        fn $method(self) -> Self {
            Self(elementary::$method(self.0))
        }
    )+};
}

impl Fast {
    /// NaN for angles that need more digits of π.
    #[inline(always)]
    fn ordinary(self) -> f64 {
        if self.0.abs() <= ORDINARY_ANGLE {
            self.0
        } else {
            f64::NAN
        }
    }
}

impl Real for Fast {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self(value)
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = elementary::ordinary_sin_cos(self.ordinary());
        (Self(sin), Self(cos))
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }
    #[inline(always)]
    fn tan(self) -> Self {
        Self(elementary::ordinary_tan(self.ordinary()))
    }
    functions!(asin, acos, atan, sinh, cosh, tanh, exp, ln);
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(elementary::square_root(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    fn sign(self) -> Self {
        // Zeros stay zero, NaN stays NaN.
        let sign = if self.0 < 0.0 { -1.0 } else { self.0 };
        Self(if self.0 > 0.0 { 1.0 } else { sign })
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        Self(elementary::atan2(self.0, x.0))
    }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        let power = elementary::powf(self.0, exponent.0);
        // 1 to any power and any number to the power of 0 are 1, of NaN too.
        let unknown = self.0.is_nan() | exponent.0.is_nan();
        Self(if unknown { f64::NAN } else { power })
    }
    #[inline(always)]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        let unknown = if a.0 >= b.0 { otherwise.0 } else { f64::NAN };
        Self(if a.0 < b.0 { then.0 } else { unknown })
    }
    #[inline(always)]
    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        let unknown = if a.0 > b.0 { otherwise.0 } else { f64::NAN };
        Self(if a.0 <= b.0 { then.0 } else { unknown })
    }
}

//! Many scalars at once.

use super::Real;
use super::functions::{Functions, Own, Standard};
use core::array::from_fn;
use core::marker::PhantomData;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// `N` independent numbers evaluated together.
///
/// Every operation acts lane by lane. With [`Standard`] elementary functions the results agree bit for bit with
/// `f64`; with [`Own`] ones they are reproducible on every machine, and `Lanes<1, Own>` is the corresponding scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lanes<const N: usize, E = Standard>(pub [f64; N], PhantomData<E>);

impl<const N: usize> Lanes<N> {
    /// Lanes that compute with the functions of `f64`.
    #[inline]
    pub fn standard(lanes: [f64; N]) -> Self {
        Self(lanes, PhantomData)
    }
}

impl<const N: usize> Lanes<N, Own> {
    /// Lanes that compute with the functions of [`crate::elementary`].
    #[inline]
    pub fn own(lanes: [f64; N]) -> Self {
        Self(lanes, PhantomData)
    }
}

impl<const N: usize, E> From<[f64; N]> for Lanes<N, E> {
    #[inline]
    fn from(lanes: [f64; N]) -> Self {
        Self(lanes, PhantomData)
    }
}

macro_rules! lanewise_operator {
    ($($trait:ident $method:ident $operator:tt),+) => {$(
        impl<const N: usize, E> $trait for Lanes<N, E> {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                from_fn(|lane| self.0[lane] $operator other.0[lane]).into()
            }
        }
    )+};
}
lanewise_operator!(Add add +, Sub sub -, Mul mul *, Div div /);

impl<const N: usize, E> Neg for Lanes<N, E> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.0.map(|lane| -lane).into()
    }
}

impl<const N: usize, E: Copy> AddAssign for Lanes<N, E> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

macro_rules! lanewise {
    ($($method:ident from $functions:ident),+) => {$(
        #[inline]
        fn $method(self) -> Self {
            self.0.map($functions::$method).into()
        }
    )+};
}

impl<const N: usize, E: Functions> Real for Lanes<N, E> {
    #[inline]
    fn constant(value: f64) -> Self {
        [value; N].into()
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let pairs = self.0.map(E::sin_cos);
        (
            pairs.map(|(sin, _)| sin).into(),
            pairs.map(|(_, cos)| cos).into(),
        )
    }
    lanewise!(
        sin from E, cos from E, tan from E, asin from E, acos from E, atan from E, sinh from E,
        cosh from E, tanh from E, exp from E, ln from E, sqrt from Real, abs from Real,
        sign from Real
    );
    #[inline]
    fn atan2(self, x: Self) -> Self {
        from_fn(|lane| E::atan2(self.0[lane], x.0[lane])).into()
    }
    #[inline]
    fn powf(self, exponent: Self) -> Self {
        from_fn(|lane| E::powf(self.0[lane], exponent.0[lane])).into()
    }
    #[inline]
    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        from_fn(|i| {
            if a.0[i] < b.0[i] {
                then.0[i]
            } else {
                otherwise.0[i]
            }
        })
        .into()
    }
    #[inline]
    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        from_fn(|i| {
            if a.0[i] <= b.0[i] {
                then.0[i]
            } else {
                otherwise.0[i]
            }
        })
        .into()
    }
}

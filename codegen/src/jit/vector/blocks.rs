//! Elementary functions of blocks.

use std::array::from_fn;

use appell_runtime::elementary::{self, ORDINARY_ANGLE};
use appell_runtime::lanes::Level;
use appell_runtime::real::{Functions, Own, Standard};

/// Elementary functions of `N` numbers: each gets the bits of the scalar function.
pub(super) trait Blocks: Functions {
    fn sin_cos<const N: usize>(x: [f64; N]) -> [[f64; N]; 2];
    fn sin<const N: usize>(x: [f64; N]) -> [f64; N];
    fn cos<const N: usize>(x: [f64; N]) -> [f64; N];
    fn asin<const N: usize>(x: [f64; N]) -> [f64; N];
    fn acos<const N: usize>(x: [f64; N]) -> [f64; N];
    fn atan<const N: usize>(x: [f64; N]) -> [f64; N];
    fn sinh<const N: usize>(x: [f64; N]) -> [f64; N];
    fn cosh<const N: usize>(x: [f64; N]) -> [f64; N];
    fn tanh<const N: usize>(x: [f64; N]) -> [f64; N];
    fn exp<const N: usize>(x: [f64; N]) -> [f64; N];
    fn ln<const N: usize>(x: [f64; N]) -> [f64; N];
    fn atan2<const N: usize>(y: [f64; N], x: [f64; N]) -> [f64; N];
    fn powf<const N: usize>(base: [f64; N], exponent: [f64; N]) -> [f64; N];
}

macro_rules! one_by_one {
    ($($name:ident($($x:ident),+)),+) => {
        $(
            fn $name<const N: usize>($($x: [f64; N]),+) -> [f64; N] {
                from_fn(|lane| <Self as Functions>::$name($($x[lane]),+))
            }
        )+
    };
}

impl Blocks for Standard {
    fn sin_cos<const N: usize>(x: [f64; N]) -> [[f64; N]; 2] {
        let pairs = x.map(<Self as Functions>::sin_cos);
        [pairs.map(|(sin, _)| sin), pairs.map(|(_, cos)| cos)]
    }
    one_by_one!(
        sin(x),
        cos(x),
        asin(x),
        acos(x),
        atan(x),
        sinh(x),
        cosh(x),
        tanh(x),
        exp(x),
        ln(x),
        atan2(y, x),
        powf(base, exponent)
    );
}

/// In one loop, which is compiled for the vectors of the processor.
macro_rules! at_once {
    ($($name:ident($($x:ident),+)),+) => {
        $(
            fn $name<const N: usize>($($x: [f64; N]),+) -> [f64; N] {
                let mut found = [0.0; N];
                Level::Avx512.run(
                    #[inline(always)]
                    || {
                        for lane in 0..N {
                            found[lane] = elementary::$name($($x[lane]),+);
                        }
                    },
                );
                found
            }
        )+
    };
}

impl Blocks for Own {
    fn sin_cos<const N: usize>(x: [f64; N]) -> [[f64; N]; 2] {
        let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
        Level::Avx512.run(
            #[inline(always)]
            || {
                for lane in 0..N {
                    (sin[lane], cos[lane]) = elementary::ordinary_sin_cos(x[lane]);
                }
            },
        );
        // Such angles need more digits of π.
        for lane in 0..N {
            if x[lane].abs() > ORDINARY_ANGLE {
                (sin[lane], cos[lane]) = elementary::sin_cos(x[lane]);
            }
        }
        [sin, cos]
    }
    fn sin<const N: usize>(x: [f64; N]) -> [f64; N] {
        <Self as Blocks>::sin_cos(x)[0]
    }
    fn cos<const N: usize>(x: [f64; N]) -> [f64; N] {
        <Self as Blocks>::sin_cos(x)[1]
    }
    at_once!(
        asin(x),
        acos(x),
        atan(x),
        sinh(x),
        cosh(x),
        tanh(x),
        exp(x),
        ln(x),
        atan2(y, x),
        powf(base, exponent)
    );
}

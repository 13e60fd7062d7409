//! Elementary functions on blocks.

use std::array::from_fn;

use appell_runtime::elementary::{self, ORDINARY_ANGLE};
use appell_runtime::lanes::dispatch;
use appell_runtime::real::{Functions, Own, Standard};

/// Elementary functions of `N` numbers, bit-identical to the scalar functions.
///
/// Arguments and results are references: passing a block by value through memory in smaller pieces costs as
/// much as the function.
pub(in crate::jit) trait Blocks: Functions {
    fn sin_cos<const N: usize>(x: &[f64; N], to: &mut [[f64; N]; 2]);
    fn sin<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn cos<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn asin<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn acos<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn atan<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn sinh<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn cosh<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn tanh<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn exp<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn ln<const N: usize>(x: &[f64; N], to: &mut [f64; N]);
    fn atan2<const N: usize>(y: &[f64; N], x: &[f64; N], to: &mut [f64; N]);
    fn powf<const N: usize>(base: &[f64; N], exponent: &[f64; N], to: &mut [f64; N]);
}

macro_rules! one_by_one {
    ($($name:ident($($x:ident),+)),+) => {
        $(
            fn $name<const N: usize>($($x: &[f64; N],)+ to: &mut [f64; N]) {
                *to = from_fn(|lane| <Self as Functions>::$name($($x[lane]),+));
            }
        )+
    };
}

impl Blocks for Standard {
    fn sin_cos<const N: usize>(x: &[f64; N], [to_sin, to_cos]: &mut [[f64; N]; 2]) {
        for lane in 0..N {
            (to_sin[lane], to_cos[lane]) = <Self as Functions>::sin_cos(x[lane]);
        }
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

/// In one loop, which is auto-vectorised for the processor.
macro_rules! at_once {
    ($($name:ident($($x:ident),+)),+) => {
        $(
            fn $name<const N: usize>($($x: &[f64; N],)+ to: &mut [f64; N]) {
                dispatch(
                    #[inline(always)]
                    || {
                        // Copies cannot alias, which the vectoriser has to know.
                        $(let $x = *$x;)+
                        let mut all = [0.0; N];
                        for lane in 0..N {
                            all[lane] = elementary::$name($($x[lane]),+);
                        }
                        *to = all;
                    },
                );
            }
        )+
    };
}

impl Blocks for Own {
    fn sin_cos<const N: usize>(x: &[f64; N], to: &mut [[f64; N]; 2]) {
        let mut some_large = false;
        dispatch(
            #[inline(always)]
            || {
                let (x, mut sin, mut cos, mut large) = (*x, [0.0; N], [0.0; N], false);
                for lane in 0..N {
                    (sin[lane], cos[lane]) = elementary::ordinary_sin_cos(x[lane]);
                    large |= x[lane].abs() > ORDINARY_ANGLE;
                }
                *to = [sin, cos];
                some_large = large;
            },
        );
        if some_large {
            with_all_digits(x, to);
        }
    }
    fn sin<const N: usize>(x: &[f64; N], to: &mut [f64; N]) {
        let mut both = [[0.0; N]; 2];
        <Self as Blocks>::sin_cos(x, &mut both);
        [*to, _] = both;
    }
    fn cos<const N: usize>(x: &[f64; N], to: &mut [f64; N]) {
        let mut both = [[0.0; N]; 2];
        <Self as Blocks>::sin_cos(x, &mut both);
        [_, *to] = both;
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

/// Sine and cosine of angles that require extended precision of π in the reduction.
#[cold]
fn with_all_digits<const N: usize>(x: &[f64; N], [sin, cos]: &mut [[f64; N]; 2]) {
    for lane in (0..N).filter(|&lane| x[lane].abs() > ORDINARY_ANGLE) {
        (sin[lane], cos[lane]) = elementary::sin_cos(x[lane]);
    }
}

//! Elementary functions of several numbers at once.

use super::dispatch;
use crate::elementary::{self, ORDINARY_ANGLE};
use crate::real::{Functions, Own, Standard};

/// Functions of one loop over the lanes, which is vectorised if `run` compiles it for that.
macro_rules! lanewise {
    ($($name:ident($($x:ident),+)),+) => {
        $(
            fn $name<const N: usize>($($x: &[f64; N],)+ to: &mut [f64; N]) {
                Self::run(
                    #[inline(always)]
                    || {
                        // Copies cannot alias, which the vectoriser has to know.
                        $(let $x = *$x;)+
                        let mut all = [0.0; N];
                        for lane in 0..N {
                            all[lane] = <Self as Functions>::$name($($x[lane]),+);
                        }
                        *to = all;
                    },
                );
            }
        )+
    };
}

/// Elementary functions of `N` numbers, bit-identical to those of one number.
///
/// Arguments and results are references: passing a block by value through memory in smaller pieces costs as much as
/// the function.
#[allow(missing_docs)]
pub trait Blocks: Functions {
    /// Runs a loop over the lanes.
    fn run(task: impl FnMut());

    fn sin_cos<const N: usize>(x: &[f64; N], [to_sin, to_cos]: &mut [[f64; N]; 2]) {
        for lane in 0..N {
            (to_sin[lane], to_cos[lane]) = <Self as Functions>::sin_cos(x[lane]);
        }
    }

    lanewise!(
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

/// Number by number: each function is a call.
impl Blocks for Standard {
    #[inline(always)]
    fn run(mut task: impl FnMut()) {
        task();
    }
}

/// With the vector instructions of the processor.
impl Blocks for Own {
    #[inline(always)]
    fn run(task: impl FnMut()) {
        dispatch(task);
    }

    fn sin_cos<const N: usize>(x: &[f64; N], to: &mut [[f64; N]; 2]) {
        let mut some_large = false;
        Self::run(
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
}

/// Sine and cosine of angles that require extended precision of π in the reduction.
#[cold]
fn with_all_digits<const N: usize>(x: &[f64; N], [sin, cos]: &mut [[f64; N]; 2]) {
    for lane in (0..N).filter(|&lane| x[lane].abs() > ORDINARY_ANGLE) {
        (sin[lane], cos[lane]) = elementary::sin_cos(x[lane]);
    }
}

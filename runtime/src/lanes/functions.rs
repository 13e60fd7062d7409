//! The functions of [`crate::elementary`] on blocks of numbers, for code that is made at run time.

use super::LANES;
use super::dispatch::dispatch;
use super::fast::Fast;
use crate::{Real, elementary};

/// A number at each place of a block.
type Block = [f64; LANES];

macro_rules! of_one_number {
    ($($(#[$about:meta])* $name:ident),+ $(,)?) => {$(
        $(#[$about])*
        pub fn $name(x: &Block, result: &mut Block) {
            #[inline(always)]
            fn straight(x: &Block, result: &mut Block) -> bool {
                let mut unknown = false;
                for lane in 0..LANES {
                    result[lane] = Fast(x[lane]).$name().0;
                    unknown |= result[lane].is_nan();
                }
                unknown
            }
            let mut unknown = false;
            dispatch(
                #[inline(always)]
                || unknown = straight(x, result),
            );
            if unknown {
                *result = x.map(elementary::$name);
            }
        }
    )+};
}

macro_rules! of_two_numbers {
    ($($(#[$about:meta])* $name:ident),+ $(,)?) => {$(
        $(#[$about])*
        pub fn $name(a: &Block, b: &Block, result: &mut Block) {
            #[inline(always)]
            fn straight(a: &Block, b: &Block, result: &mut Block) {
                for lane in 0..LANES {
                    result[lane] = elementary::$name(a[lane], b[lane]);
                }
            }
            dispatch(
                #[inline(always)]
                || straight(a, b, result),
            );
        }
    )+};
}

of_one_number!(
    /// Sine.
    sin,
    /// Cosine.
    cos,
    /// Tangent.
    tan,
    /// Inverse sine.
    asin,
    /// Inverse cosine.
    acos,
    /// Inverse tangent.
    atan,
    /// Hyperbolic sine.
    sinh,
    /// Hyperbolic cosine.
    cosh,
    /// Hyperbolic tangent.
    tanh,
    /// Exponential.
    exp,
    /// Natural logarithm.
    ln,
);

of_two_numbers!(
    /// Angle of the points (`b`, `a`).
    atan2,
    /// `a` to the power of `b`.
    powf,
);

/// Sine and cosine.
pub fn sin_cos(x: &Block, sin: &mut Block, cos: &mut Block) {
    #[inline(always)]
    fn straight(x: &Block, sin: &mut Block, cos: &mut Block) -> bool {
        let mut unknown = false;
        for lane in 0..LANES {
            let (of_sin, of_cos) = Fast(x[lane]).sin_cos();
            sin[lane] = of_sin.0;
            cos[lane] = of_cos.0;
            unknown |= of_sin.0.is_nan();
        }
        unknown
    }
    let mut unknown = false;
    dispatch(
        #[inline(always)]
        || unknown = straight(x, sin, cos),
    );
    if unknown {
        for lane in 0..LANES {
            (sin[lane], cos[lane]) = elementary::sin_cos(x[lane]);
        }
    }
}

//! Sine, cosine, tangent.

use super::arithmetic::{Pair, ROUNDER, fused, polynomial, product, sum_of_ordered};

/// Largest angle in radians, of either sign, for which the branch-free code is accurate: 2³⁰.
pub const ORDINARY_ANGLE: f64 = 1_073_741_824.0;

/// π/2 = `HALF_PI[0] + HALF_PI[1] + HALF_PI[2]` to 160 bits.
const HALF_PI: [f64; 3] = [
    core::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_169_8e-33,
];

/// (1 − sin x/x)/x² in powers of x², for |x| ≤ π/4; error 10⁻²⁰.
const SINE: [f64; 7] = [
    0.166_666_666_666_666_66,
    -0.008_333_333_333_333_331,
    0.000_198_412_698_412_650_65,
    -2.755_731_921_933_898e-6,
    2.505_210_623_238_310_8e-8,
    -1.605_853_160_876_776_5e-10,
    7.586_696_515_355_814e-13,
];

/// (cos x − 1 + x²/2)/x⁴ in powers of x², for |x| ≤ π/4; error 10⁻¹⁸.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_664,
    -0.001_388_888_888_888_739_8,
    2.480_158_729_876_557_4e-5,
    -2.755_731_727_167_133e-7,
    2.087_614_625_621_928_4e-9,
    -1.138_263_154_771_670_8e-11,
];

/// An angle modulo π/2, `high − minus_low`, and the number of quarter turns that were subtracted, in the last two
/// bits of `quarters` (Cody and Waite, *Software Manual for the Elementary Functions*, 1980).
struct Reduced {
    high: f64,
    minus_low: f64,
    quarters: u64,
}

#[inline(always)]
fn reduced(x: f64) -> Reduced {
    let rounded = fused(x, core::f64::consts::FRAC_2_PI, ROUNDER);
    let count = rounded - ROUNDER;
    // Exact: the remainder is a multiple of the last place of π/2 or x, and less than one.
    let first = fused(-count, HALF_PI[0], x);
    let second = product(count, HALF_PI[1]);
    // Exact too, even after severe cancellation.
    let high = first - second.high;
    let rounding = (high - first) + second.high;
    Reduced {
        high,
        minus_low: rounding + fused(count, HALF_PI[2], second.low),
        quarters: rounded.to_bits(),
    }
}

/// `high` minus the sine of a reduced angle. In this form the sine of −0 is −0.
#[inline(always)]
fn off_sine(angle: &Reduced, square: f64) -> f64 {
    let series = polynomial(square, SINE);
    fused(angle.high * square, series, angle.minus_low)
}

/// The cosine of a reduced angle as a sum.
#[inline(always)]
fn cosine(angle: &Reduced, square: f64) -> [f64; 2] {
    let series = polynomial(square, COSINE);
    let high = fused(square, -0.5, 1.0);
    let rounding = fused(square, -0.5, 1.0 - high);
    let rest = fused(angle.high, angle.minus_low, rounding);
    [high, fused(square * square, series, rest)]
}

/// Sine and cosine of an angle up to [`ORDINARY_ANGLE`]; meaningless beyond.
#[inline(always)]
#[must_use]
pub fn ordinary_sin_cos(x: f64) -> (f64, f64) {
    let angle = reduced(x);
    let square = angle.high * angle.high;
    let sin = angle.high - off_sine(&angle, square);
    let [high, low] = cosine(&angle, square);
    let cos = high + low;
    let odd = angle.quarters & 1 != 0;
    let (sin, cos) = (if odd { cos } else { sin }, if odd { sin } else { cos });
    let sign = |quarters: u64| (quarters & 2) << 62;
    (
        f64::from_bits(sin.to_bits() ^ sign(angle.quarters)),
        f64::from_bits(cos.to_bits() ^ sign(angle.quarters.wrapping_add(1))),
    )
}

/// Tangent of an angle up to [`ORDINARY_ANGLE`]; meaningless beyond.
#[inline(always)]
#[must_use]
fn ordinary_tan(x: f64) -> f64 {
    let angle = reduced(x);
    let square = angle.high * angle.high;
    let sin = sum_of_ordered(angle.high, -off_sine(&angle, square));
    let [high, low] = cosine(&angle, square);
    let rounding = fused(angle.high, angle.high, -square);
    let cos = sum_of_ordered(high, fused(rounding, -0.5, low));
    let odd = angle.quarters & 1 != 0;
    let pick = |a: Pair, b: Pair| Pair {
        high: if odd { a.high } else { b.high },
        low: if odd { a.low } else { b.low },
    };
    let minus_cos = Pair {
        high: -cos.high,
        low: -cos.low,
    };
    let tan = pick(minus_cos, sin).over(pick(sin, cos));
    let tan = tan.high + tan.low;
    // The correction loses the sign of zero.
    if x == 0.0 { x } else { tan }
}

#[inline(always)]
fn is_ordinary(x: f64) -> bool {
    x.abs() <= ORDINARY_ANGLE
}

/// Sine and cosine.
#[inline]
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if is_ordinary(x) {
        ordinary_sin_cos(x)
    } else {
        large_sin_cos(x)
    }
}

/// Sine.
#[inline]
#[must_use]
pub fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// Cosine.
#[inline]
#[must_use]
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// Tangent.
#[inline]
#[must_use]
pub fn tan(x: f64) -> f64 {
    if is_ordinary(x) {
        ordinary_tan(x)
    } else {
        large_tan(x)
    }
}

#[cold]
#[inline(never)]
fn large_sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

#[cold]
#[inline(never)]
fn large_tan(x: f64) -> f64 {
    libm::tan(x)
}

//! Inverse trigonometric functions, all as the angle of a point.

use super::arithmetic::{Pair, fused, polynomial, square_root, sum};
use core::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// (1 − atan x/x)/x² in powers of x², for |x| ≤ tan π/8; error 3·10⁻¹⁷.
const SERIES: [f64; 11] = [
    0.333_333_333_333_333_3,
    -0.199_999_999_999_955_13,
    0.142_857_142_846_648_2,
    -0.111_111_110_151_176_26,
    0.090_909_045_724_873_47,
    -0.076_921_830_598_941_14,
    0.066_645_096_032_553_86,
    -0.058_581_328_944_279_22,
    0.050_853_659_223_442_48,
    -0.039_229_237_138_359_43,
    0.019_173_922_285_547_93,
];

/// tan π/8.
const TAN_OF_EIGHTH: f64 = core::f64::consts::SQRT_2 - 1.0;

/// π/4 = `FRAC_PI_4 + QUARTER_LOW`; the same for its multiples.
const QUARTER_LOW: f64 = 3.061_616_997_868_383e-17;

/// The angle in the half plane y ≥ 0 of the point (x, y), from its distances to the axes and the sign of x.
/// The distances are not both zero, nor both infinite.
#[inline(always)]
fn angle(x: Pair, y: Pair, left: bool) -> f64 {
    // A rotation by a multiple of π/4 maps the point to the vicinity of the x axis.
    let near_x = y.high <= TAN_OF_EIGHTH * x.high;
    let near_y = x.high <= TAN_OF_EIGHTH * y.high;
    let (difference, total) = (sum(y.high, -x.high), sum(x.high, y.high));
    let pick = |at_x: f64, at_y: f64, between: f64| {
        let value = if near_y { at_y } else { between };
        if near_x { at_x } else { value }
    };
    let above = Pair {
        high: pick(y.high, -x.high, difference.high),
        low: pick(y.low, -x.low, difference.low + (y.low - x.low)),
    };
    let along = Pair {
        high: pick(x.high, y.high, total.high),
        low: pick(x.low, y.low, total.low + (x.low + y.low)),
    };
    let slope = above.over(along);
    // The correction is meaningless if the slope overflowed or underflowed.
    let low = if slope.low.abs() <= slope.high.abs() {
        slope.low
    } else {
        0.0
    };
    let square = slope.high * slope.high;
    let off = fused(-slope.high * square, polynomial(square, SERIES), low);
    let (high, quarters) = (
        pick(
            if left { PI } else { 0.0 },
            FRAC_PI_2,
            if left { 3.0 * FRAC_PI_4 } else { FRAC_PI_4 },
        ),
        pick(
            if left { 4.0 } else { 0.0 },
            2.0,
            if left { 3.0 } else { 1.0 },
        ),
    );
    let (slope, off) = if left {
        (-slope.high, -off)
    } else {
        (slope.high, off)
    };
    let total = sum(high, slope);
    total.high + (total.low + fused(quarters, QUARTER_LOW, off))
}

#[inline(always)]
fn exact(high: f64) -> Pair {
    Pair { high, low: 0.0 }
}

/// Inverse tangent.
#[inline(always)]
#[must_use]
pub fn atan(x: f64) -> f64 {
    let angle = angle(exact(1.0), exact(x.abs()), false);
    if x == 0.0 { x } else { angle.copysign(x) }
}

/// Angle of the point (`x`, `y`).
#[inline(always)]
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    let (right, up) = (x.abs(), y.abs());
    // Very large and very small points are scaled to others with the same angle.
    let larger = if right > up { right } else { up };
    let scale = if larger > 1e300 { 0.25 } else { 1.0 };
    let scale = if larger < 1e-250 { TWO_200 } else { scale };
    // A point at the origin is placed on the x axis, infinite ones on diagonals.
    let (far_right, far_up) = (right == f64::INFINITY, up == f64::INFINITY);
    let right = if far_right { f64::MAX } else { right };
    let up = if far_up { f64::MAX } else { up };
    let up = if far_right & !far_up { 0.0 } else { up };
    let right = if far_up & !far_right { 0.0 } else { right };
    let right = if larger == 0.0 { 1.0 } else { right };
    let angle = angle(
        exact(right * scale),
        exact(up * scale),
        x.is_sign_negative(),
    );
    let angle = if x.is_nan() | y.is_nan() {
        f64::NAN
    } else {
        angle
    };
    angle.copysign(y)
}

const TWO_200: f64 = 1.606_938_044_258_990_3e60;

/// √(1 − x²) in double-double precision.
#[inline(always)]
fn complement(x: f64) -> Pair {
    let square = x * x;
    let rounding = fused(x, x, -square);
    let high = 1.0 - square;
    let low = (1.0 - high) - square - rounding;
    let root = square_root(high + low);
    let rest = fused(-root, root, high) + low;
    Pair {
        high: root,
        low: if root > 0.0 { 0.5 * rest / root } else { 0.0 },
    }
}

/// Inverse sine.
#[inline(always)]
#[must_use]
pub fn asin(x: f64) -> f64 {
    let angle = angle(complement(x), exact(x.abs()), false);
    let angle = if x.abs() <= 1.0 { angle } else { f64::NAN };
    if x == 0.0 { x } else { angle.copysign(x) }
}

/// Inverse cosine.
#[inline(always)]
#[must_use]
pub fn acos(x: f64) -> f64 {
    let angle = angle(exact(x.abs()), complement(x), x < 0.0);
    if x.abs() <= 1.0 { angle } else { f64::NAN }
}

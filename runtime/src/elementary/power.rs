//! Powers with real exponents.

use super::arithmetic::{Pair, fused, polynomial, product, sum, sum_of_ordered};
use super::exponential::{LN_2, exp_of_pair};
use super::logarithm::{Split, split};

/// (artanh s/s − 1 − s²/3)/s⁴ in powers of s², for (1 + s)/(1 − s) from √½ to √2; error 6·10⁻²¹.
const SERIES: [f64; 9] = [
    0.2,
    0.142_857_142_857_142_82,
    0.111_111_111_111_142_18,
    0.090_909_090_898_278,
    0.076_923_078_806_814_9,
    0.066_666_482_596_436_23,
    0.058_834_068_880_797_17,
    0.052_281_562_951_978_31,
    0.053_812_787_178_675_27,
];

const THIRD: Pair = Pair {
    high: 0.333_333_333_333_333_3,
    low: 1.850_371_707_708_594e-17,
};

/// The logarithm of a positive finite number to some 67 bits.
#[inline(always)]
fn logarithm(x: f64) -> Pair {
    let Split { fraction, k } = split(x);
    let below = fraction - 1.0;
    let above = sum_of_ordered(1.0, fraction);
    let above = if fraction > 1.0 {
        sum_of_ordered(fraction, 1.0)
    } else {
        above
    };
    let s = Pair {
        high: below,
        low: 0.0,
    }
    .over(above);
    let square = s.times(s);
    let later = square.high * polynomial(square.high, SERIES);
    let third = sum_of_ordered(THIRD.high, later);
    let third = Pair {
        high: third.high,
        low: third.low + THIRD.low,
    };
    // 2 artanh s = 2 s (1 + s² (1/3 + …)).
    let beyond = square.times(third).times(s);
    let total = sum_of_ordered(s.high, beyond.high);
    let (high, low) = (2.0 * total.high, 2.0 * (total.low + (s.low + beyond.low)));
    let turns = product(k, LN_2[0]);
    let turns_low = fused(k, LN_2[1], turns.low);
    let total = sum(turns.high, high);
    sum_of_ordered(total.high, total.low + (turns_low + low))
}

/// `x` to the power of `exponent`, with the special cases of IEEE 754.
#[inline(always)]
#[must_use]
pub fn powf(x: f64, exponent: f64) -> f64 {
    let size = x.abs();
    let ln = logarithm(size);
    let along = product(ln.high, exponent);
    let power = exp_of_pair(Pair {
        high: along.high,
        low: fused(ln.low, exponent, along.low),
    });
    // Zero and infinity have no finite logarithm.
    let falls = exponent < 0.0;
    let (at_zero, at_infinity) = if falls {
        (f64::INFINITY, 0.0)
    } else {
        (0.0, f64::INFINITY)
    };
    let power = if size == 0.0 { at_zero } else { power };
    let power = if size == f64::INFINITY {
        at_infinity
    } else {
        power
    };
    let Parity { whole, odd } = parity(exponent);
    let power = if odd & x.is_sign_negative() {
        -power
    } else {
        power
    };
    let power = if !whole & (x < 0.0) & (size < f64::INFINITY) {
        f64::NAN
    } else {
        power
    };
    let power = if x.is_nan() | exponent.is_nan() {
        f64::NAN
    } else {
        power
    };
    let unit = (x == 1.0) | (exponent == 0.0) | ((x == -1.0) & (exponent.abs() == f64::INFINITY));
    if unit { 1.0 } else { power }
}

struct Parity {
    whole: bool,
    odd: bool,
}

/// Whether a number is an integer, and whether it is odd.
#[inline(always)]
fn parity(x: f64) -> Parity {
    let size = x.abs();
    let large = size >= TWO_52;
    let rounded = (size + TWO_52) - TWO_52;
    let whole = large | (rounded == size);
    // From 2⁵² to 2⁵³ the last bit of the number is the last bit of the integer.
    let last = if large { size } else { size + TWO_52 }.to_bits() & 1;
    let odd = whole & (last == 1) & (size < 2.0 * TWO_52);
    Parity { whole, odd }
}

const TWO_52: f64 = 4_503_599_627_370_496.0;

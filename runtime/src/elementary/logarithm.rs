//! The natural logarithm.

use super::arithmetic::{Pair, fused, polynomial, sum_of_ordered};

/// ln 2 in two parts, the first with so few digits that its multiples are exact.
const LN_2_HIGH: f64 = 0.693_147_180_485_539_1;
const LN_2_LOW: f64 = 7.440_617_110_012_397e-11;

/// (ln((1 + s)/(1 − s)) − 2s)/s³ in powers of s², for (1 + s)/(1 − s) from √½ to √2; error 3·10⁻¹⁶.
const SERIES: [f64; 7] = [
    0.666_666_666_666_667,
    0.399_999_999_998_993_8,
    0.285_714_286_260_310_65,
    0.222_222_111_257_228_1,
    0.181_828_897_861_910_42,
    0.153_316_996_335_438_58,
    0.146_167_211_798_618_16,
];

/// Bits of √½.
const ROOT_OF_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const ONE: u64 = 1023 << 52;

/// x = `fraction` 2ᵏ with a fraction from √½ to √2, for positive finite x.
pub(super) struct Split {
    pub(super) fraction: f64,
    pub(super) k: f64,
}

#[inline(always)]
pub(super) fn split(x: f64) -> Split {
    let subnormal = x < f64::MIN_POSITIVE;
    let bits = if subnormal { x * TWO_54 } else { x }.to_bits();
    let biased = bits.wrapping_sub(ROOT_OF_HALF).wrapping_add(ONE) >> 52;
    let fraction = f64::from_bits(bits.wrapping_sub(biased << 52).wrapping_add(ONE));
    // An integer in the mantissa bits of 2⁵² represents that number plus 2⁵².
    let number = f64::from_bits(TWO_52.to_bits() | biased) - (TWO_52 + 1023.0);
    Split {
        fraction,
        k: if subnormal { number - 54.0 } else { number },
    }
}

const TWO_52: f64 = 4_503_599_627_370_496.0;
const TWO_54: f64 = 18_014_398_509_481_984.0;

/// Natural logarithm.
#[inline(always)]
#[must_use]
pub fn ln(x: f64) -> f64 {
    let Split { fraction, k } = split(x);
    let f = fraction - 1.0;
    let s = f / (2.0 + f);
    let square = s * s;
    let half_square = 0.5 * f * f;
    let series = square * polynomial(square, SERIES);
    // f − f²/2 + s (f²/2 + series) + k ln 2, the large parts last.
    let small = fused(s, half_square + series, k * LN_2_LOW);
    let near = sum_of_ordered(f, -half_square);
    let far = sum_of_ordered(k * LN_2_HIGH, near.high);
    let far = if k == 0.0 {
        near
    } else {
        Pair {
            high: far.high,
            low: far.low + near.low,
        }
    };
    let ln = far.high + (far.low + small);
    special(x, ln)
}

/// The logarithm of zero, negative, infinite and NaN arguments.
#[inline(always)]
pub(super) fn special(x: f64, ln: f64) -> f64 {
    let ln = if x < f64::INFINITY { ln } else { x };
    let ln = if x == 0.0 { f64::NEG_INFINITY } else { ln };
    if x < 0.0 { f64::NAN } else { ln }
}

//! The exponential function.

use super::arithmetic::{Pair, ROUNDER, clamped, fused, polynomial, scaled, sum, sum_of_ordered};

/// ln 2 = `LN_2[0] + LN_2[1]` to 107 bits.
pub(super) const LN_2: [f64; 2] = [core::f64::consts::LN_2, 2.319_046_813_846_299_6e-17];

/// (eˣ − 1 − x)/x² in powers of x, for |x| ≤ ln 2/2; error 10⁻¹⁸.
const SERIES: [f64; 11] = [
    0.5,
    0.166_666_666_666_666_7,
    0.041_666_666_666_666_67,
    0.008_333_333_333_326_136,
    0.001_388_888_888_888_374_8,
    0.000_198_412_698_748_206_27,
    2.480_158_732_554_774_3e-5,
    2.755_725_540_020_642_2e-6,
    2.755_727_364_311_03e-7,
    2.510_521_700_472_074_5e-8,
    2.091_468_696_808_687_6e-9,
];

/// Beyond this, eˣ is infinite or zero.
const LARGEST: f64 = 710.0;
const SMALLEST: f64 = -746.0;

/// eˣ = `value` 2ᵏ.
pub(super) struct Power {
    pub(super) value: Pair,
    pub(super) k: f64,
}

/// The exponential of `x + low`, where |`low`| ≪ |`x`| and |x| ≤ 1000.
#[inline(always)]
pub(super) fn power(x: f64, low: f64) -> Power {
    let k = fused(x, core::f64::consts::LOG2_E, ROUNDER) - ROUNDER;
    // Exact: the remainder is a multiple of the last place of ln 2 or x, and less than a half.
    let first = fused(-k, LN_2[0], x);
    let rest = fused(-k, LN_2[1], first);
    let Pair { high: rest, low } = sum(rest, low + fused(-k, LN_2[1], first - rest));
    let beyond = fused(rest * rest, polynomial(rest, SERIES), fused(low, rest, low));
    let linear = sum_of_ordered(1.0, rest);
    Power {
        value: sum_of_ordered(linear.high, linear.low + beyond),
        k,
    }
}

/// Exponential.
#[inline(always)]
#[must_use]
pub fn exp(x: f64) -> f64 {
    let Power { value, k } = power(clamped(x, SMALLEST, LARGEST), 0.0);
    scaled(value.high, k)
}

/// The exponential of `x + low`.
#[inline(always)]
pub(super) fn exp_of_pair(Pair { high, low }: Pair) -> f64 {
    let x = clamped(high, SMALLEST, LARGEST);
    // `low` may be meaningless after overflow.
    let low = if x == high { low } else { 0.0 };
    let Power { value, k } = power(x, low);
    scaled(value.high, k)
}

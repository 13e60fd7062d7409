//! Double-double arithmetic: numbers with about twice the digits, as sums of two.

/// Adding and subtracting it rounds a number below 2⁵¹ to an integer; the last bits of the sum are
/// those of the integer.
pub(super) const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// The sum `high` + `low`, where `low` is at most about half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub(super) high: f64,
    pub(super) low: f64,
}

/// `a b + c`, rounded once.
#[inline(always)]
pub(super) fn fused(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(feature = "std")]
    return a.mul_add(b, c);
    #[cfg(not(feature = "std"))]
    return libm::fma(a, b, c);
}

/// The square root, rounded once.
#[inline(always)]
#[must_use]
pub(super) fn square_root(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(x);
}

/// c₀ + c₁ x + c₂ x² + …
#[inline(always)]
pub(super) fn polynomial<const LEN: usize>(x: f64, coefficients: [f64; LEN]) -> f64 {
    let mut value = 0.0;
    for (place, coefficient) in coefficients.into_iter().rev().enumerate() {
        value = if place == 0 {
            coefficient
        } else {
            fused(value, x, coefficient)
        };
    }
    value
}

/// a + b and its rounding error, where |a| ≥ |b| or a is zero (Dekker 1971).
#[inline(always)]
pub(super) fn sum_of_ordered(a: f64, b: f64) -> Pair {
    let high = a + b;
    Pair {
        high,
        low: b - (high - a),
    }
}

/// a + b and its rounding error (Knuth, *The Art of Computer Programming*, volume 2, 4.2.2).
#[inline(always)]
pub(super) fn sum(a: f64, b: f64) -> Pair {
    let high = a + b;
    let of_b = high - a;
    Pair {
        high,
        low: (a - (high - of_b)) + (b - of_b),
    }
}

/// a b and its rounding error.
#[inline(always)]
pub(super) fn product(a: f64, b: f64) -> Pair {
    let high = a * b;
    Pair {
        high,
        low: fused(a, b, -high),
    }
}

impl Pair {
    /// The product with another pair.
    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        let Self { high, low } = product(self.high, other.high);
        let cross = fused(self.high, other.low, self.low * other.high);
        sum_of_ordered(high, low + cross)
    }

    /// The quotient by another pair. If it is zero or infinite, `low` is meaningless.
    #[inline(always)]
    pub(super) fn over(self, other: Self) -> Self {
        let high = self.high / other.high;
        let remainder = fused(-high, other.high, self.high) + self.low;
        Self {
            high,
            low: fused(-high, other.low, remainder) / other.high,
        }
    }
}

/// 2ᵏ for an integer −1022 ≤ k ≤ 1023.
#[inline(always)]
pub(super) fn power_of_two(k: f64) -> f64 {
    f64::from_bits((k + ROUNDER).to_bits().wrapping_add(1023) << 52)
}

/// y 2ᵏ for an integer |k| ≤ 2000, rounded once.
#[inline(always)]
pub(super) fn scaled(y: f64, k: f64) -> f64 {
    let half = fused(k, 0.5, ROUNDER) - ROUNDER;
    y * power_of_two(half) * power_of_two(k - half)
}

/// `low` ≤ x ≤ `high`, or NaN.
#[inline(always)]
pub(super) fn clamped(x: f64, low: f64, high: f64) -> f64 {
    let x = if x < low { low } else { x };
    if x > high { high } else { x }
}

//! Hyperbolic functions.

use super::arithmetic::{Pair, clamped, polynomial, power_of_two, scaled, sum_of_ordered};
use super::exponential::{Power, power};

/// (sinh x/x − 1)/x² in powers of x², for |x| ≤ 1; error 3·10⁻²².
const SERIES: [f64; 8] = [
    0.166_666_666_666_666_66,
    0.008_333_333_333_333_333,
    0.000_198_412_698_412_697_73,
    2.755_731_922_404_036_5e-6,
    2.505_210_836_404_946_6e-8,
    1.605_904_839_772_239_2e-10,
    7.646_625_253_572_627e-13,
    2.844_529_742_637_889_5e-15,
];

/// Beyond this, the hyperbolic sine and cosine are infinite.
const LARGEST: f64 = 711.0;

/// Sine and cosine of |x| in units of 2ᵏ.
struct Hyperbolic {
    sinh: Pair,
    cosh: Pair,
    k: f64,
}

#[inline(always)]
fn hyperbolic(x: f64) -> Hyperbolic {
    let x = clamped(x.abs(), 0.0, LARGEST);
    let Power { value, k } = power(x, 0.0);
    let one = Pair {
        high: 1.0,
        low: 0.0,
    };
    let inverse = one.over(value);
    // e⁻ˣ in the unit of eˣ; negligible below its last place.
    let unit = power_of_two(-2.0 * clamped(k, 0.0, 500.0));
    let (far, farther) = (inverse.high * unit, inverse.low * unit);
    let half = |high: f64, low: f64| Pair {
        high: 0.5 * high,
        low: 0.5 * low,
    };
    let both = sum_of_ordered(value.high, far);
    let cosh = sum_of_ordered(both.high, both.low + (value.low + farther));
    let both = sum_of_ordered(value.high, -far);
    let sinh = sum_of_ordered(both.high, both.low + (value.low - farther));
    let (sinh, cosh) = (half(sinh.high, sinh.low), half(cosh.high, cosh.low));
    // Near zero the difference suffers from cancellation.
    let square = x * x;
    let near = sum_of_ordered(x, x * square * polynomial(square, SERIES));
    let is_near = x < 1.0;
    let near_unit = power_of_two(-k);
    let pick = |near: f64, far: f64| if is_near { near * near_unit } else { far };
    Hyperbolic {
        sinh: Pair {
            high: pick(near.high, sinh.high),
            low: pick(near.low, sinh.low),
        },
        cosh,
        k,
    }
}

/// Hyperbolic sine.
#[inline(always)]
#[must_use]
pub fn sinh(x: f64) -> f64 {
    let Hyperbolic { sinh, k, .. } = hyperbolic(x);
    let sinh = scaled(sinh.high, k).copysign(x);
    if x == 0.0 { x } else { sinh }
}

/// Hyperbolic cosine.
#[inline(always)]
#[must_use]
pub fn cosh(x: f64) -> f64 {
    let Hyperbolic { cosh, k, .. } = hyperbolic(x);
    scaled(cosh.high, k)
}

/// Hyperbolic tangent.
#[inline(always)]
#[must_use]
pub fn tanh(x: f64) -> f64 {
    let Hyperbolic { sinh, cosh, .. } = hyperbolic(x);
    let tanh = sinh.over(cosh);
    let tanh = (tanh.high + tanh.low).copysign(x);
    if x == 0.0 { x } else { tanh }
}

//! Interval enclosures of functions of time.

use super::Real;
use crate::interval::{Interval, Range};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Bounds on a function over an interval of time, on its slope there, and on its value at the midpoint.
///
/// The bounds follow from the mean value form, `f(t) ∈ f(m) + f'([t]) ([t] − m)`, where it is tighter than interval
/// evaluation: its overestimation is quadratic in the length (Moore, Kearfott and Cloud, *Introduction to Interval
/// Analysis*, chapter 6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    range: Range,
    middle: Range,
    slope: Range,
    /// Half the length of the interval; zero for a constant.
    half: f64,
}

impl Enclosure {
    /// The whole line.
    pub const UNKNOWN: Self = Self {
        range: Range::ANY,
        middle: Range::ANY,
        slope: Range::ANY,
        half: 0.0,
    };

    /// Time itself, over an interval in s.
    pub fn time(from: f64, to: f64) -> Self {
        let middle = f64::midpoint(from, to);
        Self {
            range: Range::of(Interval { lo: from, hi: to }),
            middle: thin(middle),
            slope: thin(1.0),
            half: (to - middle).max(middle - from).next_up(),
        }
    }

    /// A polynomial `c[0] + c[1] s + …`, where s ∈ [−1, 1] is the distance from the midpoint of an interval of time
    /// in units of its half length `half`, in s. The bounds are those of the sum of the absolute coefficients, and
    /// rounded outwards.
    pub fn polynomial(coefficients: &[f64], half: f64) -> Self {
        let Some((&middle, others)) = coefficients.split_first() else {
            return Self::constant(0.0);
        };
        let sum = |of: &dyn Fn(usize, f64) -> f64| -> f64 {
            others
                .iter()
                .enumerate()
                .map(|(i, c)| of(i + 1, c.abs()))
                .sum()
        };
        let rounding = ROUNDING * (middle.abs() + sum(&|_, c| c));
        let around = |middle: f64, radius: f64| {
            Range::of(Interval {
                lo: middle - radius,
                hi: middle + radius,
            })
        };
        let first = others.first().copied().unwrap_or(0.0);
        let bend = sum(&|k, c| if k > 1 { k as f64 * c } else { 0.0 });
        let slope = around(first / half, (bend + rounding) / half);
        Self {
            range: around(middle, sum(&|_, c| c) + rounding),
            middle: around(middle, rounding),
            slope: if half > 0.0 { slope } else { Range::ANY },
            half,
        }
    }

    /// The largest absolute value of the slope.
    pub fn steepness(&self) -> f64 {
        let Interval { lo, hi } = self.slope.interval;
        lo.abs().max(hi.abs())
    }

    /// Whether a function may have a pulse between samples that differ by at most `spread`, over an interval of a
    /// length in s: its largest slope times the length exceeds their spread many times. `size` is its magnitude
    /// elsewhere. False if there are no bounds.
    pub fn may_hide(&self, spread: f64, length: f64, size: f64) -> bool {
        let Interval { lo, hi } = self.middle.interval;
        let flat = FLAT * lo.abs().max(hi.abs()).max(size) + NOTHING;
        let reach = self.steepness() * length;
        lo.is_finite() && hi.is_finite() && (reach.is_nan() || reach > STEEP * spread + flat)
    }

    /// Bounds on the values.
    pub fn range(&self) -> Interval {
        self.range.interval
    }

    /// Bounds on the value at the midpoint.
    pub fn middle(&self) -> Interval {
        self.middle.interval
    }

    /// Whether the sign is the same everywhere.
    pub fn keeps_its_sign(&self) -> bool {
        let Interval { lo, hi } = self.range.interval;
        self.range.nonzero || (lo == 0.0 && hi == 0.0)
    }

    /// Whether the function is strictly monotonic.
    pub fn is_monotonic(&self) -> bool {
        let Interval { lo, hi } = self.slope.interval;
        lo > 0.0 || hi < 0.0
    }

    fn new(range: Range, middle: Range, slope: Range, half: f64) -> Self {
        let off = Range::of(Interval {
            lo: -half,
            hi: half,
        });
        Self {
            range: range.and(middle.plus(slope.times(off))),
            middle,
            slope,
            half,
        }
    }

    /// f(g), given f on ranges and the range of its slope at the values of g.
    fn map(self, f: impl Fn(Range) -> Range, slope: Range) -> Self {
        let slope = slope.times(self.slope);
        Self::new(f(self.range), f(self.middle), slope, self.half)
    }

    /// A function with possible discontinuities.
    fn jumping(range: Range, middle: Range, half: f64) -> Self {
        let Interval { lo, hi } = range.interval;
        Self {
            range,
            middle,
            slope: if lo < hi { Range::ANY } else { thin(0.0) },
            half,
        }
    }

    fn choose(answers: [Option<bool>; 2], then: Self, otherwise: Self) -> Self {
        let choice = |answer, a: Range, b: Range| match answer {
            Some(true) => a,
            Some(false) => b,
            None => a.or(b),
        };
        let half = then.half.max(otherwise.half);
        match answers[0] {
            Some(true) => then,
            Some(false) => otherwise,
            None => {
                let range = then.range.or(otherwise.range);
                let middle = choice(answers[1], then.middle, otherwise.middle);
                Self::jumping(range, middle, half)
            }
        }
    }
}

/// Ratio of the variation allowed by the largest slope to that of the samples above which a pulse may be hidden.
const STEEP: f64 = 8.0;
/// Relative variation below which a function counts as constant.
const FLAT: f64 = 1e-9;
/// Absolute variation below which a function counts as constant, in any unit.
const NOTHING: f64 = 1e-100;
/// Relative rounding error of a polynomial.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A number as a degenerate interval.
fn thin(value: f64) -> Range {
    Range::of(Interval {
        lo: value,
        hi: value,
    })
}

impl Add for Enclosure {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(
            self.range.plus(other.range),
            self.middle.plus(other.middle),
            self.slope.plus(other.slope),
            self.half.max(other.half),
        )
    }
}

impl AddAssign for Enclosure {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for Enclosure {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            range: self.range.negated(),
            middle: self.middle.negated(),
            slope: self.slope.negated(),
            half: self.half,
        }
    }
}

impl Sub for Enclosure {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Enclosure {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slope = self.slope.times(other.range);
        Self::new(
            self.range.times(other.range),
            self.middle.times(other.middle),
            slope.plus(self.range.times(other.slope)),
            self.half.max(other.half),
        )
    }
}

impl Div for Enclosure {
    type Output = Self;
    #[expect(
        clippy::suspicious_arithmetic_impl,
        reason = "the enclosure of a quotient is that of a product with a reciprocal"
    )]
    fn div(self, other: Self) -> Self {
        let slope = other.range.reciprocal().power(2).negated();
        self * other.map(Range::reciprocal, slope)
    }
}

impl Real for Enclosure {
    fn constant(value: f64) -> Self {
        if value.is_nan() {
            return Self::UNKNOWN;
        }
        let range = Range::number(value, value == 0.0);
        Self {
            range,
            middle: range,
            slope: thin(0.0),
            half: 0.0,
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    fn sin(self) -> Self {
        self.map(Range::sin, self.range.cos())
    }

    fn cos(self) -> Self {
        self.map(Range::cos, self.range.sin().negated())
    }

    fn tan(self) -> Self {
        self.sin() / self.cos()
    }

    fn asin(self) -> Self {
        let rest = thin(1.0).plus(self.range.power(2).negated());
        self.map(Range::asin, rest.sqrt().reciprocal())
    }

    fn acos(self) -> Self {
        let rest = thin(1.0).plus(self.range.power(2).negated());
        self.map(Range::acos, rest.sqrt().reciprocal().negated())
    }

    fn atan(self) -> Self {
        let slope = thin(1.0).plus(self.range.power(2)).reciprocal();
        self.map(Range::atan, slope)
    }

    fn atan2(self, x: Self) -> Self {
        if x.range.interval.lo > 0.0 {
            return (self / x).atan();
        }
        Self::jumping(Range::ANGLE, Range::ANGLE, self.half.max(x.half))
    }

    fn sinh(self) -> Self {
        self.map(Range::sinh, self.range.cosh())
    }

    fn cosh(self) -> Self {
        self.map(Range::cosh, self.range.sinh())
    }

    fn tanh(self) -> Self {
        let slope = self.range.cosh().power(2).reciprocal();
        self.map(Range::tanh, slope)
    }

    fn exp(self) -> Self {
        self.map(Range::exp, self.range.exp())
    }

    fn ln(self) -> Self {
        self.map(Range::ln, self.range.reciprocal())
    }

    fn sqrt(self) -> Self {
        let slope = self.range.sqrt().times(thin(2.0)).reciprocal();
        self.map(Range::sqrt, slope)
    }

    fn abs(self) -> Self {
        let Interval { lo, hi } = self.range.interval;
        if lo >= 0.0 {
            self
        } else if hi <= 0.0 {
            -self
        } else {
            let slopes = Range::of(Interval { lo: -1.0, hi: 1.0 });
            self.map(Range::abs, slopes)
        }
    }

    fn sign(self) -> Self {
        Self::jumping(self.range.sign(), self.middle.sign(), self.half)
    }

    fn powf(self, exponent: Self) -> Self {
        let power = self.range.real_power(exponent.range);
        let by_base = exponent.range.times(self.slope);
        let by_base = by_base.times(self.range.reciprocal());
        let by_exponent = exponent.slope.times(self.range.ln());
        Self::new(
            power,
            self.middle.real_power(exponent.middle),
            power.times(by_base.plus(by_exponent)),
            self.half.max(exponent.half),
        )
    }

    fn if_less(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        let answers = [a.range.is_less(b.range), a.middle.is_less(b.middle)];
        Self::choose(answers, then, otherwise)
    }

    fn if_less_or_equal(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
        Self::if_less(b, a, otherwise, then)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of an interval.
    const SAMPLES: usize = 200;

    fn holds<F: Fn(f64) -> f64>(of: Enclosure, [from, to]: [f64; 2], f: F) -> bool {
        (0..=SAMPLES).all(|i| {
            let value = f((from + (to - from) * i as f64 / SAMPLES as f64).min(to));
            value.is_nan() || of.range().contains(value)
        })
    }

    macro_rules! enclosed {
        ($t:ident, $span:expr, $f:expr) => {{
            fn function<T: Real>($t: T) -> T {
                $f
            }
            let [from, to] = $span;
            let of = function(Enclosure::time(from, to));
            assert!(
                holds(of, [from, to], function::<f64>),
                "{} {:?}",
                stringify!($f),
                of
            );
            of
        }};
    }

    #[test]
    fn a_polynomial_and_what_is_made_of_it_stay_within_their_bounds() {
        // 1 - 2 s + 3 s^2 over times from 2 to 2.5.
        let [from, to] = [2.0, 2.5];
        let of = Enclosure::polynomial(&[1.0, -2.0, 3.0], 0.25);
        let departure = |t: f64| (t - 2.25) / 0.25;
        let f = |t: f64| 1.0 - 2.0 * departure(t) + 3.0 * departure(t).powi(2);
        assert!(holds(of, [from, to], f));
        assert!(holds(of.sin(), [from, to], |t| libm::sin(f(t))));
        // The largest slope is 8 halves a half.
        assert!((of.steepness() - 32.0).abs() < 1e-9, "{of:?}");
    }

    fn n<T: Real>(value: f64) -> T {
        T::constant(value)
    }

    #[test]
    fn every_function_stays_within_its_bounds() {
        for span in [
            [0.3, 0.9],
            [-0.7, 0.4],
            [2.0, 9.0],
            [-3.0, -2.5],
            [0.0, 0.0],
        ] {
            enclosed!(t, span, (n::<T>(7.0) * t).sin() - n(0.99));
            enclosed!(t, span, (t * t - n(2.0)).cos() * t.exp());
            enclosed!(t, span, t.tan());
            enclosed!(t, span, (t * n(0.1)).asin() + (t * n(0.1)).acos());
            enclosed!(t, span, t.atan() + t.sinh() - t.cosh() + t.tanh());
            enclosed!(t, span, (t * t + n(1.0)).ln() / (t * t + n(0.5)).sqrt());
            enclosed!(t, span, t.abs() + (t - n(0.5)).sign());
            enclosed!(t, span, (t * t + n(1.0)).powf(t));
            enclosed!(t, span, t.atan2(t - n(0.4)));
            enclosed!(t, span, T::if_less(t, n(0.5), n(0.5), t));
            enclosed!(t, span, T::if_less_or_equal(t, n(0.5), t * t, n(-1.0)));
        }
    }

    #[test]
    fn short_intervals_are_bounded_to_the_square_of_their_length() {
        let short = 1e-4;
        let of = enclosed!(t, [2.0, 2.0 + short], t * t - n::<T>(4.0) * t + n(4.0));
        let width = of.range().hi - of.range().lo;
        assert!(width < 10.0 * short * short, "{width}");
        assert!(!of.keeps_its_sign() && !of.is_monotonic());
    }
}

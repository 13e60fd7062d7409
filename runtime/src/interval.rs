//! Interval arithmetic.
//!
//! Every operation rounds outwards, so the interval contains the true value. In addition each value records whether
//! it can be zero: a product of positive numbers stays positive where its lower bound underflows, and `exp` never
//! vanishes though its infimum is 0.

/// All numbers from `lo` to `hi`; the bounds may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound.
    pub hi: f64,
}

/// An interval, and whether the value can be zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The interval.
    pub interval: Interval,
    /// Whether no value is zero.
    pub nonzero: bool,
}

/// The double above π.
const PI_UP: f64 = 3.141_592_653_589_793_6;
/// The double above π/2.
const HALF_PI_UP: f64 = 1.570_796_326_794_896_8;

impl Interval {
    /// The whole line.
    pub const ALL: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    /// Whether it contains `x`.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Widened by one rounding on each side. A NaN bound becomes infinite.
    fn widened(self) -> Self {
        let lo = if self.lo.is_nan() {
            f64::NEG_INFINITY
        } else {
            self.lo.next_down()
        };
        let hi = if self.hi.is_nan() {
            f64::INFINITY
        } else {
            self.hi.next_up()
        };
        Self { lo, hi }
    }

    /// Widened by the errors of the elementary functions in a mathematical library.
    fn loosened(self) -> Self {
        let margin = |x: f64| x.abs() * 4.0 * f64::EPSILON + f64::MIN_POSITIVE;
        Self {
            lo: self.lo - margin(self.lo),
            hi: self.hi + margin(self.hi),
        }
        .widened()
    }

    fn meet(self, lo: f64, hi: f64) -> Self {
        Self {
            lo: self.lo.max(lo),
            hi: self.hi.min(hi),
        }
    }

    /// Image under an increasing function.
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            lo: f(self.lo),
            hi: f(self.hi),
        }
        .loosened()
    }
}

impl Range {
    /// All numbers.
    pub const ANY: Self = Self {
        interval: Interval::ALL,
        nonzero: false,
    };

    /// The range of `atan2`.
    pub const ANGLE: Self = Self {
        interval: Interval {
            lo: -PI_UP,
            hi: PI_UP,
        },
        nonzero: false,
    };

    /// All numbers of an interval.
    pub fn of(interval: Interval) -> Self {
        Self {
            interval,
            nonzero: interval.lo > 0.0 || interval.hi < 0.0,
        }
    }

    /// A number, up to its rounding unless it is an integer.
    pub fn number(value: f64, is_zero: bool) -> Self {
        let exact = value.fract() == 0.0 && value.abs() < 9e15;
        let interval = Interval {
            lo: value,
            hi: value,
        };
        let interval = if exact { interval } else { interval.widened() };
        Self {
            interval,
            nonzero: !is_zero,
        }
    }

    fn is_nonnegative(self) -> bool {
        self.interval.lo >= 0.0
    }

    fn is_nonpositive(self) -> bool {
        self.interval.hi <= 0.0
    }

    /// The opposite.
    #[must_use]
    pub fn negated(self) -> Self {
        Self {
            interval: Interval {
                lo: -self.interval.hi,
                hi: -self.interval.lo,
            },
            ..self
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let (a, b) = (self.interval, other.interval);
        let mut interval = Interval {
            lo: a.lo + b.lo,
            hi: a.hi + b.hi,
        };
        // Adding zero is exact.
        let zero = Interval { lo: 0.0, hi: 0.0 };
        if a != zero && b != zero {
            interval = interval.widened();
        }
        let mut same_sign = false;
        if self.is_nonnegative() && other.is_nonnegative() {
            interval = interval.meet(0.0, f64::INFINITY);
            same_sign = true;
        } else if self.is_nonpositive() && other.is_nonpositive() {
            interval = interval.meet(f64::NEG_INFINITY, 0.0);
            same_sign = true;
        }
        let nonzero = same_sign && (self.nonzero || other.nonzero);
        Self {
            interval,
            nonzero: nonzero || Self::of(interval).nonzero,
        }
    }

    /// The product.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        let (a, b) = (self.interval, other.interval);
        // Infinite bounds represent large finite numbers, whose product with zero is zero.
        let mul = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
        let corners = [
            mul(a.lo, b.lo),
            mul(a.lo, b.hi),
            mul(a.hi, b.lo),
            mul(a.hi, b.hi),
        ];
        let mut interval = Interval {
            lo: corners.iter().copied().fold(f64::INFINITY, f64::min),
            hi: corners.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        };
        let one = Interval { lo: 1.0, hi: 1.0 };
        if a != one && b != one {
            interval = interval.widened();
        }
        let alike = (self.is_nonnegative() && other.is_nonnegative())
            || (self.is_nonpositive() && other.is_nonpositive());
        let opposite = (self.is_nonnegative() && other.is_nonpositive())
            || (self.is_nonpositive() && other.is_nonnegative());
        if alike {
            interval = interval.meet(0.0, f64::INFINITY);
        }
        if opposite {
            interval = interval.meet(f64::NEG_INFINITY, 0.0);
        }
        Self {
            interval,
            nonzero: self.nonzero && other.nonzero,
        }
    }

    /// The reciprocal.
    #[must_use]
    pub fn reciprocal(self) -> Self {
        let Interval { lo, hi } = self.interval;
        let interval = if lo >= 0.0 {
            Interval {
                lo: 1.0 / hi,
                hi: 1.0 / lo.abs(),
            }
            .widened()
            .meet(0.0, f64::INFINITY)
        } else if hi <= 0.0 {
            // -0.0 would give the infinity of the wrong sign.
            Interval {
                lo: -1.0 / hi.abs(),
                hi: 1.0 / lo,
            }
            .widened()
            .meet(f64::NEG_INFINITY, 0.0)
        } else {
            Interval::ALL
        };
        Self {
            interval,
            nonzero: true,
        }
    }

    /// A power with an integer exponent.
    #[must_use]
    pub fn power(self, exponent: i32) -> Self {
        if exponent < 0 {
            return self.power(-exponent).reciprocal();
        }
        if exponent == 1 {
            return self;
        }
        let Interval { lo, hi } = self.interval;
        // The error of the power grows with the exponent.
        let margin = 1.0 + f64::from(exponent) * f64::EPSILON;
        let outwards = |x: f64, up: bool| {
            let y = x.powi(exponent);
            if (y > 0.0) == up {
                y * margin
            } else {
                y / margin
            }
        };
        let interval = if exponent % 2 == 1 {
            Interval {
                lo: outwards(lo, false),
                hi: outwards(hi, true),
            }
        } else {
            let far = lo.abs().max(hi.abs());
            let near = if lo <= 0.0 && hi >= 0.0 {
                0.0
            } else {
                lo.abs().min(hi.abs())
            };
            Interval {
                lo: outwards(near, false),
                hi: outwards(far, true),
            }
        };
        let mut interval = interval.widened();
        if exponent % 2 == 0 || lo >= 0.0 {
            interval = interval.meet(0.0, f64::INFINITY);
        } else if hi <= 0.0 {
            interval = interval.meet(f64::NEG_INFINITY, 0.0);
        }
        Self {
            interval,
            nonzero: self.nonzero,
        }
    }

    /// `a^b`. The exponent may happen to be an integer, so a negative base has a power.
    #[must_use]
    pub fn real_power(self, exponent: Self) -> Self {
        let base = self.interval;
        if base.lo < 0.0 {
            return Self {
                interval: Interval::ALL,
                nonzero: self.nonzero,
            };
        }
        let e = exponent.interval;
        let corners = [
            base.lo.powf(e.lo),
            base.lo.powf(e.hi),
            base.hi.powf(e.lo),
            base.hi.powf(e.hi),
        ];
        let mut interval = Interval {
            lo: 0.0,
            hi: f64::INFINITY,
        };
        if corners.iter().all(|c| c.is_finite()) && base.lo > 0.0 {
            // Monotonic in each argument: the extremes are at corners.
            interval = Interval {
                lo: corners.iter().copied().fold(f64::INFINITY, f64::min),
                hi: corners.iter().copied().fold(0.0, f64::max),
            }
            .loosened()
            .meet(0.0, f64::INFINITY);
        }
        Self {
            interval,
            nonzero: self.nonzero,
        }
    }

    /// Sine.
    #[must_use]
    pub fn sin(self) -> Self {
        self.circular(HALF_PI_UP)
    }

    /// Cosine.
    #[must_use]
    pub fn cos(self) -> Self {
        self.circular(0.0)
    }

    /// Inverse sine.
    #[must_use]
    pub fn asin(self) -> Self {
        let x = self.interval;
        let angle = x.meet(-1.0, 1.0).map(f64::asin).signed_as(x);
        self.alike(angle.meet(-HALF_PI_UP, HALF_PI_UP))
    }

    /// Inverse cosine.
    #[must_use]
    pub fn acos(self) -> Self {
        let Interval { lo, hi } = self.interval.meet(-1.0, 1.0);
        let (lo, hi) = (hi.acos(), lo.acos());
        Self::of(Interval { lo, hi }.loosened().meet(0.0, PI_UP))
    }

    /// Inverse tangent.
    #[must_use]
    pub fn atan(self) -> Self {
        let x = self.interval;
        let angle = x.map(f64::atan).signed_as(x);
        self.alike(angle.meet(-HALF_PI_UP, HALF_PI_UP))
    }

    /// Hyperbolic sine.
    #[must_use]
    pub fn sinh(self) -> Self {
        let x = self.interval;
        self.alike(x.map(f64::sinh).signed_as(x))
    }

    /// Hyperbolic cosine.
    #[must_use]
    pub fn cosh(self) -> Self {
        let Interval { lo, hi } = self.magnitude();
        let (lo, hi) = (lo.cosh(), hi.cosh());
        Self {
            interval: Interval { lo, hi }.loosened().meet(1.0, f64::INFINITY),
            nonzero: true,
        }
    }

    /// Hyperbolic tangent.
    #[must_use]
    pub fn tanh(self) -> Self {
        let x = self.interval;
        self.alike(x.map(f64::tanh).signed_as(x).meet(-1.0, 1.0))
    }

    /// Exponential.
    #[must_use]
    pub fn exp(self) -> Self {
        Self {
            interval: self.interval.map(f64::exp).meet(0.0, f64::INFINITY),
            nonzero: true,
        }
    }

    /// Natural logarithm.
    #[must_use]
    pub fn ln(self) -> Self {
        Self::of(self.interval.meet(0.0, f64::INFINITY).map(f64::ln))
    }

    /// Square root.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let root = self.interval.meet(0.0, f64::INFINITY).map(f64::sqrt);
        self.alike(root.meet(0.0, f64::INFINITY))
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        self.alike(self.magnitude())
    }

    /// −1, 0 or 1.
    #[must_use]
    pub fn sign(self) -> Self {
        let Interval { lo, hi } = self.interval;
        let lowest = if lo > 0.0 || (lo >= 0.0 && self.nonzero) {
            1.0
        } else if lo >= 0.0 {
            0.0
        } else {
            -1.0
        };
        let highest = if hi < 0.0 || (hi <= 0.0 && self.nonzero) {
            -1.0
        } else if hi <= 0.0 {
            0.0
        } else {
            1.0
        };
        self.alike(Interval {
            lo: lowest,
            hi: highest,
        })
    }

    /// The given interval with the zeros of this value.
    fn alike(self, interval: Interval) -> Self {
        Self { interval, ..self }
    }

    /// Whether all values are below those of another range; `None` if only some are.
    pub fn is_less(self, other: Self) -> Option<bool> {
        if self.interval.hi < other.interval.lo {
            Some(true)
        } else if self.interval.lo >= other.interval.hi {
            Some(false)
        } else {
            None
        }
    }

    /// The convex hull of both ranges.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            interval: Interval {
                lo: self.interval.lo.min(other.interval.lo),
                hi: self.interval.hi.max(other.interval.hi),
            },
            nonzero: self.nonzero && other.nonzero,
        }
    }

    /// The intersection of both ranges.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let Interval { lo, hi } = other.interval;
        let nonzero = self.nonzero || other.nonzero;
        let interval = self.interval.meet(lo, hi);
        Self {
            interval,
            nonzero: nonzero || Self::of(interval).nonzero,
        }
    }

    /// Range of the absolute value.
    fn magnitude(self) -> Interval {
        let Interval { lo, hi } = self.interval;
        if lo >= 0.0 {
            self.interval
        } else if hi <= 0.0 {
            self.negated().interval
        } else {
            Interval {
                lo: 0.0,
                hi: hi.max(-lo),
            }
        }
    }

    /// Range of `cos(x - peak)`.
    fn circular(self, peak: f64) -> Self {
        use std::f64::consts::PI;
        /// Angles beyond this are not reduced: their sine is bounded by ±1 only.
        const FAR: f64 = 1e12;
        /// A generous bound on the rounding error of the reduction of small angles.
        const SLACK: f64 = 1e-8;
        let Interval { lo, hi } = self.interval;
        if !(lo >= -FAR && hi <= FAR) {
            return Self::of(Interval { lo: -1.0, hi: 1.0 });
        }
        let slack = SLACK + lo.abs().max(hi.abs()) * f64::EPSILON;
        let (start, end) = ((lo - peak) / (2.0 * PI), (hi - peak) / (2.0 * PI));
        let passes =
            |offset: f64| (end - offset + slack).floor() >= (start - offset - slack).ceil();
        let ends = [(lo - peak).cos(), (hi - peak).cos()];
        let top = if passes(0.0) {
            1.0
        } else {
            ends[0].max(ends[1]) + SLACK * SLACK
        };
        let bottom = if passes(0.5) {
            -1.0
        } else {
            ends[0].min(ends[1]) - SLACK * SLACK
        };
        // The shift by the peak is exact to a few units in the last place of the angle.
        let blur = (lo.abs().max(hi.abs()) + 4.0) * f64::EPSILON;
        Self::of(
            Interval {
                lo: bottom - blur,
                hi: top + blur,
            }
            .meet(-1.0, 1.0),
        )
    }
}

impl Interval {
    /// Odd increasing functions keep the sign of their argument.
    fn signed_as(self, argument: Self) -> Self {
        let lo = if argument.lo >= 0.0 {
            self.lo.max(0.0)
        } else {
            self.lo
        };
        let hi = if argument.hi <= 0.0 {
            self.hi.min(0.0)
        } else {
            self.hi
        };
        Self { lo, hi }
    }
}

//! Exact rational numbers: machine integers while they fit, big integers otherwise.

use std::cmp::Ordering;
use std::fmt;
use std::ops::{Add, Mul, Neg};

use num_bigint::BigInt;
use num_rational::{BigRational, Ratio};
use num_traits::{Signed, ToPrimitive, Zero};

/// Bits of numerator and denominator together up to which a number is exact.
const MOST_BITS: u64 = 1 << 12;
/// Bits of a longer number after rounding.
const KEPT_BITS: u64 = 128;

/// An exact rational number in lowest terms; one that takes thousands of bits is rounded.
///
/// `Big` is used only where `Small` cannot represent the value, so equal numbers are equal variants and the
/// derived comparisons are those of the numbers.
#[derive(Clone, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
pub struct Rational(Repr);

#[derive(Clone, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
enum Repr {
    Small(Ratio<i64>),
    Big(Box<BigRational>),
}

impl Rational {
    /// Zero.
    pub const ZERO: Self = Self(Repr::Small(Ratio::new_raw(0, 1)));
    /// One.
    pub const ONE: Self = Self(Repr::Small(Ratio::new_raw(1, 1)));
    /// Minus one.
    pub const MINUS_ONE: Self = Self(Repr::Small(Ratio::new_raw(-1, 1)));

    /// `numerator / denominator`; the denominator must not be zero.
    pub fn new(numerator: i64, denominator: i64) -> Self {
        Self::from_big(BigRational::new(numerator.into(), denominator.into()))
    }

    /// From a big rational, stored small where it fits.
    pub fn from_big(value: BigRational) -> Self {
        let value = rounded(value);
        // i64::MIN has no negative and no absolute value; it is stored as `Big`.
        let small = |n: &BigInt| n.to_i64().filter(|&n| n != i64::MIN);
        match (small(value.numer()), small(value.denom())) {
            (Some(n), Some(d)) => Self(Repr::Small(Ratio::new_raw(n, d))),
            _ => Self(Repr::Big(Box::new(value))),
        }
    }

    /// A double, converted exactly, if it is finite.
    pub fn from_f64(value: f64) -> Option<Self> {
        BigRational::from_float(value).map(Self::from_big)
    }

    /// As a big rational.
    pub fn to_big(&self) -> BigRational {
        match &self.0 {
            Repr::Small(r) => BigRational::new_raw((*r.numer()).into(), (*r.denom()).into()),
            Repr::Big(r) => (**r).clone(),
        }
    }

    /// Numerator and denominator where both are machine integers.
    pub fn as_small(&self) -> Option<(i64, i64)> {
        match &self.0 {
            Repr::Small(r) => Some((*r.numer(), *r.denom())),
            Repr::Big(_) => None,
        }
    }

    /// The integer that the number equals, if any.
    pub fn as_integer(&self) -> Option<i64> {
        self.as_small().filter(|&(_, d)| d == 1).map(|(n, _)| n)
    }

    /// Nearest double.
    pub fn to_f64(&self) -> f64 {
        match &self.0 {
            // Both exact in a double: the quotient is correctly rounded.
            Repr::Small(r) if r.numer().abs() < (1 << 53) && *r.denom() < (1 << 53) => {
                *r.numer() as f64 / *r.denom() as f64
            }
            _ => self.to_big().to_f64().unwrap_or(f64::NAN),
        }
    }

    /// Whether it is in the range of doubles: neither overflowing nor, unless it is zero, underflowing.
    pub fn is_double(&self) -> bool {
        let value = self.to_f64();
        value.is_finite() && (value != 0.0 || self.is_zero())
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        *self == Self::ZERO
    }

    /// Whether it is one.
    pub fn is_one(&self) -> bool {
        *self == Self::ONE
    }

    /// Whether it is below zero.
    pub fn is_negative(&self) -> bool {
        match &self.0 {
            Repr::Small(r) => *r.numer() < 0,
            Repr::Big(r) => r.is_negative(),
        }
    }

    /// Absolute value.
    #[must_use]
    pub fn abs(&self) -> Self {
        if self.is_negative() {
            -self
        } else {
            self.clone()
        }
    }

    /// One over it; the number must not be zero.
    #[must_use]
    pub fn recip(&self) -> Self {
        match &self.0 {
            Repr::Small(r) => Self(Repr::Small(r.recip())),
            Repr::Big(r) => Self::from_big(r.recip()),
        }
    }

    /// Integer power. `None` for zero to a negative exponent, or if the result would be too long.
    pub fn checked_pow(&self, exponent: i32) -> Option<Self> {
        if exponent == 1 || self.is_one() {
            return Some(self.clone());
        }
        if self.is_zero() && exponent < 0 {
            return None;
        }
        if exponent == -1 {
            return Some(self.recip());
        }
        let base = self.to_big();
        let bits = base.numer().bits() + base.denom().bits();
        (bits * u64::from(exponent.unsigned_abs()) <= MOST_BITS || bits <= 2)
            .then(|| Self::from_big(num_traits::Pow::pow(base, exponent)))
    }

    /// The positive number of which all of `values` are integer multiples without a common divisor.
    pub fn content<'a>(values: impl Iterator<Item = &'a Self>) -> Self {
        use num_integer::Integer;
        let mut small = (0_i64, 1_i64);
        let mut values = values;
        let mut left = None;
        for value in values.by_ref() {
            let joined = value.as_small().and_then(|(n, d)| {
                let denominator = (small.1 / small.1.gcd(&d)).checked_mul(d)?;
                Some((small.0.gcd(&n), denominator))
            });
            if let Some(joined) = joined {
                small = joined;
            } else {
                left = Some(value);
                break;
            }
        }
        let Some(value) = left else {
            return if small.0 == 0 {
                Self::ONE
            } else {
                Self(Repr::Small(Ratio::new(small.0, small.1)))
            };
        };
        let values = std::iter::once(value).chain(values);
        let (mut numerator, mut denominator) = (BigInt::from(small.0), BigInt::from(small.1));
        for value in values {
            let value = value.to_big();
            numerator = numerator.gcd(value.numer());
            denominator = denominator.lcm(value.denom());
        }
        if numerator.is_zero() {
            Self::ONE
        } else {
            Self::from_big(BigRational::new(numerator, denominator))
        }
    }
}

/// Rounds a number of more than `MOST_BITS` bits to about `KEPT_BITS` leading bits, with a bounded exponent.
/// Such numbers arise only from values outside the range of doubles, and must not slow down further
/// operations.
fn rounded(value: BigRational) -> BigRational {
    let (over, under) = (value.numer().bits(), value.denom().bits());
    if over + under <= MOST_BITS {
        return value;
    }
    let [cut_over, cut_under] = [over, under].map(|bits| bits.saturating_sub(KEPT_BITS));
    let quotient = BigRational::new(value.numer() >> cut_over, value.denom() >> cut_under);
    let power = |bits: u64| BigInt::from(1) << bits.min(MOST_BITS / 2 - KEPT_BITS);
    if cut_over >= cut_under {
        quotient * power(cut_over - cut_under)
    } else {
        quotient / power(cut_under - cut_over)
    }
}

/// Both numbers, if they are integers: the common case needs no common denominator.
fn integers(a: &Rational, b: &Rational) -> Option<(i64, i64)> {
    Some((a.as_integer()?, b.as_integer()?))
}

impl Add for &Rational {
    type Output = Rational;

    fn add(self, other: Self) -> Rational {
        if let Some(sum) = integers(self, other).and_then(|(a, b)| a.checked_add(b)) {
            return Rational::from(sum);
        }
        if let (Repr::Small(a), Repr::Small(b)) = (&self.0, &other.0)
            && let Some(sum) = num_traits::CheckedAdd::checked_add(a, b)
            && *sum.numer() != i64::MIN
        {
            return Rational(Repr::Small(sum));
        }
        Rational::from_big(self.to_big() + other.to_big())
    }
}

impl Mul for &Rational {
    type Output = Rational;

    fn mul(self, other: Self) -> Rational {
        // A long number times one needs no common divisor.
        if self.is_one() {
            return other.clone();
        }
        if other.is_one() {
            return self.clone();
        }
        if let Some(product) = integers(self, other).and_then(|(a, b)| a.checked_mul(b)) {
            return Rational::from(product);
        }
        if let (Repr::Small(a), Repr::Small(b)) = (&self.0, &other.0)
            && let Some(product) = num_traits::CheckedMul::checked_mul(a, b)
            && *product.numer() != i64::MIN
        {
            return Rational(Repr::Small(product));
        }
        Rational::from_big(self.to_big() * other.to_big())
    }
}

impl Neg for &Rational {
    type Output = Rational;

    fn neg(self) -> Rational {
        match &self.0 {
            Repr::Small(r) => Rational(Repr::Small(-r)),
            Repr::Big(r) => Rational::from_big(-(**r).clone()),
        }
    }
}

impl From<i64> for Rational {
    fn from(value: i64) -> Self {
        if value == i64::MIN {
            return Self::from_big(BigRational::from_integer(value.into()));
        }
        Self(Repr::Small(Ratio::new_raw(value, 1)))
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Rational {
    fn cmp(&self, other: &Self) -> Ordering {
        match (&self.0, &other.0) {
            (Repr::Small(a), Repr::Small(b)) => a.cmp(b),
            _ => self.to_big().cmp(&other.to_big()),
        }
    }
}

impl fmt::Display for Rational {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Repr::Small(r) => r.fmt(f),
            Repr::Big(r) => r.fmt(f),
        }
    }
}

impl fmt::Debug for Rational {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

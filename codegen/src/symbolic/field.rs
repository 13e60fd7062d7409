//! Arithmetic in the prime field of `2^61 - 1` elements and on its unit circle.
//!
//! The prime is a Mersenne number, so a product is reduced by one addition. It is 3 modulo 4, which
//! has two consequences that [`identity`](super::identity) rests on:
//!
//! - `-1` has no square root, hence `1 + t²` is never zero and the rational parametrisation of the
//!   unit circle is defined for every `t`;
//! - the unit circle `c² + s² = 1` is a cyclic group of `p + 1 = 2^61` elements, so an angle can be
//!   divided by every odd number in exactly one way.

use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_traits::ToPrimitive;

use super::Rational;

/// The prime.
pub(super) const PRIME: u64 = (1 << 61) - 1;

/// An element of the field, below [`PRIME`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Element(u64);

impl Element {
    pub(super) const ZERO: Self = Self(0);
    pub(super) const ONE: Self = Self(1);
    /// `1/2`
    pub(super) const HALF: Self = Self(1 << 60);

    /// The residue of any 64-bit number.
    pub(super) const fn new(value: u64) -> Self {
        let folded = (value & PRIME) + (value >> 61);
        Self(if folded >= PRIME { folded - PRIME } else { folded })
    }

    /// Its representative below the prime.
    pub(super) const fn get(self) -> u64 {
        self.0
    }

    /// The residue of a signed number.
    pub(super) fn from_signed(value: i64) -> Self {
        let magnitude = Self::new(value.unsigned_abs());
        if value < 0 { -magnitude } else { magnitude }
    }

    /// The residue of a big integer.
    fn from_big(value: &BigInt) -> Self {
        use num_integer::Integer;
        value.mod_floor(&PRIME.into()).to_u64().map_or(Self::ZERO, Self)
    }

    /// A rational number; `None` where the prime divides its denominator.
    pub(super) fn from_rational(value: &Rational) -> Option<Self> {
        match value.as_small() {
            Some((n, 1)) => Some(Self::from_signed(n)),
            Some((n, d)) => Some(Self::from_signed(n) * Self::from_signed(d).inverse()?),
            None => {
                let value = value.to_big();
                Some(Self::from_big(value.numer()) * Self::from_big(value.denom()).inverse()?)
            }
        }
    }

    pub(super) const fn is_zero(self) -> bool {
        self.0 == 0
    }

    /// The one of `±self` in the lower half, and whether the sign changed.
    pub(super) fn without_sign(self) -> (Self, bool) {
        if self.0 > PRIME / 2 { (-self, true) } else { (self, false) }
    }

    /// `self^(2^times)`
    fn squared(self, times: u32) -> Self {
        (0..times).fold(self, |x, _| x * x)
    }

    /// Power by repeated squaring.
    pub(super) fn pow(self, mut exponent: u64) -> Self {
        let (mut base, mut power) = (self, Self::ONE);
        while exponent != 0 {
            if exponent & 1 == 1 {
                power = power * base;
            }
            base = base * base;
            exponent >>= 1;
        }
        power
    }

    /// `1/self`; zero has none.
    pub(super) fn inverse(self) -> Option<Self> {
        if self.is_zero() {
            return None;
        }
        if self == Self::ONE {
            return Some(self);
        }
        // self^(p-2), where p - 2 = 4 (2^59 - 1) + 1; `ones_n` is self^(2^n - 1).
        let ones_2 = self.squared(1) * self;
        let ones_3 = ones_2.squared(1) * self;
        let ones_6 = ones_3.squared(3) * ones_3;
        let ones_7 = ones_6.squared(1) * self;
        let ones_14 = ones_7.squared(7) * ones_7;
        let ones_28 = ones_14.squared(14) * ones_14;
        let ones_29 = ones_28.squared(1) * self;
        let ones_58 = ones_29.squared(29) * ones_29;
        let ones_59 = ones_58.squared(1) * self;
        Some(ones_59.squared(2) * self)
    }

    /// The square root that is a square itself; `None` for half of the elements.
    pub(super) fn square_root(self) -> Option<Self> {
        // (p + 1) / 4 = 2^59
        Some(self.squared(59)).filter(|&root| root * root == self)
    }
}

impl Add for Element {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = self.0 + other.0;
        Self(if sum >= PRIME { sum - PRIME } else { sum })
    }
}

impl Sub for Element {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Element {
    type Output = Self;

    fn neg(self) -> Self {
        Self(if self.0 == 0 { 0 } else { PRIME - self.0 })
    }
}

impl Mul for Element {
    type Output = Self;

    #[expect(clippy::cast_possible_truncation, reason = "both halves are below 2^61")]
    fn mul(self, other: Self) -> Self {
        let product = u128::from(self.0) * u128::from(other.0);
        let sum = (product as u64 & PRIME) + (product >> 61) as u64;
        Self(if sum >= PRIME { sum - PRIME } else { sum })
    }
}

/// A point of the unit circle: cosine and sine of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rotation {
    pub(super) cos: Element,
    pub(super) sin: Element,
}

impl Rotation {
    /// No turn.
    pub(super) const NONE: Self = Self { cos: Element::ONE, sin: Element::ZERO };

    /// The point `((1 - t²) / (1 + t²), 2t / (1 + t²))`.
    pub(super) fn from_parameter(t: Element) -> Self {
        let square = t * t;
        // 1 + t² = 0 has no solution; see the module's head.
        let scale = (Element::ONE + square).inverse().unwrap_or(Element::ONE);
        Self { cos: (Element::ONE - square) * scale, sin: (t + t) * scale }
    }

    /// The angles added.
    pub(super) fn then(self, other: Self) -> Self {
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.sin * other.cos + self.cos * other.sin,
        }
    }

    /// The opposite angle.
    pub(super) fn reversed(self) -> Self {
        Self { cos: self.cos, sin: -self.sin }
    }

    /// A multiple of the angle.
    pub(super) fn times(self, mut multiple: u64) -> Self {
        let (mut base, mut turn) = (self, Self::NONE);
        while multiple != 0 {
            if multiple & 1 == 1 {
                turn = turn.then(base);
            }
            base = base.then(base);
            multiple >>= 1;
        }
        turn
    }
}

/// A pseudo-random element that is a function of its arguments.
///
/// Folded wide multiplications mix all bits; the constants are odd and without pattern.
pub(super) fn keyed(key: u64, tag: u64, arguments: [u64; 2]) -> Element {
    let mut state = mix(key ^ 0x9e37_79b9_7f4a_7c15, tag ^ 0xd1b5_4a32_d192_ed03);
    for argument in arguments {
        state = mix(state ^ argument, 0xa076_1d64_78bd_642f ^ state.rotate_left(23));
        state = mix(state ^ 0xe703_7ed1_a0b4_28db, state.rotate_right(29) ^ argument);
    }
    Element::new(state)
}

#[expect(clippy::cast_possible_truncation, reason = "the two halves are folded")]
fn mix(a: u64, b: u64) -> u64 {
    let product = u128::from(a | 1) * u128::from(b ^ 0x8ebc_6af0_9c88_c6e3);
    let mut folded = (product as u64) ^ ((product >> 64) as u64) ^ a;
    folded ^= folded >> 32;
    folded = folded.wrapping_mul(0xd6e8_feb8_6659_fd93);
    folded ^ (folded >> 32)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn sample() -> impl Iterator<Item = Element> {
        (0..200).map(|i| keyed(1, 2, [i, 3]))
    }

    #[test]
    fn inverses_and_roots_invert() {
        for x in sample() {
            assert_eq!(x * x.inverse().unwrap(), Element::ONE);
            assert_eq!(x.pow(PRIME - 1), Element::ONE);
            let square = x * x;
            let root = square.square_root().unwrap();
            assert!(root == x || root == -x);
            assert!(root.square_root().is_some(), "the root is a square itself");
            // Exactly one of x, -x is a square.
            assert_ne!(x.square_root().is_some(), (-x).square_root().is_some());
        }
        assert_eq!(Element::HALF + Element::HALF, Element::ONE);
        assert_eq!(Element::ZERO.inverse(), None);
    }

    #[test]
    fn rationals_keep_their_relations() {
        let third = Element::from_rational(&Rational::new(1, 3)).unwrap();
        assert_eq!(third + third + third, Element::ONE);
        let minus = Element::from_rational(&Rational::new(-7, 1)).unwrap();
        assert_eq!(minus + Element::new(7), Element::ZERO);
        let big = Rational::new(i64::MAX, 2).checked_pow(3).unwrap();
        let direct = (Element::from_signed(i64::MAX) * Element::HALF).pow(3);
        assert_eq!(Element::from_rational(&big), Some(direct));
    }

    #[test]
    fn the_circle_is_a_group_of_a_power_of_two() {
        for t in sample() {
            let point = Rotation::from_parameter(t);
            assert_eq!(point.cos * point.cos + point.sin * point.sin, Element::ONE);
            assert_eq!(point.times(1 << 61), Rotation::NONE);
            assert_eq!(point.then(point.reversed()), Rotation::NONE);
            assert_eq!(point.times(3), point.then(point).then(point));
        }
    }
}

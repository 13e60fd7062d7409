//! Arithmetic in a prime field and on its unit circle.
//!
//! The prime `p = 2^61 - 6157521` lies close below a power of two, so a product is reduced without a
//! division. It has four more properties that [`identity`](super::identity) requires:
//!
//! - `-1` has no square root. So `1 + t²` is never zero and the rational parametrisation of the unit
//!   circle is defined for every `t`.
//! - All primes up to 31 have square roots: `√2`, `√3` and the like are field elements.
//! - The unit circle `c² + s² = 1` is a cyclic group of `p + 1 = 2^4 · 3 · q` elements with a large prime
//!   `q`. So an angle can be divided by every number without factors 2 and 3 in exactly one way.
//! - The circle has points of order 48: sine and cosine of `π/24`.

use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_traits::ToPrimitive;

use super::Rational;

/// How far the prime lies below `2^61`.
const GAP: u64 = 6_157_521;
/// The prime.
pub(super) const PRIME: u64 = (1 << 61) - GAP;
/// `p - 2 = 2^23 (2^38 - 1) + TAIL`, the exponent of inversion.
const TAIL: u64 = (1 << 23) - GAP - 2;
/// The lowest 61 bits.
const LOW: u64 = (1 << 61) - 1;

/// An element of the field, below [`PRIME`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Element(u64);

impl Element {
    pub(crate) const ZERO: Self = Self(0);
    pub(crate) const ONE: Self = Self(1);
    /// `1/2`
    pub(super) const HALF: Self = Self(PRIME.div_ceil(2));

    /// The residue of any 64-bit number.
    pub(crate) const fn new(value: u64) -> Self {
        // 2^61 = GAP
        let folded = (value & LOW) + (value >> 61) * GAP;
        Self(if folded >= PRIME {
            folded - PRIME
        } else {
            folded
        })
    }

    /// The representative in `0..p`.
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
        value
            .mod_floor(&PRIME.into())
            .to_u64()
            .map_or(Self::ZERO, Self)
    }

    /// A rational number; `None` where the prime divides its denominator.
    pub(crate) fn from_rational(value: &Rational) -> Option<Self> {
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
    pub(crate) fn without_sign(self) -> (Self, bool) {
        if self.0 > PRIME / 2 {
            (-self, true)
        } else {
            (self, false)
        }
    }

    /// `self^(2^times)`
    fn squared(self, times: u32) -> Self {
        (0..times).fold(self, |x, _| x * x)
    }

    /// Power by repeated squaring.
    pub(super) fn pow(self, exponent: u64) -> Self {
        repeated(self, Self::ONE, exponent, |a, b| a * b)
    }

    /// `1/self`; zero has none.
    pub(crate) fn inverse(self) -> Option<Self> {
        if self.is_zero() {
            return None;
        }
        if self == Self::ONE {
            return Some(self);
        }
        // self^(p-2), where p - 2 = 2^23 (2^38 - 1) + TAIL; `ones_n` is self^(2^n - 1).
        let ones_2 = self.squared(1) * self;
        let ones_4 = ones_2.squared(2) * ones_2;
        let ones_8 = ones_4.squared(4) * ones_4;
        let ones_9 = ones_8.squared(1) * self;
        let ones_18 = ones_9.squared(9) * ones_9;
        let ones_19 = ones_18.squared(1) * self;
        let ones_38 = ones_19.squared(19) * ones_19;
        let mut power = ones_38;
        for bit in (0..23).rev() {
            power = power * power;
            if TAIL >> bit & 1 == 1 {
                power = power * self;
            }
        }
        Some(power)
    }

    /// The square root that is a square itself; `None` for half of the elements.
    pub(super) fn square_root(self) -> Option<Self> {
        // p is 3 modulo 4.
        Some(self.pow(PRIME.div_ceil(4))).filter(|&root| root * root == self)
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

    #[expect(
        clippy::cast_possible_truncation,
        reason = "what is cut off is in the other half"
    )]
    fn mul(self, other: Self) -> Self {
        let product = u128::from(self.0) * u128::from(other.0);
        // 2^61 = GAP, twice: below 2^122, then below 2^85, then below 2^62.
        let once = u128::from(product as u64 & LOW) + (product >> 61) * u128::from(GAP);
        let twice = (once as u64 & LOW) + (once >> 61) as u64 * GAP;
        Self(if twice >= PRIME { twice - PRIME } else { twice })
    }
}

/// A point of the unit circle: cosine and sine of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rotation {
    pub(super) cos: Element,
    pub(super) sin: Element,
}

impl Rotation {
    /// The identity rotation.
    pub(super) const NONE: Self = Self {
        cos: Element::ONE,
        sin: Element::ZERO,
    };
    /// `π/24`: the point of order 48 with `2 cos(π/6) = √3` and `2 cos(π/4) = √2`, where the roots are
    /// those of [`Element::square_root`].
    pub(super) const PI_OVER_24: Self = Self {
        cos: Element(1_819_118_944_632_605_801),
        sin: Element(1_757_308_138_299_105_798),
    };

    /// The point `((1 - t²) / (1 + t²), 2t / (1 + t²))`.
    pub(super) fn from_parameter(t: Element) -> Self {
        let square = t * t;
        // 1 + t² = 0 has no solution; see the module documentation.
        let scale = (Element::ONE + square).inverse().unwrap_or(Element::ONE);
        Self {
            cos: (Element::ONE - square) * scale,
            sin: (t + t) * scale,
        }
    }

    /// Composition: the sum of the angles.
    pub(super) fn then(self, other: Self) -> Self {
        Self {
            cos: self.cos * other.cos - self.sin * other.sin,
            sin: self.sin * other.cos + self.cos * other.sin,
        }
    }

    /// The opposite angle.
    pub(super) fn reversed(self) -> Self {
        Self {
            cos: self.cos,
            sin: -self.sin,
        }
    }

    /// A multiple of the angle.
    pub(super) fn times(self, multiple: u64) -> Self {
        repeated(self, Self::NONE, multiple, Self::then)
    }
}

/// An operation applied to this many copies of an element, by repeated doubling.
fn repeated<T: Copy>(element: T, neutral: T, mut times: u64, of: impl Fn(T, T) -> T) -> T {
    let (mut base, mut whole) = (element, neutral);
    while times != 0 {
        if times & 1 == 1 {
            whole = of(whole, base);
        }
        base = of(base, base);
        times >>= 1;
    }
    whole
}

/// A pseudo-random element, a function of its arguments.
///
/// Folded wide multiplications mix all bits; the constants are odd and without pattern.
pub(super) fn keyed(key: u64, tag: u64, arguments: [u64; 2]) -> Element {
    let mut state = mix(key ^ 0x9e37_79b9_7f4a_7c15, tag ^ 0xd1b5_4a32_d192_ed03);
    for argument in arguments {
        state = mix(
            state ^ argument,
            0xa076_1d64_78bd_642f ^ state.rotate_left(23),
        );
        state = mix(
            state ^ 0xe703_7ed1_a0b4_28db,
            state.rotate_right(29) ^ argument,
        );
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
    fn the_circle_is_a_cyclic_group() {
        for t in sample() {
            let point = Rotation::from_parameter(t);
            assert_eq!(point.cos * point.cos + point.sin * point.sin, Element::ONE);
            assert_eq!(point.times(PRIME + 1), Rotation::NONE);
            assert_eq!(point.then(point.reversed()), Rotation::NONE);
            assert_eq!(point.times(3), point.then(point).then(point));
        }
    }

    #[test]
    fn parts_of_pi_and_square_roots_agree() {
        let multiple = |n| Rotation::PI_OVER_24.times(n);
        let root = |n| Element::new(n).square_root().unwrap();
        let twice = |x: Element| x + x;
        let point = |n| (multiple(n).cos, multiple(n).sin);
        let doubled = |n| (twice(multiple(n).cos), twice(multiple(n).sin));
        assert_eq!(point(24), (-Element::ONE, Element::ZERO));
        assert_eq!(point(12), (Element::ZERO, Element::ONE));
        assert_eq!(doubled(8), (Element::ONE, root(3)));
        assert_eq!(doubled(6), (root(2), root(2)));
        assert_eq!(root(2) * root(3), root(6));
        for prime in [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31] {
            assert!(Element::new(prime).square_root().is_some());
        }
    }

    #[test]
    fn products_are_reduced_at_the_edges() {
        let big = |v: u64| num_bigint::BigInt::from(v);
        for a in [0, 1, 2, GAP, PRIME / 2, PRIME - 2, PRIME - 1] {
            for b in [0, 1, 3, GAP, PRIME / 2 + 1, PRIME - 1] {
                let product = big(a) * big(b) % big(PRIME);
                assert_eq!(big((Element(a) * Element(b)).get()), product);
            }
        }
        assert_eq!(Element::new(u64::MAX).get(), u64::MAX % PRIME);
        assert_eq!(Element::new(PRIME).get(), 0);
    }
}

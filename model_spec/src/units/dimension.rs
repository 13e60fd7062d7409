//! Dimensions: rational powers of the seven base units.

use num_rational::Ratio;
use num_traits::{CheckedAdd, CheckedMul, CheckedSub, Zero};

/// Exponent of one base unit.
pub type Exponent = Ratio<i32>;

/// The base units, in the order of the exponents of a [`Dimension`].
pub const BASE_UNITS: [&str; 7] = ["m", "kg", "s", "A", "K", "mol", "cd"];

/// Largest numerator or denominator of an exponent.
const MAX_PART: i32 = 1000;

/// The dimension of a quantity; angles are dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dimension {
    exponents: [Exponent; 7],
}

/// An exponent grew beyond what any physical quantity needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an exponent of the unit is too large")]
pub struct DimensionOverflow;

impl Dimension {
    /// A pure number, or an angle.
    pub const NONE: Self = Self::integers([0, 0, 0, 0, 0, 0, 0]);
    /// A length.
    pub const LENGTH: Self = Self::integers([1, 0, 0, 0, 0, 0, 0]);
    /// A mass.
    pub const MASS: Self = Self::integers([0, 1, 0, 0, 0, 0, 0]);
    /// A time.
    pub const TIME: Self = Self::integers([0, 0, 1, 0, 0, 0, 0]);
    /// A velocity.
    pub const VELOCITY: Self = Self::integers([1, 0, -1, 0, 0, 0, 0]);
    /// An acceleration.
    pub const ACCELERATION: Self = Self::integers([1, 0, -2, 0, 0, 0, 0]);
    /// A force.
    pub const FORCE: Self = Self::integers([1, 1, -2, 0, 0, 0, 0]);
    /// A torque or an energy.
    pub const TORQUE: Self = Self::integers([2, 1, -2, 0, 0, 0, 0]);
    /// A power.
    pub const POWER: Self = Self::integers([2, 1, -3, 0, 0, 0, 0]);
    /// A moment of inertia.
    pub const INERTIA: Self = Self::integers([2, 1, 0, 0, 0, 0, 0]);

    /// The dimension with these integer exponents, in the order of [`BASE_UNITS`].
    pub const fn integers(powers: [i32; 7]) -> Self {
        let mut exponents = [Ratio::new_raw(0, 1); 7];
        let mut i = 0;
        while i < 7 {
            exponents[i] = Ratio::new_raw(powers[i], 1);
            i += 1;
        }
        Self { exponents }
    }

    /// The exponents, in the order of [`BASE_UNITS`].
    pub const fn exponents(&self) -> &[Exponent; 7] {
        &self.exponents
    }

    /// Whether this is a pure number or an angle.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Dimension of a product.
    pub fn times(&self, other: &Self) -> Result<Self, DimensionOverflow> {
        self.zip(other, CheckedAdd::checked_add)
    }

    /// Dimension of a quotient.
    pub fn over(&self, other: &Self) -> Result<Self, DimensionOverflow> {
        self.zip(other, CheckedSub::checked_sub)
    }

    /// Dimension of a power.
    pub fn power(&self, exponent: Exponent) -> Result<Self, DimensionOverflow> {
        let mut result = Self::NONE;
        for (target, own) in result.exponents.iter_mut().zip(&self.exponents) {
            // Zero stays zero, however large the exponent.
            if !own.is_zero() {
                *target = bounded(own.checked_mul(&exponent))?;
            }
        }
        Ok(result)
    }

    /// Dimension of the time derivative.
    pub fn rate(&self) -> Result<Self, DimensionOverflow> {
        self.over(&Self::TIME)
    }

    fn zip(
        &self,
        other: &Self,
        combine: fn(&Exponent, &Exponent) -> Option<Exponent>,
    ) -> Result<Self, DimensionOverflow> {
        let mut result = Self::NONE;
        for i in 0..7 {
            result.exponents[i] = bounded(combine(&self.exponents[i], &other.exponents[i]))?;
        }
        Ok(result)
    }
}

fn bounded(exponent: Option<Exponent>) -> Result<Exponent, DimensionOverflow> {
    exponent
        .filter(|e| e.numer().unsigned_abs() <= MAX_PART.unsigned_abs() && *e.denom() <= MAX_PART)
        .ok_or(DimensionOverflow)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_times_a_length_is_a_torque() {
        assert_eq!(
            Dimension::FORCE.times(&Dimension::LENGTH),
            Ok(Dimension::TORQUE)
        );
    }

    #[test]
    fn roots_and_powers_cancel() {
        let root = Dimension::LENGTH.power(Ratio::new(1, 2));
        let square = root.and_then(|d| d.power(Ratio::from_integer(2)));
        assert_eq!(square, Ok(Dimension::LENGTH));
    }

    #[test]
    fn exponents_are_bounded() {
        let mut dimension = Dimension::LENGTH;
        let overflow = (0..20).find_map(|_| {
            dimension
                .power(Ratio::from_integer(7))
                .map(|d| dimension = d)
                .err()
        });
        assert_eq!(overflow, Some(DimensionOverflow));
    }
}

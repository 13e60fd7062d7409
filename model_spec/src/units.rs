//! Units and dimensions.

mod dimension;
mod parse;
mod table;

use num_rational::BigRational;
use num_traits::{One, ToPrimitive};

pub use dimension::{BASE_UNITS, Dimension, DimensionOverflow, Exponent};
pub use parse::{UnitError, parse};
pub use table::{PREFIXES, UNITS, UnitEntry};

use crate::number::exact;

/// A unit as written, with its dimension and its size in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As written in the spec, e.g. `kg*m^2`.
    pub text: String,
    /// One of this unit in SI: 1 for SI units, π/180 for `deg`.
    pub scale: f64,
    /// Its dimension.
    pub dimension: Dimension,
    /// Rational part of the scale, exact: 1/180 for `deg`.
    pub factor: BigRational,
    /// Power of π in the scale: 1 for `deg`.
    pub pi_power: i8,
}

impl Unit {
    /// A unit of exactly `factor · π^pi_power` in SI.
    pub fn new(
        text: impl Into<String>,
        dimension: Dimension,
        factor: BigRational,
        pi_power: i8,
    ) -> Self {
        let scale = scaled(&factor, pi_power);
        Self {
            text: text.into(),
            scale,
            dimension,
            factor,
            pi_power,
        }
    }

    /// The SI unit of a dimension in its usual notation.
    pub fn si(dimension: Dimension) -> Self {
        let text = table::si_text(&dimension);
        Self::new(text, dimension, BigRational::one(), 0)
    }

    /// Whether numbers of this unit are numbers in SI.
    pub fn is_si(&self) -> bool {
        self.factor.is_one() && self.pi_power == 0
    }

    /// Whether it measures an angle: `rad`, `deg` or `mrad`, but not `1` or `%`, whose dimension is the
    /// same.
    pub fn is_angle(&self) -> bool {
        self.dimension.is_none() && self.has_angle()
    }

    /// Whether it contains an angle, as in `deg/s`, `rpm` and `N*m/rad`.
    pub fn has_angle(&self) -> bool {
        let mut symbols = self.text.split(|c: char| !c.is_alphabetic());
        symbols.any(parse::is_angle)
    }

    /// The value in SI of an exact number of this unit, rounded once.
    pub fn to_si(&self, value: &BigRational) -> f64 {
        scaled(&(value * &self.factor), self.pi_power)
    }

    /// The value in SI of a decimal number of this unit.
    pub fn read(&self, number: &str) -> Option<f64> {
        exact(number).ok().map(|number| self.to_si(&number))
    }

    /// A value in SI expressed in this unit.
    pub fn from_si(&self, value: f64) -> f64 {
        value / self.scale
    }
}

fn scaled(factor: &BigRational, pi_power: i8) -> f64 {
    let rational = factor.to_f64().unwrap_or(f64::NAN);
    if pi_power == 0 {
        rational
    } else {
        rational * std::f64::consts::PI.powi(i32::from(pi_power))
    }
}

/// Name of the quantity of a dimension, with its article: `a length`, `a force`.
pub fn quantity_name(dimension: &Dimension) -> String {
    table::quantity_word(dimension)
        .map_or_else(|| format!("`{}`", table::si_text(dimension)), str::to_owned)
}

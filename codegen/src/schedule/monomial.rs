//! Names products by their factors, independent of association: `m·(R·R)` and `(m·R)·R` are both
//! `m_R_squared`, in every function.

use rustc_hash::FxHashMap;

use super::names::{ArgumentNames, LONGEST, joined_up_to};
use crate::symbolic::Rational;
use crate::tape::{Argument, Arithmetic, Operation, Tape, Value};

/// Longest name of a product, or quotient, of two factors.
const LONGEST_OF_TWO: usize = 40;

/// A factor that is not itself a product, in the order used in names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Factor {
    /// A parameter by index.
    Parameter(u32),
    /// A value that is no product, or that the derivation named.
    Value(Value),
    /// Any other argument.
    Argument(Argument),
}

/// A number times powers of factors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Monomial {
    coefficient: Rational,
    powers: Vec<(Factor, i32)>,
}

impl Monomial {
    /// The monomial that a value represents, if any. `products` has the monomials of named values.
    pub(super) fn of(
        value: Value,
        tape: &Tape,
        products: &FxHashMap<Value, Monomial>,
    ) -> Option<Self> {
        let of = |value: &Value| Self::of(*value, tape, products);
        let Some(operation) = tape.unnamed(value) else {
            let known = products.get(&value).cloned();
            return Some(known.unwrap_or_else(|| Self::factor(Factor::Value(value))));
        };
        match operation {
            Operation::Constant(value) => Some(Self {
                coefficient: value.clone(),
                powers: Vec::new(),
            }),
            Operation::Argument(Argument::Parameter(i)) => {
                Some(Self::factor(Factor::Parameter(*i)))
            }
            Operation::Argument(argument) => Some(Self::factor(Factor::Argument(*argument))),
            Operation::Negate(a) => {
                let a = of(a)?;
                Some(Self {
                    coefficient: -&a.coefficient,
                    ..a
                })
            }
            Operation::Binary(Arithmetic::Multiply, a, b) => Some(of(a)?.times(&of(b)?, 1)),
            Operation::Binary(Arithmetic::Divide, a, b) => {
                let (above, below) = (of(a)?, of(b)?);
                (!below.coefficient.is_zero()).then(|| above.times(&below, -1))
            }
            _ => None,
        }
    }

    fn factor(factor: Factor) -> Self {
        Self {
            coefficient: Rational::ONE,
            powers: vec![(factor, 1)],
        }
    }

    /// `self · other^±1`
    fn times(mut self, other: &Self, sign: i32) -> Self {
        self.coefficient = if sign > 0 {
            &self.coefficient * &other.coefficient
        } else {
            &self.coefficient * &other.coefficient.recip()
        };
        for &(factor, power) in &other.powers {
            match self.powers.binary_search_by_key(&factor, |known| known.0) {
                Ok(place) => self.powers[place].1 += sign * power,
                Err(place) => self.powers.insert(place, (factor, sign * power)),
            }
        }
        self.powers.retain(|known| known.1 != 0);
        self
    }

    /// The number of factors that are written, the numeric one included.
    pub(super) fn length(&self) -> usize {
        usize::from(!self.coefficient.is_one()) + self.powers.len()
    }

    /// The values among the factors.
    pub(super) fn values(&self) -> impl Iterator<Item = Value> {
        self.powers.iter().filter_map(|(factor, _)| match factor {
            Factor::Value(value) => Some(*value),
            _ => None,
        })
    }

    /// Sort key in a sum: products of parameters in the order of declaration, then powers of one
    /// value in the order of definition, then the others.
    pub(super) fn place_in_sum(&self) -> (u8, u32) {
        let all_parameters = self
            .powers
            .iter()
            .all(|(factor, _)| matches!(factor, Factor::Parameter(_)));
        match *self.powers.as_slice() {
            [(Factor::Parameter(i), _), ..] if all_parameters => (0, i),
            [(Factor::Value(Value(i)), _)] => (1, i),
            _ => (2, 0),
        }
    }

    /// `m_R_squared`, `two_over_pivot`, `inv_R`, `tan_theta`; `None` where that would be too long.
    pub(super) fn name(&self, tape: &Tape, arguments: &ArgumentNames) -> Option<String> {
        let mut above = Vec::new();
        let mut below = Vec::new();
        if !self.coefficient.is_one() {
            above.push(arguments.constant(&self.coefficient));
        }
        for &(factor, power) in &self.powers {
            let name = match factor {
                Factor::Parameter(i) => arguments.get(Argument::Parameter(i)),
                Factor::Value(value) => tape.name(value)?,
                Factor::Argument(argument) => arguments.get(argument),
            };
            let sum = name.contains("_plus_") || name.contains("_minus_");
            let side = if power > 0 { &mut above } else { &mut below };
            side.push(match power.abs() {
                1 if sum && power > 0 && !side.is_empty() => format!("times_{name}"),
                _ if sum && self.length() + power.unsigned_abs() as usize > 2 => return None,
                1 => name.to_owned(),
                2 => format!("{name}_squared"),
                3 => format!("{name}_cubed"),
                _ => return None,
            });
        }
        // sin over cos is named as a tangent.
        for cosine in 0..below.len() {
            let Some(angle) = below[cosine].strip_prefix("cos_") else {
                continue;
            };
            let sine = format!("sin_{angle}");
            if let Some(place) = above.iter().position(|name| *name == sine) {
                above[place] = format!("tan_{angle}");
                below.remove(cosine);
                break;
            }
        }
        let sum = above.iter().any(|name| name.starts_with("times_"));
        let longest = if self.length() <= 2 && !sum {
            LONGEST_OF_TWO
        } else {
            LONGEST
        };
        let joined = |parts: &[&str]| joined_up_to(longest, parts);
        let words = |side: &[String]| joined(&side.iter().map(String::as_str).collect::<Vec<_>>());
        match (above.is_empty(), below.is_empty()) {
            (true, true) => Some(arguments.constant(&Rational::ONE)),
            (_, true) => words(&above),
            (true, _) => joined(&["inv", &words(&below)?]),
            _ => joined(&[&words(&above)?, "over", &words(&below)?]),
        }
    }
}

//! Expressions of emitted text under construction, with their printed width.

use rustc_hash::FxHashMap;

use super::monomial::Monomial;
use super::names::{ArgumentNames, joined};
use crate::symbolic::{Function, Relation};
use crate::tape::{Arithmetic, Operation, Tape, Value};

/// Precedence of the outermost operation of an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    Sum,
    Product,
    Sign,
    Atom,
}

/// A value with its printed width and precedence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub(super) value: Value,
    pub(super) width: usize,
    pub(super) level: Level,
}

impl Piece {
    fn new(value: Value, width: usize, level: Level) -> Self {
        Self {
            value,
            width,
            level,
        }
    }

    /// A value that prints as a name.
    pub(super) fn name(value: Value, name: &str) -> Self {
        Self::new(value, name.len(), Level::Atom)
    }

    /// Width including the parentheses required at precedence `level`.
    fn width_at(&self, level: Level) -> usize {
        self.width + if self.level < level { 2 } else { 0 }
    }

    /// Width of `self ∘ right`.
    pub(super) fn width_of_binary(&self, operation: Arithmetic, right: &Self) -> usize {
        let (level, right_level) = levels(operation);
        self.width_at(level) + 3 + right.width_at(right_level)
    }

    /// `self ∘ right`
    pub(super) fn binary(self, tape: &mut Tape, operation: Arithmetic, right: Self) -> Self {
        let width = self.width_of_binary(operation, &right);
        let value = tape.binary(operation, self.value, right.value);
        Self::new(value, width, levels(operation).0)
    }

    /// `-self`
    pub(super) fn negated(self, tape: &mut Tape) -> Self {
        let value = tape.push(Operation::Negate(self.value));
        Self::new(value, 1 + self.width_at(Level::Atom), Level::Sign)
    }

    /// Whether the text starts with a negative number.
    pub(super) fn starts_negative(&self, tape: &Tape) -> bool {
        let mut first = self.value;
        loop {
            match tape.unnamed(first) {
                Some(Operation::Binary(Arithmetic::Multiply | Arithmetic::Divide, a, _)) => {
                    first = *a;
                }
                Some(Operation::Constant(value)) => return value.is_negative(),
                _ => return false,
            }
        }
    }

    /// Minus the value, with the sign moved inwards as far as rounding is unaffected.
    pub(super) fn opposite(self, tape: &mut Tape) -> Self {
        let width = self.width;
        match tape.unnamed(self.value).cloned() {
            Some(Operation::Constant(value)) => Self {
                value: tape.constant(-&value),
                ..self
            },
            Some(Operation::Negate(value)) => Self::new(value, width, Level::Atom),
            Some(Operation::Binary(Arithmetic::Subtract, value, b)) => {
                let first = Self::new(value, width, Level::Product);
                let value = if first.starts_negative(tape) {
                    let first = first.opposite(tape).value;
                    tape.binary(Arithmetic::Add, b, first)
                } else {
                    tape.binary(Arithmetic::Subtract, b, first.value)
                };
                Self::new(value, width, Level::Sum)
            }
            Some(Operation::Binary(
                operation @ (Arithmetic::Multiply | Arithmetic::Divide),
                value,
                b,
            )) => {
                let first = Self::new(value, width, Level::Atom).opposite(tape).value;
                let value = tape.binary(operation, first, b);
                Self::new(value, width + 1, Level::Product)
            }
            _ => self.negated(tape),
        }
    }

    /// `self.function()`
    pub(super) fn function(self, tape: &mut Tape, function: Function) -> Self {
        let width = self.width_at(Level::Atom) + function.name().len() + 3;
        let value = tape.push(Operation::Function(function, self.value));
        Self::new(value, width, Level::Atom)
    }

    /// `self.atan2(x)`
    pub(super) fn atan2(self, tape: &mut Tape, x: Self) -> Self {
        let width = self.width_at(Level::Atom) + x.width + ".atan2()".len();
        let value = tape.push(Operation::Atan2(self.value, x.value));
        Self::new(value, width, Level::Atom)
    }

    /// `self.powf(exponent)`
    pub(super) fn power(self, tape: &mut Tape, exponent: Self) -> Self {
        let width = self.width_at(Level::Atom) + exponent.width + ".powf()".len();
        let value = tape.push(Operation::Power(self.value, exponent.value));
        Self::new(value, width, Level::Atom)
    }

    /// Compared left and right sides, value if the relation holds, value otherwise.
    pub(super) fn choice(tape: &mut Tape, relation: Relation, operands: [Self; 4]) -> Self {
        let width: usize = operands.iter().map(|operand| operand.width).sum();
        let [left, right, then, otherwise] = operands.map(|operand| operand.value);
        let value = tape.push(Operation::Choice {
            relation,
            compared: [left, right],
            branches: [then, otherwise],
        });
        let width = width + "T::if_less_or_equal(, , , )".len();
        Self::new(value, width, Level::Atom)
    }
}

/// Precedences that an operation requires of its left and right operand.
pub(crate) fn levels(operation: Arithmetic) -> (Level, Level) {
    match operation {
        Arithmetic::Add | Arithmetic::Subtract => (Level::Sum, Level::Product),
        Arithmetic::Multiply | Arithmetic::Divide => (Level::Product, Level::Sign),
    }
}

/// A short name that describes the operation of a value, if there is one: `R_squared`, `m_R`,
/// `inv_D`, `tan_theta`, `a_minus_b`. `products` has the values that are products.
pub(super) fn describe(
    value: Value,
    tape: &Tape,
    products: &FxHashMap<Value, Monomial>,
    arguments: &ArgumentNames,
) -> Option<String> {
    if let Some(monomial) = Monomial::of(value, tape, products) {
        return monomial.name(tape, arguments);
    }
    if let Some(name) = angle_sum(value, tape) {
        return joined(&[&name]);
    }
    let inner = |value: &Value| describe(*value, tape, products, arguments);
    match tape.unnamed(value)? {
        Operation::Negate(a) => joined(&["minus", &inner(a)?]),
        Operation::Function(function, a) => joined(&[function.name(), &inner(a)?]),
        Operation::Binary(operation, a, b) => {
            let (left, right) = (inner(a)?, inner(b)?);
            match operation {
                Arithmetic::Add => joined(&[&left, "plus", &right]),
                Arithmetic::Subtract => joined(&[&left, "minus", &right]),
                Arithmetic::Multiply => joined(&[&left, &right]),
                Arithmetic::Divide => joined(&[&left, "over", &right]),
            }
        }
        _ => None,
    }
}

/// `sin_a_minus_b` and the like for a value expanded by an addition theorem.
fn angle_sum(value: Value, tape: &Tape) -> Option<String> {
    let Some(Operation::Binary(operation @ (Arithmetic::Add | Arithmetic::Subtract), left, right)) =
        tape.unnamed(value)
    else {
        return None;
    };
    // Function and angle of both factors.
    let factors = |value: &Value| {
        let Some(Operation::Binary(Arithmetic::Multiply, a, b)) = tape.unnamed(*value) else {
            return None;
        };
        let factor = |value: Value| tape.name(value)?.split_once('_');
        Some([factor(*a)?, factor(*b)?])
    };
    let ([(f, a), (g, b)], right) = (factors(left)?, factors(right)?);
    let swapped = [right[1], right[0]];
    let opposite = |function: &str| if function == "sin" { "cos" } else { "sin" };
    let partner = [(opposite(f), a), (opposite(g), b)];
    if a == b || (right != partner && swapped != partner) {
        return None;
    }
    let plus = *operation == Arithmetic::Add;
    match (f, g, plus) {
        ("sin", "cos", true) | ("cos", "sin", true) => Some(format!("sin_{a}_plus_{b}")),
        ("sin", "cos", false) => Some(format!("sin_{a}_minus_{b}")),
        ("cos", "sin", false) => Some(format!("sin_{b}_minus_{a}")),
        ("cos", "cos", false) => Some(format!("cos_{a}_plus_{b}")),
        ("cos", "cos", true) | ("sin", "sin", true) => {
            Some(format!("cos_{}_minus_{}", a.min(b), a.max(b)))
        }
        _ => None,
    }
}

//! Tapes as text: statements and expressions, written alike for all languages.
//!
//! A value with a name is a statement; other values are written where they are used, unless they are used more than
//! once or nest too deeply. A [`Notation`] has what differs between languages.

mod infix;
mod vectors;

use std::collections::BTreeSet;

use crate::schedule::names::ArgumentNames;
use crate::symbolic::Rational;
use crate::tape::{Operation, Tape, Value};

pub(crate) use infix::{Infix, Notation, math_name, sign, unreserved};
pub(crate) use vectors::{GROUPS, Vectors, shape, type_name};

/// A statement of a function.
pub(crate) struct Statement<'a> {
    /// The heading before it; an empty one is a blank line.
    pub(crate) heading: Option<&'a str>,
    pub(crate) action: Action,
}

/// What a statement does.
pub(crate) enum Action {
    /// Defines a value.
    Define(String, Infix),
    /// Defines the sine and the cosine of an angle.
    SinCos([String; 2], Infix),
    /// Factorises a matrix, given row by row, with this number.
    Factor(usize, Vec<Vec<Infix>>),
    /// Solves the system of the factorisation with this number: its unknowns, each with a mark whether it is used,
    /// and its right-hand side.
    Solve(usize, Vec<(String, bool)>, Vec<Infix>),
}

/// Writes one tape.
pub(crate) struct Text<'a, N> {
    pub(crate) notation: N,
    pub(crate) tape: &'a Tape,
    pub(crate) names: &'a ArgumentNames,
    /// By value: its name in the language, if it has a statement.
    identifiers: Vec<Option<String>>,
    /// By value: how many operations and results use it.
    uses: Vec<u32>,
}

/// The deepest nesting of an expression. The scheduler names values long before.
const DEEPEST: u32 = 64;

impl<'a, N: Notation> Text<'a, N> {
    pub(crate) fn new(notation: N, tape: &'a Tape, names: &'a ArgumentNames) -> Self {
        let mut uses = vec![0; tape.operations.len()];
        let operands = tape.operations.iter().flat_map(Operation::operands);
        let entries = tape.results.iter().flat_map(|result| &result.entries);
        for value in operands.chain(entries.copied()) {
            uses[value.index()] += 1;
        }
        let mut text = Self {
            notation,
            tape,
            names,
            identifiers: Vec::with_capacity(uses.len()),
            uses,
        };
        text.identify();
        text
    }

    /// Names the values that have statements.
    fn identify(&mut self) {
        let mut depths: Vec<u32> = Vec::with_capacity(self.uses.len());
        for (index, operation) in self.tape.operations.iter().enumerate() {
            let inner = operation.operands().into_iter();
            let inner = inner.filter(|operand| self.identifiers[operand.index()].is_none());
            let depth = inner.map(|operand| depths[operand.index()] + 1).max();
            let depth = depth.unwrap_or(0);
            let needs_name = self.uses[index] > 1 && !operation.is_leaf()
                || matches!(operation, Operation::Part(..))
                || depth > DEEPEST;
            let identifier = match &self.tape.names[index] {
                Some(name) => Some(self.notation.name(name)),
                None if needs_name && operation.is_number() => {
                    Some(self.notation.name(&self.free(&format!("v_{index}"))))
                }
                None => None,
            };
            self.identifiers.push(identifier);
            depths.push(depth);
        }
    }

    /// The name of a value that has a statement.
    fn identifier(&self, value: Value) -> String {
        self.identifiers[value.index()].clone().unwrap_or_default()
    }

    /// A value: its name, or the expression that computes it.
    pub(crate) fn value(&self, value: Value) -> Infix {
        match &self.identifiers[value.index()] {
            Some(name) => Infix::atom(name.clone()),
            None => self.expression(value),
        }
    }

    /// Several values.
    pub(crate) fn values(&self, values: &[Value]) -> Vec<Infix> {
        values.iter().map(|&value| self.value(value)).collect()
    }

    /// The name of a positive number.
    pub(crate) fn constant(&self, value: &Rational) -> String {
        self.notation.name(&self.names.constant(value))
    }

    /// The expression that computes a value; it nests as deep as [`DEEPEST`].
    fn expression(&self, value: Value) -> Infix {
        let notation = &self.notation;
        Infix::atom(match self.tape.operation(value) {
            Operation::Argument(argument) => notation.name(self.names.get(*argument)),
            Operation::Constant(number) if number.is_negative() => {
                return Infix::atom(self.constant(&number.abs())).negated();
            }
            Operation::Constant(number) => self.constant(number),
            Operation::Negate(a) => return self.value(*a).negated(),
            Operation::Binary(operation, a, b) => {
                return self.value(*a).binary(*operation, &self.value(*b));
            }
            Operation::Function(function, a) => notation.function(*function, &self.value(*a)),
            Operation::Atan2(y, x) => notation.atan2(&self.value(*y), &self.value(*x)),
            Operation::Power(base, exponent) => {
                notation.power(&self.value(*base), &self.value(*exponent))
            }
            Operation::Choice {
                relation,
                compared: [left, right],
                branches: [then, otherwise],
            } => {
                let operands = [left, right, then, otherwise];
                notation.choice(*relation, operands.map(|value| self.value(*value)))
            }
            // These are statements: their parts have names.
            Operation::SinCos(_)
            | Operation::Factorise(_)
            | Operation::Solve { .. }
            | Operation::Part(..) => self.identifier(value),
        })
    }

    /// The statements, in order.
    pub(crate) fn statements(&self) -> Vec<Statement<'a>> {
        let mut statements = Vec::new();
        let mut headings = self.tape.headings.iter().peekable();
        let mut factorised: Vec<Value> = Vec::new();
        for value in (0..).map(Value).take(self.tape.operations.len()) {
            let Some(action) = self.action(value, &mut factorised) else {
                continue;
            };
            let heading = headings.next_if(|(before, _)| *before <= value);
            statements.push(Statement {
                heading: heading.map(|(_, title)| title.as_str()),
                action,
            });
        }
        statements
    }

    /// The statement that starts with an operation, if one does.
    fn action(&self, value: Value, factorised: &mut Vec<Value>) -> Option<Action> {
        Some(match self.tape.operation(value) {
            Operation::SinCos(angle) => Action::SinCos(
                [0, 1].map(|index| self.identifier(value.part(index))),
                self.value(*angle),
            ),
            Operation::Factorise(matrix) => {
                factorised.push(value);
                let rows = matrix.chunks(matrix.len().isqrt().max(1));
                let rows = rows.map(|row| self.values(row)).collect();
                Action::Factor(factorised.len() - 1, rows)
            }
            Operation::Solve {
                factorisation,
                right,
            } => {
                let number = factorised.iter().position(|other| other == factorisation);
                let unknowns = (0..).map(|row| value.part(row)).take(right.len());
                let unknowns =
                    unknowns.map(|part| (self.identifier(part), self.uses[part.index()] > 0));
                // A factorisation comes before its solutions.
                Action::Solve(number.unwrap_or(0), unknowns.collect(), self.values(right))
            }
            Operation::Part(..) => return None,
            _ => {
                let name = self.identifiers[value.index()].clone()?;
                Action::Define(name, self.expression(value))
            }
        })
    }

    /// The absolute values of the numbers in a function.
    pub(crate) fn constants(&self) -> BTreeSet<Rational> {
        let numbers = self
            .tape
            .operations
            .iter()
            .filter_map(|operation| match operation {
                Operation::Constant(value) => Some(value.abs()),
                _ => None,
            });
        numbers.collect()
    }

    /// A name different from all arguments and values.
    pub(crate) fn free(&self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        while self
            .tape
            .names
            .iter()
            .flatten()
            .chain(self.names.iter())
            .any(|other| *other == name)
        {
            name.push('_');
        }
        name
    }
}

//! Tapes as text: statements and expressions, written alike for all languages.
//!
//! A value with a name is a statement; other values are written where they are used, unless they are used more than
//! once or nest too deeply. A [`Dialect`] has what differs between languages.

mod dump;
mod infix;
mod shape;

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::schedule::names::ArgumentNames;
use crate::symbolic::{Function, Rational, Relation};
use crate::tape::{Arithmetic, Operation, Tape, Value};

pub(crate) use infix::{Infix, Notation, math_name};
pub(crate) use shape::shape;

/// The expressions and statements of a language.
pub(crate) trait Dialect {
    /// An expression.
    type Expression;

    /// The value or argument of this name.
    fn name(&self, name: &str) -> Self::Expression;
    /// A number that is not negative, with the name of its constant.
    fn number(&self, value: &Rational, name: &str) -> Self::Expression;
    /// `-a`
    fn negated(&self, a: Self::Expression) -> Self::Expression;
    /// `a ∘ b`
    fn binary(
        &self,
        operation: Arithmetic,
        a: Self::Expression,
        b: Self::Expression,
    ) -> Self::Expression;
    /// A function of one argument.
    fn function(&self, function: Function, a: Self::Expression) -> Self::Expression;
    /// The angle of a point in the plane.
    fn atan2(&self, y: Self::Expression, x: Self::Expression) -> Self::Expression;
    /// A power with a real exponent.
    fn power(&self, base: Self::Expression, exponent: Self::Expression) -> Self::Expression;
    /// Left and right side of the relation, value if it holds, value otherwise.
    fn choice(&self, relation: Relation, operands: [Self::Expression; 4]) -> Self::Expression;
}

/// A statement of a function.
pub(crate) struct Statement<'a, E> {
    /// The heading before it; an empty one is a blank line.
    pub(crate) heading: Option<&'a str>,
    pub(crate) action: Action<'a, E>,
}

/// What a statement does.
pub(crate) enum Action<'a, E> {
    /// Defines a value.
    Define(Cow<'a, str>, E),
    /// Defines the sine and the cosine of an angle.
    SinCos([Cow<'a, str>; 2], E),
    /// Factorises a matrix, given row by row, with this number.
    Factor(usize, Vec<Vec<E>>),
    /// Solves the system of the factorisation with this number: its unknowns, each with a mark whether it is used,
    /// and its right-hand side.
    Solve(usize, Vec<(Cow<'a, str>, bool)>, Vec<E>),
}

/// Writes one tape.
pub(crate) struct Text<'a, D> {
    pub(crate) dialect: D,
    pub(crate) tape: &'a Tape,
    pub(crate) names: &'a ArgumentNames,
    /// By value: its name, if it has a statement.
    identifiers: Vec<Option<Cow<'a, str>>>,
    /// By value: how many operations and results use it.
    uses: Vec<u32>,
}

/// The deepest nesting of an expression. The scheduler names values long before.
const DEEPEST: u32 = 64;

impl<'a, D: Dialect> Text<'a, D> {
    pub(crate) fn new(dialect: D, tape: &'a Tape, names: &'a ArgumentNames) -> Self {
        let mut uses = vec![0; tape.operations.len()];
        let operands = tape.operations.iter().flat_map(Operation::operands);
        let entries = tape.results.iter().flat_map(|result| &result.entries);
        for value in operands.chain(entries.copied()) {
            uses[value.index()] += 1;
        }
        let mut text = Self {
            dialect,
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
                Some(name) => Some(name.as_str().into()),
                None if needs_name && operation.is_number() => {
                    Some(self.free(&format!("v_{index}")).into())
                }
                None => None,
            };
            self.identifiers.push(identifier);
            depths.push(depth);
        }
    }

    /// The name of a value that has a statement.
    fn identifier(&self, value: Value) -> Option<Cow<'a, str>> {
        self.identifiers[value.index()].clone()
    }

    /// A value: its name, or the expression that computes it.
    pub(crate) fn value(&self, value: Value) -> D::Expression {
        match self.identifier(value) {
            Some(name) => self.dialect.name(&name),
            None => self.expression(value),
        }
    }

    /// Several values.
    pub(crate) fn values(&self, values: &[Value]) -> Vec<D::Expression> {
        values.iter().map(|&value| self.value(value)).collect()
    }

    /// The expression that computes a value; it nests as deep as [`DEEPEST`].
    fn expression(&self, value: Value) -> D::Expression {
        let dialect = &self.dialect;
        match self.tape.operation(value) {
            Operation::Argument(argument) => dialect.name(self.names.get(*argument)),
            Operation::Constant(number) => {
                let magnitude = number.abs();
                let written = dialect.number(&magnitude, &self.names.constant(&magnitude));
                if number.is_negative() {
                    dialect.negated(written)
                } else {
                    written
                }
            }
            Operation::Negate(a) => dialect.negated(self.value(*a)),
            Operation::Binary(operation, a, b) => {
                dialect.binary(*operation, self.value(*a), self.value(*b))
            }
            Operation::Function(function, a) => dialect.function(*function, self.value(*a)),
            Operation::Atan2(y, x) => dialect.atan2(self.value(*y), self.value(*x)),
            Operation::Power(base, exponent) => {
                dialect.power(self.value(*base), self.value(*exponent))
            }
            Operation::Choice {
                relation,
                compared: [left, right],
                branches: [then, otherwise],
            } => {
                let operands = [left, right, then, otherwise];
                dialect.choice(*relation, operands.map(|value| self.value(*value)))
            }
            // These are statements: their parts have names.
            Operation::SinCos(_)
            | Operation::Factorise(_)
            | Operation::Solve { .. }
            | Operation::Part(..) => dialect.name(&self.identifier(value).unwrap_or_default()),
        }
    }

    /// The statements, in order.
    pub(crate) fn statements(&self) -> Vec<Statement<'a, D::Expression>> {
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
    fn action(
        &self,
        value: Value,
        factorised: &mut Vec<Value>,
    ) -> Option<Action<'a, D::Expression>> {
        let name = |value| self.identifier(value).unwrap_or_default();
        Some(match self.tape.operation(value) {
            Operation::SinCos(angle) => Action::SinCos(
                [0, 1].map(|index| name(value.part(index))),
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
                let unknowns = unknowns.map(|part| (name(part), self.uses[part.index()] > 0));
                // A factorisation comes before its solutions.
                Action::Solve(number.unwrap_or(0), unknowns.collect(), self.values(right))
            }
            Operation::Part(..) => return None,
            _ => Action::Define(self.identifier(value)?, self.expression(value)),
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
        let is_taken = |name: &String| {
            let mut values = self.tape.names.iter().flatten();
            values.any(|other| other == name) || self.names.iter().any(|other| other == name)
        };
        while is_taken(&name) {
            name.push('_');
        }
        name
    }
}

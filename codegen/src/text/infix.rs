//! Expressions with infix operators and calls.

use std::borrow::Cow;

use crate::schedule::piece::{Level, levels};
use crate::symbolic::{Function, Relation};
use crate::tape::Arithmetic;

/// The differences between languages.
pub(crate) trait Notation {
    /// A name that is not reserved in the language.
    fn name(&self, name: &str) -> String;
    /// A function of one argument.
    fn function(&self, function: Function, of: &Infix) -> String;
    /// The angle of a point in the plane.
    fn atan2(&self, y: &Infix, x: &Infix) -> String;
    /// A power with a real exponent.
    fn power(&self, base: &Infix, exponent: &Infix) -> String;
    /// Left and right side of the relation, value if it holds, value otherwise.
    fn choice(&self, relation: Relation, operands: [Infix; 4]) -> String;
}

/// Name of a function of one argument in `math.h`, or `sign`, which `math.h` lacks.
pub(crate) fn math_name(function: Function) -> &'static str {
    match function {
        Function::Ln => "log",
        Function::Abs => "fabs",
        other => other.name(),
    }
}

/// A name with an underscore at its end if it is one of these words.
pub(crate) fn unreserved(name: &str, words: &str) -> String {
    if words.split(' ').any(|word| word == name) {
        format!("{name}_")
    } else {
        name.to_owned()
    }
}

/// The sign of a relation.
pub(crate) fn sign(relation: Relation) -> &'static str {
    match relation {
        Relation::Less => "<",
        Relation::LessOrEqual => "<=",
    }
}

/// A text with the precedence of its outermost operation.
pub(crate) struct Infix {
    pub(crate) text: String,
    level: Level,
}

impl Infix {
    /// A name or a call.
    pub(super) fn atom(text: String) -> Self {
        let level = Level::Atom;
        Self { text, level }
    }

    /// The text, in parentheses if its precedence is below `least`.
    fn at(&self, least: Level) -> Cow<'_, str> {
        if self.level < least {
            format!("({})", self.text).into()
        } else {
            (&self.text).into()
        }
    }

    /// The text, in parentheses unless it is a name or a call.
    pub(crate) fn receiver(&self) -> Cow<'_, str> {
        self.at(Level::Atom)
    }

    /// `-self`
    pub(super) fn negated(&self) -> Self {
        Self {
            text: format!("-{}", self.receiver()),
            level: Level::Sign,
        }
    }

    /// `self ∘ other`
    pub(super) fn binary(&self, operation: Arithmetic, other: &Self) -> Self {
        let (level, right) = levels(operation);
        let operator = match operation {
            Arithmetic::Add => "+",
            Arithmetic::Subtract => "-",
            Arithmetic::Multiply => "*",
            Arithmetic::Divide => "/",
        };
        Self {
            text: format!("{} {operator} {}", self.at(level), other.at(right)),
            level,
        }
    }

    /// Texts separated by commas.
    pub(crate) fn list(all: &[Self]) -> String {
        let all: Vec<&str> = all.iter().map(|one| one.text.as_str()).collect();
        all.join(", ")
    }
}

//! Expressions with infix operators and calls, as in C and Python.

use super::Dialect;
use crate::schedule::names::method;
use crate::schedule::piece::{Level, levels};
use crate::symbolic::{Function, Rational, Relation};
use crate::tape::Arithmetic;

/// The differences between languages with infix operators.
pub(crate) trait Notation {
    /// A name that is not reserved in the language.
    fn name(&self, name: &str) -> String;
    /// A number that is not negative, with the name of its constant.
    fn number(&self, _: &Rational, name: &str) -> String {
        self.name(name)
    }
    /// An operator with the space around it.
    fn operator(&self, operation: Arithmetic) -> &'static str {
        match operation {
            Arithmetic::Add => " + ",
            Arithmetic::Subtract => " - ",
            Arithmetic::Multiply => " * ",
            Arithmetic::Divide => " / ",
        }
    }
    /// A function of one argument.
    fn function(&self, function: Function, of: &str) -> String;
    /// The angle of a point in the plane.
    fn atan2(&self, y: &str, x: &str) -> String;
    /// A power with a real exponent.
    fn power(&self, base: &str, exponent: &str) -> String;
    /// Left and right side of the relation, value if it holds, value otherwise.
    fn choice(&self, relation: Relation, operands: [String; 4]) -> String;
}

/// Name of a function of one argument in `math.h`, or `sign`, which `math.h` lacks.
pub(crate) fn math_name(function: Function) -> &'static str {
    match function {
        Function::Ln => "log",
        Function::Abs => "fabs",
        other => method(other),
    }
}

/// A text with the precedence of its outermost operation.
pub(crate) struct Infix {
    pub(crate) text: String,
    level: Level,
}

impl Infix {
    fn atom(text: String) -> Self {
        let level = Level::Atom;
        Self { text, level }
    }

    /// The text, in parentheses if its precedence is below `least`.
    fn at(self, least: Level) -> String {
        if self.level < least {
            format!("({})", self.text)
        } else {
            self.text
        }
    }

    /// Texts separated by commas.
    pub(crate) fn list(all: &[Self]) -> String {
        let all: Vec<&str> = all.iter().map(|one| one.text.as_str()).collect();
        all.join(", ")
    }
}

impl<N: Notation> Dialect for N {
    type Expression = Infix;

    fn name(&self, name: &str) -> Infix {
        Infix::atom(Notation::name(self, name))
    }

    fn number(&self, value: &Rational, name: &str) -> Infix {
        Infix::atom(Notation::number(self, value, name))
    }

    fn negated(&self, a: Infix) -> Infix {
        Infix {
            text: format!("-{}", a.at(Level::Atom)),
            level: Level::Sign,
        }
    }

    fn binary(&self, operation: Arithmetic, a: Infix, b: Infix) -> Infix {
        let (level, right) = levels(operation);
        let operator = self.operator(operation);
        Infix {
            text: format!("{}{operator}{}", a.at(level), b.at(right)),
            level,
        }
    }

    fn function(&self, function: Function, a: Infix) -> Infix {
        Infix::atom(Notation::function(self, function, &a.text))
    }

    fn atan2(&self, y: Infix, x: Infix) -> Infix {
        Infix::atom(Notation::atan2(self, &y.text, &x.text))
    }

    fn power(&self, base: Infix, exponent: Infix) -> Infix {
        Infix::atom(Notation::power(self, &base.text, &exponent.text))
    }

    fn choice(&self, relation: Relation, operands: [Infix; 4]) -> Infix {
        Infix::atom(Notation::choice(
            self,
            relation,
            operands.map(|one| one.text),
        ))
    }
}

//! A tape as mathematics in plain text, for debugging and snapshots.

use std::fmt::Write;

use super::{Action, Infix, Notation, Text};
use crate::program::Program;
use crate::schedule::names::{ArgumentNames, method};
use crate::symbolic::{Function, Rational, Relation};
use crate::tape::{Arithmetic, Tape};

impl Tape {
    /// The statements and the results as text, one per line.
    pub fn dump(&self, program: &Program) -> String {
        dump(self, &ArgumentNames::of(program))
    }
}

struct Plain;

impl Notation for Plain {
    fn name(&self, name: &str) -> String {
        name.to_owned()
    }

    fn number(&self, value: &Rational, _: &str) -> String {
        value.to_string()
    }

    fn operator(&self, operation: Arithmetic) -> &'static str {
        match operation {
            Arithmetic::Add => " + ",
            Arithmetic::Subtract => " - ",
            Arithmetic::Multiply => " ",
            Arithmetic::Divide => "/",
        }
    }

    fn function(&self, function: Function, of: &str) -> String {
        format!("{}({of})", method(function))
    }

    fn atan2(&self, y: &str, x: &str) -> String {
        format!("atan2({y}, {x})")
    }

    fn power(&self, base: &str, exponent: &str) -> String {
        format!("pow({base}, {exponent})")
    }

    fn choice(&self, _: Relation, operands: [String; 4]) -> String {
        format!("if_less({})", operands.join(", "))
    }
}

fn dump(tape: &Tape, arguments: &ArgumentNames) -> String {
    let text = Text::new(Plain, tape, arguments);
    let mut out = String::new();
    for statement in text.statements() {
        if let Some(title) = statement.heading {
            let _ = writeln!(out, "\n# {title}");
        }
        let line = match statement.action {
            Action::Define(name, value) => format!("{name} = {}", value.text),
            Action::SinCos([sin, cos], angle) => {
                format!("{sin}, {cos} = sin_cos({})", angle.text)
            }
            Action::Factor(number, rows) => {
                let rows: Vec<String> = rows.iter().map(|row| Infix::list(row)).collect();
                format!("lu_{number} = factor({})", rows.join(", "))
            }
            Action::Solve(number, unknowns, right) => {
                let unknowns: Vec<&str> = unknowns.iter().map(|(name, _)| &**name).collect();
                let right = Infix::list(&right);
                format!("{} = lu_{number} \\ ({right})", unknowns.join(", "))
            }
        };
        let _ = writeln!(out, "{line}");
    }
    for array in &tape.results {
        let entries = Infix::list(&text.values(&array.entries));
        let _ = writeln!(out, "\n{} = [{entries}]", array.name);
    }
    out
}

//! The body of a function: its tape, statement by statement.

use std::fmt::Write as _;

use super::layout::{BLANK, comment};
use super::syntax::{ident, number};
use super::types::{Types, result_struct};
use crate::program::{Array, Function, Layout, Space};
use crate::schedule::pi::parts_of_pi;
use crate::symbolic::{self, Rational, Relation};
use crate::tape::{Argument, Operation, Tape, Value};
use crate::text::{Action, GROUPS, Infix, Notation, Text, type_name};

/// Maximum columns of lines that destructure arguments.
const COLUMNS: usize = 80;

/// Expressions of emitted Rust.
struct Rust;

impl Notation for Rust {
    fn name(&self, name: &str) -> String {
        ident(name).to_string()
    }

    fn function(&self, function: symbolic::Function, of: &Infix) -> String {
        format!("{}.{}()", of.receiver(), function.name())
    }

    fn atan2(&self, y: &Infix, x: &Infix) -> String {
        format!("{}.atan2({})", y.receiver(), x.text)
    }

    fn power(&self, base: &Infix, exponent: &Infix) -> String {
        format!("{}.powf({})", base.receiver(), exponent.text)
    }

    fn choice(&self, relation: Relation, operands: [Infix; 4]) -> String {
        let function = match relation {
            Relation::Less => "if_less",
            Relation::LessOrEqual => "if_less_or_equal",
        };
        format!("T::{function}({})", Infix::list(&operands))
    }
}

/// The statements of a function; the last one is its result.
pub(super) fn body(types: &Types<'_>, function: &Function, tape: &Tape) -> String {
    let mut body = Body {
        types,
        tape,
        written: Text::new(Rust, tape, &types.vectors.names),
        text: String::new(),
    };
    body.arguments();
    body.own(function);
    for value in body.written.constants() {
        let name = body.written.constant(&value);
        body.define(&name, &format!("T::constant({})", constant(&value)));
    }
    body.statements();
    body.results(function);
    body.text
}

struct Body<'a> {
    types: &'a Types<'a>,
    tape: &'a Tape,
    written: Text<'a, Rust>,
    text: String,
}

impl Body<'_> {
    /// `let pattern = value;`
    fn define(&mut self, pattern: &str, value: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "let {pattern} = {value};");
    }

    /// `let &Parameters { m, g, .. } = p;`, on as many lines as the names need.
    fn arguments(&mut self) {
        let types = self.types;
        let arguments = self.tape.arguments();
        for ((space, like), argument) in GROUPS.into_iter().zip(&types.argument_names()[1..]) {
            let used = arguments.iter().filter(|argument| argument.is_like(like));
            let used: Vec<&str> = used
                .map(|&argument| types.vectors.names.get(argument))
                .collect();
            let (name, count) = (type_name(space), types.fields(space).len());
            let frame = "    let & { .. } = ;".len() + name.len() + argument.len();
            for row in rows(&used, COLUMNS.saturating_sub(frame)) {
                let fields: Vec<String> = row.iter().map(|field| Rust.name(field)).collect();
                let rest = if row.len() == count { "" } else { ", .." };
                let pattern = format!("&{name} {{ {}{rest} }}", fields.join(", "));
                self.define(&pattern, &Rust.name(argument));
            }
        }
    }

    /// `let lambda_v = weights[0];`, `let v_dot = accelerations.v_dot;`
    fn own(&mut self, function: &Function) {
        let Some((own, _)) = self.types.own(function.kind) else {
            return;
        };
        let own = Rust.name(&own);
        let accelerations = self.types.fields(Space::Accelerations);
        for argument in self.tape.arguments() {
            let value = match argument {
                Argument::Weight(index) | Argument::OutputWeight(index) => {
                    format!("{own}[{index}]")
                }
                Argument::Acceleration(index) => {
                    format!("{own}.{}", Rust.name(&accelerations[index as usize]))
                }
                _ => continue,
            };
            self.define(&Rust.name(self.types.vectors.names.get(argument)), &value);
        }
    }

    /// All operations.
    fn statements(&mut self) {
        for statement in self.written.statements() {
            if let Some(title) = statement.heading {
                self.text.push_str(BLANK);
                if !title.is_empty() {
                    self.text.push_str(&comment(title));
                }
            }
            match statement.action {
                Action::Define(name, value) => self.define(&name, &value.text),
                Action::SinCos([sin, cos], angle) => self.define(
                    &format!("({sin}, {cos})"),
                    &format!("{}.sin_cos()", angle.receiver()),
                ),
                Action::Factor(number, rows) => {
                    let rows = rows.iter().map(|row| Infix::list(row));
                    let factors = format!("lu_factor({})", array(rows.map(|row| array([row]))));
                    self.define(&self.factors(number), &factors);
                }
                Action::Solve(number, unknowns, right) => {
                    let unknown = |(name, used)| if used { name } else { "_".to_owned() };
                    let right = array([Infix::list(&right)]);
                    let solved = format!("lu_solve(&{}, {right})", self.factors(number));
                    self.define(&array(unknowns.into_iter().map(unknown)), &solved);
                }
            }
        }
    }

    /// Name of a factorisation, distinct from values.
    fn factors(&self, number: usize) -> String {
        self.written.free(&format!("lu_{}", number + 1))
    }

    /// The arrays, and the expression that contains them.
    fn results(&mut self, function: &Function) {
        let results = function.results.iter().zip(&self.tape.results);
        let values: Vec<String> = results
            .map(|(array, result)| self.result(array, &result.entries))
            .collect();
        if !self.text.is_empty() && self.can_have_a_comment(function) {
            self.text.push_str(BLANK);
        }
        match (result_struct(function), values.as_slice()) {
            (None, [value]) => self.text.push_str(value),
            (structured, _) => {
                let names = Types::result_fields(function);
                let fields = names.iter().map(String::as_str).zip(values);
                let name = structured.unwrap_or_default();
                self.text.push_str(&structure(name, fields, None));
            }
        }
    }

    /// Whether the result does not begin with an operand, before which a comment would be printed.
    fn can_have_a_comment(&self, function: &Function) -> bool {
        let ([array], [result]) = (&*function.results, &*self.tape.results) else {
            return true;
        };
        let number = result.entries.first();
        let number = number.filter(|_| array.layout == Layout::Scalar);
        !number.is_some_and(|&number| {
            matches!(
                self.tape.unnamed(number),
                Some(
                    Operation::Binary(..)
                        | Operation::Function(..)
                        | Operation::Atan2(..)
                        | Operation::Power(..)
                )
            )
        })
    }

    fn result(&self, array: &Array, entries: &[Value]) -> String {
        match array.layout {
            Layout::Scalar => match entries {
                [entry, ..] => self.written.value(*entry).text,
                [] => "T::constant(0.0)".to_owned(),
            },
            Layout::Vector(space) => self.vector(space, entries.iter().map(|one| self.value(*one))),
            Layout::List(_) => self.list(entries),
            Layout::Rows(space, columns) => {
                self.vector(space, entries.chunks(columns).map(|row| self.list(row)))
            }
            Layout::Matrix(rows, columns) => {
                // A row may be empty: a model may have contacts and no coordinates.
                let lines = (0..rows).map(|row| &entries[row * columns..][..columns]);
                self::array(lines.map(|line| self.list(line)))
            }
            Layout::Jacobian(rows, columns) => {
                let count = self.types.fields(columns).len();
                let lines = (0..self.types.fields(rows).len())
                    .map(|row| self.row(columns, &entries[row * count..][..count]));
                self.vector(rows, lines)
            }
        }
    }

    fn value(&self, value: Value) -> String {
        self.written.value(value).text
    }

    /// `[a, b]`
    fn list(&self, values: &[Value]) -> String {
        array(values.iter().map(|&value| self.value(value)))
    }

    /// `Name { field: value, … }`
    fn vector(&self, space: Space, values: impl Iterator<Item = String>) -> String {
        let fields = self.types.fields(space).iter().map(String::as_str);
        structure(type_name(space), fields.zip(values), None)
    }

    /// `Name { field: value, ..Name::splat(zero) }` with the nonzero entries.
    fn row(&self, space: Space, entries: &[Value]) -> String {
        let zero = Operation::Constant(Rational::ZERO);
        let is_zero = |entry: &&Value| *self.tape.operation(**entry) == zero;
        if entries.iter().filter(is_zero).count() <= 1 {
            return self.vector(space, entries.iter().map(|one| self.value(*one)));
        }
        let name = type_name(space);
        let zeros = format!("{name}::splat({})", self.written.constant(&Rational::ZERO));
        if entries.iter().all(|entry| is_zero(&entry)) {
            return zeros;
        }
        let fields = self.types.fields(space).iter().zip(entries);
        let fields = fields.filter(|(_, entry)| !is_zero(entry));
        let fields = fields.map(|(field, entry)| (field.as_str(), self.value(*entry)));
        structure(name, fields, Some(zeros))
    }
}

/// `[a, b]`
fn array(elements: impl IntoIterator<Item = String>) -> String {
    let elements: Vec<String> = elements.into_iter().collect();
    format!("[{}]", elements.join(", "))
}

/// `Type { field: value, …, ..rest }`, in shorthand form if field and value have the same name.
fn structure<'a>(
    name: &str,
    fields: impl Iterator<Item = (&'a str, String)>,
    rest: Option<String>,
) -> String {
    let fields = fields.map(|(field, value)| match Rust.name(field) {
        field if field == value => field,
        field => format!("{field}: {value}"),
    });
    let rest = rest.map(|rest| format!("..{rest}"));
    let fields: Vec<String> = fields.chain(rest).collect();
    format!("{name} {{ {} }}", fields.join(", "))
}

/// Names in rows of at most `columns` columns, commas included.
fn rows<'a>(names: &'a [&'a str], columns: usize) -> impl Iterator<Item = &'a [&'a str]> {
    let mut rest = names;
    std::iter::from_fn(move || {
        let mut width = 0;
        let fits = |name: &&&str| {
            width += name.len() + ", ".len();
            width <= columns
        };
        let count = rest.iter().take_while(fits).count().max(1);
        let (row, later) = rest.split_at_checked(count)?;
        rest = later;
        Some(row)
    })
}

/// The number as a Rust expression that rounds it once.
fn constant(value: &Rational) -> String {
    const EXACT: u64 = 1 << 53;
    // Clippy rejects the digits of π.
    if parts_of_pi(value) == Some((1, 1)) {
        return "core::f64::consts::PI".to_owned();
    }
    match value.as_small() {
        // Both are exact as doubles, so the quotient is rounded once.
        Some((numerator, denominator))
            if denominator > 1
                && numerator.unsigned_abs() < EXACT
                && denominator.unsigned_abs() < EXACT
                && !denominator.unsigned_abs().is_power_of_two() =>
        {
            let [over, under] = [numerator, denominator].map(|part| number(part as f64));
            format!("{over} / {under}")
        }
        _ => number(value.to_f64()).to_string(),
    }
}

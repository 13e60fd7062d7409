//! Converts a tape to statements, with names for its arguments.

use syn::{Attribute, BinOp, Expr, Stmt, token};

use super::layout;
use super::syntax as s;
use crate::schedule::names::{ArgumentNames, method};
use crate::schedule::pi::parts_of_pi;
use crate::symbolic::{Function, Rational, Relation};
use crate::tape::{Arithmetic, Tape, Value};
use crate::text::{Action, Dialect, Text};

/// Expressions of emitted Rust.
struct Rust;

impl Dialect for Rust {
    type Expression = Expr;

    fn name(&self, name: &str) -> Expr {
        s::name(name)
    }

    fn number(&self, _: &Rational, name: &str) -> Expr {
        s::name(name)
    }

    fn negated(&self, a: Expr) -> Expr {
        s::negated(a)
    }

    fn binary(&self, operation: Arithmetic, a: Expr, b: Expr) -> Expr {
        let operator = match operation {
            Arithmetic::Add => BinOp::Add(token::Plus::default()),
            Arithmetic::Subtract => BinOp::Sub(token::Minus::default()),
            Arithmetic::Multiply => BinOp::Mul(token::Star::default()),
            Arithmetic::Divide => BinOp::Div(token::Slash::default()),
        };
        s::binary(a, operator, b)
    }

    fn function(&self, function: Function, a: Expr) -> Expr {
        s::method(a, method(function), Vec::new())
    }

    fn atan2(&self, y: Expr, x: Expr) -> Expr {
        s::method(y, "atan2", vec![x])
    }

    fn power(&self, base: Expr, exponent: Expr) -> Expr {
        s::method(base, "powf", vec![exponent])
    }

    fn choice(&self, relation: Relation, operands: [Expr; 4]) -> Expr {
        let function = match relation {
            Relation::Less => "if_less",
            Relation::LessOrEqual => "if_less_or_equal",
        };
        s::associated(function, operands.into())
    }
}

/// The statements of a function under construction.
pub(super) struct Statements<'a> {
    text: Text<'a, Rust>,
    pub(super) all: Vec<Stmt>,
    /// Comments and blank lines before the next statement.
    pub(super) attributes: Vec<Attribute>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(names: &'a ArgumentNames, tape: &'a Tape) -> Self {
        Self {
            text: Text::new(Rust, tape, names),
            all: Vec::new(),
            attributes: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, pattern: syn::Pat, value: Expr) {
        let attributes = std::mem::take(&mut self.attributes);
        self.all.push(s::let_(attributes, pattern, value));
    }

    /// `let half = T::constant(0.5);`
    pub(super) fn constants(&mut self) {
        for value in self.text.constants() {
            let name = self.text.names.constant(&value);
            self.push(
                s::binding(&name),
                s::associated("constant", vec![constant(&value)]),
            );
        }
    }

    /// All operations.
    pub(super) fn operations(&mut self) {
        for statement in self.text.statements() {
            if let Some(title) = statement.heading {
                self.attributes.push(layout::blank());
                if !title.is_empty() {
                    self.attributes.push(layout::comment(title));
                }
            }
            match statement.action {
                Action::Define(name, value) => self.push(s::binding(&name), value),
                Action::SinCos([sin, cos], angle) => {
                    let pattern = s::tuple_pattern(&[&sin, &cos]);
                    self.push(pattern, s::method(angle, "sin_cos", Vec::new()));
                }
                Action::Factor(number, rows) => {
                    let rows = rows.into_iter().map(s::array).collect();
                    let factors = s::call("lu_factor", vec![s::array(rows)]);
                    self.push(s::binding(&self.factors(number)), factors);
                }
                Action::Solve(number, unknowns, right) => {
                    let names = unknowns.iter().map(|(name, used)| used.then_some(&**name));
                    let names: Vec<Option<&str>> = names.collect();
                    let factors = s::borrowed(s::name(&self.factors(number)));
                    let solved = s::call("lu_solve", vec![factors, s::array(right)]);
                    self.push(s::array_pattern(&names), solved);
                }
            }
        }
    }

    /// Name of a factorisation, distinct from values.
    fn factors(&self, number: usize) -> String {
        self.text.free(&format!("lu_{}", number + 1))
    }

    pub(super) fn values(&self, values: &[Value]) -> Vec<Expr> {
        self.text.values(values)
    }

    pub(super) fn value(&self, value: Value) -> Expr {
        self.text.value(value)
    }
}

/// The number as a Rust expression that rounds it once.
fn constant(value: &Rational) -> Expr {
    const EXACT: u64 = 1 << 53;
    // Clippy rejects the digits of π.
    if parts_of_pi(value) == Some((1, 1)) {
        return syn::parse_quote!(core::f64::consts::PI);
    }
    match value.as_small() {
        // Both are exact as doubles, so the quotient is rounded once.
        Some((numerator, denominator))
            if denominator > 1
                && numerator.unsigned_abs() < EXACT
                && denominator.unsigned_abs() < EXACT
                && !denominator.unsigned_abs().is_power_of_two() =>
        {
            let over = BinOp::Div(token::Slash::default());
            s::binary(
                s::number(numerator as f64),
                over,
                s::number(denominator as f64),
            )
        }
        _ => s::number(value.to_f64()),
    }
}

//! Converts the steps of a schedule to statements, with names for its arguments.

use std::collections::BTreeSet;

use syn::{Attribute, BinOp, Expr, Stmt, token};

use super::layout;
use super::syntax as s;
use crate::schedule::names::{ArgumentNames, number_in_words};
use crate::schedule::pi::parts_of_pi;
use crate::schedule::piece::method;
use crate::schedule::{Argument, Operation, Schedule, Step, Tree, Value};
use crate::symbolic::{Rational, Relation};

/// The array of all values.
pub(super) const ARRAY: &str = "v";

/// Storage of a function's arguments and values.
pub(super) enum Places<'a> {
    /// Arguments and values are locals.
    Locals(&'a ArgumentNames),
    /// Values are entries of the array `v`, since compilers cannot handle thousands of locals in nested scopes.
    /// Arguments are read at each use.
    Array {
        /// An argument.
        argument: &'a dyn Fn(Argument) -> Expr,
    },
}

/// The statements of a function under construction.
pub(super) struct Statements<'a> {
    places: Places<'a>,
    schedule: &'a Schedule,
    pub(super) all: Vec<Stmt>,
    /// Comments and blank lines before the next statement.
    pub(super) attributes: Vec<Attribute>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(places: Places<'a>, schedule: &'a Schedule) -> Self {
        Self {
            places,
            schedule,
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
        let mut constants = BTreeSet::new();
        let entries = self
            .schedule
            .results
            .iter()
            .flat_map(|array| &array.entries);
        for tree in trees(&self.schedule.steps).chain(entries) {
            collect_constants(tree, &mut constants);
        }
        for value in constants {
            let name = self.constant(&value);
            self.push(
                s::binding(&name),
                s::associated("constant", vec![constant(&value)]),
            );
        }
    }

    fn value(&self, value: Value) -> &str {
        &self.schedule.names[value.0 as usize]
    }

    /// Name of a number.
    fn constant(&self, value: &Rational) -> String {
        match self.places {
            Places::Locals(names) => names.constant(value),
            Places::Array { .. } => number_in_words(value),
        }
    }

    /// A value as a place expression.
    fn place(&self, Value(value): Value) -> Expr {
        match self.places {
            Places::Locals(_) => s::name(self.value(Value(value))),
            Places::Array { .. } => s::entry(s::name(ARRAY), &[value as usize]),
        }
    }

    /// Defines values that are used; others are omitted.
    fn define(&mut self, pattern: syn::Pat, places: Expr, tree: Expr) {
        match self.places {
            Places::Locals(_) => self.push(pattern, tree),
            Places::Array { .. } => {
                self.attributes.clear();
                self.all.push(s::assigned(places, tree));
            }
        }
    }

    /// All steps.
    pub(super) fn steps(&mut self) {
        for step in &self.schedule.steps {
            self.step(step);
        }
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Let { value, tree } => {
                let pattern = s::binding(self.value(*value));
                self.define(pattern, self.place(*value), self.tree(tree));
            }
            Step::SinCos { sin, cos, angle } => {
                let pattern = s::tuple_pattern(&[self.value(*sin), self.value(*cos)]);
                let places = s::tuple(vec![self.place(*sin), self.place(*cos)]);
                let both = s::method(self.tree(angle), "sin_cos", Vec::new());
                self.define(pattern, places, both);
            }
            Step::Factor {
                factorisation,
                size,
                matrix,
            } => {
                let rows = matrix
                    .chunks(*size)
                    .map(|row| s::array(self.trees(row)))
                    .collect();
                let factors = s::call("lu_factor", vec![s::array(rows)]);
                self.push(s::binding(&self.factors(*factorisation)), factors);
            }
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let used = self.used();
                let names: Vec<Option<&str>> = values
                    .iter()
                    .map(|value| used.contains(value).then(|| self.value(*value)))
                    .collect();
                let factors = s::borrowed(s::name(&self.factors(*factorisation)));
                let right = s::array(self.trees(right));
                let solved = s::call("lu_solve", vec![factors, right]);
                let pattern = s::array_pattern(&names);
                let places = s::array(values.iter().map(|&value| self.place(value)).collect());
                self.define(pattern, places, solved);
            }
            Step::Paragraph { title } => {
                self.attributes.push(layout::blank());
                if !title.is_empty() {
                    self.attributes.push(layout::comment(title));
                }
            }
        }
    }

    /// Name of a factorisation, distinct from values.
    fn factors(&self, factorisation: u32) -> String {
        let mut name = format!("lu_{}", factorisation + 1);
        let taken = |name: &String| {
            let of_argument = match self.places {
                Places::Locals(names) => names.iter().any(|other| other == name),
                Places::Array { .. } => false,
            };
            of_argument || self.schedule.names.contains(name)
        };
        while taken(&name) {
            name.push('_');
        }
        name
    }

    /// Values that are used.
    fn used(&self) -> BTreeSet<Value> {
        let entries = self
            .schedule
            .results
            .iter()
            .flat_map(|array| &array.entries);
        let mut used = BTreeSet::new();
        let mut rest: Vec<&Tree> = trees(&self.schedule.steps).chain(entries).collect();
        while let Some(tree) = rest.pop() {
            if let Tree::Value(value) = tree {
                used.insert(*value);
            }
            rest.extend(parts(tree));
        }
        used
    }

    pub(super) fn trees(&self, trees: &[Tree]) -> Vec<Expr> {
        trees.iter().map(|tree| self.tree(tree)).collect()
    }

    // Trees are at most one printed line deep.
    pub(super) fn tree(&self, tree: &Tree) -> Expr {
        match tree {
            Tree::Value(value) => self.place(*value),
            Tree::Argument(argument) => match self.places {
                Places::Locals(names) => s::name(names.get(*argument)),
                Places::Array { argument: of } => of(*argument),
            },
            Tree::Constant(value) if value.is_negative() => {
                s::negated(s::name(&self.constant(&value.abs())))
            }
            Tree::Constant(value) => s::name(&self.constant(value)),
            Tree::Negate(a) => s::negated(self.tree(a)),
            Tree::Binary(operation, a, b) => {
                let operator = match operation {
                    Operation::Add => BinOp::Add(token::Plus::default()),
                    Operation::Subtract => BinOp::Sub(token::Minus::default()),
                    Operation::Multiply => BinOp::Mul(token::Star::default()),
                    Operation::Divide => BinOp::Div(token::Slash::default()),
                };
                s::binary(self.tree(a), operator, self.tree(b))
            }
            Tree::Function(function, a) => s::method(self.tree(a), method(*function), Vec::new()),
            Tree::Atan2(y, x) => s::method(self.tree(y), "atan2", vec![self.tree(x)]),
            Tree::Power(base, exponent) => {
                s::method(self.tree(base), "powf", vec![self.tree(exponent)])
            }
            Tree::Choice {
                relation,
                compared,
                branches,
            } => {
                let function = match relation {
                    Relation::Less => "if_less",
                    Relation::LessOrEqual => "if_less_or_equal",
                };
                let all = compared.iter().chain(branches.iter());
                s::associated(function, all.map(|tree| self.tree(tree)).collect())
            }
        }
    }
}

/// The trees of all steps.
fn trees(steps: &[Step]) -> impl Iterator<Item = &Tree> {
    steps.iter().flat_map(|step| match step {
        Step::Let { tree, .. } => std::slice::from_ref(tree),
        Step::SinCos { angle, .. } => std::slice::from_ref(angle),
        Step::Factor { matrix, .. } => matrix,
        Step::Solve { right, .. } => right,
        Step::Paragraph { .. } => &[],
    })
}

/// The direct subtrees of a tree.
fn parts(tree: &Tree) -> Vec<&Tree> {
    match tree {
        Tree::Value(_) | Tree::Argument(_) | Tree::Constant(_) => Vec::new(),
        Tree::Negate(a) | Tree::Function(_, a) => vec![a],
        Tree::Binary(_, a, b) | Tree::Atan2(a, b) | Tree::Power(a, b) => vec![a, b],
        Tree::Choice {
            compared, branches, ..
        } => compared.iter().chain(branches.iter()).collect(),
    }
}

fn collect_constants(tree: &Tree, constants: &mut BTreeSet<Rational>) {
    let mut rest = vec![tree];
    while let Some(tree) = rest.pop() {
        if let Tree::Constant(value) = tree {
            constants.insert(value.abs());
        }
        rest.extend(parts(tree));
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

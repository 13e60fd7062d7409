//! Converts the steps of a schedule to statements, with names for its arguments.

use std::collections::BTreeSet;

use syn::{Attribute, BinOp, Expr, Stmt, token};

use super::layout;
use super::syntax as s;
use crate::schedule::names::ArgumentNames;
use crate::schedule::pi::parts_of_pi;
use crate::schedule::piece::method;
use crate::schedule::{Operation, Schedule, Step, Tree, Value};
use crate::symbolic::{Rational, Relation};

/// The statements of a function under construction.
pub(super) struct Statements<'a> {
    names: &'a ArgumentNames,
    schedule: &'a Schedule,
    pub(super) all: Vec<Stmt>,
    /// Comments and blank lines before the next statement.
    pub(super) attributes: Vec<Attribute>,
}

impl<'a> Statements<'a> {
    pub(super) fn new(names: &'a ArgumentNames, schedule: &'a Schedule) -> Self {
        Self {
            names,
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
            let name = self.names.constant(&value);
            self.push(
                s::binding(&name),
                s::associated("constant", vec![constant(&value)]),
            );
        }
    }

    fn value(&self, value: Value) -> &str {
        &self.schedule.names[value.0 as usize]
    }

    /// All steps.
    pub(super) fn steps(&mut self) {
        for step in &self.schedule.steps {
            self.step(step);
        }
    }

    fn step(&mut self, step: &Step) {
        match step {
            Step::Let { value, tree } => self.push(s::binding(self.value(*value)), self.tree(tree)),
            Step::SinCos { sin, cos, angle } => {
                let pattern = s::tuple_pattern(&[self.value(*sin), self.value(*cos)]);
                self.push(pattern, s::method(self.tree(angle), "sin_cos", Vec::new()));
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
                self.push(s::array_pattern(&names), solved);
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
            self.schedule.names.contains(name) || self.names.iter().any(|other| other == name)
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
            Tree::Value(value) => s::name(self.value(*value)),
            Tree::Argument(argument) => s::name(self.names.get(*argument)),
            Tree::Constant(value) if value.is_negative() => {
                s::negated(s::name(&self.names.constant(&value.abs())))
            }
            Tree::Constant(value) => s::name(&self.names.constant(value)),
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

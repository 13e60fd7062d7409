//! The body of a function: its schedule, statement by statement.

use std::collections::BTreeSet;

use syn::{Attribute, BinOp, Expr, Stmt, token};

use super::layout;
use super::syntax as s;
use super::types::{Types, result_struct};
use crate::program::{Array, Function, Layout, Space};
use crate::schedule::pi::parts_of_pi;
use crate::schedule::piece::method;
use crate::schedule::{Argument, Operation, Schedule, Step, Tree, Value};
use crate::symbolic::{Rational, Relation};

/// Columns of the lines that take arguments apart.
const COLUMNS: usize = 80;

/// The statements of a function; the last one is its result.
pub(super) fn body(types: &Types<'_>, function: &Function, schedule: &Schedule) -> Vec<Stmt> {
    let mut body = Body {
        types,
        schedule,
        statements: Vec::new(),
        attributes: Vec::new(),
    };
    body.arguments();
    body.weights();
    body.constants();
    for step in &schedule.steps {
        body.step(step);
    }
    body.results(function);
    body.statements
}

struct Body<'a> {
    types: &'a Types<'a>,
    schedule: &'a Schedule,
    statements: Vec<Stmt>,
    /// Comments and blank lines before the next statement.
    attributes: Vec<Attribute>,
}

impl Body<'_> {
    fn push(&mut self, pattern: syn::Pat, value: Expr) {
        let attributes = std::mem::take(&mut self.attributes);
        self.statements.push(s::let_(attributes, pattern, value));
    }

    /// `let &Parameters { m, g, .. } = p;`, as often as the names need lines.
    fn arguments(&mut self) {
        for group in self.types.groups() {
            let used: Vec<&str> = self
                .schedule
                .arguments
                .iter()
                .filter(|&&argument| group.holds(argument))
                .map(|&argument| self.types.names.get(argument))
                .collect();
            let frame = "    let & { .. } = ;".len() + group.type_name.len() + group.argument.len();
            for row in rows(&used, COLUMNS.saturating_sub(frame)) {
                let pattern = s::borrowed_fields(group.type_name, row, row.len() == group.len);
                self.push(pattern, s::name(&group.argument));
            }
        }
    }

    /// `let lambda_v = weights[0];`
    fn weights(&mut self) {
        for &argument in &self.schedule.arguments {
            if let Argument::Weight(index) | Argument::OutputWeight(index) = argument {
                let weights = &self.types.argument_names()[4];
                let value = s::entry(s::name(weights), &[index as usize]);
                self.push(s::binding(self.types.names.get(argument)), value);
            }
        }
    }

    /// `let half = T::constant(0.5);`
    fn constants(&mut self) {
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
            let name = self.types.names.constant(&value);
            self.push(
                s::binding(&name),
                s::associated("constant", vec![constant(&value)]),
            );
        }
    }

    fn value(&self, value: Value) -> &str {
        &self.schedule.names[value.0 as usize]
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
                    .map(|row| s::array(self.all(row)))
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
                let right = s::array(self.all(right));
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

    /// Name of a factorisation, not that of a value.
    fn factors(&self, factorisation: u32) -> String {
        let mut name = format!("lu_{}", factorisation + 1);
        let taken = |name: &String| {
            self.schedule.names.contains(name) || self.types.names.iter().any(|other| other == name)
        };
        while taken(&name) {
            name.push('_');
        }
        name
    }

    /// Values that something uses.
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

    fn all(&self, trees: &[Tree]) -> Vec<Expr> {
        trees.iter().map(|tree| self.tree(tree)).collect()
    }

    // Trees are at most one printed line deep.
    fn tree(&self, tree: &Tree) -> Expr {
        match tree {
            Tree::Value(value) => s::name(self.value(*value)),
            Tree::Argument(argument) => s::name(self.types.names.get(*argument)),
            Tree::Constant(value) if value.is_negative() => {
                s::negated(s::name(&self.types.names.constant(&value.abs())))
            }
            Tree::Constant(value) => s::name(&self.types.names.constant(value)),
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

    /// The arrays, and the expression that holds them all.
    fn results(&mut self, function: &Function) {
        let mut fields = Vec::new();
        let structure = result_struct(function);
        let names = Types::result_fields(function);
        let results = function.results.iter().zip(&self.schedule.results);
        for ((array, result), name) in results.zip(&names) {
            let value = self.result(array, &result.entries);
            fields.push((name.as_str(), value));
        }
        let value = match (structure, fields.len()) {
            (None, 1) => fields.remove(0).1,
            (structure, _) => {
                let fields = fields
                    .iter()
                    .map(|(name, value)| (*name, value.clone()))
                    .collect();
                s::structure(structure.unwrap_or_default(), fields, None)
            }
        };
        let mut value = value;
        if !self.statements.is_empty() {
            self.attributes.push(layout::blank());
        }
        attach(&mut value, std::mem::take(&mut self.attributes));
        self.statements.push(Stmt::Expr(value, None));
    }

    fn result(&self, array: &Array, entries: &[Tree]) -> Expr {
        match array.layout {
            Layout::Scalar => match entries {
                [entry, ..] => self.tree(entry),
                [] => s::associated("constant", vec![s::number(0.0)]),
            },
            Layout::Vector(space) => self.vector(space, self.all(entries)),
            Layout::List(_) => s::array(self.all(entries)),
            Layout::Rows(space, columns) => {
                let rows = entries.chunks(columns).map(|row| s::array(self.all(row)));
                self.vector(space, rows.collect())
            }
            Layout::Matrix(rows, columns) => {
                // A row may be empty: a model may have contacts and no coordinates.
                let lines = (0..rows).map(|row| &entries[row * columns..][..columns]);
                s::array(lines.map(|line| s::array(self.all(line))).collect())
            }
            Layout::Jacobian(rows, columns) => {
                let count = self.types.fields(columns).len();
                let lines = (0..self.types.fields(rows).len())
                    .map(|row| self.row(columns, &entries[row * count..][..count]));
                self.vector(rows, lines.collect())
            }
        }
    }

    /// `Name { field: value, … }`
    fn vector(&self, space: Space, values: Vec<Expr>) -> Expr {
        let fields = self.types.fields(space).iter().map(String::as_str);
        s::structure(Types::type_name(space), fields.zip(values).collect(), None)
    }

    /// `Name { field: value, ..Name::splat(zero) }`: the entries that are not zero.
    fn row(&self, space: Space, entries: &[Tree]) -> Expr {
        let is_zero = |tree: &&Tree| **tree == Tree::Constant(Rational::ZERO);
        if entries.iter().filter(is_zero).count() <= 1 {
            return self.vector(space, self.all(entries));
        }
        let name = Types::type_name(space);
        let zero = s::name(&self.types.names.constant(&Rational::ZERO));
        let zeros = s::associated_with(name, "splat", vec![zero]);
        let fields: Vec<(&str, Expr)> = self
            .types
            .fields(space)
            .iter()
            .zip(entries)
            .filter(|(_, entry)| !is_zero(entry))
            .map(|(field, entry)| (field.as_str(), self.tree(entry)))
            .collect();
        if fields.is_empty() {
            zeros
        } else {
            s::structure(name, fields, Some(zeros))
        }
    }
}

/// Names in rows of so many columns, commas included.
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

/// Comments before an expression.
fn attach(value: &mut Expr, attributes: Vec<Attribute>) {
    match value {
        Expr::Struct(inner) => inner.attrs = attributes,
        Expr::Array(inner) => inner.attrs = attributes,
        Expr::Path(inner) => inner.attrs = attributes,
        Expr::Call(inner) => inner.attrs = attributes,
        Expr::Unary(inner) => inner.attrs = attributes,
        _ => {}
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

/// What a tree is made of.
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

/// The number as Rust computes it: rounded once.
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

/// Which arguments a struct holds.
pub(super) struct Group {
    /// Name of the struct.
    pub(super) type_name: &'static str,
    /// Name of the function's argument.
    pub(super) argument: String,
    /// Number of fields.
    pub(super) len: usize,
    /// One of its arguments.
    pub(super) like: Argument,
}

impl Group {
    fn holds(&self, argument: Argument) -> bool {
        std::mem::discriminant(&argument) == std::mem::discriminant(&self.like)
    }
}

//! Expressions of schedules in languages with infix operators, such as C and Python.
//!
//! A [`Dialect`] defines names, numbers, functions and choices; operators, parentheses and the order of
//! evaluation are common to all, and follow the schedule.

use std::collections::BTreeSet;

use crate::program::{Layout, Program, Space};
use crate::schedule::names::ArgumentNames;
use crate::schedule::piece::method;
use crate::schedule::{Operation, Schedule, Step, Tree, Value};
use crate::symbolic::{Function, Rational, Relation};

/// The differences between languages.
pub(crate) trait Dialect {
    /// A name that is not reserved in the language.
    fn name(&self, name: &str) -> String;
    /// A function of one argument.
    fn function(&self, function: Function, of: &str) -> String;
    /// The angle of a point in the plane.
    fn atan2(&self, y: &str, x: &str) -> String;
    /// A power with a real exponent.
    fn power(&self, base: &str, exponent: &str) -> String;
    /// Compared left and right sides, value if the relation holds, value otherwise.
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

/// Precedence of an operation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Sum,
    Product,
    Sign,
    Atom,
}

/// Writes the trees of one schedule.
pub(crate) struct Infix<'a, D> {
    pub(crate) dialect: &'a D,
    pub(crate) schedule: &'a Schedule,
    pub(crate) names: &'a ArgumentNames,
}

impl<D: Dialect> Infix<'_, D> {
    /// Name of a value.
    pub(crate) fn value(&self, value: Value) -> String {
        self.dialect.name(&self.schedule.names[value.0 as usize])
    }

    /// A tree.
    pub(crate) fn tree(&self, tree: &Tree) -> String {
        self.at(tree, Level::Sum)
    }

    /// Several trees, separated by commas.
    pub(crate) fn list(&self, trees: &[Tree]) -> String {
        let trees: Vec<String> = trees.iter().map(|tree| self.tree(tree)).collect();
        trees.join(", ")
    }

    /// A tree, in parentheses if its precedence is below `least`.
    // Trees are at most one printed line deep.
    fn at(&self, tree: &Tree, least: Level) -> String {
        let (text, level) = match tree {
            Tree::Value(value) => (self.value(*value), Level::Atom),
            Tree::Argument(argument) => (self.dialect.name(self.names.get(*argument)), Level::Atom),
            Tree::Constant(value) if value.is_negative() => {
                let name = self.dialect.name(&self.names.constant(&value.abs()));
                (format!("-{name}"), Level::Sign)
            }
            Tree::Constant(value) => (self.dialect.name(&self.names.constant(value)), Level::Atom),
            Tree::Negate(a) => (format!("-{}", self.at(a, Level::Atom)), Level::Sign),
            Tree::Binary(operation, a, b) => {
                let (sign, level, right) = match operation {
                    Operation::Add => ("+", Level::Sum, Level::Product),
                    Operation::Subtract => ("-", Level::Sum, Level::Product),
                    Operation::Multiply => ("*", Level::Product, Level::Sign),
                    Operation::Divide => ("/", Level::Product, Level::Sign),
                };
                let (a, b) = (self.at(a, level), self.at(b, right));
                (format!("{a} {sign} {b}"), level)
            }
            Tree::Function(function, a) => {
                (self.dialect.function(*function, &self.tree(a)), Level::Atom)
            }
            Tree::Atan2(y, x) => (
                self.dialect.atan2(&self.tree(y), &self.tree(x)),
                Level::Atom,
            ),
            Tree::Power(base, exponent) => {
                let (base, exponent) = (self.tree(base), self.tree(exponent));
                (self.dialect.power(&base, &exponent), Level::Atom)
            }
            Tree::Choice {
                relation,
                compared,
                branches,
            } => {
                let all = [&compared[0], &compared[1], &branches[0], &branches[1]];
                let all = all.map(|tree| self.tree(tree));
                (self.dialect.choice(*relation, all), Level::Atom)
            }
        };
        if level < least {
            format!("({text})")
        } else {
            text
        }
    }

    /// The absolute values of the numbers in a function.
    pub(crate) fn constants(&self) -> BTreeSet<Rational> {
        let mut constants = BTreeSet::new();
        visit(self.schedule, &mut |tree| {
            if let Tree::Constant(value) = tree {
                constants.insert(value.abs());
            }
        });
        constants
    }

    /// Values that are used after their definition.
    pub(crate) fn used(&self) -> BTreeSet<Value> {
        let mut used = BTreeSet::new();
        visit(self.schedule, &mut |tree| {
            if let Tree::Value(value) = tree {
                used.insert(*value);
            }
        });
        used
    }

    /// A name different from all arguments and values.
    pub(crate) fn free(&self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        while self.schedule.names.contains(&name) || self.names.iter().any(|other| *other == name) {
            name.push('_');
        }
        name
    }
}

/// Calls a function on every tree of a schedule and every subtree.
fn visit<'t>(schedule: &'t Schedule, see: &mut impl FnMut(&'t Tree)) {
    let mut rest: Vec<&Tree> = Vec::new();
    for step in &schedule.steps {
        match step {
            Step::Let { tree, .. } => rest.push(tree),
            Step::SinCos { angle, .. } => rest.push(angle),
            Step::Factor { matrix, .. } => rest.extend(matrix),
            Step::Solve { right, .. } => rest.extend(right),
            Step::Paragraph { .. } => {}
        }
    }
    rest.extend(schedule.results.iter().flat_map(|array| &array.entries));
    while let Some(tree) = rest.pop() {
        see(tree);
        match tree {
            Tree::Value(_) | Tree::Argument(_) | Tree::Constant(_) => {}
            Tree::Negate(a) | Tree::Function(_, a) => rest.push(a),
            Tree::Binary(_, a, b) | Tree::Atan2(a, b) | Tree::Power(a, b) => {
                rest.extend([a.as_ref(), b]);
            }
            Tree::Choice {
                compared, branches, ..
            } => rest.extend(compared.iter().chain(branches.iter())),
        }
    }
}

/// Rows and columns of an array; only columns for a list, neither for a number.
pub(crate) fn shape(program: &Program, layout: Layout) -> Vec<usize> {
    let len = |space: Space| match space {
        Space::ConstraintRows => program.info.constraint_rows.len(),
        Space::Reactions => program.info.reactions.len(),
        _ => space.quantities(&program.info).len(),
    };
    match layout {
        Layout::Scalar => Vec::new(),
        Layout::List(n) => vec![n],
        Layout::Vector(space) => vec![len(space)],
        Layout::Matrix(rows, columns) => vec![rows, columns],
        Layout::Rows(space, columns) => vec![len(space), columns],
        Layout::Jacobian(rows, columns) => vec![len(rows), len(columns)],
    }
}

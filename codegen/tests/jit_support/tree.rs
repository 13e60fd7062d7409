//! Expressions written by hand, and the tape of steps that define numbered values by them.

use std::collections::HashMap;

use appell_codegen::symbolic::{Function, Rational, Relation};
use appell_codegen::tape::{Argument, Arithmetic, Operation, ResultArray, Tape, Value};

/// An expression.
#[derive(Debug, Clone)]
pub(crate) enum Tree {
    /// A value of an earlier step.
    Value(u32),
    Argument(Argument),
    Constant(Rational),
    Negate(Box<Tree>),
    Binary(Arithmetic, Box<Tree>, Box<Tree>),
    Function(Function, Box<Tree>),
    Atan2(Box<Tree>, Box<Tree>),
    Power(Box<Tree>, Box<Tree>),
    Choice {
        relation: Relation,
        compared: Box<[Tree; 2]>,
        branches: Box<[Tree; 2]>,
    },
}

/// Defines values.
#[derive(Debug, Clone)]
pub(crate) enum Step {
    Let {
        value: u32,
        tree: Tree,
    },
    SinCos {
        sin: u32,
        cos: u32,
        angle: Tree,
    },
    Factor {
        factorisation: u32,
        matrix: Vec<Tree>,
    },
    Solve {
        factorisation: u32,
        values: Vec<u32>,
        right: Vec<Tree>,
    },
}

/// The tape of these steps with one result. Values that no step defines become operations that do not exist.
pub(crate) fn tape(steps: Vec<Step>, entries: Vec<Tree>) -> Tape {
    let mut writer = Writer::default();
    for step in steps {
        writer.step(step);
    }
    let entries = writer.all(entries);
    writer.tape.results.push(ResultArray {
        name: "result".to_owned(),
        entries,
    });
    writer.tape
}

/// Adds a result of expressions in the arguments.
pub(crate) fn add_result(tape: &mut Tape, entries: Vec<Tree>) {
    let mut writer = Writer {
        tape: std::mem::take(tape),
        ..Writer::default()
    };
    let entries = writer.all(entries);
    let name = "more".to_owned();
    writer.tape.results.push(ResultArray { name, entries });
    *tape = writer.tape;
}

#[derive(Default)]
struct Writer {
    tape: Tape,
    values: HashMap<u32, Value>,
    factorisations: HashMap<u32, Value>,
}

impl Writer {
    fn step(&mut self, step: Step) {
        match step {
            Step::Let { value, tree } => {
                let computed = self.tree(tree);
                self.values.insert(value, computed);
            }
            Step::SinCos { sin, cos, angle } => {
                let angle = self.tree(angle);
                self.with_parts(Operation::SinCos(angle), [sin, cos]);
            }
            Step::Factor {
                factorisation,
                matrix,
            } => {
                let matrix = self.all(matrix);
                let made = self.tape.push(Operation::Factorise(matrix));
                self.factorisations.insert(factorisation, made);
            }
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let right = self.all(right);
                let known = self.factorisations.get(&factorisation).copied();
                let factorisation = known.unwrap_or(Value(u32::MAX));
                let solve = Operation::Solve {
                    factorisation,
                    right,
                };
                self.with_parts(solve, values);
            }
        }
    }

    fn with_parts(&mut self, operation: Operation, values: impl IntoIterator<Item = u32>) {
        let whole = self.tape.push(operation);
        for (index, value) in (0..).zip(values) {
            self.values.insert(value, whole.part(index));
        }
    }

    fn all(&mut self, trees: Vec<Tree>) -> Vec<Value> {
        trees.into_iter().map(|tree| self.tree(tree)).collect()
    }

    fn tree(&mut self, tree: Tree) -> Value {
        let operation = match tree {
            Tree::Value(value) => {
                let known = self.values.get(&value).copied();
                return known.unwrap_or(Value(u32::MAX - value));
            }
            Tree::Argument(argument) => Operation::Argument(argument),
            Tree::Constant(number) => Operation::Constant(number),
            Tree::Negate(a) => Operation::Negate(self.tree(*a)),
            Tree::Binary(operation, a, b) => {
                Operation::Binary(operation, self.tree(*a), self.tree(*b))
            }
            Tree::Function(function, a) => Operation::Function(function, self.tree(*a)),
            Tree::Atan2(y, x) => Operation::Atan2(self.tree(*y), self.tree(*x)),
            Tree::Power(base, exponent) => Operation::Power(self.tree(*base), self.tree(*exponent)),
            Tree::Choice {
                relation,
                compared,
                branches,
            } => Operation::Choice {
                relation,
                compared: compared.map(|tree| self.tree(tree)),
                branches: branches.map(|tree| self.tree(tree)),
            },
        };
        self.tape.push(operation)
    }
}

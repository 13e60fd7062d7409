//! Partial evaluation of a schedule for parameters that are zero.
//!
//! Adding zero and multiplying by one are exact, so the results are those of the full schedule
//! except for the sign of zero and for products of zero with a non-finite value.

use super::steps::{Argument, Operation, ResultArray, Schedule, Step, Tree, Value};
use crate::symbolic::{Function, Rational};

impl Schedule {
    /// The residual schedule where the parameters for which `is_zero` holds are zero.
    #[must_use]
    pub fn without(&self, is_zero: impl Fn(usize) -> bool) -> Self {
        let mut fold = Fold {
            is_zero,
            known: vec![None; self.names.len()],
        };
        let steps = self.steps.iter().filter_map(|step| fold.step(step));
        let mut steps: Vec<Step> = steps.collect();
        let results = self.results.iter().map(|result| ResultArray {
            name: result.name.clone(),
            entries: fold.all(&result.entries),
        });
        let results: Vec<ResultArray> = results.collect();
        keep_used(&mut steps, &results, self.names.len());
        Self {
            arguments: self.arguments.clone(),
            steps,
            results,
            names: self.names.clone(),
        }
    }
}

/// Constant and copy propagation.
struct Fold<F> {
    is_zero: F,
    /// By value: the number, argument or other value that it equals, possibly negated.
    known: Vec<Option<Tree>>,
}

impl<F: Fn(usize) -> bool> Fold<F> {
    fn step(&mut self, step: &Step) -> Option<Step> {
        match step {
            Step::Let { value, tree } => {
                let tree = self.tree(tree);
                if is_leaf(&tree) {
                    self.know(*value, tree);
                    return None;
                }
                Some(Step::Let {
                    value: *value,
                    tree,
                })
            }
            Step::SinCos { sin, cos, angle } => {
                let angle = self.tree(angle);
                if is_number(&angle, 0) {
                    self.know(*sin, number(0));
                    self.know(*cos, number(1));
                    return None;
                }
                Some(Step::SinCos {
                    sin: *sin,
                    cos: *cos,
                    angle,
                })
            }
            Step::Factor {
                factorisation,
                size,
                matrix,
            } => Some(Step::Factor {
                factorisation: *factorisation,
                size: *size,
                matrix: self.all(matrix),
            }),
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let right = self.all(right);
                if right.iter().all(|entry| is_number(entry, 0)) {
                    for value in values {
                        self.know(*value, number(0));
                    }
                    return None;
                }
                Some(Step::Solve {
                    factorisation: *factorisation,
                    values: values.clone(),
                    right,
                })
            }
            Step::Paragraph { .. } => Some(step.clone()),
        }
    }

    fn know(&mut self, value: Value, tree: Tree) {
        self.known[value.0 as usize] = Some(tree);
    }

    fn all(&self, trees: &[Tree]) -> Vec<Tree> {
        trees.iter().map(|tree| self.tree(tree)).collect()
    }

    fn boxed(&self, tree: &Tree) -> Box<Tree> {
        Box::new(self.tree(tree))
    }

    fn tree(&self, tree: &Tree) -> Tree {
        match tree {
            Tree::Value(value) => {
                let known = self.known[value.0 as usize].as_ref();
                known.unwrap_or(tree).clone()
            }
            Tree::Argument(Argument::Parameter(index)) if (self.is_zero)(*index as usize) => {
                number(0)
            }
            Tree::Argument(_) | Tree::Constant(_) => tree.clone(),
            Tree::Negate(a) => negated(self.tree(a)),
            Tree::Binary(operation, a, b) => binary(*operation, self.tree(a), self.tree(b)),
            Tree::Function(function, a) => applied(*function, self.tree(a)),
            Tree::Atan2(y, x) => Tree::Atan2(self.boxed(y), self.boxed(x)),
            Tree::Power(base, exponent) => Tree::Power(self.boxed(base), self.boxed(exponent)),
            Tree::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = [self.tree(&compared[0]), self.tree(&compared[1])];
                let [then, otherwise] = [self.tree(&branches[0]), self.tree(&branches[1])];
                if then == otherwise {
                    return then;
                }
                Tree::Choice {
                    relation: *relation,
                    compared: Box::new([left, right]),
                    branches: Box::new([then, otherwise]),
                }
            }
        }
    }
}

fn negated(a: Tree) -> Tree {
    match a {
        Tree::Negate(inner) => *inner,
        zero if is_number(&zero, 0) => zero,
        other => Tree::Negate(Box::new(other)),
    }
}

fn binary(operation: Operation, a: Tree, b: Tree) -> Tree {
    let zeros = [is_number(&a, 0), is_number(&b, 0)];
    match (operation, zeros) {
        (Operation::Add, [true, _]) => b,
        (Operation::Add | Operation::Subtract, [_, true]) => a,
        (Operation::Subtract, [true, _]) => negated(b),
        (Operation::Multiply, [true, _] | [_, true]) | (Operation::Divide, [true, false]) => {
            number(0)
        }
        (Operation::Multiply, _) if is_number(&a, 1) => b,
        (Operation::Multiply | Operation::Divide, _) if is_number(&b, 1) => a,
        _ => Tree::Binary(operation, Box::new(a), Box::new(b)),
    }
}

fn applied(function: Function, a: Tree) -> Tree {
    let is_odd = matches!(
        function,
        Function::Sin
            | Function::Asin
            | Function::Atan
            | Function::Sinh
            | Function::Tanh
            | Function::Sqrt
            | Function::Abs
            | Function::Sign
    );
    let is_one = matches!(function, Function::Cos | Function::Cosh | Function::Exp);
    match is_number(&a, 0) {
        true if is_odd => a,
        true if is_one => number(1),
        _ => Tree::Function(function, Box::new(a)),
    }
}

fn number(value: i64) -> Tree {
    Tree::Constant(Rational::from(value))
}

fn is_number(tree: &Tree, value: i64) -> bool {
    match (tree, value) {
        (Tree::Constant(constant), 0) => constant.is_zero(),
        (Tree::Constant(constant), 1) => constant.is_one(),
        _ => false,
    }
}

fn is_leaf(tree: &Tree) -> bool {
    match tree {
        Tree::Value(_) | Tree::Argument(_) | Tree::Constant(_) => true,
        Tree::Negate(a) => matches!(**a, Tree::Value(_) | Tree::Argument(_)),
        _ => false,
    }
}

/// Dead-code elimination.
fn keep_used(steps: &mut Vec<Step>, results: &[ResultArray], values: usize) {
    let mut used = Used {
        values: vec![false; values],
        factorisations: Vec::new(),
    };
    for result in results {
        used.all(&result.entries);
    }
    let mut kept = Vec::with_capacity(steps.len());
    for step in steps.drain(..).rev() {
        if used.needs(&step) {
            kept.push(step);
        }
    }
    kept.reverse();
    *steps = kept;
}

/// Live values and factorisations.
struct Used {
    values: Vec<bool>,
    factorisations: Vec<u32>,
}

impl Used {
    fn has(&self, value: Value) -> bool {
        self.values[value.0 as usize]
    }

    /// Whether a step is live; its operands then become live.
    fn needs(&mut self, step: &Step) -> bool {
        match step {
            Step::Let { value, tree } if self.has(*value) => self.tree(tree),
            Step::SinCos { sin, cos, angle } if self.has(*sin) || self.has(*cos) => {
                self.tree(angle);
            }
            Step::Factor {
                factorisation,
                matrix,
                ..
            } if self.factorisations.contains(factorisation) => self.all(matrix),
            Step::Solve {
                factorisation,
                values,
                right,
            } if values.iter().any(|value| self.has(*value)) => {
                self.factorisations.push(*factorisation);
                self.all(right);
            }
            Step::Paragraph { .. } => {}
            _ => return false,
        }
        true
    }

    fn all(&mut self, trees: &[Tree]) {
        for tree in trees {
            self.tree(tree);
        }
    }

    fn tree(&mut self, tree: &Tree) {
        match tree {
            Tree::Value(value) => self.values[value.0 as usize] = true,
            Tree::Argument(_) | Tree::Constant(_) => {}
            Tree::Negate(a) | Tree::Function(_, a) => self.tree(a),
            Tree::Binary(_, a, b) | Tree::Atan2(a, b) | Tree::Power(a, b) => {
                self.tree(a);
                self.tree(b);
            }
            Tree::Choice {
                compared, branches, ..
            } => {
                self.all(&**compared);
                self.all(&**branches);
            }
        }
    }
}

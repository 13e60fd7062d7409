//! Converts a schedule to its graph, with its arguments substituted.

use rustc_hash::FxHashMap;

use super::graph::{Graph, Id, Node};
use crate::schedule::{Argument, Schedule, Step, Tree, Value};
use crate::symbolic::Function;

/// Adds the operations of a schedule to a graph and returns its results, one list per array. `argument` gives
/// the node of an argument.
pub(crate) fn flatten(
    schedule: &Schedule,
    graph: &mut Graph,
    argument: impl FnMut(&mut Graph, Argument) -> Id,
) -> Vec<Vec<Id>> {
    let mut flat = Flattening {
        graph,
        argument,
        values: FxHashMap::default(),
        matrices: FxHashMap::default(),
    };
    for step in &schedule.steps {
        flat.step(step);
    }
    let arrays = schedule.results.iter();
    arrays.map(|array| flat.all(&array.entries)).collect()
}

struct Flattening<'g, F> {
    graph: &'g mut Graph,
    argument: F,
    values: FxHashMap<Value, Id>,
    /// By index of the factorisation.
    matrices: FxHashMap<u32, u32>,
}

impl<F: FnMut(&mut Graph, Argument) -> Id> Flattening<'_, F> {
    fn step(&mut self, step: &Step) {
        match step {
            Step::Let { value, tree } => {
                let id = self.tree(tree);
                self.values.insert(*value, id);
            }
            Step::SinCos { sin, cos, angle } => {
                let angle = self.tree(angle);
                for (value, function) in [(sin, Function::Sin), (cos, Function::Cos)] {
                    let id = self.graph.function(function, angle);
                    self.values.insert(*value, id);
                }
            }
            Step::Factor {
                factorisation,
                size,
                matrix,
            } => {
                let entries = self.all(matrix);
                let matrix = self.graph.factorise(*size, entries);
                self.matrices.insert(*factorisation, matrix);
            }
            Step::Solve {
                factorisation,
                values,
                right,
            } => {
                let right = self.all(right);
                let unknowns = self.graph.solve(self.matrices[factorisation], right);
                self.values.extend(values.iter().copied().zip(unknowns));
            }
            Step::Paragraph { .. } => {}
        }
    }

    fn all(&mut self, trees: &[Tree]) -> Vec<Id> {
        trees.iter().map(|tree| self.tree(tree)).collect()
    }

    // Trees are at most one printed line deep.
    fn tree(&mut self, tree: &Tree) -> Id {
        let node = match tree {
            Tree::Value(value) => return self.values[value],
            Tree::Argument(argument) => return (self.argument)(self.graph, *argument),
            Tree::Constant(number) => Node::Constant(number.clone()),
            Tree::Negate(a) => Node::Negate(self.tree(a)),
            Tree::Binary(operation, a, b) => Node::Binary(*operation, self.tree(a), self.tree(b)),
            Tree::Function(function, a) => Node::Function(*function, self.tree(a)),
            Tree::Atan2(y, x) => Node::Atan2(self.tree(y), self.tree(x)),
            Tree::Power(base, exponent) => Node::Power(self.tree(base), self.tree(exponent)),
            Tree::Choice {
                relation,
                compared,
                branches,
            } => Node::Choice {
                relation: *relation,
                compared: compared.each_ref().map(|tree| self.tree(tree)),
                branches: branches.each_ref().map(|tree| self.tree(tree)),
            },
        };
        self.graph.intern(node)
    }
}

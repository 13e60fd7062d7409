//! Converts a graph to a schedule of the live nodes.

use rustc_hash::FxHashMap;

use super::graph::{Graph, Id, Node, Solution, count};
use crate::schedule::{Argument, ResultArray, Schedule, Step, Tree, Value};
use crate::symbolic::Function;

/// The operations on which named results depend, each bound to a value.
pub(crate) fn bind(graph: &Graph, results: Vec<(&str, Vec<Id>)>) -> Schedule {
    let mut binding = Binding {
        graph,
        live: live(graph, results.iter().flat_map(|(_, entries)| entries)),
        values: FxHashMap::default(),
        arguments: Vec::new(),
        steps: Vec::new(),
        factorised: FxHashMap::default(),
    };
    for id in graph.ids() {
        if binding.live[id.index()] && !binding.values.contains_key(&id) {
            binding.step(id);
        }
    }
    let array = |(name, entries): (&str, Vec<Id>)| ResultArray {
        name: name.to_owned(),
        entries: entries.iter().map(|&id| binding.operand(id)).collect(),
    };
    let results = results.into_iter().map(array).collect();
    let names = (0..binding.values.len()).map(|i| format!("v_{i}"));
    binding.arguments.sort_unstable();
    Schedule {
        names: names.collect(),
        arguments: binding.arguments,
        steps: binding.steps,
        results,
    }
}

/// The live nodes: those that `needed` ones depend on.
fn live<'a>(graph: &Graph, needed: impl Iterator<Item = &'a Id>) -> Vec<bool> {
    let mut live = vec![false; graph.len()];
    let mut open: Vec<Id> = needed.copied().collect();
    while let Some(id) = open.pop() {
        if !std::mem::replace(&mut live[id.index()], true) {
            open.extend(graph.operands(id));
        }
    }
    live
}

struct Binding<'g> {
    graph: &'g Graph,
    live: Vec<bool>,
    values: FxHashMap<Id, Value>,
    arguments: Vec<Argument>,
    steps: Vec<Step>,
    /// Indices of the factorisations, by matrix.
    factorised: FxHashMap<u32, u32>,
}

impl Binding<'_> {
    fn define(&mut self, id: Id) -> Value {
        let value = Value(count(self.values.len()));
        self.values.insert(id, value);
        value
    }

    fn operand(&self, id: Id) -> Tree {
        match self.graph.node(id) {
            Node::Argument(argument) => Tree::Argument(*argument),
            Node::Constant(number) => Tree::Constant(number.clone()),
            _ => Tree::Value(self.values[&id]),
        }
    }

    fn step(&mut self, id: Id) {
        let operand = |id: &Id| self.operand(*id);
        let boxed = |id: &Id| Box::new(self.operand(*id));
        let tree = match self.graph.node(id) {
            Node::Argument(argument) => return self.arguments.push(*argument),
            Node::Constant(_) => return,
            Node::Function(function @ (Function::Sin | Function::Cos), angle) => {
                return self.sine_or_cosine(id, *function, *angle);
            }
            Node::Unknown { solution, .. } => return self.solve(*solution),
            Node::Negate(a) => Tree::Negate(boxed(a)),
            Node::Binary(operation, a, b) => Tree::Binary(*operation, boxed(a), boxed(b)),
            Node::Function(function, a) => Tree::Function(*function, boxed(a)),
            Node::Atan2(y, x) => Tree::Atan2(boxed(y), boxed(x)),
            Node::Power(base, exponent) => Tree::Power(boxed(base), boxed(exponent)),
            Node::Choice {
                relation,
                compared,
                branches,
            } => Tree::Choice {
                relation: *relation,
                compared: Box::new(compared.each_ref().map(operand)),
                branches: Box::new(branches.each_ref().map(operand)),
            },
        };
        let value = self.define(id);
        self.steps.push(Step::Let { value, tree });
    }

    /// Computes both together if both are live.
    fn sine_or_cosine(&mut self, id: Id, function: Function, angle: Id) {
        let other = match function {
            Function::Sin => Function::Cos,
            _ => Function::Sin,
        };
        let partner = self.graph.find(&Node::Function(other, angle));
        let tree = self.operand(angle);
        let own = self.define(id);
        let Some(partner) = partner.filter(|partner| self.live[partner.index()]) else {
            let tree = Tree::Function(function, Box::new(tree));
            self.steps.push(Step::Let { value: own, tree });
            return;
        };
        let other = self.define(partner);
        let (sin, cos) = match function {
            Function::Sin => (own, other),
            _ => (other, own),
        };
        let angle = tree;
        self.steps.push(Step::SinCos { sin, cos, angle });
    }

    fn solve(&mut self, solution: u32) {
        let Solution { matrix, right } = self.graph.solution(solution);
        let next = count(self.factorised.len());
        let factorisation = *self.factorised.entry(*matrix).or_insert(next);
        if factorisation == next {
            let matrix = self.graph.matrix(*matrix);
            self.steps.push(Step::Factor {
                factorisation,
                size: matrix.size,
                matrix: matrix.entries.iter().map(|&id| self.operand(id)).collect(),
            });
        }
        let right = right.iter().map(|&id| self.operand(id)).collect::<Vec<_>>();
        let unknowns = (0..count(right.len())).map(|row| Node::Unknown { solution, row });
        let unknowns: Vec<Id> = unknowns.filter_map(|node| self.graph.find(&node)).collect();
        let values = unknowns.into_iter().map(|id| self.define(id)).collect();
        self.steps.push(Step::Solve {
            factorisation,
            values,
            right,
        });
    }
}

//! Operations without the order of a schedule, hash-consed.

use rustc_hash::FxHashMap;

use crate::schedule::{Argument, Operation};
use crate::symbolic::{Function, Rational, Relation};

/// A node of a [`Graph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Id(u32);

impl Id {
    /// Its index among the nodes.
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// An operation on earlier nodes.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    /// An argument.
    Argument(Argument),
    /// An exact number.
    Constant(Rational),
    /// `-a`
    Negate(Id),
    /// `a ∘ b`
    Binary(Operation, Id, Id),
    /// A function of one argument.
    Function(Function, Id),
    /// `atan2(y, x)`
    Atan2(Id, Id),
    /// `base^exponent`
    Power(Id, Id),
    /// A select between two values.
    Choice {
        /// Relation.
        relation: Relation,
        /// Left and right side of the relation.
        compared: [Id; 2],
        /// Value if it holds, value otherwise.
        branches: [Id; 2],
    },
    /// An unknown of a linear system.
    Unknown {
        /// The solution; see [`Graph::solution`].
        solution: u32,
        /// Row of the unknown.
        row: u32,
    },
}

/// A linear system with one right-hand side.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Solution {
    /// Index of the matrix; see [`Graph::matrix`].
    pub(crate) matrix: u32,
    /// Right-hand side.
    pub(crate) right: Vec<Id>,
}

/// A square matrix, row by row.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct Matrix {
    /// Rows.
    pub(crate) size: usize,
    /// Entries.
    pub(crate) entries: Vec<Id>,
}

/// Nodes in order of creation: operands come first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    known: FxHashMap<Node, Id>,
    matrices: Vec<Matrix>,
    solutions: Vec<Solution>,
}

impl Graph {
    /// The number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// All nodes.
    pub(crate) fn ids(&self) -> impl Iterator<Item = Id> + use<> {
        (0..self.nodes.len()).map(id)
    }

    /// The operation of a node.
    pub(crate) fn node(&self, Id(id): Id) -> &Node {
        &self.nodes[id as usize]
    }

    /// An existing node.
    pub(crate) fn find(&self, node: &Node) -> Option<Id> {
        self.known.get(node).copied()
    }

    /// A solved system.
    pub(crate) fn solution(&self, solution: u32) -> &Solution {
        &self.solutions[solution as usize]
    }

    /// The matrix of a system.
    pub(crate) fn matrix(&self, matrix: u32) -> &Matrix {
        &self.matrices[matrix as usize]
    }

    /// The operands of a node.
    pub(crate) fn operands(&self, id: Id) -> Vec<Id> {
        match self.node(id) {
            Node::Argument(_) | Node::Constant(_) => Vec::new(),
            Node::Negate(a) | Node::Function(_, a) => vec![*a],
            Node::Binary(_, a, b) | Node::Atan2(a, b) | Node::Power(a, b) => vec![*a, *b],
            Node::Choice {
                compared, branches, ..
            } => compared.iter().chain(branches).copied().collect(),
            Node::Unknown { solution, .. } => {
                let Solution { matrix, right } = self.solution(*solution);
                let entries = &self.matrix(*matrix).entries;
                entries.iter().chain(right).copied().collect()
            }
        }
    }

    /// The node of an operation, without simplification.
    pub(crate) fn intern(&mut self, node: Node) -> Id {
        let nodes = &mut self.nodes;
        *self.known.entry(node).or_insert_with_key(|node| {
            nodes.push(node.clone());
            id(nodes.len() - 1)
        })
    }

    /// A matrix to be factorised.
    pub(crate) fn factorise(&mut self, size: usize, entries: Vec<Id>) -> u32 {
        position(&mut self.matrices, Matrix { size, entries })
    }

    /// The unknowns of a system.
    pub(crate) fn solve(&mut self, matrix: u32, right: Vec<Id>) -> Vec<Id> {
        let rows = right.len();
        let solution = position(&mut self.solutions, Solution { matrix, right });
        let row = |row| Node::Unknown {
            solution,
            row: count(row),
        };
        (0..rows).map(|i| self.intern(row(i))).collect()
    }

    /// An argument.
    pub(crate) fn argument(&mut self, argument: Argument) -> Id {
        self.intern(Node::Argument(argument))
    }

    /// `a + b`
    pub(crate) fn add(&mut self, a: Id, b: Id) -> Id {
        if let Node::Negate(b) = *self.node(b) {
            return self.subtract(a, b);
        }
        if let Node::Negate(a) = *self.node(a) {
            return self.subtract(b, a);
        }
        self.intern(Node::Binary(Operation::Add, a, b))
    }

    /// `a - b`
    pub(crate) fn subtract(&mut self, a: Id, b: Id) -> Id {
        if let Node::Negate(b) = *self.node(b) {
            return self.add(a, b);
        }
        self.intern(Node::Binary(Operation::Subtract, a, b))
    }

    /// A function of one argument.
    pub(crate) fn function(&mut self, function: Function, a: Id) -> Id {
        self.intern(Node::Function(function, a))
    }
}

fn position<T: PartialEq>(all: &mut Vec<T>, one: T) -> u32 {
    let known = all.iter().position(|other| *other == one);
    let place = known.unwrap_or(all.len());
    if place == all.len() {
        all.push(one);
    }
    count(place)
}

fn id(index: usize) -> Id {
    Id(count(index))
}

/// Converts an index; schedules are far shorter than its range.
pub(crate) fn count(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}

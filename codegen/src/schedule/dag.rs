//! The working graph: n-ary sums and products, rewritten by the passes to lower their cost.
//!
//! It differs from the symbolic graph in three ways. It contains only the nodes of one function.
//! Sums and products are not flattened automatically, so `m·R·(x + y)` can stay factored. Numbers
//! are ordinary factors, so `2·m` is shared like any other product.

use std::hash::BuildHasher;

use rustc_hash::{FxBuildHasher, FxHashMap};

use crate::symbolic::{Function, Rational, Relation};
use crate::tape::Argument;

/// A node of the working graph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Id(u32);

impl Id {
    /// Its index in per-node vectors.
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// An operand. `flip` means a reciprocal among the factors of a product and a minus everywhere
/// else.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Item {
    pub(super) id: Id,
    pub(super) flip: bool,
}

impl Item {
    /// The operand without a flip.
    pub(super) fn plain(id: Id) -> Self {
        Self { id, flip: false }
    }

    /// The operand, with its flip toggled if `flip` holds.
    #[must_use]
    pub(super) fn flipped_if(self, flip: bool) -> Self {
        Self {
            id: self.id,
            flip: self.flip != flip,
        }
    }
}

/// The operation of a node.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Op {
    /// A number, not negative.
    Number(Rational),
    /// An argument.
    Argument(Argument),
    /// Two or more terms, ordered, the first one positive.
    Sum(Vec<Item>),
    /// Factors, ordered, at most one number; one reciprocal or two or more factors.
    Product(Vec<Item>),
    /// A function of one argument.
    Function(Function, Item),
    /// `atan2(y, x)`
    Atan2([Item; 2]),
    /// `base^exponent`
    Power([Item; 2]),
    /// Compared left and right sides, value if the relation holds, value otherwise.
    Choice(Relation, [Item; 4]),
    /// A quantity that is displayed unchanged: opaque to all rewriting.
    Kept(Id),
    /// One unknown of a linear system.
    Solution { system: u32, row: u32 },
}

/// A linear system.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct System {
    /// Matrix, row by row.
    pub(super) matrix: Vec<Item>,
    /// Right-hand side.
    pub(super) right: Vec<Item>,
}

/// A name from the derivation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Name {
    /// Index of its definition in the symbolic graph.
    pub(super) definition: u32,
    /// Whether it stands for minus the node.
    pub(super) negative: bool,
    /// Whether differentiation generated it; such a name is used only for a value with several
    /// users.
    pub(super) automatic: bool,
}

/// The working graph.
#[derive(Debug, Clone, Default)]
pub(super) struct Dag {
    ops: Vec<Op>,
    /// Nodes by the hash of their operation, with linear probing.
    index: FxHashMap<u64, Id>,
    /// Names, one entry per node.
    pub(super) names: Vec<Option<Name>>,
    /// Linear systems, by the index in [`Op::Solution`].
    pub(super) systems: Vec<System>,
    /// Entries of all results, array by array.
    pub(super) results: Vec<Item>,
}

impl Dag {
    /// The number of nodes, including dead ones.
    pub(super) fn len(&self) -> usize {
        self.ops.len()
    }

    /// The operation of a node.
    pub(super) fn op(&self, id: Id) -> &Op {
        &self.ops[id.index()]
    }

    /// Replaces the operation of a node by one of equal value.
    pub(super) fn replace(&mut self, id: Id, op: Op) {
        self.ops[id.index()] = op;
    }

    /// A graph with capacity for this many nodes.
    pub(super) fn with_capacity(nodes: usize) -> Self {
        let mut dag = Self::default();
        dag.ops.reserve(nodes);
        dag.names.reserve(nodes);
        dag.index.reserve(nodes);
        dag
    }

    /// The node of an operation, by hash consing.
    pub(super) fn intern(&mut self, op: Op) -> Id {
        let hash = FxBuildHasher.hash_one(&op);
        let mut slot = hash;
        while let Some(&id) = self.index.get(&slot) {
            let known = &self.ops[id.index()];
            if *known == op {
                return id;
            }
            if FxBuildHasher.hash_one(known) != hash {
                // The node was rewritten since, or belongs to a neighbouring hash.
                break;
            }
            slot = slot.wrapping_add(1);
        }
        let id = Id(u32::try_from(self.ops.len()).unwrap_or(u32::MAX));
        self.ops.push(op);
        self.names.push(None);
        self.index.insert(slot, id);
        id
    }

    /// A number.
    pub(super) fn number(&mut self, value: &Rational) -> Item {
        let id = self.intern(Op::Number(value.abs()));
        Item {
            id,
            flip: value.is_negative(),
        }
    }

    /// The number that a node represents, if any.
    pub(super) fn as_number(&self, id: Id) -> Option<&Rational> {
        match self.op(id) {
            Op::Number(value) => Some(value),
            _ => None,
        }
    }

    /// Whether a node costs nothing: numbers and arguments.
    pub(super) fn is_leaf(&self, id: Id) -> bool {
        matches!(self.op(id), Op::Number(_) | Op::Argument(_))
    }

    /// Σ ± term. Numbers and equal terms are combined; the sign is that of the first remaining
    /// term.
    pub(super) fn sum(&mut self, mut terms: Vec<Item>) -> Item {
        terms.sort_unstable();
        let mut constant = Rational::ZERO;
        let mut sum: Vec<Item> = Vec::with_capacity(terms.len());
        let mut rest = terms.as_slice();
        while let [first, ..] = rest {
            let same = rest.partition_point(|item| item.id <= first.id);
            let minus = rest[..same].iter().filter(|item| item.flip).count();
            let count = i64::try_from(same).unwrap_or(0) - 2 * i64::try_from(minus).unwrap_or(0);
            if let Some(value) = self.as_number(first.id) {
                constant = &constant + &(&Rational::from(count) * value);
            } else if count.abs() == 1 {
                sum.push(Item {
                    id: first.id,
                    flip: count < 0,
                });
            } else if count != 0 {
                let factor = self.number(&Rational::from(count.abs()));
                let product = self.product(vec![factor, Item::plain(first.id)]);
                sum.push(product.flipped_if(count < 0));
            }
            rest = &rest[same..];
        }
        if !constant.is_zero() {
            let constant = self.number(&constant);
            sum.push(constant);
        }
        sum.sort_unstable();
        match sum.as_slice() {
            [] => self.number(&Rational::ZERO),
            [only] => *only,
            [first, ..] => {
                let negative = first.flip;
                if negative {
                    for term in &mut sum {
                        term.flip = !term.flip;
                    }
                }
                Item {
                    id: self.intern(Op::Sum(sum)),
                    flip: negative,
                }
            }
        }
    }

    /// Π factor^±1. Numbers are combined, and reciprocal factors cancel. The result is never
    /// negative.
    pub(super) fn product(&mut self, mut factors: Vec<Item>) -> Item {
        let mut coefficient = Rational::ONE;
        factors.retain(|factor| match self.as_number(factor.id) {
            Some(value) if !(factor.flip && value.is_zero()) => {
                let value = if factor.flip {
                    value.recip()
                } else {
                    value.clone()
                };
                coefficient = &coefficient * &value;
                false
            }
            _ => true,
        });
        factors.sort_unstable();
        // Equal nodes are adjacent, reciprocals last.
        let mut kept: Vec<Item> = Vec::with_capacity(factors.len() + 1);
        for factor in factors {
            match kept.last() {
                Some(last) if last.id == factor.id && last.flip != factor.flip => {
                    kept.pop();
                }
                _ => kept.push(factor),
            }
        }
        if coefficient.is_zero() || kept.is_empty() {
            return self.number(&coefficient);
        }
        if !coefficient.is_one() {
            let number = self.number(&coefficient);
            kept.push(number);
            kept.sort_unstable();
        }
        match kept.as_slice() {
            [only] if !only.flip => *only,
            _ => Item::plain(self.intern(Op::Product(kept))),
        }
    }

    /// Makes a value opaque; numbers and arguments are returned unchanged.
    pub(super) fn kept(&mut self, item: Item) -> Item {
        if self.is_leaf(item.id) {
            return item;
        }
        Item {
            id: self.intern(Op::Kept(item.id)),
            flip: item.flip,
        }
    }

    /// A function of one argument. The sign of the argument is moved out of odd functions and
    /// dropped in even ones.
    pub(super) fn function(&mut self, function: Function, argument: Item) -> Item {
        use Function::{Abs, Asin, Atan, Cos, Cosh, Sign, Sin, Sinh, Tanh};
        let odd = matches!(function, Sin | Asin | Atan | Sinh | Tanh | Sign);
        let even = matches!(function, Cos | Cosh | Abs);
        let inner = Item {
            id: argument.id,
            flip: argument.flip && !odd && !even,
        };
        Item {
            id: self.intern(Op::Function(function, inner)),
            flip: argument.flip && odd,
        }
    }

    /// Calls `visit` with every operand of a node; one that occurs twice is visited twice.
    pub(super) fn for_each_part(&self, id: Id, mut visit: impl FnMut(Item)) {
        match self.op(id) {
            Op::Number(_) | Op::Argument(_) => {}
            Op::Sum(items) | Op::Product(items) => items.iter().copied().for_each(visit),
            Op::Function(_, item) => visit(*item),
            Op::Kept(id) => visit(Item::plain(*id)),
            Op::Atan2(items) | Op::Power(items) => items.iter().copied().for_each(visit),
            Op::Choice(_, items) => items.iter().copied().for_each(visit),
            Op::Solution { system, .. } => {
                let system = &self.systems[*system as usize];
                system
                    .matrix
                    .iter()
                    .chain(&system.right)
                    .copied()
                    .for_each(visit);
            }
        }
    }

    /// The nodes reachable from the results, operands before users.
    pub(super) fn order(&self) -> Vec<Id> {
        let roots: Vec<Id> = self.results.iter().map(|item| item.id).collect();
        let mut seen = vec![false; self.len()];
        let mut order = Vec::with_capacity(self.len());
        self.visit_from(&roots, &mut seen, |id| order.push(id));
        order
    }

    /// Visits the nodes below `roots` that are not `seen`, operands before users.
    pub(super) fn visit_from(&self, roots: &[Id], seen: &mut [bool], mut visit: impl FnMut(Id)) {
        // Explicit stack: deep expressions must not overflow the call stack.
        let mut stack: Vec<(Id, bool)> = roots.iter().rev().map(|&id| (id, false)).collect();
        while let Some((id, parts_done)) = stack.pop() {
            if parts_done {
                visit(id);
            } else if !seen[id.index()] {
                seen[id.index()] = true;
                stack.push((id, true));
                let first = stack.len();
                self.for_each_part(id, |part| {
                    if !seen[part.id.index()] {
                        stack.push((part.id, false));
                    }
                });
                stack[first..].reverse();
            }
        }
    }

    /// Number of uses of each live node, by live nodes and results.
    pub(super) fn uses(&self, order: &[Id]) -> Vec<u32> {
        let mut uses = vec![0; self.len()];
        let mut systems_seen = vec![false; self.systems.len()];
        for &id in order {
            if let Op::Solution { system, .. } = self.op(id) {
                // All unknowns of a system come from one solution.
                if std::mem::replace(&mut systems_seen[*system as usize], true) {
                    continue;
                }
            }
            self.for_each_part(id, |part| uses[part.id.index()] += 1);
        }
        for result in &self.results {
            uses[result.id.index()] += 1;
        }
        uses
    }

    /// Operation count of the live nodes, with a division counted as `division` operations.
    pub(super) fn weight(&self, order: &[Id], division: usize) -> usize {
        order
            .iter()
            .map(|&id| match self.op(id) {
                Op::Sum(terms) => terms.len() - 1,
                Op::Product(factors) => {
                    let below = factors.iter().filter(|factor| factor.flip).count();
                    let above = factors.len() - below;
                    above.saturating_sub(1) + below.saturating_sub(1) + division * below.min(1)
                }
                _ => 0,
            })
            .sum()
    }
}

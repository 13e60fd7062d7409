//! The two programs under construction: what is computed once for an expansion, and what is computed
//! again for every order.

use rustc_hash::FxHashMap;

use crate::operations::graph::{Graph, Id, Node, count};
use crate::schedule::Argument;
use crate::symbolic::Function;
use appell_runtime::series::{Guard, OrderNumber};

/// A series whose coefficients enter a product: cₖ, or k cₖ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Operand {
    /// The node whose series it is.
    pub(super) of: Id,
    /// Whether each coefficient is multiplied by its order, as in a derivative.
    pub(super) derived: bool,
}

/// The series cₖ of a node.
pub(super) fn plain(of: Id) -> Operand {
    Operand { of, derived: false }
}

/// The series k cₖ of a node.
pub(super) fn derived(of: Id) -> Operand {
    Operand { of, derived: true }
}

/// Expands the values of one graph, order by order, in another.
#[derive(Debug)]
pub(super) struct Expansion {
    /// Values at the start of a step: those of the equations, and what the coefficients need of them.
    pub(super) zero: Graph,
    /// The coefficients of order k.
    pub(super) sweep: Graph,
    /// How many inputs the equations have.
    inputs: usize,
    /// Coefficients by node of `zero`; `None` where the value does not change.
    known: FxHashMap<Id, Option<Id>>,
    /// Values of `zero` that the sweep reads.
    pub(super) kept: Vec<Id>,
    places: FxHashMap<Id, usize>,
    /// Pairs of series whose products are summed.
    pub(super) products: Vec<[Operand; 2]>,
    slots: FxHashMap<[Operand; 2], usize>,
    /// Nodes of `zero` whose signs decide what the equations are.
    pub(super) guards: Vec<(Id, Guard)>,
}

impl Expansion {
    /// Nothing is expanded yet.
    pub(super) fn new(zero: Graph, inputs: usize) -> Self {
        Self {
            zero,
            sweep: Graph::default(),
            inputs,
            known: FxHashMap::default(),
            kept: Vec::new(),
            places: FxHashMap::default(),
            products: Vec::new(),
            slots: FxHashMap::default(),
            guards: Vec::new(),
        }
    }

    /// The coefficient of order k of a node, `None` where it is zero for every k ≥ 1.
    pub(super) fn coefficient(&mut self, id: Id) -> Option<Id> {
        if let Some(known) = self.known.get(&id) {
            return *known;
        }
        let coefficient = self.recurrence(id);
        self.known.insert(id, coefficient);
        coefficient
    }

    /// Tells the coefficient of a node.
    pub(super) fn know(&mut self, id: Id, coefficient: Option<Id>) {
        self.known.insert(id, coefficient);
    }

    /// The coefficient of an argument.
    pub(super) fn of_argument(&mut self, argument: Argument) -> Option<Id> {
        Some(match argument {
            Argument::State(_) | Argument::Input(_) => self.sweep.argument(argument),
            Argument::Time => self.order(OrderNumber::Time),
            Argument::Parameter(_)
            | Argument::Weight(_)
            | Argument::OutputWeight(_)
            | Argument::Acceleration(_) => return None,
        })
    }

    /// The order k.
    pub(super) fn k(&mut self) -> Id {
        self.sweep.argument(Argument::Time)
    }

    /// A number that depends on the order alone.
    pub(super) fn order(&mut self, number: OrderNumber) -> Id {
        let place = self.inputs + number as usize;
        self.sweep.argument(Argument::Input(count(place)))
    }

    /// A value of order zero, as the sweep reads it.
    pub(super) fn kept(&mut self, id: Id) -> Id {
        if let Node::Constant(number) = self.zero.node(id) {
            return self.sweep.intern(Node::Constant(number.clone()));
        }
        // A sign is taken off on either side.
        if let Node::Negate(a) = *self.zero.node(id) {
            let kept = self.kept(a);
            return self.sweep.negate(kept);
        }
        let place = *self.places.entry(id).or_insert_with(|| {
            self.kept.push(id);
            self.kept.len() - 1
        });
        self.sweep.argument(Argument::Parameter(count(place)))
    }

    /// Σ aⱼ bₖ₋ⱼ over 1 ≤ j < k.
    pub(super) fn sum(&mut self, a: Operand, b: Operand) -> Id {
        let pair = [a.min(b), a.max(b)];
        let slot = *self.slots.entry(pair).or_insert_with(|| {
            self.products.push(pair);
            self.products.len() - 1
        });
        self.sweep.argument(Argument::Weight(count(slot)))
    }

    /// 1/k Σ aⱼ bₖ₋ⱼ over 1 ≤ j < k.
    pub(super) fn mean(&mut self, a: Operand, b: Operand) -> Id {
        let sum = self.sum(a, b);
        let inverse = self.order(OrderNumber::Inverse);
        self.sweep.multiply(inverse, sum)
    }

    /// A value of order zero times a coefficient.
    pub(super) fn scaled(&mut self, factor: Id, coefficient: Id) -> Id {
        let factor = self.kept(factor);
        self.sweep.multiply(factor, coefficient)
    }

    /// A sum, where a coefficient may be zero.
    pub(super) fn add(&mut self, a: Option<Id>, b: Option<Id>) -> Option<Id> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.sweep.add(a, b)),
            (one, other) => one.or(other),
        }
    }

    /// A difference, where a coefficient may be zero.
    pub(super) fn subtract(&mut self, a: Option<Id>, b: Option<Id>) -> Option<Id> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.sweep.subtract(a, b)),
            (None, Some(b)) => Some(self.sweep.negate(b)),
            (a, None) => a,
        }
    }

    /// A value whose sign decides what the equations are, if it changes at all.
    pub(super) fn guard(&mut self, id: Id, guard: Guard) {
        if self.coefficient(id).is_some() && !self.guards.contains(&(id, guard)) {
            self.guards.push((id, guard));
        }
    }

    /// A function of one argument at order zero.
    pub(super) fn zero_function(&mut self, function: Function, a: Id) -> Id {
        self.zero.function(function, a)
    }

    /// The coefficients of the operands of all products, left and right.
    pub(super) fn operands(&mut self) -> [Vec<Id>; 2] {
        let mut sides = [Vec::new(), Vec::new()];
        // Coefficients that nothing else needed may need further products.
        let mut product = 0;
        while let Some(&pair) = self.products.get(product) {
            for (side, operand) in sides.iter_mut().zip(pair) {
                let coefficient = self.coefficient(operand.of);
                let coefficient = coefficient.unwrap_or_else(|| self.sweep.number(0));
                side.push(if operand.derived {
                    let k = self.k();
                    self.sweep.multiply(k, coefficient)
                } else {
                    coefficient
                });
            }
            product += 1;
        }
        sides
    }
}

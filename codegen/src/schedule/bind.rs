//! Writes the working graph as a tape: decides which nodes are bound to names, their order and their names.

mod factors;
mod naming;

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Id, Item, Op};
use super::monomial::Monomial;
use super::names::{ArgumentNames, Names};
use super::outline::Outline;
use super::piece::{Level, Piece, describe};
use super::signs::choose_signs;
use crate::program::{Function, Own, Program};
use crate::symbolic::{Function as Elementary, Rational};
use crate::tape::{Argument, Arithmetic, Operation, ResultArray, Tape, Value};

/// Maximum columns of an emitted line.
const COLUMNS: usize = 88;
/// Columns of `    let `, ` = ` and `;`.
const FRAME: usize = 12;
/// Columns assumed for a name that is not chosen yet.
const USUAL: usize = 24;
/// Columns available on the continuation lines of a long sum.
const MORE_LINES: usize = 140;
/// Wider expressions are not written inside others.
const INLINE: usize = 72;
/// Columns guaranteed to an expression, however long its name is.
const NARROWEST: usize = 30;

/// The tape of a function. `hints` marks the nodes that equal a hint of the program up to sign.
pub(super) fn bind(
    program: &Program,
    function: &Function,
    dag: &Dag,
    hints: Vec<Option<(usize, bool)>>,
) -> Tape {
    let mut binding = Binding::new(program, function, dag, hints);
    let mut seen = vec![false; dag.len()];
    for (title, roots) in binding.outline.paragraphs(function) {
        binding.title = Some(title);
        let mut order = Vec::new();
        dag.visit_from(&roots, &mut seen, |id| order.push(id));
        for id in order {
            binding.node(id);
        }
    }
    binding.finish(function)
}

/// How a node is referred to.
#[derive(Debug, Clone)]
struct Built {
    piece: Piece,
    /// Whether the piece is minus the node.
    negative: bool,
}

struct Binding<'a> {
    program: &'a Program,
    function: &'a Function,
    dag: &'a Dag,
    arguments: ArgumentNames,
    outline: Outline<'a>,
    /// Nodes to be computed with the opposite sign.
    minus: Vec<bool>,
    /// Per node without a derived name: index of a matching hint, and whether the hint is minus the
    /// node.
    hints: Vec<Option<(usize, bool)>>,
    /// Number of parts defined so far, per consumer.
    parts: Vec<u32>,
    built: Vec<Option<Built>>,
    names: Names,
    tape: Tape,
    /// The monomials of values whose names denote one.
    products: FxHashMap<Value, Monomial>,
    /// Values named by hints.
    hinted: FxHashSet<Value>,
    title: Option<String>,
    systems_done: Vec<bool>,
    /// Systems with their factorisations.
    factorisations: Vec<(u32, Value)>,
}

impl<'a> Binding<'a> {
    fn new(
        program: &'a Program,
        function: &'a Function,
        dag: &'a Dag,
        hints: Vec<Option<(usize, bool)>>,
    ) -> Self {
        let arguments = ArgumentNames::of(program);
        let mut names = Names::default();
        for name in arguments.iter() {
            names.reserve(name);
        }
        if function.kind.takes() == Some(Own::Accelerations) {
            for name in &arguments.accelerations {
                names.reserve(name);
            }
        }
        let outline = Outline::new(function, dag);
        for &id in &outline.order {
            if let Some(value) = dag.as_number(id) {
                names.reserve(&arguments.constant(value));
                names.reserve(&arguments.constant(&-value));
            }
        }
        for value in [Rational::ZERO, Rational::ONE] {
            names.reserve(&arguments.constant(&value));
        }
        Self {
            program,
            function,
            dag,
            minus: choose_signs(dag, &outline.order),
            outline,
            hints,
            parts: vec![0; dag.len()],
            built: vec![None; dag.len()],
            names,
            tape: Tape::default(),
            products: FxHashMap::default(),
            hinted: FxHashSet::default(),
            title: None,
            systems_done: vec![false; dag.systems.len()],
            factorisations: Vec::new(),
            arguments,
        }
    }

    fn finish(mut self, function: &Function) -> Tape {
        let dag = self.dag;
        let mut results = dag.results.iter();
        for array in &function.results {
            let own = results.by_ref().take(array.entries.len());
            let entries = own.map(|&item| self.signed(item).value).collect();
            self.tape.results.push(ResultArray {
                name: array.name.clone(),
                entries,
            });
        }
        self.tape.in_order_of_text()
    }

    /// The piece of an operand whose flip is a sign, and whether it is to be negated.
    fn part(&mut self, item: Item) -> (Piece, bool) {
        match &self.built[item.id.index()] {
            Some(built) => (built.piece, built.negative != item.flip),
            // Operands are built before their users.
            None => (self.constant(&Rational::ZERO), false),
        }
    }

    fn constant(&mut self, value: &Rational) -> Piece {
        let name = self.arguments.constant(value);
        Piece::name(self.tape.constant(value.clone()), &name)
    }

    /// Sort key of a term among the terms of its sign.
    fn place_in_sum(&self, value: Value) -> (u8, u32) {
        let monomial = Monomial::of(value, &self.tape, &self.products);
        monomial.map_or((2, 0), |monomial| monomial.place_in_sum())
    }

    /// The piece of an operand, with its sign.
    fn signed(&mut self, item: Item) -> Piece {
        let (piece, negative) = self.part(item);
        match (negative, self.tape.unnamed(piece.value)) {
            (false, _) => piece,
            (true, Some(Operation::Constant(value))) => {
                let opposite = -value;
                self.constant(&opposite)
            }
            (true, _) => piece.negated(&mut self.tape),
        }
    }

    fn node(&mut self, id: Id) {
        if self.built[id.index()].is_some() {
            return;
        }
        let (piece, negative) = match self.dag.op(id) {
            Op::Number(value) => (self.constant(value), false),
            Op::Argument(argument) => {
                let value = self.tape.argument(*argument);
                (Piece::name(value, self.arguments.get(*argument)), false)
            }
            Op::Sum(terms) => self.sum(id, terms),
            Op::Product(factors) => self.product(id, factors),
            Op::Function(_, angle) if self.outline.partner[id.index()].is_some() => {
                return self.sine_and_cosine(id, *angle);
            }
            Op::Function(function, argument) => {
                let [argument] = self.operands(id, [*argument]);
                (argument.function(&mut self.tape, *function), false)
            }
            Op::Kept(inner) => {
                self.built[id.index()] = self.built[inner.index()].clone();
                return;
            }
            Op::Atan2(items) => {
                let [y, x] = self.operands(id, *items);
                (y.atan2(&mut self.tape, x), false)
            }
            Op::Power(items) => {
                let [base, exponent] = self.operands(id, *items);
                (base.power(&mut self.tape, exponent), false)
            }
            Op::Choice(relation, items) => {
                let operands = self.operands(id, *items);
                (Piece::choice(&mut self.tape, *relation, operands), false)
            }
            Op::Solution { system, .. } => return self.solve(*system),
        };
        let leaf = self.dag.is_leaf(id);
        let built = if !leaf && (self.outline.bound[id.index()] || piece.width > INLINE) {
            self.named(id, piece, negative)
        } else {
            Built { piece, negative }
        };
        self.built[id.index()] = Some(built);
    }

    /// The operands of a function, with their signs, bound beforehand where they would not all fit
    /// on the line.
    fn operands<const N: usize>(&mut self, id: Id, items: [Item; N]) -> [Piece; N] {
        const CALL: usize = 26;
        let room = self.room(id).saturating_sub(CALL) / N;
        items.map(|item| {
            let piece = self.signed(item);
            if piece.width > room {
                self.bound(id, piece)
            } else {
                piece
            }
        })
    }

    fn sum(&mut self, id: Id, terms: &[Item]) -> (Piece, bool) {
        let mut negative = self.minus[id.index()];
        let mut parts: Vec<(Piece, bool)> = terms
            .iter()
            .map(|&term| {
                let (piece, minus) = self.part(term);
                (piece, minus != negative)
            })
            .collect();
        if parts.iter().all(|part| part.1) {
            negative = !negative;
            for part in &mut parts {
                part.1 = false;
            }
        }
        // `a - 2 b` instead of `a + -2 b`, if there is a positive term to start with.
        let positive = parts
            .iter()
            .any(|(piece, minus)| !minus && !piece.starts_negative(&self.tape));
        for (piece, minus) in parts.iter_mut().filter(|_| positive) {
            if piece.starts_negative(&self.tape) {
                *piece = piece.opposite(&mut self.tape);
                *minus = !*minus;
            }
        }
        parts.sort_by_key(|(piece, minus)| (*minus, self.place_in_sum(piece.value)));
        let parts = parts.into_iter().map(|(part, minus)| {
            let operation = if minus {
                Arithmetic::Subtract
            } else {
                Arithmetic::Add
            };
            (operation, part)
        });
        // If the sum is bound, it may continue term by term on the next lines.
        let sum = self.chain(id, self.room_with(id, MORE_LINES), parts);
        (
            sum.unwrap_or_else(|| self.constant(&Rational::ZERO)),
            negative,
        )
    }

    fn product(&mut self, id: Id, factors: &[Item]) -> (Piece, bool) {
        let mut natural = false;
        let (mut above, mut below) = (Vec::new(), Vec::new());
        for factor in factors {
            let (piece, minus) = self.part(Item::plain(factor.id));
            natural ^= minus;
            if factor.flip {
                below.push(piece);
            } else {
                above.push(piece);
            }
        }
        above.sort_by_key(|piece| self.reading_order(piece.value));
        below.sort_by_key(|piece| self.reading_order(piece.value));
        let mut negative = natural;
        if let Some(first) = above.first()
            && let Some(Operation::Constant(value)) = self.tape.unnamed(first.value)
            && natural != self.minus[id.index()]
        {
            let opposite = -value;
            above[0] = self.constant(&opposite);
            negative = !natural;
        }
        // If the product is bound, it may continue on one more line.
        let room = self.room_with(id, MORE_LINES / 2);
        let mut chain = |factors: Vec<Piece>| {
            let factors = factors
                .into_iter()
                .map(|factor| (Arithmetic::Multiply, factor));
            self.chain(id, room, factors)
        };
        let piece = match (chain(above), chain(below)) {
            (Some(numerator), None) => numerator,
            (numerator, Some(denominator)) => {
                let numerator = numerator.unwrap_or_else(|| self.constant(&Rational::ONE));
                let room = self.room(id);
                self.joined(id, room, Arithmetic::Divide, [numerator, denominator])
            }
            (None, None) => self.constant(&Rational::ONE),
        };
        (piece, negative)
    }

    /// `a ∘ b ∘ …`, with partial results bound beforehand where the line would be too long.
    fn chain(
        &mut self,
        id: Id,
        room: usize,
        parts: impl Iterator<Item = (Arithmetic, Piece)>,
    ) -> Option<Piece> {
        let mut whole: Option<Piece> = None;
        for (operation, part) in parts {
            whole = Some(match whole {
                None => part,
                Some(whole) => self.joined(id, room, operation, [whole, part]),
            });
        }
        whole
    }

    /// `left ∘ right`, the first or both of them bound beforehand where the line would be too long.
    fn joined(
        &mut self,
        id: Id,
        room: usize,
        operation: Arithmetic,
        [mut left, mut right]: [Piece; 2],
    ) -> Piece {
        let too_long = |left: &Piece, right: &Piece| left.width_of_binary(operation, right) > room;
        if too_long(&left, &right) {
            left = self.bound(id, left);
        }
        if too_long(&left, &right) {
            right = self.bound(id, right);
        }
        left.binary(&mut self.tape, operation, right)
    }

    /// An operand that is bound unless it is a name or a call.
    fn bound(&mut self, id: Id, piece: Piece) -> Piece {
        if piece.level == Level::Atom {
            piece
        } else {
            self.define_by_making(id, piece, None)
        }
    }

    /// Columns available to the expression of a node.
    fn room(&self, id: Id) -> usize {
        let made_up = || {
            let consumer = self.outline.feeds[id.index()].and_then(|feed| self.given_name(feed));
            consumer.map_or(USUAL, |name| name.len() + "_part_10".len())
        };
        let given = self
            .given_name(id)
            .filter(|_| self.outline.bound[id.index()]);
        let name = given.map_or_else(made_up, |name| name.len() + 1);
        COLUMNS.saturating_sub(FRAME + name).max(NARROWEST)
    }

    /// Columns available to a node that may continue on further lines if it is bound.
    fn room_with(&self, id: Id, more: usize) -> usize {
        self.room(id)
            + if self.outline.bound[id.index()] {
                more
            } else {
                0
            }
    }

    fn sine_and_cosine(&mut self, id: Id, angle: Item) {
        let Some(partner) = self.outline.partner[id.index()] else {
            return;
        };
        let (sin, cos) = match self.dag.op(id) {
            Op::Function(Elementary::Sin, _) => (id, partner),
            _ => (partner, id),
        };
        let angle = self.signed(angle);
        let text = describe(angle.value, &self.tape, &self.products, &self.arguments);
        let whole = self.push(Operation::SinCos(angle.value));
        for (index, of, prefix) in [(0, sin, "sin"), (1, cos, "cos")] {
            let wanted = match (&text, self.given_name(of)) {
                (Some(text), _) => format!("{prefix}_{text}"),
                (None, Some(name)) => name,
                (None, None) => self.fallback(of, prefix),
            };
            let piece = self.named_value(whole.part(index), &wanted);
            self.built[of.index()] = Some(Built {
                piece,
                negative: false,
            });
        }
    }

    fn solve(&mut self, system: u32) {
        if std::mem::replace(&mut self.systems_done[system as usize], true) {
            return;
        }
        let dag = self.dag;
        let matrix = &dag.systems[system as usize].matrix;
        let right = &dag.systems[system as usize].right;
        let same = |(other, _): &&(u32, Value)| dag.systems[*other as usize].matrix == *matrix;
        let known = self.factorisations.iter().find(same).map(|known| known.1);
        let factorisation = known.unwrap_or_else(|| {
            let matrix = matrix.iter().map(|&item| self.signed(item).value).collect();
            let made = self.push(Operation::Factorise(matrix));
            self.factorisations.push((system, made));
            made
        });
        let right = right.iter().map(|&item| self.signed(item).value).collect();
        let whole = self.push(Operation::Solve {
            factorisation,
            right,
        });
        for (row, unknown) in (0..).zip(self.unknowns(system)) {
            let wanted = unknown
                .and_then(|id| self.given_name(id))
                .unwrap_or_else(|| format!("solution_{}_{}", system + 1, row + 1));
            let piece = self.named_value(whole.part(row), &wanted);
            if let Some(id) = unknown {
                self.built[id.index()] = Some(Built {
                    piece,
                    negative: false,
                });
            }
        }
    }

    /// The nodes of the unknowns of a system, row by row.
    fn unknowns(&self, system: u32) -> Vec<Option<Id>> {
        let rows = self.dag.systems[system as usize].right.len();
        let mut unknowns = vec![None; rows];
        for &id in &self.outline.order {
            if let Op::Solution { system: other, row } = self.dag.op(id)
                && *other == system
                && let Some(place) = unknowns.get_mut(*row as usize)
            {
                *place = Some(id);
            }
        }
        unknowns
    }

    /// Binds a value to a name. Names are in the order of their definitions, so an operation that others follow is
    /// repeated here; the earlier one is dead.
    fn define(&mut self, name: &str, piece: Piece) -> Piece {
        let operation = self.tape.operation(piece.value).clone();
        debug_assert!(!matches!(operation, Operation::Part(..)), "{name}");
        let value = self.push(operation);
        self.named_value(value, name)
    }

    fn named_value(&mut self, value: Value, wanted: &str) -> Piece {
        let name = self.names.fresh(wanted);
        let piece = Piece::name(value, &name);
        self.tape.names[value.index()] = Some(name);
        piece
    }

    /// Adds the operation of a statement, under the heading that is due.
    fn push(&mut self, operation: Operation) -> Value {
        let value = self.tape.push(operation);
        if let Some(title) = self.title.take() {
            self.tape.headings.push((value, title));
        }
        value
    }

    /// Sort key: numbers, then parameters, values and variables, each in their order, then sums in
    /// parentheses.
    fn reading_order(&self, value: Value) -> (u8, u32) {
        match self.tape.unnamed(value) {
            None => (2, value.0),
            Some(Operation::Constant(_)) => (0, 0),
            Some(Operation::Argument(argument)) => match *argument {
                Argument::Parameter(i) => (1, i),
                Argument::Time => (3, 0),
                Argument::State(i) => (4, i),
                Argument::Input(i) => (5, i),
                Argument::Weight(i) | Argument::OutputWeight(i) | Argument::Acceleration(i) => {
                    (6, i)
                }
            },
            Some(_) => (7, 0),
        }
    }
}

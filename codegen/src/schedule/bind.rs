//! Turns the working graph into steps: decides which nodes are bound to names, their order and
//! their names.

mod factors;

use super::dag::{Dag, Id, Item, Name, Op};
use super::monomial::Monomial;
use super::names::{ArgumentNames, Names};
use super::outline::Outline;
use super::piece::{Level, Piece, describe};
use super::signs::{choose_signs, keeps_its_name};
use super::steps::{Argument, Operation, ResultArray, Schedule, Step, Tree, Value};
use crate::program::{Function, Own, Program};
use crate::symbolic::{Function as Elementary, Rational};

/// Maximum columns of an emitted line.
const COLUMNS: usize = 88;
/// Columns of `    let `, ` = ` and `;`.
const FRAME: usize = 12;
/// Columns assumed for a name that is not chosen yet.
const USUAL: usize = 24;
/// Columns available on the continuation lines of a long sum.
const MORE_LINES: usize = 140;
/// Wider trees are not inlined into other trees.
const INLINE: usize = 72;
/// Columns guaranteed to a tree, however long its name is.
const NARROWEST: usize = 30;

/// The steps of a function. `hints` marks the nodes that equal a hint of the program up to sign.
pub(super) fn bind(
    program: &Program,
    function: &Function,
    dag: &Dag,
    hints: Vec<Option<(usize, bool)>>,
) -> Schedule {
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
    values: Vec<String>,
    /// The monomial of each value, where its name denotes one.
    products: Vec<Option<Monomial>>,
    /// Values named by hints.
    hinted: Vec<bool>,
    steps: Vec<Step>,
    title: Option<String>,
    systems_done: Vec<bool>,
    /// System of each factorisation.
    factorisations: Vec<u32>,
}

impl<'a> Binding<'a> {
    fn new(
        program: &'a Program,
        function: &Function,
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
        let outline = Outline::new(program, function, dag);
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
            dag,
            minus: choose_signs(dag, &outline.order),
            outline,
            hints,
            parts: vec![0; dag.len()],
            built: vec![None; dag.len()],
            names,
            values: Vec::new(),
            products: Vec::new(),
            hinted: Vec::new(),
            steps: Vec::new(),
            title: None,
            systems_done: vec![false; dag.systems.len()],
            factorisations: Vec::new(),
            arguments,
        }
    }

    fn finish(self, function: &Function) -> Schedule {
        let mut results = self.dag.results.iter();
        let results: Vec<ResultArray> = function
            .results
            .iter()
            .map(|array| ResultArray {
                name: array.name.clone(),
                entries: results
                    .by_ref()
                    .take(array.entries.len())
                    .map(|&item| self.signed(item).tree)
                    .collect(),
            })
            .collect();
        let mut used: Vec<Argument> = self
            .outline
            .order
            .iter()
            .filter_map(|&id| match self.dag.op(id) {
                Op::Argument(argument) => Some(*argument),
                _ => None,
            })
            .collect();
        used.sort_unstable();
        Schedule {
            arguments: used,
            steps: self.steps,
            results,
            names: self.values,
        }
    }

    /// The piece of an operand whose flip is a sign, and whether it is to be negated.
    fn part(&self, item: Item) -> (Piece, bool) {
        match &self.built[item.id.index()] {
            Some(built) => (built.piece.clone(), built.negative != item.flip),
            // Operands are built before their users.
            None => (Piece::name(Tree::Constant(Rational::ZERO), "zero"), false),
        }
    }

    fn constant(&self, value: &Rational) -> Piece {
        Piece::name(
            Tree::Constant(value.clone()),
            &self.arguments.constant(value),
        )
    }

    /// Sort key of a term among the terms of its sign.
    fn place_in_sum(&self, tree: &Tree) -> (u8, u32) {
        Monomial::of(tree, &self.products).map_or((2, 0), |monomial| monomial.place_in_sum())
    }

    /// The piece of an operand, with its sign.
    fn signed(&self, item: Item) -> Piece {
        let (piece, negative) = self.part(item);
        match (negative, &piece.tree) {
            (false, _) => piece,
            (true, Tree::Constant(value)) => self.constant(&-value),
            (true, _) => piece.negated(),
        }
    }

    fn node(&mut self, id: Id) {
        if self.built[id.index()].is_some() {
            return;
        }
        let (piece, negative) = match self.dag.op(id) {
            Op::Number(value) => (self.constant(value), false),
            Op::Argument(argument) => (
                Piece::name(Tree::Argument(*argument), self.arguments.get(*argument)),
                false,
            ),
            Op::Sum(terms) => self.sum(id, terms),
            Op::Product(factors) => self.product(id, factors),
            Op::Function(_, angle) if self.outline.partner[id.index()].is_some() => {
                return self.sine_and_cosine(id, *angle);
            }
            Op::Function(function, argument) => {
                let [argument] = self.operands(id, [*argument]);
                (argument.function(*function), false)
            }
            Op::Kept(inner) => {
                self.built[id.index()] = self.built[inner.index()].clone();
                return;
            }
            Op::Atan2(items) => {
                let [y, x] = self.operands(id, *items);
                (y.atan2(x), false)
            }
            Op::Power(items) => {
                let [base, exponent] = self.operands(id, *items);
                (base.power(exponent), false)
            }
            Op::Choice(relation, items) => {
                let operands = self.operands(id, *items);
                (Piece::choice(*relation, operands), false)
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
            if piece.width > room && piece.level != Level::Atom {
                self.define_part(id, piece)
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
            .any(|(piece, minus)| !minus && !piece.starts_negative());
        for (piece, minus) in parts.iter_mut().filter(|_| positive) {
            if piece.starts_negative() {
                *piece = piece.clone().opposite();
                *minus = !*minus;
            }
        }
        parts.sort_by_key(|(piece, minus)| (*minus, self.place_in_sum(&piece.tree)));
        let room = self.room_of_sum(id);
        let mut sum: Option<Piece> = None;
        for (part, minus) in parts {
            sum = Some(match sum {
                None => part,
                Some(sum) => {
                    let operation = if minus {
                        Operation::Subtract
                    } else {
                        Operation::Add
                    };
                    let (sum, part) = self.fitting(id, room, operation, sum, part);
                    sum.binary(operation, part)
                }
            });
        }
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
        above.sort_by_key(|piece| reading_order(&piece.tree));
        below.sort_by_key(|piece| reading_order(&piece.tree));
        let mut negative = natural;
        if let Some(Piece {
            tree: Tree::Constant(value),
            ..
        }) = above.first()
            && natural != self.minus[id.index()]
        {
            above[0] = self.constant(&-value);
            negative = !natural;
        }
        let numerator = self.chain(id, above);
        let piece = match (numerator, self.chain(id, below)) {
            (Some(numerator), None) => numerator,
            (numerator, Some(denominator)) => {
                let numerator = numerator.unwrap_or_else(|| self.constant(&Rational::ONE));
                let room = self.room(id);
                let (numerator, denominator) =
                    self.fitting(id, room, Operation::Divide, numerator, denominator);
                numerator.binary(Operation::Divide, denominator)
            }
            (None, None) => self.constant(&Rational::ONE),
        };
        (piece, negative)
    }

    /// `a b c …`, with partial products bound beforehand where the line would be too long.
    fn chain(&mut self, id: Id, factors: Vec<Piece>) -> Option<Piece> {
        let room = self.room_of_product(id);
        let mut product: Option<Piece> = None;
        for factor in factors {
            product = Some(match product {
                None => factor,
                Some(product) => {
                    let (product, factor) =
                        self.fitting(id, room, Operation::Multiply, product, factor);
                    product.binary(Operation::Multiply, factor)
                }
            });
        }
        product
    }

    /// Two operands unchanged, or the first or both of them bound beforehand where the line would
    /// be too long.
    fn fitting(
        &mut self,
        id: Id,
        room: usize,
        operation: Operation,
        left: Piece,
        right: Piece,
    ) -> (Piece, Piece) {
        let too_long = |left: &Piece, right: &Piece| left.width_of_binary(operation, right) > room;
        let mut define = |piece: Piece| {
            if piece.level == Level::Atom {
                piece
            } else {
                self.define_part(id, piece)
            }
        };
        let left = if too_long(&left, &right) {
            define(left)
        } else {
            left
        };
        let right = if too_long(&left, &right) {
            define(right)
        } else {
            right
        };
        (left, right)
    }

    /// Columns available to the tree of a node.
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

    /// Columns available to a sum: if it is bound, it may continue term by term on the next lines.
    fn room_of_sum(&self, id: Id) -> usize {
        let more = if self.outline.bound[id.index()] {
            MORE_LINES
        } else {
            0
        };
        self.room(id) + more
    }

    /// Columns available to a product: if it is bound, it may continue on one more line.
    fn room_of_product(&self, id: Id) -> usize {
        let more = if self.outline.bound[id.index()] {
            MORE_LINES / 2
        } else {
            0
        };
        self.room(id) + more
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
        let text = describe(&angle.tree, &self.values, &self.products, &self.arguments);
        let mut value = |of: Id, prefix: &str| {
            let wanted = match (&text, self.given_name(of)) {
                (Some(text), _) => format!("{prefix}_{text}"),
                (None, Some(name)) => name,
                (None, None) => self.fallback(of, prefix),
            };
            let (value, piece) = self.new_value(&wanted);
            self.built[of.index()] = Some(Built {
                piece,
                negative: false,
            });
            value
        };
        let (sin, cos) = (value(sin, "sin"), value(cos, "cos"));
        self.push(Step::SinCos {
            sin,
            cos,
            angle: angle.tree,
        });
    }

    fn solve(&mut self, system: u32) {
        if std::mem::replace(&mut self.systems_done[system as usize], true) {
            return;
        }
        let dag = self.dag;
        let matrix = &dag.systems[system as usize].matrix;
        let right = &dag.systems[system as usize].right;
        let same = |other: &u32| dag.systems[*other as usize].matrix == *matrix;
        let known = self.factorisations.iter().position(same);
        let number = known.unwrap_or(self.factorisations.len());
        let factorisation = u32::try_from(number).unwrap_or(u32::MAX);
        if known.is_none() {
            self.factorisations.push(system);
            let matrix = matrix.iter().map(|&item| self.signed(item).tree).collect();
            self.push(Step::Factor {
                factorisation,
                size: right.len(),
                matrix,
            });
        }
        let right = right.iter().map(|&item| self.signed(item).tree).collect();
        let unknowns = self.unknowns(system);
        let values = unknowns
            .into_iter()
            .enumerate()
            .map(|(row, unknown)| {
                let wanted = unknown
                    .and_then(|id| self.given_name(id))
                    .unwrap_or_else(|| format!("solution_{}_{}", system + 1, row + 1));
                let (value, piece) = self.new_value(&wanted);
                if let Some(id) = unknown {
                    self.built[id.index()] = Some(Built {
                        piece,
                        negative: false,
                    });
                }
                value
            })
            .collect();
        self.push(Step::Solve {
            factorisation,
            values,
            right,
        });
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

    /// Name from the derivation, or of the result.
    fn given_name(&self, id: Id) -> Option<String> {
        let label = self.outline.labels[id.index()].as_ref();
        let derived = self.derived_name(id);
        let derived = derived.map(|name| &self.program.graph.definition(name.definition).name);
        derived.or(label.map(|label| &label.0)).cloned()
    }

    /// Name from the derivation; the name of a result takes precedence over one made up by
    /// differentiation.
    fn derived_name(&self, id: Id) -> Option<Name> {
        let label = self.outline.labels[id.index()].as_ref();
        self.dag.names[id.index()].filter(|name| !name.automatic || label.is_none())
    }

    /// Whether the name of a node denotes minus the node; `None` without a name.
    fn sign_of_name(&self, id: Id) -> Option<bool> {
        let label = self.outline.labels[id.index()].as_ref();
        let derived = self.derived_name(id).map(|name| name.negative);
        derived.or(label.map(|label| label.1))
    }

    /// Binds a value to its most informative name. `negative` says that the piece is minus the
    /// node.
    fn named(&mut self, id: Id, piece: Piece, negative: bool) -> Built {
        let sign = self.sign_of_name(id);
        let given = self
            .given_name(id)
            .filter(|_| !self.tells_itself(id, &piece));
        let (piece, negative) = match given {
            Some(name) if sign == Some(negative) => (self.define(&name, piece.tree), negative),
            Some(name) if self.takes_its_sign(id) => {
                (self.define(&name, piece.opposite().tree), !negative)
            }
            // A value of the opposite sign is named after its own operation.
            _ => {
                let hint = self.hint(id, negative);
                (self.define_by_making(id, piece.tree, hint), negative)
            }
        };
        Built { piece, negative }
    }

    /// Whether a shared value is better named after its factors than after one of its uses.
    fn tells_itself(&self, id: Id, piece: &Piece) -> bool {
        const FEW: usize = 3;
        self.outline.is_entry(id)
            && self.derived_name(id).is_none_or(|name| name.automatic)
            && self.outline.feeds_others(id)
            && Monomial::of(&piece.tree, &self.products).is_some_and(|product| {
                // A hint may add a name but not replace one.
                let hinted = product.values().any(|value| self.hinted[value.0 as usize]);
                !hinted
                    && product.length() <= FEW
                    && product.name(&self.values, &self.arguments).is_some()
            })
    }

    /// Whether a value computed with the opposite sign is negated to keep its name.
    fn takes_its_sign(&self, id: Id) -> bool {
        self.dag.names[id.index()].is_some()
            || keeps_its_name(self.dag, id)
            || !self.outline.is_shared(id)
    }

    /// The name of a hint, or one made of the cofactors; `negative` says that minus the node is
    /// bound.
    fn hint(&self, id: Id, negative: bool) -> Option<String> {
        let hint = self.hints[id.index()].and_then(|(number, opposite)| {
            let hint = &self.program.hints[number];
            if opposite == negative {
                Some(hint.name.clone())
            } else {
                hint.opposite.clone()
            }
        });
        hint.or_else(|| self.by_factors(id, negative))
    }

    /// `consumer_part_2`
    fn fallback(&mut self, id: Id, word: &str) -> String {
        let feed = self.outline.feeds[id.index()];
        let consumer = feed
            .and_then(|feed| self.given_name(feed))
            .unwrap_or_else(|| "result".to_owned());
        let count = &mut self.parts[feed.unwrap_or(id).index()];
        *count += 1;
        format!("{consumer}_{word}_{count}")
    }

    /// Binds a subtree that is too wide for a line.
    fn define_part(&mut self, id: Id, piece: Piece) -> Piece {
        self.define_by_making(id, piece.tree, None)
    }

    /// Binds a value to a name made from its operation.
    fn define_by_making(&mut self, id: Id, tree: Tree, hint: Option<String>) -> Piece {
        let described = describe(&tree, &self.values, &self.products, &self.arguments);
        let product = described
            .is_some()
            .then(|| Monomial::of(&tree, &self.products));
        let hinted = described.is_none() && hint.is_some();
        let name = described
            .or(hint)
            .unwrap_or_else(|| self.fallback(id, "part"));
        let piece = self.define(&name, tree);
        if let Some(last) = self.hinted.last_mut() {
            *last = hinted;
        }
        if let Some(last) = self.products.last_mut() {
            *last = product.flatten();
        }
        piece
    }

    fn define(&mut self, name: &str, tree: Tree) -> Piece {
        let (value, piece) = self.new_value(name);
        self.push(Step::Let { value, tree });
        piece
    }

    fn new_value(&mut self, wanted: &str) -> (Value, Piece) {
        let name = self.names.fresh(wanted);
        let value = Value(u32::try_from(self.values.len()).unwrap_or(u32::MAX));
        let piece = Piece::name(Tree::Value(value), &name);
        self.values.push(name);
        self.products.push(None);
        self.hinted.push(false);
        (value, piece)
    }

    fn push(&mut self, step: Step) {
        if let Some(title) = self.title.take() {
            self.steps.push(Step::Paragraph { title });
        }
        self.steps.push(step);
    }
}

/// Sort key: numbers, then parameters, values and variables, each in their order, then sums in
/// parentheses.
fn reading_order(tree: &Tree) -> (u8, u32) {
    match tree {
        Tree::Constant(_) => (0, 0),
        Tree::Argument(Argument::Parameter(i)) => (1, *i),
        Tree::Value(Value(i)) => (2, *i),
        Tree::Argument(Argument::Time) => (3, 0),
        Tree::Argument(Argument::State(i)) => (4, *i),
        Tree::Argument(Argument::Input(i)) => (5, *i),
        Tree::Argument(
            Argument::Weight(i) | Argument::OutputWeight(i) | Argument::Acceleration(i),
        ) => (6, *i),
        _ => (7, 0),
    }
}

//! From the working graph to steps: what gets a name, in which order, under which name.

use super::dag::{Dag, Id, Item, Op};
use super::names::{ArgumentNames, LONGEST, Names, result_label};
use super::piece::{Level, Piece, describe};
use super::signs::choose_signs;
use super::{Argument, Operation, ResultArray, Schedule, Step, Tree, Value};
use crate::program::{Function, Program};
use crate::symbolic::{Function as Elementary, Rational};

/// Columns of an emitted line.
const COLUMNS: usize = 88;
/// Columns of `    let `, ` = ` and `;`.
const FRAME: usize = 12;
/// Wider trees are not written inside other trees.
const INLINE: usize = 48;

/// The steps of a function.
pub(super) fn bind(program: &Program, function: &Function, dag: &Dag) -> Schedule {
    let mut binding = Binding::new(program, function, dag);
    let mut seen = vec![false; dag.len()];
    for (title, roots) in binding.paragraphs(function) {
        binding.title = Some(title);
        let mut order = Vec::new();
        dag.visit_from(&roots, &mut seen, |id| order.push(id));
        for id in order {
            binding.node(id);
        }
    }
    binding.finish(function)
}

/// How a node can be referred to.
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
    uses: Vec<u32>,
    /// Nodes that must not be written inside other trees.
    bound: Vec<bool>,
    /// Nodes wanted with the opposite sign.
    minus: Vec<bool>,
    /// Sine and cosine of the same angle: the partner.
    partner: Vec<Option<Id>>,
    /// What the node is called if it is a result.
    labels: Vec<Option<(String, bool)>>,
    /// What the node is for: the name of the first named value or result that it feeds.
    feeds: Vec<Option<Id>>,
    parts: Vec<u32>,
    built: Vec<Option<Built>>,
    names: Names,
    values: Vec<String>,
    steps: Vec<Step>,
    title: Option<String>,
    systems_done: Vec<bool>,
    /// System of each factorisation.
    factorisations: Vec<u32>,
}

impl<'a> Binding<'a> {
    fn new(program: &'a Program, function: &Function, dag: &'a Dag) -> Self {
        let arguments = ArgumentNames::of(program);
        let mut names = Names::default();
        for name in arguments.iter() {
            names.reserve(name);
        }
        let order = dag.order();
        for &id in &order {
            if let Some(value) = dag.as_number(id) {
                names.reserve(&arguments.constant(value));
                names.reserve(&arguments.constant(&-value));
            }
        }
        names.reserve(&arguments.constant(&Rational::ONE));
        let mut binding = Self {
            program,
            dag,
            uses: dag.uses(&order),
            bound: vec![false; dag.len()],
            minus: choose_signs(dag, &order),
            partner: vec![None; dag.len()],
            labels: vec![None; dag.len()],
            feeds: vec![None; dag.len()],
            parts: vec![0; dag.len()],
            built: vec![None; dag.len()],
            names,
            values: Vec::new(),
            steps: Vec::new(),
            title: None,
            systems_done: vec![false; dag.systems.len()],
            factorisations: Vec::new(),
            arguments,
        };
        binding.label_results(function);
        binding.pair_sines(&order);
        binding.choose_bound(&order);
        binding.find_feeds(&order);
        binding
    }

    fn label_results(&mut self, function: &Function) {
        let mut results = self.dag.results.iter();
        for array in &function.results {
            for (entry, result) in (0..array.entries.len()).zip(&mut results) {
                let label = &mut self.labels[result.id.index()];
                if label.is_none() {
                    let text =
                        result_label(self.program, &self.arguments, function.kind, array, entry);
                    *label = Some((text, result.flip));
                }
                self.bound[result.id.index()] = true;
            }
        }
    }

    fn pair_sines(&mut self, order: &[Id]) {
        let mut sines: Vec<(Item, Elementary, Id)> = order
            .iter()
            .filter_map(|&id| match self.dag.op(id) {
                Op::Function(kind @ (Elementary::Sin | Elementary::Cos), angle) => {
                    Some((*angle, *kind, id))
                }
                _ => None,
            })
            .collect();
        sines.sort_unstable();
        for pair in sines.windows(2) {
            if pair[0].0 == pair[1].0 {
                let (sin, cos) = (pair[0].2, pair[1].2);
                self.partner[sin.index()] = Some(cos);
                self.partner[cos.index()] = Some(sin);
            }
        }
    }

    fn choose_bound(&mut self, order: &[Id]) {
        for &id in order {
            let i = id.index();
            let parts = match self.dag.op(id) {
                Op::Number(_) | Op::Argument(_) => {
                    self.bound[i] = false;
                    continue;
                }
                Op::Sum(items) | Op::Product(items) => items.len(),
                Op::Solution { system, .. } => {
                    let system = &self.dag.systems[*system as usize];
                    for item in system.matrix.iter().chain(&system.right) {
                        self.bound[item.id.index()] |= !self.dag.is_leaf(item.id);
                    }
                    usize::MAX
                }
                _ => 1,
            };
            let worth_reading = self.dag.names[i].is_some() && parts > 2;
            self.bound[i] |= self.uses[i] >= 2
                || worth_reading
                || parts == usize::MAX
                || self.partner[i].is_some();
        }
    }

    fn find_feeds(&mut self, order: &[Id]) {
        for &id in order.iter().rev() {
            let named = self.bound[id.index()]
                && (self.dag.names[id.index()].is_some() || self.labels[id.index()].is_some());
            if named {
                self.feeds[id.index()] = Some(id);
            }
            let feed = self.feeds[id.index()];
            self.dag
                .for_each_part(id, |part| self.feeds[part.id.index()] = feed);
        }
    }

    /// Titles and the nodes to reach under them.
    fn paragraphs(&self, function: &Function) -> Vec<(String, Vec<Id>)> {
        let order = self.dag.order();
        let mut only_parameters = vec![false; self.dag.len()];
        for &id in &order {
            let mut all =
                !matches!(self.dag.op(id), Op::Argument(a) if !matches!(a, Argument::Parameter(_)));
            self.dag
                .for_each_part(id, |part| all &= only_parameters[part.id.index()]);
            only_parameters[id.index()] = all;
        }
        let sines = order.iter().copied().filter(|id| match self.dag.op(*id) {
            Op::Function(Elementary::Sin | Elementary::Cos, angle) => {
                self.bound[id.index()] && matches!(self.dag.op(angle.id), Op::Argument(_))
            }
            _ => false,
        });
        let parameters = order
            .iter()
            .copied()
            .filter(|id| only_parameters[id.index()] && self.bound[id.index()]);
        let mut paragraphs = vec![
            ("Sines and cosines.".to_owned(), sines.collect()),
            (
                "Combinations of parameters.".to_owned(),
                parameters.collect(),
            ),
        ];
        let mut results = self.dag.results.iter();
        for array in &function.results {
            let title = match array.name.as_str() {
                "a" => "Derivatives by the state.".to_owned(),
                "b" => "Derivatives by the inputs.".to_owned(),
                "p" => "Derivatives by the parameters.".to_owned(),
                name => {
                    let mut title = name.replace('_', " ");
                    title
                        .get_mut(..1)
                        .map(str::make_ascii_uppercase)
                        .unwrap_or_default();
                    title + "."
                }
            };
            let roots = results
                .by_ref()
                .take(array.entries.len())
                .map(|item| item.id)
                .collect();
            paragraphs.push((title, roots));
        }
        paragraphs
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
            .dag
            .order()
            .into_iter()
            .filter_map(|id| match self.dag.op(id) {
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

    /// The piece of an item whose flip is a sign, and whether it is to be negated.
    fn part(&self, item: Item) -> (Piece, bool) {
        match &self.built[item.id.index()] {
            Some(built) => (built.piece.clone(), built.negative != item.flip),
            // Parts are built before wholes.
            None => (Piece::name(Tree::Constant(Rational::ZERO), "zero"), false),
        }
    }

    fn constant(&self, value: &Rational) -> Piece {
        Piece::name(
            Tree::Constant(value.clone()),
            &self.arguments.constant(value),
        )
    }

    /// The piece of an item, with its sign.
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
            Op::Function(_, angle) if self.partner[id.index()].is_some() => {
                return self.sine_and_cosine(id, *angle);
            }
            Op::Function(function, argument) => (self.signed(*argument).function(*function), false),
            Op::Atan2([y, x]) => (self.signed(*y).atan2(self.signed(*x)), false),
            Op::Power([base, exponent]) => {
                (self.signed(*base).power(self.signed(*exponent)), false)
            }
            Op::Choice(relation, items) => {
                let [left, right, then, otherwise] = items.map(|item| self.signed(item));
                let widths = left.width + right.width + then.width + otherwise.width;
                let tree = Tree::Choice {
                    relation: *relation,
                    compared: Box::new([left.tree, right.tree]),
                    branches: Box::new([then.tree, otherwise.tree]),
                };
                let width = widths + "T::if_less_or_equal(, , , )".len();
                (
                    Piece {
                        tree,
                        width,
                        level: Level::Atom,
                    },
                    false,
                )
            }
            Op::Solution { system, .. } => return self.solve(*system),
        };
        let leaf = self.dag.is_leaf(id);
        let piece = if !leaf && (self.bound[id.index()] || piece.width > INLINE) {
            let name = self.value_name(id, &piece.tree, negative);
            self.define(&name, piece.tree)
        } else {
            piece
        };
        self.built[id.index()] = Some(Built { piece, negative });
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
        // The first term is positive.
        parts.sort_by_key(|part| part.1);
        let room = self.room(id);
        let mut sum: Option<Piece> = None;
        for (part, minus) in parts {
            sum = Some(match sum {
                None => part,
                Some(sum) => {
                    let (sum, part) = self.fitting(id, room, sum, part);
                    let operation = if minus {
                        Operation::Subtract
                    } else {
                        Operation::Add
                    };
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
                let (numerator, denominator) = self.fitting(id, room, numerator, denominator);
                numerator.binary(Operation::Divide, denominator)
            }
            (None, None) => self.constant(&Rational::ONE),
        };
        (piece, negative)
    }

    /// `a b c …`, with parts defined before where the line would be too long.
    fn chain(&mut self, id: Id, factors: Vec<Piece>) -> Option<Piece> {
        let room = self.room(id);
        let mut product: Option<Piece> = None;
        for factor in factors {
            product = Some(match product {
                None => factor,
                Some(product) => {
                    let (product, factor) = self.fitting(id, room, product, factor);
                    product.binary(Operation::Multiply, factor)
                }
            });
        }
        product
    }

    /// Two operands as they are, or the first one, or both, defined before where the line would be
    /// too long.
    fn fitting(&mut self, id: Id, room: usize, left: Piece, right: Piece) -> (Piece, Piece) {
        const OPERATOR_AND_PARENTHESES: usize = 7;
        let too_long = |left: &Piece, right: &Piece| {
            left.width + right.width + OPERATOR_AND_PARENTHESES > room
        };
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

    /// Columns for the tree of a node.
    fn room(&self, id: Id) -> usize {
        let made_up = || {
            let consumer = self.feeds[id.index()].and_then(|feed| self.given_name(feed));
            consumer.map_or(LONGEST, |name| LONGEST.max(name.len() + "_part_99".len()))
        };
        let name = self
            .given_name(id)
            .map_or_else(made_up, |name| name.len() + "minus__2".len());
        COLUMNS.saturating_sub(FRAME + name).max(INLINE)
    }

    fn sine_and_cosine(&mut self, id: Id, angle: Item) {
        let Some(partner) = self.partner[id.index()] else {
            return;
        };
        let (sin, cos) = match self.dag.op(id) {
            Op::Function(Elementary::Sin, _) => (id, partner),
            _ => (partner, id),
        };
        let angle = self.signed(angle);
        let text = describe(&angle.tree, &self.values, &self.arguments);
        let mut value = |of: Id, prefix: &str| {
            let wanted = match (self.given_name(of), &text) {
                (Some(name), _) => name,
                (None, Some(text)) => format!("{prefix}_{text}"),
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
        for id in self.dag.order() {
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
        let derived = self.dag.names[id.index()]
            .map(|name| self.program.graph.definition(name.definition).name.clone());
        derived.or_else(|| {
            self.labels[id.index()]
                .as_ref()
                .map(|label| label.0.clone())
        })
    }

    /// Name for a value that gets a binding.
    fn value_name(&mut self, id: Id, tree: &Tree, negative: bool) -> String {
        let derived = self.dag.names[id.index()].map(|name| name.negative);
        let of_result = self.labels[id.index()].as_ref().map(|label| label.1);
        match (self.given_name(id), derived.or(of_result)) {
            (Some(name), Some(sign)) if sign == negative => name,
            (Some(name), _) => format!("minus_{name}"),
            (None, _) => describe(tree, &self.values, &self.arguments)
                .unwrap_or_else(|| self.fallback(id, "part")),
        }
    }

    /// `consumer_part_2`
    fn fallback(&mut self, id: Id, word: &str) -> String {
        let feed = self.feeds[id.index()];
        let consumer = feed
            .and_then(|feed| self.given_name(feed))
            .unwrap_or_else(|| "result".to_owned());
        let count = &mut self.parts[feed.unwrap_or(id).index()];
        *count += 1;
        format!("{consumer}_{word}_{count}")
    }

    /// Defines a part of a tree that is too wide for a line.
    fn define_part(&mut self, id: Id, piece: Piece) -> Piece {
        let name = describe(&piece.tree, &self.values, &self.arguments)
            .unwrap_or_else(|| self.fallback(id, "part"));
        self.define(&name, piece.tree)
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
        (value, piece)
    }

    fn push(&mut self, step: Step) {
        if let Some(title) = self.title.take() {
            self.steps.push(Step::Paragraph { title });
        }
        self.steps.push(step);
    }
}

/// Numbers first, then parameters, values and variables, then sums in parentheses.
fn reading_order(tree: &Tree) -> u8 {
    match tree {
        Tree::Constant(_) => 0,
        Tree::Argument(Argument::Parameter(_)) => 1,
        Tree::Value(_) => 2,
        Tree::Argument(_) => 3,
        _ => 4,
    }
}

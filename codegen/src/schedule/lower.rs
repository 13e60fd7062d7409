//! Lowers the symbolic graph to the working graph.

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Item, Name, Op, System};
use crate::program::{Function, Own, Program};
use crate::symbolic::{Expr, Graph, Node, Rational, SymbolId};
use crate::tape::Argument;

/// The working graph of all results of a function.
///
/// # Panics
///
/// If an expression contains a symbol that is not an argument of the program, which would be a bug of the
/// derivation.
pub(super) fn lower(program: &Program, function: &Function) -> Dag {
    let roots: Vec<Expr> = function
        .results
        .iter()
        .flat_map(|array| array.entries.iter().copied())
        .collect();
    let kept = kept(&function.graph, function);
    lowered(program, function, &roots, kept)
}

/// The hint values of the program, whether or not the function computes them.
pub(super) fn hints(program: &Program, function: &Function) -> Dag {
    let roots: Vec<Expr> = program.hints.iter().map(|hint| hint.value).collect();
    lowered(program, function, &roots, FxHashSet::default())
}

fn lowered(program: &Program, function: &Function, roots: &[Expr], kept: FxHashSet<u32>) -> Dag {
    let graph = &*function.graph;
    let mut lowering = Lowering {
        graph,
        arguments: arguments(program, function),
        pi: program.arguments.pi,
        kept,
        dag: Dag::default(),
        known: FxHashMap::default(),
        systems: FxHashMap::default(),
    };
    for expr in graph.in_order(roots) {
        let item = lowering.node(expr);
        lowering.known.insert(expr, item);
    }
    let mut dag = lowering.dag;
    dag.results = roots.iter().map(|root| lowering.known[root]).collect();
    dag
}

/// Definitions of the displayed intermediate values.
fn kept(graph: &Graph, function: &Function) -> FxHashSet<u32> {
    let values = function.stages.iter().flat_map(|stage| &stage.values);
    values
        .filter_map(|&value| definition(graph, value))
        .collect()
}

/// The definition behind a named expression or its negative.
pub(super) fn definition(graph: &Graph, expr: Expr) -> Option<u32> {
    match graph.node(expr) {
        Node::Named(definition) => Some(*definition),
        Node::Sum(terms) if terms.len() == 1 => definition(graph, terms[0].expr),
        _ => None,
    }
}

/// The argument behind each symbol.
fn arguments(program: &Program, function: &Function) -> FxHashMap<SymbolId, Argument> {
    fn numbered(
        symbols: &[SymbolId],
        argument: fn(u32) -> Argument,
    ) -> impl Iterator<Item = (SymbolId, Argument)> {
        symbols
            .iter()
            .zip(0..)
            .map(move |(&symbol, i)| (symbol, argument(i)))
    }
    let of = &program.arguments;
    let own = match function.kind.takes() {
        Some(Own::Weights) => Argument::Weight,
        Some(Own::OutputWeights) => Argument::OutputWeight,
        Some(Own::Accelerations) | None => Argument::Acceleration,
    };
    std::iter::once((of.time, Argument::Time))
        .chain(numbered(&of.states, Argument::State))
        .chain(numbered(&of.inputs, Argument::Input))
        .chain(numbered(&of.parameters, Argument::Parameter))
        .chain(numbered(&function.own, own))
        .collect()
}

struct Lowering<'a> {
    graph: &'a Graph,
    arguments: FxHashMap<SymbolId, Argument>,
    pi: Option<SymbolId>,
    /// Definitions of the displayed intermediate values.
    kept: FxHashSet<u32>,
    dag: Dag,
    known: FxHashMap<Expr, Item>,
    /// System index in the working graph, by symbolic system.
    systems: FxHashMap<u32, u32>,
}

impl Lowering<'_> {
    /// Lowers one node; its operands are lowered already.
    fn node(&mut self, expr: Expr) -> Item {
        match self.graph.node(expr) {
            Node::Number(value) => self.dag.number(value),
            Node::Symbol(symbol) => {
                let Some(&argument) = self.arguments.get(symbol) else {
                    if self.pi == Some(*symbol) {
                        return self.dag.number(&super::pi::pi());
                    }
                    panic!(
                        "`{}` is not an argument of the program",
                        self.graph.symbol_name(*symbol)
                    );
                };
                Item::plain(self.dag.intern(Op::Argument(argument)))
            }
            Node::Named(definition) => self.named(*definition),
            Node::Sum(terms) => {
                let terms = terms
                    .iter()
                    .map(|term| self.term(&term.coefficient, term.expr))
                    .collect();
                self.dag.sum(terms)
            }
            Node::Product(factors) => {
                let mut negative = false;
                let mut product = Vec::new();
                for factor in factors {
                    let base = self.known[&factor.base];
                    negative ^= base.flip && factor.exponent % 2 != 0;
                    self.power(base, factor.exponent, &mut product);
                }
                self.dag.product(product).flipped_if(negative)
            }
            Node::Function(function, argument) => {
                let argument = self.known[argument];
                self.dag.function(*function, argument)
            }
            Node::Atan2(y, x) => {
                let items = [self.known[y], self.known[x]];
                Item::plain(self.dag.intern(Op::Atan2(items)))
            }
            Node::Power(base, exponent) => {
                let items = [self.known[base], self.known[exponent]];
                Item::plain(self.dag.intern(Op::Power(items)))
            }
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let items = [compared[0], compared[1], branches[0], branches[1]];
                let items = items.map(|part| self.known[&part]);
                Item::plain(self.dag.intern(Op::Choice(*relation, items)))
            }
            Node::Solution { system, row } => {
                let system = self.system(*system);
                Item::plain(self.dag.intern(Op::Solution { system, row: *row }))
            }
        }
    }

    /// A named value lowers to the value itself, which takes the name. A displayed value becomes
    /// opaque.
    fn named(&mut self, definition: u32) -> Item {
        let value = self.known[&self.graph.definition(definition).value];
        let name = &mut self.dag.names[value.id.index()];
        if name.is_none() {
            *name = Some(Name {
                definition,
                negative: value.flip,
                automatic: self.graph.definition(definition).automatic,
            });
        }
        if self.kept.contains(&definition) {
            self.dag.kept(value)
        } else {
            value
        }
    }

    /// `coefficient · expr`, with the number as a factor.
    fn term(&mut self, coefficient: &Rational, expr: Expr) -> Item {
        let value = self.known[&expr];
        let negative = value.flip != coefficient.is_negative();
        let number = self.dag.number(&coefficient.abs());
        let mut factors = vec![number];
        match self.dag.op(value.id) {
            Op::Product(inner) if self.dag.names[value.id.index()].is_none() => {
                factors.extend(inner);
            }
            _ => factors.push(Item::plain(value.id)),
        }
        self.dag.product(factors).flipped_if(negative)
    }

    /// Appends the factors of `base^exponent`. Small powers are written as repeated factors, so
    /// that squares are shared like other products; large ones use repeated squaring.
    fn power(&mut self, base: Item, exponent: i32, factors: &mut Vec<Item>) {
        const WRITTEN_OUT: u32 = 4;
        let flip = exponent < 0;
        let mut left = exponent.unsigned_abs();
        if left <= WRITTEN_OUT {
            factors.extend((0..left).map(|_| Item { id: base.id, flip }));
            return;
        }
        let mut square = base.id;
        while left > 0 {
            if left % 2 == 1 {
                factors.push(Item { id: square, flip });
            }
            left /= 2;
            if left > 0 {
                square = self.dag.product(vec![Item::plain(square); 2]).id;
            }
        }
    }

    fn system(&mut self, index: u32) -> u32 {
        if let Some(&known) = self.systems.get(&index) {
            return known;
        }
        let system = self.graph.system(index);
        let items = |parts: &[Expr]| parts.iter().map(|part| self.known[part]).collect();
        let lowered = System {
            matrix: items(&system.matrix),
            right: items(&system.right),
        };
        let number = u32::try_from(self.dag.systems.len()).unwrap_or(u32::MAX);
        self.dag.systems.push(lowered);
        self.systems.insert(index, number);
        number
    }
}

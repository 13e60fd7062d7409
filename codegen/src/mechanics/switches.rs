//! Discontinuities and kinks of the equations, such as those of `if(t < t_brake, …)` or `abs(v)`. An integrator
//! has to end a step at each. Those that depend on time alone are located reliably, by bounds on functions of
//! time.

use rustc_hash::FxHashMap;

use super::Derivation;
use super::symbols::{Symbols, ids};
use crate::program::{Array, FunctionKind, Layout};
use crate::symbolic::{Expr, Function, Graph, Node, SymbolId};

/// Switching functions of expressions, and their behaviour in time.
#[derive(Debug, Clone, Default)]
pub struct Switches {
    /// Relations and signs of time and parameters: 1 if a relation holds and 0 otherwise, or a sign. Each is
    /// piecewise constant.
    pub answers: Vec<Expr>,
    /// The corresponding switching functions: the difference of the sides of a relation, or the argument of a
    /// sign or an absolute value.
    pub functions: Vec<Expr>,
    /// Functions of time and parameters that vary continuously: sines, exponentials, powers.
    pub shapes: Vec<Expr>,
    /// Switching functions that also depend on states or inputs.
    pub crossings: Vec<Expr>,
    /// Functions of states that vary rapidly within a small part of their arguments' range: exponentials,
    /// hyperbolic tangents, and roots of a square and a constant, as in smoothed signs.
    pub pulses: Vec<Expr>,
}

/// Dependencies of an expression.
#[derive(Debug, Clone, Copy, Default)]
struct Nature {
    by_time: bool,
    by_others: bool,
    jumps: bool,
}

impl Nature {
    fn with(self, part: Self) -> Self {
        Self {
            by_time: self.by_time || part.by_time,
            by_others: self.by_others || part.by_others,
            jumps: self.jumps || part.jumps,
        }
    }
}

/// The switching functions of `roots`.
pub fn switches(graph: &mut Graph, symbols: &Symbols, roots: &[Expr]) -> Switches {
    let time = ids(graph, &[symbols.time]);
    let constants = ids(
        graph,
        &[symbols.parameters.as_slice(), &[symbols.pi]].concat(),
    );
    let of_symbol = |symbol: SymbolId| Nature {
        by_time: time.contains(&symbol),
        by_others: !time.contains(&symbol) && !constants.contains(&symbol),
        jumps: false,
    };
    let mut natures: FxHashMap<Expr, Nature> = FxHashMap::default();
    let mut all = Switches::default();
    for expr in graph.in_order(roots) {
        let mut nature = Nature::default();
        let of_parts = |part: Expr| natures.get(&part).copied().unwrap_or_default();
        graph.for_each_part(expr, |part| nature = nature.with(of_parts(part)));
        match *graph.node(expr) {
            Node::Symbol(symbol) => nature = of_symbol(symbol),
            Node::Choice {
                relation,
                compared: [left, right],
                branches,
            } => {
                let decides = of_parts(left).with(of_parts(right));
                let is_extremum = [[left, right], [right, left]].contains(&branches);
                nature.jumps |= !is_extremum;
                let function = graph.sub(left, right);
                let answer = graph.choice(relation, [left, right], [Graph::ONE, Graph::ZERO]);
                all.add(graph, decides, function, answer);
            }
            Node::Function(kind @ (Function::Abs | Function::Sign), argument) => {
                nature.jumps |= kind == Function::Sign;
                let answer = graph.function(Function::Sign, argument);
                all.add(graph, of_parts(argument), argument, answer);
            }
            Node::Atan2(..) => nature.jumps = true,
            _ => {}
        }
        natures.insert(expr, nature);
        if nature.by_time && !nature.by_others && !nature.jumps && is_shape(graph, expr) {
            all.shapes.push(expr);
        }
        let is_constant = |part: Expr| {
            let nature = natures.get(&part).copied().unwrap_or_default();
            !nature.by_others && !nature.by_time
        };
        if nature.by_others && !nature.jumps && is_pulse(graph, expr, is_constant) {
            all.pulses.push(expr);
        }
    }
    all
}

impl Derivation {
    /// The results of a function that reports the switching of the rates.
    pub(super) fn switch_arrays(&mut self, kind: FunctionKind) -> Vec<Array> {
        let rates = self.rates();
        let all = switches(&mut self.algebra.graph, &self.symbols, &rates);
        let list = |name: &'static str, heading: &'static str, entries: Vec<Expr>| {
            Array::new(name, heading, Layout::List(entries.len()), entries)
        };
        match kind {
            FunctionKind::TimeFunctions => vec![
                list("functions", "Their signs switch.", all.functions),
                list("shapes", "They rise and fall.", all.shapes),
            ],
            FunctionKind::Crossings => vec![
                list("crossings", "Their zeros switch.", all.crossings),
                list("pulses", "They rise and fall.", all.pulses),
            ],
            _ => vec![list("switches", "Switches.", all.answers)],
        }
    }
}

impl Switches {
    /// Whether there are neither switching functions nor functions that vary with time.
    pub fn is_empty(&self) -> bool {
        [&self.answers, &self.shapes, &self.crossings, &self.pulses]
            .iter()
            .all(|list| list.is_empty())
    }

    fn add(&mut self, graph: &mut Graph, decides: Nature, function: Expr, answer: Expr) {
        if graph.as_number(function).is_some() || graph.as_number(answer).is_some() {
            return;
        }
        if decides.by_others {
            let opposite = graph.neg(function);
            if !self.crossings.contains(&function) && !self.crossings.contains(&opposite) {
                self.crossings.push(function);
            }
        } else if decides.by_time && !self.answers.contains(&answer) {
            self.answers.push(answer);
            self.functions.push(function);
        }
    }
}

/// Whether an expression may vary rapidly within a small part of its arguments' range.
fn is_pulse(graph: &Graph, expr: Expr, is_constant: impl Fn(Expr) -> bool) -> bool {
    match *graph.node(expr) {
        Node::Function(Function::Exp | Function::Tanh, _) => true,
        Node::Function(Function::Sqrt, argument) => match graph.node(argument) {
            Node::Sum(terms) => terms.iter().any(|term| is_constant(term.expr)),
            _ => false,
        },
        _ => false,
    }
}

/// Whether an expression may vary faster than its operands.
fn is_shape(graph: &Graph, expr: Expr) -> bool {
    match graph.node(expr) {
        Node::Function(function, _) => !matches!(function, Function::Abs | Function::Sign),
        Node::Power(..) => true,
        Node::Product(factors) => factors.iter().any(|factor| factor.exponent != 1),
        _ => false,
    }
}

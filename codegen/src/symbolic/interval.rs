//! Interval bounds of expressions over declared ranges of symbols, in the arithmetic of
//! [`appell_runtime::interval`].

use super::{Expr, Function, Graph, Node, Relation, SymbolId, applied};
pub use appell_runtime::interval::Interval;
use appell_runtime::interval::Range;

/// Interval bounds on one graph, memoised by expression. The graph may grow between queries.
#[derive(Debug)]
pub struct Intervals {
    symbols: Vec<Interval>,
    known: Vec<Option<Range>>,
    stack: Vec<Expr>,
}

impl Intervals {
    /// Bounds that follow from ranges of symbols, each `(symbol, lowest, highest)`. A symbol without a range
    /// is unbounded.
    pub fn new(g: &Graph, ranges: Vec<(SymbolId, f64, f64)>) -> Self {
        let mut symbols = vec![Interval::ALL; g.symbol_count()];
        for (symbol, lo, hi) in ranges {
            // An invalid range is ignored.
            if let Some(place) = symbols.get_mut(symbol.0 as usize)
                && lo <= hi
            {
                *place = Interval { lo, hi };
            }
        }
        Self {
            symbols,
            known: Vec::new(),
            stack: Vec::new(),
        }
    }

    /// An interval that contains every value of `e`.
    pub fn of(&mut self, g: &Graph, e: Expr) -> Interval {
        self.range(g, e).interval
    }

    /// Whether `e` is provably different from zero everywhere it is defined.
    pub fn cannot_vanish(&mut self, g: &Graph, e: Expr) -> bool {
        self.range(g, e).nonzero
    }

    fn range(&mut self, g: &Graph, root: Expr) -> Range {
        if self.known.len() < g.len() {
            self.known.resize(g.len(), None);
        }
        let mut stack = std::mem::take(&mut self.stack);
        stack.push(root);
        while let Some(&expr) = stack.last() {
            let index = expr.0 as usize;
            if self.known[index].is_none() {
                let height = stack.len();
                // The unknowns of a system are unbounded; its entries do not matter.
                if !matches!(g.node(expr), Node::Solution { .. }) {
                    g.for_each_part(expr, |part| {
                        if self.known[part.0 as usize].is_none() {
                            stack.push(part);
                        }
                    });
                }
                if stack.len() > height {
                    continue;
                }
                self.known[index] = Some(self.step(g, expr));
            }
            stack.pop();
        }
        self.stack = stack;
        self.at(root)
    }

    fn at(&self, expr: Expr) -> Range {
        self.known[expr.0 as usize].unwrap_or(Range::ANY)
    }

    /// The bounds of a node whose operands are bounded.
    fn step(&self, g: &Graph, expr: Expr) -> Range {
        match g.node(expr) {
            Node::Number(n) => Range::number(n.to_f64(), n.is_zero()),
            Node::Symbol(symbol) => Range::of(
                self.symbols
                    .get(symbol.0 as usize)
                    .copied()
                    .unwrap_or(Interval::ALL),
            ),
            Node::Named(id) => self.at(g.definition(*id).value),
            Node::Sum(terms) => {
                let mut sum = Range::number(0.0, true);
                for term in terms {
                    let c = &term.coefficient;
                    let scaled = Range::number(c.to_f64(), false).times(self.at(term.expr));
                    sum = sum.plus(scaled);
                }
                sum
            }
            Node::Product(factors) => factors.iter().fold(Range::number(1.0, false), |p, f| {
                p.times(self.at(f.base).power(f.exponent))
            }),
            Node::Function(function, x) => applied!(function, self.at(*x)),
            Node::Atan2(..) => Range::ANGLE,
            Node::Power(base, exponent) => self.at(*base).real_power(self.at(*exponent)),
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = compared.map(|e| self.at(e));
                let [then, otherwise] = branches.map(|e| self.at(e));
                let answer = match relation {
                    Relation::Less => left.is_less(right),
                    Relation::LessOrEqual => right.is_less(left).map(|greater| !greater),
                };
                match answer {
                    Some(true) => then,
                    Some(false) => otherwise,
                    None => then.or(otherwise),
                }
            }
            Node::Solution { .. } => Range::ANY,
        }
    }
}

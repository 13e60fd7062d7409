//! Replacing symbols by expressions.

use rustc_hash::FxHashMap;

use super::Graph;
use super::node::{Expr, Node, SymbolId};
use super::support::Support;

/// A simultaneous, memoised replacement of symbols. A name whose definition changes is removed, since it
/// would denote another quantity.
#[derive(Debug, Default)]
pub struct Substitution {
    known: FxHashMap<Expr, Expr>,
    keeps_names: bool,
    /// Supports of the replaced expressions; expressions that cannot contain any of these are unchanged.
    targets: Vec<Support>,
}

impl Substitution {
    /// Replaces each symbol by its expression.
    pub fn new(graph: &mut Graph, replacements: &[(SymbolId, Expr)]) -> Self {
        let parts: Vec<(Expr, Expr)> = replacements
            .iter()
            .map(|&(symbol, value)| (graph.intern(Node::Symbol(symbol)), value))
            .collect();
        Self::of_parts(graph, &parts)
    }

    /// Replaces symbols by the number 0.
    pub fn by_zero(graph: &Graph, symbols: &[Expr]) -> Self {
        let zeros: Vec<(Expr, Expr)> = symbols.iter().map(|&s| (s, Graph::ZERO)).collect();
        Self::of_parts(graph, &zeros)
    }

    /// Replaces whole subexpressions wherever they occur.
    pub fn of_parts(graph: &Graph, replacements: &[(Expr, Expr)]) -> Self {
        let targets = replacements
            .iter()
            .map(|&(part, _)| graph.support(part))
            .collect();
        Self {
            known: replacements.iter().copied().collect(),
            keeps_names: false,
            targets,
        }
    }

    /// The same if the symbols were stand-ins for the replacements: a named quantity keeps its name.
    #[must_use]
    pub fn keeping_names(mut self) -> Self {
        self.keeps_names = true;
        self
    }

    /// Adds a replacement. Expressions substituted before must not contain the replaced one.
    pub fn replace(&mut self, graph: &Graph, part: Expr, value: Expr) {
        let target = graph.support(part);
        if !self.targets.contains(&target) {
            self.targets.push(target);
        }
        self.known.insert(part, value);
    }

    /// `expr` with the symbols replaced, in canonical form. `None` if this divides by the number zero.
    pub fn apply(&mut self, graph: &mut Graph, expr: Expr) -> Option<Expr> {
        let unknown = |e: Expr| {
            self.targets.iter().any(|&target| graph.may_hold(e, target))
                && !self.known.contains_key(&e)
        };
        for part in graph.in_order_where(&[expr], unknown) {
            let replaced = self.step(graph, part)?;
            self.known.insert(part, replaced);
        }
        Some(self.get(expr))
    }

    /// [`Substitution::apply`] to each.
    pub fn apply_all(&mut self, graph: &mut Graph, exprs: &[Expr]) -> Option<Vec<Expr>> {
        exprs.iter().map(|&expr| self.apply(graph, expr)).collect()
    }

    fn get(&self, expr: Expr) -> Expr {
        self.known.get(&expr).copied().unwrap_or(expr)
    }

    fn step(&self, graph: &mut Graph, expr: Expr) -> Option<Expr> {
        let new = |e: &Expr| self.get(*e);
        Some(match graph.node(expr).clone() {
            Node::Number(_) | Node::Symbol(_) => expr,
            Node::Named(id) => {
                let definition = graph.definition(id);
                let (old, value) = (definition.value, new(&definition.value));
                if value == old {
                    expr
                } else if self.keeps_names {
                    graph.name_like(id, value)
                } else {
                    value
                }
            }
            Node::Sum(terms) => {
                let parts: Vec<_> = terms
                    .iter()
                    .map(|t| (t.coefficient.clone(), new(&t.expr)))
                    .collect();
                graph.linear_combination(&parts)
            }
            Node::Product(factors) => {
                if factors
                    .iter()
                    .any(|f| f.exponent < 0 && new(&f.base) == Graph::ZERO)
                {
                    return None;
                }
                let powers: Vec<_> = factors
                    .iter()
                    .map(|f| graph.pow(new(&f.base), f.exponent))
                    .collect();
                graph.product(&powers)
            }
            Node::Function(function, argument) => graph.function(function, new(&argument)),
            Node::Atan2(y, x) => graph.atan2(new(&y), new(&x)),
            Node::Power(base, exponent) => {
                let (base, exponent) = (new(&base), new(&exponent));
                if base == Graph::ZERO
                    && graph.leads_with_minus(exponent)
                    && graph.as_number(exponent).is_some()
                {
                    return None;
                }
                graph.power(base, exponent)
            }
            Node::Choice {
                relation,
                compared,
                branches,
            } => graph.choice(
                relation,
                compared.map(|e| new(&e)),
                branches.map(|e| new(&e)),
            ),
            Node::Solution { system, row } => {
                let system = graph.system(system).clone();
                let matrix = system.matrix.iter().map(new).collect();
                let right = system.right.iter().map(new).collect();
                graph.solve_numerically(matrix, right)[row as usize]
            }
        })
    }
}

//! The order in which people write factors and terms.

use rustc_hash::FxHashMap;

use super::super::{Expr, Factor, Graph, Node, Term};
use super::Piece;

/// Sorts by kind, then by the symbol that comes first, then higher powers first.
type FactorKey = (u8, u32, i32, Expr);

/// Factors of a term; the number 1 has none.
pub(super) fn factors(graph: &Graph, expr: Expr, pieces: &FxHashMap<Expr, Piece>) -> Vec<Factor> {
    let mut factors = match graph.node(expr) {
        Node::Product(factors) => factors.to_vec(),
        _ if expr == Graph::ONE => Vec::new(),
        _ => vec![Factor {
            base: expr,
            exponent: 1,
        }],
    };
    sort_factors(graph, &mut factors, pieces);
    factors
}

/// Numbers, symbols, names, functions, sums.
pub(super) fn sort_factors(graph: &Graph, factors: &mut [Factor], pieces: &FxHashMap<Expr, Piece>) {
    factors.sort_by_key(|f| factor_key(graph, f, pieces));
}

/// Positive terms first; among them those whose factors come first.
pub(super) fn term_key(
    graph: &Graph,
    term: &Term,
    factors: &[Factor],
    pieces: &FxHashMap<Expr, Piece>,
) -> (bool, Vec<FactorKey>) {
    let keys = factors
        .iter()
        .map(|f| factor_key(graph, f, pieces))
        .collect();
    (term.coefficient.is_negative(), keys)
}

fn factor_key(graph: &Graph, factor: &Factor, pieces: &FxHashMap<Expr, Piece>) -> FactorKey {
    let kind = match graph.node(factor.base) {
        Node::Number(_) => 0,
        Node::Symbol(_) => 1,
        Node::Named(_) => 2,
        Node::Solution { .. } | Node::Power(..) => 3,
        Node::Function(..) | Node::Atan2(..) => 4,
        Node::Sum(_) | Node::Product(_) | Node::Choice { .. } => 5,
    };
    let first = pieces.get(&factor.base).map_or(u32::MAX, |p| p.first);
    (kind, first, factor.exponent.saturating_neg(), factor.base)
}

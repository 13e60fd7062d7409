//! Expression to terms: a sum collected by the velocities, or the sines and cosines, of its terms.

use appell_codegen::symbolic::{Expr, Function, Graph, Node, Rational};

/// The power of each key in a product; keys are given by their index.
pub(super) type Monomial = Vec<(usize, i32)>;

/// A sum as `Σ coefficient · monomial`, ordered by monomial: high degrees in early keys first, the terms
/// without any key last. Keys inside functions and denominators stay in the coefficients.
pub(super) fn collect(graph: &mut Graph, expr: Expr, keys: &[Expr]) -> Vec<(Monomial, Expr)> {
    let terms: Vec<(Expr, Rational)> = match graph.node(expr) {
        Node::Sum(terms) => terms
            .iter()
            .map(|t| (t.expr, t.coefficient.clone()))
            .collect(),
        _ => vec![(expr, Rational::ONE)],
    };
    let mut groups: Vec<(Monomial, Vec<(Rational, Expr)>)> = Vec::new();
    for (term, coefficient) in terms {
        let mut monomial = Monomial::new();
        let mut rest = term;
        let factors: Vec<(Expr, i32)> = match graph.node(term) {
            Node::Product(factors) => factors.iter().map(|f| (f.base, f.exponent)).collect(),
            _ => vec![(term, 1)],
        };
        for (base, exponent) in factors {
            if let Some(key) = keys
                .iter()
                .position(|&k| k == base)
                .filter(|_| exponent > 0)
            {
                monomial.push((key, exponent));
                let power = graph.pow(base, -exponent);
                rest = graph.mul(rest, power);
            }
        }
        monomial.sort_unstable();
        match groups.iter_mut().find(|(m, _)| *m == monomial) {
            Some((_, parts)) => parts.push((coefficient, rest)),
            None => groups.push((monomial, vec![(coefficient, rest)])),
        }
    }
    // Early keys and high powers first; the empty monomial last.
    groups.sort_by_key(|(monomial, _)| {
        let key: Vec<(usize, i32)> = monomial
            .iter()
            .map(|&(key, exponent)| (key, -exponent))
            .collect();
        (monomial.is_empty(), key)
    });
    groups
        .into_iter()
        .map(|(monomial, parts)| (monomial, graph.linear_combination(&parts)))
        .collect()
}

/// A sum as `Σ coefficient · turns`, where `turns` is a product of sines and cosines, also below the
/// fraction line.
pub(super) fn collect_turns(graph: &mut Graph, expr: Expr) -> Vec<(Expr, Expr)> {
    let Node::Sum(terms) = graph.node(expr) else {
        return vec![(Graph::ONE, expr)];
    };
    let terms: Vec<(Expr, Rational)> = terms
        .iter()
        .map(|t| (t.expr, t.coefficient.clone()))
        .collect();
    let mut groups: Vec<(Expr, Vec<(Rational, Expr)>)> = Vec::new();
    for (term, coefficient) in terms {
        let factors: Vec<(Expr, i32)> = match graph.node(term) {
            Node::Product(factors) => factors.iter().map(|f| (f.base, f.exponent)).collect(),
            _ => vec![(term, 1)],
        };
        let mut turns = Graph::ONE;
        for (base, exponent) in factors {
            if matches!(
                graph.node(base),
                Node::Function(Function::Sin | Function::Cos, _)
            ) {
                let power = graph.pow(base, exponent);
                turns = graph.mul(turns, power);
            }
        }
        let rest = graph.div(term, turns);
        match groups.iter_mut().find(|(t, _)| *t == turns) {
            Some((_, parts)) => parts.push((coefficient, rest)),
            None => groups.push((turns, vec![(coefficient, rest)])),
        }
    }
    groups
        .into_iter()
        .map(|(turns, parts)| (turns, graph.linear_combination(&parts)))
        .collect()
}

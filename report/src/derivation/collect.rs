//! Expression to terms: a sum collected by the velocities, or the sines and cosines, of its terms.

use appell_codegen::symbolic::{Expr, Function, Graph, Node, Rational};

/// The power of each key in a product; keys are given by their index.
pub(super) type Monomial = Vec<(usize, i32)>;
/// A term of a sum, with its coefficient.
pub(super) type Term = (Rational, Expr);

/// The terms of a sum, or the expression itself.
pub(super) fn terms(graph: &Graph, expr: Expr) -> Vec<Term> {
    match graph.node(expr) {
        Node::Sum(terms) => (terms.iter())
            .map(|term| (term.coefficient.clone(), term.expr))
            .collect(),
        _ => vec![(Rational::ONE, expr)],
    }
}

/// The factors of a product with their exponents, or the expression itself.
fn factors(graph: &Graph, expr: Expr) -> Vec<(Expr, i32)> {
    match graph.node(expr) {
        Node::Product(factors) => factors.iter().map(|f| (f.base, f.exponent)).collect(),
        _ => vec![(expr, 1)],
    }
}

/// A sum as `Σ coefficient · monomial`, ordered by monomial: high degrees in early keys first, the terms
/// without any key last. Keys inside functions and denominators stay in the coefficients.
pub(super) fn collect(graph: &mut Graph, expr: Expr, keys: &[Expr]) -> Vec<(Monomial, Expr)> {
    let mut groups = grouped(graph, expr, |graph, term| {
        let mut monomial = Monomial::new();
        let mut rest = term;
        for (base, exponent) in factors(graph, term) {
            let key = keys.iter().position(|&key| key == base);
            if let Some(key) = key.filter(|_| exponent > 0) {
                monomial.push((key, exponent));
                let power = graph.pow(base, -exponent);
                rest = graph.mul(rest, power);
            }
        }
        monomial.sort_unstable();
        (monomial, rest)
    });
    // Early keys and high powers first; the empty monomial last.
    groups.sort_by_key(|(monomial, _)| {
        let powers = monomial.iter().map(|&(key, exponent)| (key, -exponent));
        (monomial.is_empty(), powers.collect::<Vec<_>>())
    });
    summed(graph, groups)
}

/// A sum as `Σ coefficient · turns`, where `turns` is a product of sines and cosines, also below the
/// fraction line.
pub(super) fn collect_turns(graph: &mut Graph, expr: Expr) -> Vec<(Expr, Expr)> {
    let groups = grouped(graph, expr, |graph, term| {
        let mut turns = Graph::ONE;
        for (base, exponent) in factors(graph, term) {
            let is_turn = matches!(
                graph.node(base),
                Node::Function(Function::Sin | Function::Cos, _)
            );
            if is_turn {
                let power = graph.pow(base, exponent);
                turns = graph.mul(turns, power);
            }
        }
        (turns, graph.div(term, turns))
    });
    summed(graph, groups)
}

/// The terms of a sum, divided into a key and a rest each, by their keys in the order of appearance.
fn grouped<K: PartialEq>(
    graph: &mut Graph,
    expr: Expr,
    divided: impl Fn(&mut Graph, Expr) -> (K, Expr),
) -> Vec<(K, Vec<Term>)> {
    let mut groups: Vec<(K, Vec<Term>)> = Vec::new();
    for (coefficient, term) in terms(graph, expr) {
        let (key, rest) = divided(graph, term);
        match groups.iter_mut().find(|(other, _)| *other == key) {
            Some((_, parts)) => parts.push((coefficient, rest)),
            None => groups.push((key, vec![(coefficient, rest)])),
        }
    }
    groups
}

fn summed<K>(graph: &mut Graph, groups: Vec<(K, Vec<Term>)>) -> Vec<(K, Expr)> {
    let groups = groups.into_iter();
    groups
        .map(|(key, parts)| (key, graph.linear_combination(&parts)))
        .collect()
}

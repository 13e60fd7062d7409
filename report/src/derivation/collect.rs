//! Terms of sums, collected by the velocities, or the sines and cosines, in them; angle sum identities.

use appell_codegen::symbolic::{Expr, Function, Graph, Node, Rational};
use rustc_hash::FxHashMap;

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

/// A product of two sines or cosines of different angles, and its cofactor.
struct Pair {
    /// Functions and angles, in the order of the angles.
    turns: [(Function, Expr); 2],
    rest: Expr,
}

/// An expanded sum with pairs of products combined into functions of one angle.
pub(super) fn with_compound_angles(graph: &mut Graph, expr: Expr) -> Expr {
    let terms = terms(graph, expr);
    if terms.len() == 1 {
        return expr;
    }
    let mut used = vec![false; terms.len()];
    let mut sum: Vec<Term> = Vec::new();
    // Terms without a partner so far, by cofactor and angles.
    let mut waiting: FxHashMap<(Expr, Expr, Expr), Vec<usize>> = FxHashMap::default();
    let pairs = terms.iter().map(|&(_, term)| pairs_of(graph, term));
    let pairs: Vec<Vec<Pair>> = pairs.collect();
    for (k, candidates) in pairs.iter().enumerate() {
        for pair in candidates {
            let key = (pair.rest, pair.turns[0].1, pair.turns[1].1);
            let partners = waiting.get(&key).cloned().unwrap_or_default();
            for partner in partners {
                if used[k] || used[partner] {
                    continue;
                }
                let other = pairs[partner]
                    .iter()
                    .find(|p| (p.rest, p.turns[0].1, p.turns[1].1) == key);
                let together = other.and_then(|other| {
                    let coefficients = [&terms[partner].0, &terms[k].0];
                    compound(graph, coefficients, [&other.turns, &pair.turns])
                });
                if let Some((coefficient, function)) = together {
                    used[k] = true;
                    used[partner] = true;
                    let term = graph.mul(pair.rest, function);
                    sum.push((coefficient, term));
                }
            }
            waiting.entry(key).or_default().push(k);
        }
    }
    if sum.is_empty() {
        return expr;
    }
    let others = terms.into_iter().zip(used).filter(|(_, used)| !used);
    sum.extend(others.map(|(term, _)| term));
    graph.linear_combination(&sum)
}

/// Every choice of two simple sine or cosine factors of different angles in a product.
fn pairs_of(graph: &mut Graph, term: Expr) -> Vec<Pair> {
    let Node::Product(factors) = graph.node(term) else {
        return Vec::new();
    };
    let turns: Vec<(Expr, Function, Expr)> = factors
        .iter()
        .filter(|f| f.exponent == 1)
        .filter_map(|f| match graph.node(f.base) {
            Node::Function(kind @ (Function::Sin | Function::Cos), angle) => {
                Some((f.base, *kind, *angle))
            }
            _ => None,
        })
        .collect();
    let mut pairs = Vec::new();
    for (i, &a) in turns.iter().enumerate() {
        for &b in &turns[i + 1..] {
            if a.2 == b.2 {
                continue;
            }
            let (a, b) = if a.2 < b.2 { (a, b) } else { (b, a) };
            let both = graph.mul(a.0, b.0);
            pairs.push(Pair {
                turns: [(a.1, a.2), (b.1, b.2)],
                rest: graph.div(term, both),
            });
        }
    }
    pairs
}

/// `p f(a) g(b) + q h(a) k(b)` as one function of the sum or difference of the angles.
fn compound(
    graph: &mut Graph,
    [p, q]: [&Rational; 2],
    [first, second]: [&[(Function, Expr); 2]; 2],
) -> Option<(Rational, Expr)> {
    use Function::{Cos, Sin};
    let (a, b) = (first[0].1, first[1].1);
    let equal = p == q;
    if !equal && *p != -q {
        return None;
    }
    let kinds = ([first[0].0, first[1].0], [second[0].0, second[1].0]);
    let (sine, coefficient) = match kinds {
        // p (sin a cos b ± cos a sin b)
        ([Sin, Cos], [Cos, Sin]) => (true, p.clone()),
        ([Cos, Sin], [Sin, Cos]) => (true, q.clone()),
        // p (cos a cos b ∓ sin a sin b)
        ([Cos, Cos], [Sin, Sin]) => (false, p.clone()),
        ([Sin, Sin], [Cos, Cos]) => (false, q.clone()),
        _ => return None,
    };
    let plus = sine == equal;
    let angle = if plus {
        graph.add(a, b)
    } else {
        graph.sub(a, b)
    };
    let function = if sine {
        graph.sin(angle)
    } else {
        graph.cos(angle)
    };
    Some((coefficient, function))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_turns_become_functions_of_one_angle() {
        let mut g = Graph::new();
        let (a, b, m) = (g.symbol("a"), g.symbol("b"), g.symbol("m"));
        for (angle_sign, sine) in [(1, true), (-1, true), (1, false), (-1, false)] {
            let (sa, ca, sb, cb) = (g.sin(a), g.cos(a), g.sin(b), g.cos(b));
            let (first, second, sign) = if sine {
                ([sa, cb], [ca, sb], angle_sign)
            } else {
                ([ca, cb], [sa, sb], -angle_sign)
            };
            let first = g.product(&[m, first[0], first[1]]);
            let second = g.product(&[m, second[0], second[1]]);
            let sum = g.linear_combination(&[(3.into(), first), ((3 * sign).into(), second)]);
            let angle = g.linear_combination(&[(1.into(), a), (angle_sign.into(), b)]);
            let function = if sine { g.sin(angle) } else { g.cos(angle) };
            let expected = g.product(&[m, function]);
            let expected = g.scale(&3.into(), expected);
            assert_eq!(
                with_compound_angles(&mut g, sum),
                expected,
                "{angle_sign} {sine}"
            );
        }
    }
}

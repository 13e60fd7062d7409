//! Angle sum identities: `sin a cos b + cos a sin b = sin(a + b)` and similar ones.

use rustc_hash::FxHashMap;

use super::collect::{Term, terms};
use appell_codegen::symbolic::{Expr, Function, Graph, Node, Rational};

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

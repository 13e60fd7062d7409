//! Right angles in sums of angles: they swap sine and cosine, so a fixed turn by one costs no operations.

use super::algebra::Algebra;
use crate::symbolic::{Expr, Graph, Node, Rational};

/// Sine and cosine of an angle, with multiples of right angles removed.
pub(super) fn sin_cos(algebra: &mut Algebra, angle: Expr) -> [Expr; 2] {
    let (count, rest) = taken_out(&mut algebra.graph, algebra.pi, angle);
    let graph = &mut algebra.graph;
    let (sin, cos) = (graph.sin(rest), graph.cos(rest));
    match count.rem_euclid(4) {
        1 => [cos, graph.neg(sin)],
        2 => [graph.neg(sin), graph.neg(cos)],
        3 => [graph.neg(cos), sin],
        _ => [sin, cos],
    }
}

/// `angle = count · π/2 + rest`; the count is zero unless the angle contains a half-integer multiple of π.
fn taken_out(graph: &mut Graph, pi: Expr, angle: Expr) -> (i64, Expr) {
    let terms = match graph.node(angle) {
        Node::Sum(terms) => terms
            .iter()
            .find(|term| term.expr == pi)
            .map(|term| term.coefficient.clone()),
        _ if angle == pi => Some(Rational::ONE),
        _ => None,
    };
    let Some(coefficient) = terms else {
        return (0, angle);
    };
    let Some(count) = (&coefficient * &Rational::from(2)).as_integer() else {
        return (0, angle);
    };
    let taken = graph.scale(&coefficient, pi);
    (count, graph.sub(angle, taken))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_right_angles_are_taken_out() {
        let mut graph = Graph::new();
        let (pi, q) = (graph.symbol("pi"), graph.symbol("q"));
        let mut plus = |numerator: i64, denominator: i64| {
            let part = graph.scale(&Rational::new(numerator, denominator), pi);
            let sum = graph.add(q, part);
            taken_out(&mut graph, pi, sum) == (0, sum)
        };
        assert!(plus(1, 3) && plus(-1, 4) && plus(0, 1));
        assert!(!plus(1, 2) && !plus(-3, 2) && !plus(5, 1));
        assert_eq!(taken_out(&mut graph, pi, pi), (2, Graph::ZERO));
    }
}

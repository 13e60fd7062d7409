//! Gradients by reverse accumulation: one sweep from the results back to the variables, which costs
//! a small multiple of the results, however many variables there are (A. Griewank and A. Walther,
//! *Evaluating Derivatives*, 2nd edition, chapter 3).

use rustc_hash::FxHashMap;

use super::differentiate::outer_derivative;
use super::node::{Expr, Node, SymbolId};
use super::{Graph, Rational};

/// The gradient of `Σ weight · result` with respect to symbols, for pairs of a result and its weight. The
/// weights are treated as constants.
pub fn gradient(graph: &mut Graph, weighted: &[(Expr, Expr)], by: &[SymbolId]) -> Vec<Expr> {
    let results: Vec<Expr> = weighted.iter().map(|&(result, _)| result).collect();
    let order = graph.in_order_where(&results, |part| graph.mentions(part, by));
    let mut sweep = Sweep::default();
    for &part in &order {
        if let Node::Solution { system, .. } = graph.node(part) {
            sweep.systems.entry(*system).or_default().open += 1;
        }
    }
    for &(result, weight) in weighted {
        sweep.add(result, weight);
    }
    let mut gradient = vec![Graph::ZERO; by.len()];
    for &part in order.iter().rev() {
        let adjoint = sweep.take(graph, part);
        if let Node::Symbol(symbol) = graph.node(part) {
            if let Some(place) = by.iter().position(|other| other == symbol) {
                gradient[place] = adjoint;
            }
        } else {
            sweep.pass_on(graph, part, adjoint);
        }
    }
    gradient
}

/// Derivatives of the weighted sum with respect to expressions, during accumulation.
#[derive(Default)]
struct Sweep {
    /// Adjoint contributions received from users.
    shares: FxHashMap<Expr, Vec<Expr>>,
    systems: FxHashMap<u32, Unknowns>,
}

/// The unknowns of a linear system: the adjoints of its entries require those of all unknowns.
#[derive(Default)]
struct Unknowns {
    /// Unknowns whose adjoints are still to be propagated.
    open: usize,
    /// Adjoints of the others, with their rows.
    adjoints: Vec<(usize, Expr)>,
}

impl Sweep {
    fn add(&mut self, part: Expr, share: Expr) {
        if share != Graph::ZERO {
            self.shares.entry(part).or_default().push(share);
        }
    }

    /// The derivative with respect to an expression, once all expressions that contain it have contributed.
    /// It is used for every operand, so a sum is given a name.
    fn take(&mut self, graph: &mut Graph, expr: Expr) -> Expr {
        let shares = self.shares.remove(&expr).unwrap_or_default();
        let sum = graph.sum(&shares);
        let is_sum = matches!(graph.node(sum), Node::Sum(terms) if terms.len() > 1);
        if !is_sum || matches!(graph.node(expr), Node::Symbol(_)) {
            return sum;
        }
        let name = match graph.node(expr) {
            Node::Named(id) => format!("adjoint_{}", graph.definition(*id).name),
            _ => "adjoint".to_owned(),
        };
        graph.name_automatically(&name, sum)
    }

    /// Propagates the derivative with respect to an expression to its operands.
    fn pass_on(&mut self, graph: &mut Graph, expr: Expr, adjoint: Expr) {
        if let Node::Solution { system, row } = *graph.node(expr) {
            self.solution(graph, system, row as usize, adjoint);
            return;
        }
        if adjoint == Graph::ZERO {
            return;
        }
        match graph.node(expr).clone() {
            Node::Number(_) | Node::Symbol(_) | Node::Solution { .. } => {}
            Node::Named(id) => {
                let value = graph.definition(id).value;
                self.add(value, adjoint);
            }
            Node::Sum(terms) => {
                for term in &terms {
                    let share = graph.scale(&term.coefficient, adjoint);
                    self.add(term.expr, share);
                }
            }
            Node::Product(factors) => {
                for factor in &factors {
                    let without = graph.div(expr, factor.base);
                    let slope = graph.scale(&Rational::from(i64::from(factor.exponent)), without);
                    let share = graph.mul(adjoint, slope);
                    self.add(factor.base, share);
                }
            }
            Node::Function(function, argument) => {
                let slope = outer_derivative(graph, function, argument, expr);
                let share = graph.mul(adjoint, slope);
                self.add(argument, share);
            }
            Node::Atan2(y, x) => {
                let squares = [graph.square(x), graph.square(y)];
                let radius_squared = graph.sum(&squares);
                let part = graph.div(adjoint, radius_squared);
                let (by_y, by_x) = (graph.mul(part, x), graph.mul(part, y));
                let by_x = graph.neg(by_x);
                self.add(y, by_y);
                self.add(x, by_x);
            }
            Node::Power(base, exponent) => {
                // a^b (b' ln a + b a'/a)
                let scaled = graph.mul(adjoint, expr);
                let quotient = graph.div(exponent, base);
                let by_base = graph.mul(scaled, quotient);
                self.add(base, by_base);
                if graph.as_number(exponent).is_none() {
                    let logarithm = graph.function(super::Function::Ln, base);
                    let by_exponent = graph.mul(scaled, logarithm);
                    self.add(exponent, by_exponent);
                }
            }
            Node::Choice {
                relation,
                compared,
                branches: [then, otherwise],
            } => {
                let of_then = graph.choice(relation, compared, [adjoint, Graph::ZERO]);
                let of_otherwise = graph.choice(relation, compared, [Graph::ZERO, adjoint]);
                self.add(then, of_then);
                self.add(otherwise, of_otherwise);
            }
        }
    }

    /// A x = b gives b̄ = A⁻ᵀ x̄ and Ā = −b̄ xᵀ, once x̄ is known for all unknowns.
    fn solution(&mut self, graph: &mut Graph, system: u32, row: usize, adjoint: Expr) {
        let unknowns = self.systems.entry(system).or_default();
        unknowns.adjoints.push((row, adjoint));
        unknowns.open = unknowns.open.saturating_sub(1);
        if unknowns.open > 0 || unknowns.adjoints.iter().all(|&(_, x)| x == Graph::ZERO) {
            return;
        }
        let adjoints = std::mem::take(&mut unknowns.adjoints);
        let parts = graph.system(system).clone();
        let size = parts.right.len();
        let mut right = vec![Graph::ZERO; size];
        for (row, adjoint) in adjoints {
            right[row] = adjoint;
        }
        let transposed = (0..size * size).map(|k| parts.matrix[k % size * size + k / size]);
        let by_right = graph.solve_numerically(transposed.collect(), right);
        let unknowns = graph.unknowns(system);
        for i in 0..size {
            self.add(parts.right[i], by_right[i]);
            for j in 0..size {
                let product = graph.mul(by_right[i], unknowns[j]);
                let share = graph.neg(product);
                self.add(parts.matrix[i * size + j], share);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbolic::{Derivatives, Function, Relation, evaluate};

    /// Compares reverse accumulation with symbolic differentiation at a point.
    fn assert_same(graph: &mut Graph, results: &[Expr], symbols: &[Expr], at: &[f64]) {
        let ids: Vec<SymbolId> = symbols.iter().filter_map(|&s| graph.as_symbol(s)).collect();
        let weights: Vec<Expr> = (3_i64..)
            .step_by(2)
            .take(results.len())
            .map(|weight| graph.number(Rational::from(weight)))
            .collect();
        let weighted: Vec<_> = results.iter().copied().zip(weights.clone()).collect();
        let backwards = gradient(graph, &weighted, &ids);
        for (&symbol, backwards) in ids.iter().zip(backwards) {
            let mut forwards = Derivatives::with_respect_to(symbol);
            let mut sum = Vec::new();
            for &(result, weight) in &weighted {
                let slope = forwards.of(graph, result);
                sum.push(graph.mul(weight, slope));
            }
            let forwards = graph.sum(&sum);
            let values = evaluate(graph, at, &[forwards, backwards]);
            let error = (values[0] - values[1]).abs();
            assert!(error <= 1e-13 * values[0].abs().max(1.0), "{values:?}");
        }
    }

    #[test]
    fn reverse_accumulation_agrees_with_derivatives_symbol_by_symbol() {
        let mut graph = Graph::new();
        let [x, y, z] = ["x", "y", "z"].map(|name| graph.symbol(name));
        let sum = graph.sum(&[x, y, y, z]);
        let named = graph.name("n", sum);
        let sine = graph.sin(named);
        let product = graph.mul(sine, x);
        let quotient = graph.div(product, y);
        let power = graph.power(named, z);
        let angle = graph.atan2(product, named);
        let choice = graph.choice(Relation::Less, [x, y], [product, quotient]);
        let root = graph.function(Function::Sqrt, named);
        let results = [quotient, power, angle, choice, root, product];
        assert_same(&mut graph, &results, &[x, y, z], &[0.7, 1.3, 0.4]);
    }

    #[test]
    fn the_adjoint_of_a_linear_system_solves_the_transposed_one() {
        let mut graph = Graph::new();
        let [x, y, z] = ["x", "y", "z"].map(|name| graph.symbol(name));
        let square = graph.square(z);
        let matrix = vec![x, y, z, square];
        let unknowns = graph.solve_numerically(matrix, vec![z, x]);
        let product = graph.mul(unknowns[1], y);
        let results = [unknowns[0], product];
        assert_same(&mut graph, &results, &[x, y, z], &[0.7, 1.3, 0.4]);
    }
}

//! Comparison of user-supplied equations of motion with the derived ones.

use appell_spec::mechanism::Mechanism;

use super::Judge;
use super::comparison::{Agreement, Pair};
use crate::mechanics::Derivation;
use crate::mechanics::algebra::Algebra;
use crate::symbolic::Expr;

/// The result of comparing user-supplied equations with the derived ones.
#[derive(Debug, Clone)]
pub struct Typed {
    /// One per equation.
    pub agreements: Vec<Agreement>,
    /// Bound on the probability that any equation was wrongly taken for identical.
    pub error_bound: f64,
}

/// Compares rates of states, by index, with user-supplied expressions. These belong to the graph of the derivation.
///
/// # Panics
///
/// If a state index is out of range.
pub fn compare_typed(
    mechanism: &Mechanism,
    derivation: &Derivation,
    typed: &[(usize, Expr)],
) -> Typed {
    let graph = derivation.algebra.graph.clone();
    let mut algebra = Algebra::new(graph, mechanism, &derivation.symbols);
    let mut judge = Judge::new(mechanism, derivation);
    let accelerations = &derivation.motion.accelerations;
    let derived = [accelerations.as_slice(), &derivation.coordinate_rates].concat();
    let agreements = typed.iter().map(|&(state, other)| {
        let pair = Pair {
            entry: String::new(),
            derived: derived[state],
            other,
        };
        judge.agreement(&mut algebra, &[pair], &|| true)
    });
    Typed {
        agreements: agreements.collect(),
        error_bound: judge.error_bound,
    }
}

//! The generic rank of linear rows: which of them depend on earlier ones in all configurations.

use super::algebra::Algebra;
use crate::symbolic::{Expr, Graph, Intervals, Node};

/// A row `Σ coefficient · unknown + rest`.
#[derive(Debug, Clone)]
pub struct LinearRow {
    /// One coefficient per unknown.
    pub coefficients: Vec<Expr>,
    /// Terms without unknowns.
    pub rest: Expr,
}

impl LinearRow {
    /// A row without such terms.
    pub fn homogeneous(coefficients: Vec<Expr>) -> Self {
        Self {
            coefficients,
            rest: Graph::ZERO,
        }
    }
}

/// A row as a sum of earlier ones: `Σ factor · row`, by their index.
pub type Combination = Vec<(usize, Expr)>;

/// Relation of a row to the independent rows before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Standing {
    /// Independent of them.
    Independent,
    /// This linear combination of them.
    Redundant(Combination),
    /// Its coefficients are a linear combination of theirs, its rest is not.
    Inconsistent,
}

/// A row in echelon form, and its combination of the original rows.
struct Reduced {
    pivot: usize,
    row: LinearRow,
    origin: Combination,
}

/// Gaussian elimination over the field of functions: pivots must not vanish identically.
pub fn standings(algebra: &mut Algebra, rows: &[LinearRow]) -> Vec<Standing> {
    let mut echelon: Vec<Reduced> = Vec::new();
    let mut standings = Vec::with_capacity(rows.len());
    for (index, given) in rows.iter().enumerate() {
        let (row, factors) = reduced(algebra, &echelon, given);
        let standing = match row.coefficients.iter().position(|&c| c != Graph::ZERO) {
            Some(pivot) => {
                let mut origin = in_given_rows(algebra, &echelon, &factors);
                for (_, factor) in &mut origin {
                    *factor = algebra.graph.neg(*factor);
                }
                origin.push((index, Graph::ONE));
                echelon.push(Reduced { pivot, row, origin });
                Standing::Independent
            }
            None if row.rest == Graph::ZERO => {
                Standing::Redundant(in_given_rows(algebra, &echelon, &factors))
            }
            None => Standing::Inconsistent,
        };
        standings.push(standing);
    }
    standings
}

/// Reduces a row by the rows in echelon form; returns the rest and the factors.
fn reduced(
    algebra: &mut Algebra,
    echelon: &[Reduced],
    given: &LinearRow,
) -> (LinearRow, Vec<Expr>) {
    let mut row = given.clone();
    let mut factors = vec![Graph::ZERO; echelon.len()];
    for (share, above) in factors.iter_mut().zip(echelon) {
        if row.coefficients[above.pivot] == Graph::ZERO {
            continue;
        }
        let pivot = above.row.coefficients[above.pivot];
        let factor = algebra.graph.div(row.coefficients[above.pivot], pivot);
        let entries = row.coefficients.iter_mut().chain([&mut row.rest]);
        let subtracted = above.row.coefficients.iter().chain([&above.row.rest]);
        for (value, &other) in entries.zip(subtracted) {
            let change = algebra.graph.mul(factor, other);
            *value = algebra.graph.sub(*value, change);
            if algebra.vanishes(*value) {
                *value = Graph::ZERO;
            }
        }
        *share = factor;
    }
    (row, factors)
}

/// Converts a combination of rows in echelon form to one of the original rows.
fn in_given_rows(algebra: &mut Algebra, echelon: &[Reduced], factors: &[Expr]) -> Combination {
    let mut combination = Combination::new();
    for (&factor, above) in factors.iter().zip(echelon) {
        for &(index, part) in &above.origin {
            let part = algebra.graph.mul(factor, part);
            match combination.iter_mut().find(|(known, _)| *known == index) {
                Some((_, sum)) => *sum = algebra.graph.add(*sum, part),
                None => combination.push((index, part)),
            }
        }
    }
    for (_, factor) in &mut combination {
        *factor = algebra.shortest(*factor);
        // Factors ±1 are most frequent, and elimination produces them in many forms.
        for whole in [1, -1] {
            let whole = algebra.graph.integer(whole);
            if *factor != whole && algebra.test.are_equal(&algebra.graph, *factor, whole) {
                *factor = whole;
            }
        }
    }
    combination.retain(|&(_, factor)| factor != Graph::ZERO);
    combination
}

/// Whether no denominator in `expr` can vanish in the declared ranges.
pub fn is_finite(graph: &Graph, intervals: &mut Intervals, expr: Expr) -> bool {
    graph.in_order(&[expr]).into_iter().all(|part| {
        let Node::Product(factors) = graph.node(part) else {
            return true;
        };
        factors
            .iter()
            .all(|f| f.exponent > 0 || intervals.cannot_vanish(graph, f.base))
    })
}

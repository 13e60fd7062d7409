//! Large blocks of the mass matrix: `Pᵀ M P = L D Lᵀ`, unrolled into named entries.

use appell_spec::mechanism::Mechanism;

use super::algebra::Algebra;
use super::finding::Outcome;
use super::letters;
use super::motion::{Way, simplest_pivot};
use super::symbols::speed_name;
use crate::symbolic::{Expr, Graph};

/// A factorised block.
#[derive(Debug, Clone, Default)]
pub struct FactorizedBlock {
    /// Speeds in the order of elimination.
    pub speeds: Vec<usize>,
    /// `lower[i][j]`, `j < i`.
    lower: Vec<Vec<Expr>>,
    /// Diagonal of D.
    pivots: Vec<Expr>,
}

impl FactorizedBlock {
    /// Factorises the block of `speeds`.
    pub fn new(
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        mass_matrix: &[Vec<Expr>],
        speeds: &[usize],
        way: Way<'_>,
    ) -> Outcome<Self> {
        let [mass, lower, diagonal] =
            [letters::mass, letters::lower, letters::diagonal].map(|letter| letter(mechanism));
        let name = |speed: usize| speed_name(mechanism, speed);
        let mut schur = mass_matrix.to_vec();
        for &i in speeds {
            for &j in speeds.iter().filter(|&&j| j <= i) {
                let entry = &format!("{mass}_{}_{}", name(j), name(i));
                let entry = algebra.graph.name(entry, schur[i][j]);
                schur[i][j] = entry;
                schur[j][i] = entry;
            }
        }
        let mut open = speeds.to_vec();
        let mut block = Self::default();
        // Columns of L in the order of elimination, indexed by speed.
        let mut columns: Vec<Vec<Expr>> = Vec::new();
        while !open.is_empty() {
            let k = match way {
                Way::InOrder(order) => next_of(order, &mut open),
                Way::Shortest | Way::Factorized => {
                    simplest_pivot(algebra, mechanism, &schur, &mut open)?
                }
            };
            let graph = &mut algebra.graph;
            let pivot = graph.name(&format!("{diagonal}_{}", name(k)), schur[k][k]);
            let mut column = vec![Graph::ZERO; mass_matrix.len()];
            for &i in &open {
                let ratio = graph.div(schur[i][k], pivot);
                column[i] = graph.name(&format!("{lower}_{}_{}", name(i), name(k)), ratio);
            }
            for (a, &i) in open.iter().enumerate() {
                for &j in &open[..=a] {
                    let change = graph.mul(column[i], schur[j][k]);
                    if change == Graph::ZERO {
                        continue;
                    }
                    let mut entry = graph.sub(schur[i][j], change);
                    if i != j {
                        entry = graph.name(&format!("{diagonal}_{}_{}", name(i), name(j)), entry);
                    }
                    schur[i][j] = entry;
                    schur[j][i] = entry;
                }
            }
            block
                .lower
                .push(columns.iter().map(|column| column[k]).collect());
            block.pivots.push(pivot);
            block.speeds.push(k);
            columns.push(column);
        }
        Ok(block)
    }

    /// Whether L has a nonzero entry, with row and column in the order of elimination.
    pub fn couples(&self, row: usize, column: usize) -> bool {
        self.lower[row][column] != Graph::ZERO
    }

    /// Each speed with its entry of D.
    pub fn pivots(&self) -> impl Iterator<Item = (usize, Expr)> {
        self.speeds.iter().copied().zip(self.pivots.iter().copied())
    }

    /// Solution of `M x = right` for the speeds of the block. `name` is called on the solution `z` of
    /// `L z = right`.
    pub fn solve(
        &self,
        algebra: &mut Algebra,
        right: &[Expr],
        x: &mut [Expr],
        mut name: impl FnMut(&mut Graph, usize, Expr) -> Expr,
    ) {
        let graph = &mut algebra.graph;
        let mut z: Vec<Expr> = Vec::with_capacity(self.speeds.len());
        for (&speed, lower) in self.speeds.iter().zip(&self.lower) {
            let mut terms = vec![right[speed]];
            for (&entry, &done) in lower.iter().zip(&z) {
                let term = graph.mul(entry, done);
                terms.push(graph.neg(term));
            }
            let sum = graph.sum(&terms);
            z.push(name(graph, speed, sum));
        }
        for i in (0..self.speeds.len()).rev() {
            let mut terms = vec![graph.div(z[i], self.pivots[i])];
            for j in i + 1..self.speeds.len() {
                let term = graph.mul(self.lower[j][i], x[self.speeds[j]]);
                terms.push(graph.neg(term));
            }
            x[self.speeds[i]] = graph.sum(&terms);
        }
    }
}

/// Removes and returns the first open entry of an order.
fn next_of(order: &[usize], open: &mut Vec<usize>) -> usize {
    let rank = |speed: usize| order.iter().position(|&other| other == speed);
    let first = (0..open.len()).min_by_key(|&place| rank(open[place]));
    open.remove(first.unwrap_or(0))
}

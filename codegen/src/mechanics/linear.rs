//! Jacobians of the rates by implicit differentiation.

use super::algebra::Algebra;
use super::motion::Factorization;
use super::symbols::{Symbols, ids};
use crate::symbolic::{Expr, Graph, Substitution};

/// What the accelerations solve: `r(x, u, p, ω̇) = Π - b - M ω̇ = 0`.
pub struct ImplicitMotion<'a> {
    /// M.
    pub mass_matrix: &'a [Vec<Expr>],
    /// b.
    pub bias: &'a [Expr],
    /// Π.
    pub forces: &'a [Expr],
    /// Factorised M.
    pub factorization: &'a Factorization,
    /// The accelerations themselves.
    pub accelerations: &'a [Expr],
    /// q̇.
    pub coordinate_rates: &'a [Expr],
}

impl ImplicitMotion<'_> {
    /// Residual of Appell's equations with symbols for the accelerations.
    pub fn residual(&self, algebra: &mut Algebra, symbols: &Symbols) -> Vec<Expr> {
        (0..self.bias.len())
            .map(|i| {
                let mut parts = vec![self.forces[i], algebra.graph.neg(self.bias[i])];
                for (&entry, &acceleration) in self.mass_matrix[i].iter().zip(&symbols.accelerations) {
                    let inertial = algebra.graph.mul(entry, acceleration);
                    parts.push(algebra.graph.neg(inertial));
                }
                algebra.graph.sum(&parts)
            })
            .collect()
    }

    /// Derivatives of all rates, one column per variable: `M ∂ω̇/∂z = ∂r/∂z`, with ω̇ put in after
    /// the differentiation, and ∂q̇/∂z directly.
    pub fn jacobian(
        &self,
        algebra: &mut Algebra,
        symbols: &Symbols,
        residual: &[Expr],
        variables: &[Expr],
    ) -> Vec<Vec<Expr>> {
        let replacements: Vec<_> = ids(&algebra.graph, &symbols.accelerations)
            .into_iter()
            .zip(self.accelerations.iter().copied())
            .collect();
        let mut actual = Substitution::new(&mut algebra.graph, &replacements);
        variables
            .iter()
            .map(|&variable| {
                let right: Vec<Expr> = residual
                    .iter()
                    .map(|&r| {
                        let partial = algebra.derivative(r, variable);
                        actual.apply(&mut algebra.graph, partial).unwrap_or(Graph::ZERO)
                    })
                    .collect();
                let mut column = self.factorization.solve(algebra, &right, None);
                for &rate in self.coordinate_rates {
                    column.push(algebra.derivative(rate, variable));
                }
                column
            })
            .collect()
    }
}

//! The generalised velocities without an explicit formula: a system that is solved with pivoting, or quotients
//! that remain symbols for display.

use super::algebra::{Algebra, replacing};
use super::finding::Outcome;
use super::symbols::ids;
use crate::symbolic::{Expr, Graph};

/// An equation `Σ coefficient · q̇ = right`.
pub struct Equation {
    /// The constraint row from which it originates.
    pub row: Option<usize>,
    /// Coefficients of q̇.
    pub coefficients: Vec<Expr>,
    /// Its right-hand side.
    pub right: Expr,
}

/// The equations without a safe pivot: `matrix · unknowns = right`.
#[derive(Debug, Clone, Default)]
pub struct OpenSystem {
    /// Coordinates whose rates it determines.
    pub coordinates: Vec<usize>,
    /// Symbols of these rates; those of the vector part of a quaternion denote the angular velocity instead.
    pub unknowns: Vec<Expr>,
    /// The constraint row of each equation; `None` for the definition of a pseudo-velocity.
    pub rows: Vec<Option<usize>>,
    /// Its matrix, row by row: a function of coordinates and time.
    pub matrix: Vec<Expr>,
    /// Its right-hand side, linear in the pseudo-velocities.
    pub right: Vec<Expr>,
    /// Whether each equation has a single unknown, with a coefficient that cannot vanish.
    pub by_division: bool,
}

impl OpenSystem {
    /// Its unknowns for another right-hand side.
    pub fn solved_for(&self, graph: &mut Graph, right: &[Expr]) -> Vec<Expr> {
        self.solved(graph, self.matrix.clone(), right)
    }

    /// The same for the transposed matrix.
    pub fn transposed_for(&self, graph: &mut Graph, right: &[Expr]) -> Vec<Expr> {
        let n = right.len();
        let transposed = (0..n * n).map(|k| self.matrix[k % n * n + k / n]);
        self.solved(graph, transposed.collect(), right)
    }

    fn solved(&self, graph: &mut Graph, matrix: Vec<Expr>, right: &[Expr]) -> Vec<Expr> {
        if !self.by_division {
            return graph.solve_numerically(matrix, right.to_vec());
        }
        let diagonal = matrix.iter().step_by(right.len() + 1);
        let equations = right.iter().zip(diagonal);
        equations
            .map(|(&right, &by)| graph.div(right, by))
            .collect()
    }

    /// Adds an equation for the unknown of `column`, with the `rates` of the others substituted. Returns false
    /// if these contain unknowns of the system.
    pub fn keep(
        &mut self,
        algebra: &mut Algebra,
        column: usize,
        rates: &[Expr],
        equation: &Equation,
    ) -> bool {
        let graph = &mut algebra.graph;
        let mut parts = vec![equation.right];
        for (other, &coefficient) in equation.coefficients.iter().enumerate() {
            if other != column {
                let part = graph.mul(coefficient, rates[other]);
                parts.push(graph.neg(part));
            }
        }
        let right = graph.sum(&parts);
        if graph.mentions(right, &ids(graph, &self.unknowns)) {
            return false;
        }
        let n = self.right.len();
        let mut matrix = vec![Graph::ZERO; (n + 1) * (n + 1)];
        for k in 0..n {
            matrix[k * (n + 2)] = self.matrix[k * (n + 1)];
        }
        matrix[n * (n + 2)] = equation.coefficients[column];
        self.matrix = matrix;
        self.right.push(right);
        self.rows.push(equation.row);
        self.by_division = true;
        true
    }

    /// Expressions with values substituted for the unknowns.
    pub fn put_in(
        &self,
        algebra: &mut Algebra,
        values: &[Expr],
        exprs: &[Expr],
    ) -> Outcome<Vec<Expr>> {
        let mut actual = replacing(&algebra.graph, &self.unknowns, values);
        algebra.apply(&mut actual, exprs)
    }
}

//! Jacobians of the rates by implicit differentiation: the equations of motion are differentiated at fixed
//! accelerations, and solved with the pivots of the motion.

use super::algebra::{Algebra, name_of};
use super::finding::{Item, Outcome, defined};
use super::gibbs_appell::GibbsForm;
use super::motion::{Block, Motion};
use super::recursion::Recursion;
use super::symbols::{Symbols, ids};
use crate::symbolic::{Expr, Graph, Substitution};

/// The equations solved by the accelerations.
pub struct ImplicitMotion<'a> {
    /// M and b.
    pub gibbs: &'a GibbsForm,
    /// Π.
    pub forces: &'a [Expr],
    /// The solved equations.
    pub motion: &'a Motion,
    /// q̇.
    pub coordinate_rates: &'a [Expr],
}

impl ImplicitMotion<'_> {
    /// Residual of every equation with symbols for the accelerations. Eliminated equations, with the symbol
    /// denoting ω̇ minus its whole part: `right - pivot (ω̇ + Σ coupling ω̇_other)`; others: `Π - b - M ω̇`.
    pub fn residual(&self, algebra: &mut Algebra, symbols: &Symbols) -> Vec<Expr> {
        let unknowns = &symbols.accelerations;
        let mut residual = vec![Graph::ZERO; unknowns.len()];
        for block in &self.motion.blocks {
            match block {
                Block::Eliminated(equations) => {
                    for equation in equations {
                        let minus: Vec<Expr> =
                            unknowns.iter().map(|&u| algebra.graph.neg(u)).collect();
                        let own = unknowns[equation.speed];
                        let sum = equation.less_couplings(algebra, own, &minus);
                        let inertial = algebra.graph.mul(equation.pivot, sum);
                        residual[equation.speed] = algebra.graph.sub(equation.right, inertial);
                    }
                }
                Block::Factorized(block) => {
                    for &i in &block.speeds {
                        let mut terms = vec![self.forces[i], algebra.graph.neg(self.gibbs.bias[i])];
                        for (&entry, &unknown) in self.gibbs.mass_matrix[i].iter().zip(unknowns) {
                            let inertial = algebra.graph.mul(entry, unknown);
                            terms.push(algebra.graph.neg(inertial));
                        }
                        residual[i] = algebra.graph.sum(&terms);
                    }
                }
            }
        }
        residual
    }

    /// Derivatives of all rates, one column per variable: those of ω̇ from `∂residual/∂z` with the
    /// accelerations substituted after the differentiation, those of q̇ directly.
    pub fn jacobian(
        &self,
        algebra: &mut Algebra,
        symbols: &Symbols,
        residual: &[Expr],
        variables: &[Expr],
    ) -> Outcome<Vec<Vec<Expr>>> {
        let mut values = self.motion.accelerations.clone();
        for equation in self.motion.eliminated() {
            if equation.whole != Graph::ZERO {
                values[equation.speed] = equation.quotient;
            }
        }
        let replacements: Vec<_> = ids(&algebra.graph, &symbols.accelerations)
            .into_iter()
            .zip(values)
            .collect();
        let mut actual = Substitution::new(&mut algebra.graph, &replacements);
        let mut columns = Vec::with_capacity(variables.len());
        for &variable in variables {
            let mut right = Vec::with_capacity(residual.len());
            for &r in residual {
                let partial = algebra.derivative(r, variable);
                let partial = actual.apply(&mut algebra.graph, partial);
                right.push(defined(partial, Item::Mechanism)?);
            }
            columns.push(self.column(algebra, symbols, variable, right));
        }
        Ok(columns)
    }

    /// Derivatives of all rates with respect to a variable from those of the residuals.
    fn column(
        &self,
        algebra: &mut Algebra,
        symbols: &Symbols,
        variable: Expr,
        right: Vec<Expr>,
    ) -> Vec<Expr> {
        let mut column = self.motion.solved_for(algebra, symbols, variable, right);
        for &rate in self.coordinate_rates {
            column.push(algebra.derivative(rate, variable));
        }
        column
    }

    /// [`ImplicitMotion::jacobian`] for variables other than parameters, by recursion over the links.
    pub fn jacobian_along(
        &self,
        algebra: &mut Algebra,
        symbols: &Symbols,
        tree: &Recursion,
        variables: &[Expr],
    ) -> Vec<Vec<Expr>> {
        let accelerations = &self.motion.accelerations;
        let at = tree.differentiable(algebra, accelerations);
        let columns = variables.iter().map(|&variable| {
            let right = tree.partial(algebra, &at, accelerations, variable);
            self.column(algebra, symbols, variable, right)
        });
        columns.collect()
    }
}

impl Motion {
    /// Derivatives of ω̇ from those of the residuals with respect to `variable`: of the eliminated
    /// equations, or of `Π - b - M ω̇`.
    pub fn solved_for(
        &self,
        algebra: &mut Algebra,
        symbols: &Symbols,
        variable: Expr,
        mut right: Vec<Expr>,
    ) -> Vec<Expr> {
        let speeds = symbols.speeds.iter();
        let speeds: Vec<String> = speeds.map(|&w| name_of(&algebra.graph, w)).collect();
        let by = name_of(&algebra.graph, variable);
        let rho = |algebra: &mut Algebra, speed: usize, value: Expr| {
            let name = format!("d_rho_{}_d_{by}", speeds[speed]);
            algebra.graph.name_automatically(&name, value)
        };
        let mut column = vec![Graph::ZERO; right.len()];
        for block in &self.blocks {
            match block {
                Block::Eliminated(equations) => {
                    for equation in equations {
                        let right = right[equation.speed];
                        let plain = algebra.graph.div(right, equation.pivot);
                        let named = rho(algebra, equation.speed, right);
                        let named = algebra.graph.div(named, equation.pivot);
                        // A cancelling pivot is not named.
                        let count = |own| algebra.graph.operations(&[own]);
                        let own = if count(plain) < count(named) {
                            plain
                        } else {
                            named
                        };
                        let whole = algebra.derivative(equation.whole, variable);
                        let own = algebra.graph.add(own, whole);
                        column[equation.speed] = equation.less_couplings(algebra, own, &column);
                    }
                }
                Block::Factorized(block) => {
                    for &speed in &block.speeds {
                        right[speed] = rho(algebra, speed, right[speed]);
                    }
                    block.solve(algebra, &right, &mut column, |graph, speed, z| {
                        graph.name_automatically(&format!("d_z_{}_d_{by}", speeds[speed]), z)
                    });
                }
            }
        }
        column
    }
}

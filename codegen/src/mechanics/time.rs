//! Time derivatives along a motion.

use super::algebra::Algebra;
use super::symbols::Symbols;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};

/// d/dt of functions of coordinates, signals and time, with given generalised velocities.
pub struct TimeDerivative<'a> {
    /// Symbols of the mechanism.
    pub symbols: &'a Symbols,
    /// Generalised velocities q̇, one per coordinate.
    pub rates: &'a [Expr],
}

impl TimeDerivative<'_> {
    /// `Σ ∂e/∂q q̇ + Σ ∂e/∂s ṡ + ∂e/∂t` at fixed pseudo-velocities.
    pub fn of(&self, algebra: &mut Algebra, expr: Expr) -> Expr {
        let mut parts = vec![algebra.derivative(expr, self.symbols.time)];
        for (&coordinate, &rate) in self.symbols.coordinates.iter().zip(self.rates) {
            let partial = algebra.derivative(expr, coordinate);
            parts.push(algebra.graph.mul(partial, rate));
        }
        for [value, first, second] in &self.symbols.signals {
            for (symbol, rate) in [(value, first), (first, second)] {
                let partial = algebra.derivative(expr, *symbol);
                parts.push(algebra.graph.mul(partial, *rate));
            }
        }
        algebra.graph.sum(&parts)
    }

    /// The component-wise derivative, in the frame of the components.
    pub fn of3(&self, algebra: &mut Algebra, v: Vec3) -> Vec3 {
        if v.iter().all(|&c| algebra.graph.as_number(c).is_some()) {
            return [Graph::ZERO; 3];
        }
        v.map(|component| self.of(algebra, component))
    }
}

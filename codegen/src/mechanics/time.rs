//! Time derivatives along a motion.

use super::algebra::Algebra;
use super::expressions::Setting;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};

impl Setting<'_> {
    /// d/dt of a function of coordinates, signals and time, at fixed pseudo-velocities:
    /// `Σ ∂e/∂q q̇ + Σ ∂e/∂s ṡ + ∂e/∂t`.
    pub fn rate(self, algebra: &mut Algebra, expr: Expr) -> Expr {
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
    pub fn rate3(self, algebra: &mut Algebra, v: Vec3) -> Vec3 {
        if v.iter().all(|&c| algebra.graph.as_number(c).is_some()) {
            return [Graph::ZERO; 3];
        }
        v.map(|component| self.rate(algebra, component))
    }
}

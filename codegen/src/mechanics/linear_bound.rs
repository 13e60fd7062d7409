//! Jacobians of the rates with dependent speeds.
//!
//! All expressions are differentiated at fixed dependent speeds s, fixed rates ṡ and fixed accelerations, and
//! the results are combined once. With `C s = r`, `D = ∂r/∂ω` and `C ṡ = D ω̇ + c`:
//!
//! ```text
//! C ds = d(r - C s)                 C dṡ = d(D ω̇ + c - C ṡ) + ∂c/∂s ds
//! M dω̇ = Bᵀ (d(ρ + [D, -C]ᵀ λ) + ∂ρ/∂s ds + ∂ρ/∂ṡ dṡ)
//! ```
//!
//! ρ = Π - b - M ω̇ of all speeds does not vanish: its dependent part is `Cᵀ λ`, the work of the constraints;
//! differentiating at fixed λ replaces the derivative of B.

use super::Unbound;
use super::algebra::{Algebra, name_of, named3};
use super::dependent::DependentSpeeds;
use super::finding::Outcome;
use super::gibbs_appell::ActualMotion;
use super::motion::Motion;
use super::symbols::Symbols;
use crate::symbolic::{Expr, Graph, Substitution};

/// The motion with its dependent speeds, prepared for differentiation.
pub struct BoundMotion<'a> {
    symbols: &'a Symbols,
    motion: &'a Motion,
    dependent: &'a DependentSpeeds,
    // Residuals, with symbols for the fixed quantities.
    /// `r - C s`
    velocity: Vec<Expr>,
    /// `D ω̇ + c - C ṡ`
    acceleration: Vec<Expr>,
    /// `ρ + [D, -C]ᵀ λ` of all speeds, the dependent ones last.
    balance: Vec<Expr>,
    /// Substitutes the actual motion for the symbols.
    actual: Substitution,
    /// ∂c/∂s, a column per dependent speed.
    change_by_speeds: Vec<Vec<Expr>>,
    /// Bᵀ ∂ρ/∂s, a column per dependent speed.
    balance_by_speeds: Vec<Vec<Expr>>,
    /// Bᵀ ∂ρ/∂ṡ, a column per dependent speed.
    balance_by_accelerations: Vec<Vec<Expr>>,
    /// ∂q̇/∂s, a column per dependent speed.
    rates_by_speeds: Vec<Vec<Expr>>,
}

/// Derivatives with respect to one symbol at fixed others, at the actual motion.
fn partials(
    actual: &mut Substitution,
    algebra: &mut Algebra,
    of: &[Expr],
    variable: Expr,
) -> Outcome<Vec<Expr>> {
    let partials = of.iter().map(|&e| algebra.derivative(e, variable));
    let partials: Vec<Expr> = partials.collect();
    algebra.apply(actual, &partials)
}

impl<'a> BoundMotion<'a> {
    /// Computes the terms that are independent of the variable of differentiation.
    pub fn new(
        algebra: &mut Algebra,
        symbols: &'a Symbols,
        unbound: &Unbound,
        dependent: &'a DependentSpeeds,
        motion: &'a Motion,
    ) -> Outcome<Self> {
        let accelerations = [symbols.accelerations.as_slice(), &dependent.accelerations].concat();
        let residual = residual(algebra, unbound, &accelerations);
        let graph = &mut algebra.graph;
        let happening = dependent.accelerations_with(graph, &motion.accelerations);
        let speeds = dependent.system.unknowns.iter().zip(&dependent.values);
        let pairs = speeds.chain(accelerations.iter().zip(&happening));
        let mut pairs: Vec<(Expr, Expr)> = pairs.map(|(&symbol, &value)| (symbol, value)).collect();
        let mut actual = Substitution::of_parts(graph, &pairs).keeping_names();
        let work = algebra.apply(&mut actual, &residual[symbols.speeds.len()..])?;
        let graph = &mut algebra.graph;
        let multipliers = dependent.solved_multipliers(graph, &work);
        pairs.extend(dependent.multipliers.iter().copied().zip(multipliers));
        let mut bound = Self {
            symbols,
            motion,
            dependent,
            velocity: dependent.residual(graph),
            acceleration: dependent.acceleration_residual(graph, &accelerations),
            balance: dependent.balance(graph, &residual),
            actual: Substitution::of_parts(graph, &pairs).keeping_names(),
            change_by_speeds: Vec::new(),
            balance_by_speeds: Vec::new(),
            balance_by_accelerations: Vec::new(),
            rates_by_speeds: Vec::new(),
        };
        let actual = &mut bound.actual;
        let speeds = dependent.system.unknowns.iter();
        for (&speed, &rate) in speeds.zip(&dependent.accelerations) {
            let by_speed = partials(actual, algebra, &bound.acceleration, speed)?;
            bound.change_by_speeds.push(by_speed);
            for (columns, variable) in [
                (&mut bound.balance_by_speeds, speed),
                (&mut bound.balance_by_accelerations, rate),
            ] {
                let all = partials(actual, algebra, &bound.balance, variable)?;
                columns.push(dependent.along_allowed(&mut algebra.graph, &all));
            }
            let rates = partials(actual, algebra, &dependent.rates, speed)?;
            bound.rates_by_speeds.push(rates);
        }
        Ok(bound)
    }

    /// Derivatives of all rates with respect to a variable: those of ω̇, then those of q̇.
    pub fn column(&mut self, algebra: &mut Algebra, variable: Expr) -> Outcome<Vec<Expr>> {
        let [right, speeds] = self.balance_column(algebra, variable)?;
        let mut column = self
            .motion
            .solved_for(algebra, self.symbols, variable, right);
        let (dependent, actual) = (self.dependent, &mut self.actual);
        let mut rates = partials(actual, algebra, &dependent.rates, variable)?;
        add_along(
            &mut algebra.graph,
            &mut rates,
            &self.rates_by_speeds,
            &speeds,
        );
        column.extend(rates);
        Ok(column)
    }

    /// Derivatives of Π - b - M ω̇ with respect to a variable at fixed ω̇; and those of the dependent speeds.
    pub fn balance_column(
        &mut self,
        algebra: &mut Algebra,
        variable: Expr,
    ) -> Outcome<[Vec<Expr>; 2]> {
        let (dependent, system) = (self.dependent, &self.dependent.system);
        let actual = &mut self.actual;
        let mut partials =
            |algebra: &mut Algebra, of: &[Expr]| partials(actual, algebra, of, variable);
        let by = name_of(&algebra.graph, variable);
        let named = |graph: &mut Graph, symbols: &[Expr], values: Vec<Expr>| -> Vec<Expr> {
            let named = symbols.iter().zip(values).map(|(&symbol, value)| {
                let name = format!("d_{}_d_{by}", name_of(graph, symbol));
                graph.name_automatically(&name, value)
            });
            named.collect()
        };

        let speed = self.symbols.speeds.iter().position(|&w| w == variable);
        let speeds = if let Some(speed) = speed {
            dependent.partial.iter().map(|row| row[speed]).collect()
        } else {
            let change = partials(algebra, &self.velocity)?;
            let solved = system.solved_for(&mut algebra.graph, &change);
            named(&mut algebra.graph, &system.unknowns, solved)
        };
        let mut change = partials(algebra, &self.acceleration)?;
        let graph = &mut algebra.graph;
        add_along(graph, &mut change, &self.change_by_speeds, &speeds);
        let solved = system.solved_for(graph, &change);
        let accelerations = named(graph, &dependent.accelerations, solved);

        let all = partials(algebra, &self.balance)?;
        let graph = &mut algebra.graph;
        let mut right = dependent.along_allowed(graph, &all);
        add_along(graph, &mut right, &self.balance_by_speeds, &speeds);
        let by_accelerations = &self.balance_by_accelerations;
        add_along(graph, &mut right, by_accelerations, &accelerations);
        Ok([right, speeds])
    }
}

/// ρ = Π - b - M ω̇ of all speeds, body by body: applied forces minus `v_j · m a + w_j · ḣ`.
fn residual(algebra: &mut Algebra, unbound: &Unbound, accelerations: &[Expr]) -> Vec<Expr> {
    let mut rows: Vec<Vec<Expr>> = unbound.forces.iter().map(|&force| vec![force]).collect();
    for body in &unbound.bodies {
        let motion = ActualMotion::new(algebra, body, accelerations);
        let force = algebra.graph.scale3(body.mass, motion.a);
        let force = named3(algebra, &format!("f_{}", body.name), force);
        for (j, row) in rows.iter_mut().enumerate() {
            let part = algebra.graph.dot(body.centre.partial[j], force);
            row.push(algebra.graph.neg(part));
            if let Some(rotation) = &body.rotation {
                let moment = motion.momentum_rate;
                let part = algebra.graph.dot(rotation.partial[j], moment);
                row.push(algebra.graph.neg(part));
            }
        }
    }
    let rows = rows.into_iter().map(|row| algebra.graph.sum(&row));
    rows.collect()
}

/// `sum + Σ column · factor`
fn add_along(graph: &mut Graph, sum: &mut [Expr], columns: &[Vec<Expr>], factors: &[Expr]) {
    for (column, &factor) in columns.iter().zip(factors) {
        for (entry, &slope) in sum.iter_mut().zip(column) {
            let part = graph.mul(slope, factor);
            *entry = graph.add(*entry, part);
        }
    }
}

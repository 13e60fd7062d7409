//! Inverse dynamics: the pseudo-forces M ω̇ + b − Π that a given motion requires in addition to the loads, and
//! their derivatives.
//!
//! Π is that of the state and the inputs, as in the equations of motion: reactions in loads are those of the
//! motion under these inputs.

use appell_runtime::model::{ModelInfo, Quantity};
use appell_spec::mechanism::Mechanism;

use super::Derivation;
use super::algebra::Algebra;
use super::arguments::input_symbols;
use super::assemble::{by_speed, listed};
use super::finding::Outcome;
use super::gibbs_appell::demand;
use super::linear_bound::BoundMotion;
use super::motion::Motion;
use crate::program::{Array, Layout, Space};
use crate::symbolic::Expr;

impl Derivation {
    /// M ω̇ + b − Π with symbols for ω̇.
    pub(super) fn inverse_dynamics(&mut self, speeds: &[Quantity]) -> Array {
        let demand = self.demand();
        let about = "M ω̇ + b − Π.";
        by_speed("demand", "demand", about, speeds, demand)
    }

    /// The same with its derivatives.
    pub(super) fn inverse_dynamics_jacobians(
        &mut self,
        mechanism: &Mechanism,
        info: &ModelInfo,
    ) -> Outcome<Vec<Array>> {
        let speeds = &info.states[..info.speeds];
        let states = [self.symbols.speeds.as_slice(), &self.symbols.coordinates].concat();
        let inputs = input_symbols(&self.symbols, info);
        let demand = self.inverse_dynamics(speeds);
        let by_state = self.changes_of_demand(&demand.entries, &states)?;
        let by_inputs = self.changes_of_demand(&demand.entries, &inputs)?;
        let jacobian = |name: &str, about: &str, by: Space, entries: Vec<Expr>| {
            let columns = by.quantities(info);
            let rows = speeds.iter();
            let labels = rows.flat_map(|row| listed(&format!("d_{}_d", row.name), columns));
            let layout = Layout::Jacobian(Space::GeneralizedForces, by);
            let mut array = Array::new(name, about, layout, entries).labelled(labels);
            for (row, speed) in speeds.iter().enumerate() {
                let title = format!("Row `{}` of `{name}`.", speed.name);
                array = array.under(&title, row * columns.len()..(row + 1) * columns.len());
            }
            array
        };
        Ok(vec![
            demand,
            jacobian(
                "by_state",
                "∂(M ω̇ + b − Π)/∂x, ω̇ held.",
                Space::State,
                by_state,
            ),
            jacobian("by_inputs", "−∂Π/∂u.", Space::Inputs, by_inputs),
            self.mass_matrix(mechanism, speeds),
        ])
    }

    pub(super) fn demand(&mut self) -> Vec<Expr> {
        let accelerations = &self.symbols.accelerations;
        if let Some(tree) = &self.recursion {
            return tree.demand(&mut self.algebra, accelerations);
        }
        let graph = &mut self.algebra.graph;
        let (mass, bias) = (&self.gibbs.mass_matrix, &self.gibbs.bias);
        let rows = mass.iter().zip(bias).zip(&self.forces);
        rows.map(|((row, &bias), &force)| demand(graph, row, accelerations, bias, force))
            .collect()
    }

    /// ∂(M ω̇ + b − Π)/∂z, row by row.
    fn changes_of_demand(&mut self, demand: &[Expr], variables: &[Expr]) -> Outcome<Vec<Expr>> {
        let (algebra, symbols) = (&mut self.algebra, &self.symbols);
        let mut columns: Vec<Vec<Expr>> = Vec::with_capacity(variables.len());
        if let Some(tree) = &self.recursion {
            let at = tree.differentiable(algebra, &symbols.accelerations);
            for &z in variables {
                let left = tree.partial(algebra, &at, &symbols.accelerations, z);
                columns.push(negated(algebra, &left));
            }
        } else if self.dependent.values.is_empty() {
            for &z in variables {
                let rows = demand.iter().map(|&row| {
                    let entry = algebra.derivative(row, z);
                    algebra.unless_zero(entry)
                });
                columns.push(rows.collect());
            }
        } else {
            let motion = Motion {
                accelerations: symbols.accelerations.clone(),
                ..self.motion.clone()
            };
            let (unbound, dependent) = (&self.unbound, &self.dependent);
            let mut bound = BoundMotion::new(algebra, symbols, unbound, dependent, &motion)?;
            for &z in variables {
                let [left, _] = bound.balance_column(algebra, z)?;
                columns.push(negated(algebra, &left));
            }
        }
        let row = |row| columns.iter().map(move |column: &Vec<Expr>| column[row]);
        Ok((0..demand.len()).flat_map(row).collect())
    }
}

fn negated(algebra: &mut Algebra, column: &[Expr]) -> Vec<Expr> {
    let entries = column.iter();
    entries.map(|&entry| algebra.graph.neg(entry)).collect()
}

//! The outputs of a spec and their derivatives. Accelerations and forces in outputs are in terms of symbols for
//! ω̇ until they are differentiated.

use appell_spec::mechanism::Mechanism;

use super::Derivation;
use super::algebra::replacing;
use super::expressions::Setting;
use super::finding::{Item, Outcome, defined};
use super::motions::motions;
use super::responses::named_in;
use super::symbols::ids;
use crate::program::{Array, Layout, Space};
use crate::symbolic::{Expr, Substitution};

/// Values of the outputs.
pub(super) struct Outputs {
    /// With symbols for ω̇.
    implicit: Vec<Expr>,
    /// With the solved ω̇.
    pub(super) values: Vec<Expr>,
}

impl Derivation {
    /// Whether outputs depend on the solution of the equations.
    pub(super) fn outputs_need_accelerations(&self) -> bool {
        let unknown = ids(&self.algebra.graph, &self.symbols.accelerations);
        let values = self.responses_in_outputs.iter();
        let mut values = values.map(|(_, value)| *value);
        values.any(|value| self.algebra.graph.mentions(value, &unknown))
    }

    /// The outputs of the spec.
    pub(super) fn outputs(&mut self, mechanism: &Mechanism) -> Outcome<Vec<Array>> {
        let values = self.output_values(mechanism)?.values;
        let labels = mechanism.outputs.iter().map(|y| y.label.name.clone());
        let all = 0..values.len();
        let array = Array::new(
            "outputs",
            "Outputs.",
            Layout::Vector(Space::Outputs),
            values,
        );
        Ok(vec![array.labelled(labels).under("Outputs.", all)])
    }

    /// Values of the outputs, with and without symbols for ω̇.
    pub(super) fn output_values(&mut self, mechanism: &Mechanism) -> Outcome<Outputs> {
        let setting = Setting::new(mechanism, &self.symbols, &self.coordinate_rates);
        let mut told = motions(&mut self.algebra, &self.symbols, &self.kinematics);
        let mut implicit = Vec::with_capacity(mechanism.outputs.len());
        for (index, output) in mechanism.outputs.entries() {
            let graph = &mut self.algebra.graph;
            let item = Item::Output(index);
            let value = setting.lower_in(graph, item, &output.value)?;
            implicit.push(defined(told.apply(graph, value), item)?);
        }
        if self.responses_in_outputs.is_empty() {
            let values = implicit.clone();
            return Ok(Outputs { implicit, values });
        }
        let algebra = &mut self.algebra;
        let mut told = Substitution::of_parts(&algebra.graph, &self.responses_in_outputs);
        let implicit = algebra.apply(&mut told, &implicit)?;
        let mut actual = self.actual_accelerations().keeping_names();
        let values = self.algebra.apply(&mut actual, &implicit)?;
        Ok(Outputs { implicit, values })
    }

    /// Values for the symbols of accelerations and forces in outputs, in terms of symbols for ω̇.
    pub(super) fn named_in_outputs(&mut self, mechanism: &Mechanism) -> Outcome<Vec<(Expr, Expr)>> {
        let outputs = mechanism.outputs.iter().map(|output| &output.value);
        let wanted = named_in(&self.symbols, outputs);
        if wanted.is_empty() {
            return Ok(Vec::new());
        }
        let accelerations = self.symbols.accelerations.clone();
        let in_loads = self.reactions_in_loads.clone();
        self.answers(mechanism, &wanted, &accelerations, &in_loads)
    }

    /// Substitutes ω̇ for its symbols.
    fn actual_accelerations(&mut self) -> Substitution {
        let symbols = &self.symbols.accelerations;
        replacing(&self.algebra.graph, symbols, &self.motion.accelerations)
    }

    /// Derivatives of the outputs with respect to each list of variables, row by row:
    /// `∂y/∂z + ∂y/∂ω̇ ∂ω̇/∂z`.
    pub(super) fn output_slopes<const N: usize>(
        &mut self,
        outputs: &Outputs,
        variables: [&[Expr]; N],
    ) -> Outcome<[Vec<Expr>; N]> {
        let mut slopes = variables.map(|variables| self.slopes(&outputs.implicit, variables));
        if outputs.implicit == outputs.values {
            return Ok(slopes);
        }
        let accelerations = self.symbols.accelerations.clone();
        let along = self.slopes(&outputs.implicit, &accelerations);
        // Unnamed, since these derivatives contain symbols of ω̇, which are not displayed.
        let mut actual = self.actual_accelerations();
        let along = self.algebra.apply(&mut actual, &along)?;
        let rates = self.derivatives(variables)?;
        for ((slopes, rates), variables) in slopes.iter_mut().zip(&rates).zip(variables) {
            *slopes = self.algebra.apply(&mut actual, slopes)?;
            let graph = &mut self.algebra.graph;
            for (place, slope) in slopes.iter_mut().enumerate() {
                let (row, column) = (place / variables.len(), place % variables.len());
                let mut parts = vec![*slope];
                let own = &along[row * accelerations.len()..][..accelerations.len()];
                for (k, &by) in own.iter().enumerate() {
                    parts.push(graph.mul(by, rates[k * variables.len() + column]));
                }
                *slope = graph.sum(&parts);
            }
        }
        Ok(slopes)
    }

    /// Derivatives of values with respect to variables, row by row.
    pub(super) fn slopes(&mut self, values: &[Expr], variables: &[Expr]) -> Vec<Expr> {
        let mut slopes = Vec::with_capacity(values.len() * variables.len());
        for &value in values {
            for &variable in variables {
                slopes.push(self.algebra.derivative(value, variable));
            }
        }
        slopes
    }
}

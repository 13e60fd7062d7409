//! Adjoints of the equations of motion and of the outputs: gradients of weighted sums of the entries of the
//! Jacobians, by reverse accumulation.
//!
//! The gradient of a filter or of a shooting method needs second derivatives of the rates, but only as weighted
//! sums. One reverse sweep gives the gradient of such a sum in all variables.

use appell_runtime::model::ModelInfo;
use appell_spec::mechanism::Mechanism;

use super::Derivation;
use super::arguments::input_symbols;
use super::assemble::{listed, paired};
use super::finding::Outcome;
use super::symbols::ids;
use crate::program::{Array, Layout, Space};
use crate::symbolic::{Expr, gradient};

impl Derivation {
    /// The gradient of ⟨λ, ẋ⟩ + ⟨Λ, A⟩ + ⟨Γ, B⟩ + ⟨K, M⟩.
    pub(super) fn adjoint(&mut self, info: &ModelInfo) -> Outcome<Vec<Array>> {
        let speeds = &info.states[..info.speeds];
        let names = [
            listed("lambda", &info.states),
            paired("Lambda", &info.states, &info.states),
            paired("Gamma", &info.states, &info.inputs),
            paired("K", speeds, speeds),
        ];
        self.symbols.weights = self.new_symbols(&names.concat());
        let (states, inputs) = self.variables(info);
        let [a, b] = self.derivatives([&states, &inputs])?;
        let mass = self.gibbs.mass_matrix.concat();
        let weighted = [self.rates(), a, b, mass].concat();
        let weights = self.symbols.weights.clone();
        Ok(self.gradient_arrays(info, &weighted, &weights))
    }

    /// Outputs and their Jacobians with respect to states and inputs.
    pub(super) fn output_jacobians(
        &mut self,
        mechanism: &Mechanism,
        info: &ModelInfo,
    ) -> Outcome<Vec<Array>> {
        let values = self.output_values(mechanism)?;
        let outputs = self.outputs(mechanism)?;
        let (states, inputs) = self.variables(info);
        let [c, d] = self.output_slopes(&values, [&states, &inputs])?;
        let matrix = |name: &str, about: &str, by: Space, entries: Vec<Expr>| {
            let layout = Layout::Jacobian(Space::Outputs, by);
            let labels = paired(&name.to_uppercase(), &info.outputs, by.quantities(info));
            Array::new(name, about, layout, entries).labelled(labels.into_iter())
        };
        let c = matrix("c", "C = ∂y/∂x.", Space::State, c);
        let d = matrix("d", "D = ∂y/∂u.", Space::Inputs, d);
        Ok(outputs.into_iter().chain([c, d]).collect())
    }

    /// The gradient of ⟨μ, y⟩ + ⟨Γ, C⟩ + ⟨Δ, D⟩.
    pub(super) fn output_adjoint(
        &mut self,
        mechanism: &Mechanism,
        info: &ModelInfo,
    ) -> Outcome<Vec<Array>> {
        let names = [
            listed("mu", &info.outputs),
            paired("Gamma", &info.outputs, &info.states),
            paired("Delta", &info.outputs, &info.inputs),
        ];
        self.symbols.weights = self.new_symbols(&names.concat());
        let arrays = self.output_jacobians(mechanism, info)?;
        let weighted: Vec<Expr> = arrays.into_iter().flat_map(|array| array.entries).collect();
        if weighted.is_empty() {
            return Ok(Vec::new());
        }
        let weights = self.symbols.weights.clone();
        Ok(self.gradient_arrays(info, &weighted, &weights))
    }

    fn new_symbols(&mut self, names: &[String]) -> Vec<Expr> {
        let graph = &mut self.algebra.graph;
        names.iter().map(|name| graph.symbol(name)).collect()
    }

    fn variables(&self, info: &ModelInfo) -> (Vec<Expr>, Vec<Expr>) {
        let symbols = &self.symbols;
        let states = [symbols.speeds.as_slice(), &symbols.coordinates].concat();
        (states, input_symbols(symbols, info))
    }

    fn gradient_arrays(
        &mut self,
        info: &ModelInfo,
        values: &[Expr],
        weights: &[Expr],
    ) -> Vec<Array> {
        let (states, inputs) = self.variables(info);
        let parameters = self.symbols.parameters.clone();
        let graph = &mut self.algebra.graph;
        let variables = ids(graph, &[states, inputs, parameters].concat());
        let weighted: Vec<(Expr, Expr)> = values
            .iter()
            .copied()
            .zip(weights.iter().copied())
            .collect();
        let mut entries = gradient(graph, &weighted, &variables).into_iter();
        let parts = [
            ("x", "With respect to the state.", Space::State),
            ("u", "With respect to the inputs.", Space::Inputs),
            ("p", "With respect to the parameters.", Space::Parameters),
        ];
        let array = |(name, about, by): (&str, &str, Space)| {
            let quantities = by.quantities(info);
            let entries: Vec<Expr> = entries.by_ref().take(quantities.len()).collect();
            Array::new(name, about, Layout::Vector(by), entries)
                .labelled(listed("by", quantities).into_iter())
        };
        parts.map(array).into()
    }
}

//! Models written by hand for the tests.

use appell_runtime::model::{At, Energies, List, Model, ModelInfo, Quantity, Text};
use std::borrow::Cow;

/// Rates, the only part of a model that differs between the tests.
pub(crate) type Rates = fn(At<'_>, &mut [f64]);

/// A model that knows nothing but its rates; its kinetic energy is half the square of state 0
/// and its outputs are the first states.
pub(crate) struct HandWritten {
    pub(crate) info: ModelInfo,
    pub(crate) rates: Rates,
}

impl Model for HandWritten {
    fn info(&self) -> &ModelInfo {
        &self.info
    }
    fn rates(&self, at: At<'_>, rates: &mut [f64]) {
        (self.rates)(at, rates);
    }
    fn jacobians(&self, _: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
        rates.fill(f64::NAN);
        a.fill(f64::NAN);
        b.fill(f64::NAN);
    }
    fn parameter_jacobian(&self, _: At<'_>, p: &mut [f64]) {
        p.fill(f64::NAN);
    }
    fn appell(&self, _: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
        mass.fill(f64::NAN);
        bias.fill(f64::NAN);
        forces.fill(f64::NAN);
    }
    fn energies(&self, at: At<'_>) -> Energies {
        Energies {
            kinetic: 0.5 * at.x[0] * at.x[0],
            ..Energies::default()
        }
    }
    fn constraint_residual(&self, _: At<'_>, residual: &mut [f64]) {
        residual.fill(0.0);
    }
    fn constraint_forces(&self, _: At<'_>, forces: &mut [f64]) {
        forces.fill(0.0);
    }
    fn outputs(&self, at: At<'_>, outputs: &mut [f64]) {
        outputs.copy_from_slice(&at.x[..outputs.len()]);
    }
}

/// A quantity in SI without limits.
pub(crate) const fn si(name: &'static str, unit: &'static str, value: f64) -> Quantity {
    in_unit(name, unit, 1.0, value)
}

/// A quantity whose unit is `scale` in SI.
pub(crate) const fn in_unit(
    name: &'static str,
    unit: &'static str,
    scale: f64,
    value: f64,
) -> Quantity {
    Quantity {
        name: text(name),
        about: text(""),
        unit: text(unit),
        scale,
        value,
        range: [f64::NEG_INFINITY, f64::INFINITY],
    }
}

const fn text(text: &'static str) -> Text {
    Cow::Borrowed(text)
}

/// Names and sizes; whatever a test needs besides is set there.
pub(crate) fn info(
    name: &'static str,
    states: impl Into<List<Quantity>>,
    speeds: usize,
    inputs: impl Into<List<Quantity>>,
    parameters: impl Into<List<Quantity>>,
) -> ModelInfo {
    let inputs = inputs.into();
    ModelInfo {
        name: text(name),
        title: text(""),
        source: text(""),
        states: states.into(),
        speeds,
        declared_inputs: inputs.len(),
        inputs,
        signals: List::default(),
        signal_inputs: List::default(),
        parameters: parameters.into(),
        outputs: List::default(),
        constraint_rows: List::default(),
        reactions: List::default(),
        contacts: List::default(),
        explicit_time: false,
    }
}

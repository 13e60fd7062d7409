//! A mechanism at one place in state space, with its quantities by name.

use appell_codegen::interpreted::InterpretedModel;
use appell_runtime::model::Model;

use crate::engine::{Evaluation, assert_close};
use crate::point::Point;
use appell_test_kit::Random;

/// A mechanism at a place.
pub struct Place<'a> {
    /// The mechanism.
    pub model: &'a InterpretedModel,
    /// The place.
    pub point: Point,
}

impl<'a> Place<'a> {
    /// A mechanism at a random place.
    pub fn random(model: &'a InterpretedModel, random: &mut Random) -> Self {
        let point = Point::random(model.info(), random);
        Self { model, point }
    }

    /// A state, input or parameter by name, if there is one.
    fn value(&mut self, name: &str) -> Option<&mut f64> {
        let (info, point) = (self.model.info(), &mut self.point);
        if let Some(i) = info.state_index(name) {
            return point.x.get_mut(i);
        }
        if let Some(i) = info.input_index(name) {
            return point.u.get_mut(i);
        }
        info.parameter_index(name).and_then(|i| point.p.get_mut(i))
    }

    /// A state, input or parameter by name.
    pub fn get(&mut self, name: &str) -> f64 {
        *self.value(name).unwrap_or_else(|| panic!("no `{name}`"))
    }

    /// Several of them.
    pub fn all<const N: usize>(&mut self, names: [&str; N]) -> [f64; N] {
        names.map(|name| self.get(name))
    }

    /// Changes states, inputs and parameters.
    pub fn set(&mut self, values: &[(&str, f64)]) {
        for &(name, value) in values {
            *self.value(name).unwrap_or_else(|| panic!("no `{name}`")) = value;
        }
    }

    /// Gives every quantity that another place has under the same name that value.
    pub fn follow(&mut self, other: &mut Place<'_>) {
        let info = self.model.info();
        let quantities = info.states.iter().chain(&*info.inputs);
        let names: Vec<String> = quantities
            .chain(&*info.parameters)
            .map(|quantity| quantity.name.to_string())
            .collect();
        for name in names {
            if let Some(&mut value) = other.value(&name) {
                self.set(&[(&name, value)]);
            }
        }
    }

    /// Everything the model computes here.
    pub fn evaluate(&self) -> Evaluation {
        Evaluation::of(self.model, self.point.at())
    }

    /// Rates of states by name.
    pub fn rates<const N: usize>(&self, names: [&str; N]) -> [f64; N] {
        let rates = self.evaluate().rates;
        names.map(|name| rates[self.index(name)])
    }

    /// The place of a state in the vector of all.
    pub fn index(&self, name: &str) -> usize {
        let index = self.model.info().state_index(name);
        index.unwrap_or_else(|| panic!("no state `{name}`"))
    }

    /// Appell's equations M ω̇ + b = Π in the speeds `own = factor * other`, which are all that
    /// move: M, b, Π of their rows, one after the other, as equations in the other speeds.
    pub fn equations(&self, speeds: &[(&str, f64)]) -> Vec<f64> {
        let e = self.evaluate();
        let count = self.model.info().speeds;
        let mut numbers = Vec::new();
        for &(row, factor) in speeds {
            let i = self.index(row);
            for &(column, other) in speeds {
                let entry = e.mass_matrix[i * count + self.index(column)];
                numbers.push(factor * other * entry);
            }
            numbers.push(factor * e.bias[i]);
            numbers.push(factor * e.forces[i]);
        }
        numbers
    }
}

/// Demands that a mechanism, in some of its speeds, has the equations of a simpler one. Each line is
/// the speed of the general mechanism, that of the special one, and what the first is in the second.
pub fn assert_contains(
    what: &str,
    general: &Place<'_>,
    special: &Place<'_>,
    speeds: &[(&str, &str, f64)],
    tolerance: f64,
) {
    let own: Vec<(&str, f64)> = speeds
        .iter()
        .map(|&(own, _, factor)| (own, factor))
        .collect();
    let other: Vec<(&str, f64)> = speeds.iter().map(|&(_, other, _)| (other, 1.0)).collect();
    assert_eq!(other.len(), special.model.info().speeds, "{what}: speeds");
    let (own, other) = (general.equations(&own), special.equations(&other));
    assert_close(what, &own, &other, tolerance, 1e-3);
}

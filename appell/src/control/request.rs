//! A request for gains, in texts with units.

use appell_runtime::model::Model;

use super::ask;
use super::design::{self, Design, Goal, Method};
use crate::Error;
use crate::setup::{Assignment, Setup};

/// What is asked for. Without poles or weights nothing is designed, and the answer tells only what the
/// inputs reach.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Parameters; the others are those of the spec.
    pub parameters: Vec<Assignment>,
    /// States or inputs on the steady motion, or what they follow from: outputs, rates of hidden coordinates.
    pub at: Vec<Assignment>,
    /// The inputs that the law may use; none for all.
    pub inputs: Vec<String>,
    /// The states that are fed back; none for as many as the inputs reach, coordinates first.
    pub outputs: Vec<String>,
    /// Poles of the closed loop in 1/s, such as `-8,-2+3i,-2-3i`; a single one is for all.
    pub poles: Option<String>,
    /// Weights of a linear-quadratic regulator, such as `Q=1,10,R=0.1`; a single number is for all.
    pub weights: Option<String>,
    /// Interval between measurements in ms, for a sampled controller.
    pub sampled_ms: Option<f64>,
    /// Delay from a measurement to its effect in ms.
    pub delay_ms: Option<f64>,
}

impl Request {
    /// Gives a parameter another value.
    #[must_use]
    pub fn set(mut self, name: &str, value: impl ToString) -> Self {
        self.parameters.push(Assignment::new(name, value));
        self
    }

    /// Gives a quantity a value on the steady motion.
    #[must_use]
    pub fn at(mut self, name: &str, value: impl ToString) -> Self {
        self.at.push(Assignment::new(name, value));
        self
    }

    /// Feeds these states back.
    #[must_use]
    pub fn outputs(mut self, names: &[&str]) -> Self {
        self.outputs = names.iter().map(ToString::to_string).collect();
        self
    }

    /// Places the poles of the closed loop.
    #[must_use]
    pub fn poles(mut self, poles: &str) -> Self {
        self.poles = Some(poles.to_owned());
        self
    }

    /// Weighs outputs and inputs, for optimal gains.
    #[must_use]
    pub fn weights(mut self, weights: &str) -> Self {
        self.weights = Some(weights.to_owned());
        self
    }

    /// The goal with its names resolved.
    pub fn resolve(&self, setup: &Setup<'_>) -> Result<Goal, Error> {
        let inputs = if self.inputs.is_empty() {
            (0..setup.info.declared_inputs).collect()
        } else {
            ask::distinct("--inputs", &self.inputs, |name| setup.input(name))?
        };
        if inputs.is_empty() {
            return Err(Error::Usage(
                "the mechanism has no input; declare one under `[inputs]` of the spec".to_owned(),
            ));
        }
        let outputs = ask::distinct("--outputs", &self.outputs, |name| setup.state(name))?;
        let method = match (&self.poles, &self.weights) {
            (Some(poles), _) => Method::Poles(ask::poles(poles)?),
            (None, Some(weights)) => ask::weights(weights)?,
            (None, None) => Method::None,
        };
        Ok(Goal {
            inputs,
            outputs,
            method,
            sampling: ask::sampling(self.sampled_ms, self.delay_ms)?,
        })
    }

    /// The design for a model, with the numbers of its spec.
    pub(crate) fn design(&self, model: &dyn Model, mut setup: Setup<'_>) -> Result<Design, Error> {
        setup.set(&self.parameters)?;
        let goal = self.resolve(&setup)?;
        let at = ask::point(model, &mut setup, &self.at)?;
        design::design(model, &setup, &at, &goal)
    }
}

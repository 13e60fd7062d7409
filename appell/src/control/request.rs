//! A request for a controller, in texts with units.

use appell_runtime::model::{At, Model};

use super::design::{self, Design, Goal, Method};
use super::parse;
use crate::setup::{Assignment, Setup, assigning};
use crate::{Error, Field};

/// A request for a controller. Without poles or weights no law is designed, and only controllability is
/// determined.
#[derive(Debug, Clone, Default)]
pub struct Request {
    /// Parameters; the others are those of the spec.
    pub parameters: Vec<Assignment>,
    /// States or inputs on the steady motion, or quantities that determine them: outputs, rates of
    /// ignorable coordinates.
    pub at: Vec<Assignment>,
    /// The inputs that the law may use; empty for all.
    pub inputs: Vec<String>,
    /// The states that are fed back, or outputs of the spec for the states that these depend on; empty for a
    /// controllable set, coordinates first.
    pub outputs: Vec<String>,
    /// Closed-loop poles in 1/s, such as `-8,-2+3i,-2-3i`; a single one is used for all.
    pub poles: Option<String>,
    /// Weights of a linear-quadratic regulator, such as `Q=1,10,R=0.1`; a single number is used for all.
    pub weights: Option<String>,
    /// Sampling period in ms, for a discrete-time controller.
    pub sampled_ms: Option<f64>,
    /// Delay from a measurement to its effect in ms.
    pub delay_ms: Option<f64>,
}

impl Request {
    assigning! {
        /// Sets a parameter.
        set to parameters;
        /// Prescribes a quantity on the steady motion.
        at to at;
    }

    /// Chooses the inputs that the law may use.
    #[must_use]
    pub fn inputs(mut self, names: &[&str]) -> Self {
        self.inputs = names.iter().map(ToString::to_string).collect();
        self
    }

    /// Samples the controller, with a delay from a measurement to its effect, in ms.
    #[must_use]
    pub fn sampled(mut self, period_ms: f64, delay_ms: f64) -> Self {
        (self.sampled_ms, self.delay_ms) = (Some(period_ms), Some(delay_ms));
        self
    }

    /// Chooses the states that are fed back.
    #[must_use]
    pub fn outputs(mut self, names: &[&str]) -> Self {
        self.outputs = names.iter().map(ToString::to_string).collect();
        self
    }

    /// Places the closed-loop poles.
    #[must_use]
    pub fn poles(mut self, poles: &str) -> Self {
        self.poles = Some(poles.to_owned());
        self
    }

    /// Weights outputs and inputs, for a linear-quadratic regulator.
    #[must_use]
    pub fn weights(mut self, weights: &str) -> Self {
        self.weights = Some(weights.to_owned());
        self
    }

    /// The request with its names resolved.
    pub fn resolve(&self, model: &dyn Model, setup: &Setup<'_>) -> Result<Goal, Error> {
        let inputs = if self.inputs.is_empty() {
            (0..setup.info.declared_inputs).collect()
        } else {
            parse::distinct(Field::Inputs, &self.inputs, |name| {
                setup.input(Field::Inputs, name)
            })?
        };
        if inputs.is_empty() {
            let message = "the mechanism has no input; declare one under `[inputs]` of the spec";
            return Err(Error::request(Field::Inputs, message));
        }
        let outputs = fed_back(model, setup, &self.outputs)?;
        let method = match (&self.poles, &self.weights) {
            (Some(_), Some(_)) => {
                let message = "a law has poles or weights, not both";
                return Err(Error::request(Field::Weights, message));
            }
            (Some(poles), None) => Method::Poles(parse::poles(poles)?),
            (None, Some(weights)) => parse::weights(weights)?,
            (None, None) => Method::None,
        };
        Ok(Goal {
            inputs,
            outputs,
            method,
            sampling: parse::sampling(self.sampled_ms, self.delay_ms)?,
        })
    }

    /// The design for a model, with the values of its spec.
    pub(crate) fn design(&self, model: &dyn Model, mut setup: Setup<'_>) -> Result<Design, Error> {
        setup.set(&self.parameters)?;
        let goal = self.resolve(model, &setup)?;
        let at = parse::point(model, &mut setup, &self.at, None)?;
        design::design(model, &setup, &at, &goal)
    }
}

/// The states that are fed back: those of the list, and those on which outputs of the list depend.
fn fed_back(model: &dyn Model, setup: &Setup<'_>, names: &[String]) -> Result<Vec<usize>, Error> {
    let info = setup.info;
    let mut states = Vec::new();
    let mut from_outputs = Vec::new();
    for name in names {
        match info.output_index(name.trim()) {
            Some(output) if info.state_index(name.trim()).is_none() => {
                let of_output = dependences(model, setup, output);
                if of_output.is_empty() {
                    let message = format!("the output `{name}` depends on no state");
                    return Err(Error::request(Field::Outputs, message));
                }
                from_outputs.extend(of_output);
            }
            _ => states.push(name.clone()),
        }
    }
    let mut all = parse::distinct(Field::Outputs, &states, |name| {
        setup.state(Field::Outputs, name)
    })?;
    for state in from_outputs {
        if !all.contains(&state) {
            all.push(state);
        }
    }
    Ok(all)
}

/// The states on which an output depends near the initial state.
fn dependences(model: &dyn Model, setup: &Setup<'_>, output: usize) -> Vec<usize> {
    /// Departures from the initial state in SI: several, as a slope may vanish at one.
    const DEPARTURES: [f64; 3] = [0.0, 0.013, -0.027];
    let info = setup.info;
    let (n, m, l) = (info.state_len(), info.input_len(), info.output_len());
    let (mut y, mut c, mut d) = (vec![0.0; l], vec![0.0; l * n], vec![0.0; l * m]);
    let u = vec![0.0; m];
    let mut felt = vec![false; n];
    for departure in DEPARTURES {
        let x: Vec<f64> = setup.initial.iter().map(|x| x + departure).collect();
        let at = At {
            t: 0.0,
            x: &x,
            u: &u,
            p: &setup.parameters,
        };
        model.output_jacobians(at, &mut y, &mut c, &mut d);
        for (felt, slope) in felt.iter_mut().zip(&c[output * n..]) {
            *felt |= *slope != 0.0;
        }
    }
    (0..n).filter(|&state| felt[state]).collect()
}

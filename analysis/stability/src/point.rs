//! State, inputs and parameters at which a model is evaluated.

use appell_runtime::model::{At, Model};
use appell_runtime::signal::Signal;

/// State, inputs and parameters in SI, in the order of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// State.
    pub x: Vec<f64>,
    /// Inputs, then signals and their rates.
    pub u: Vec<f64>,
    /// Parameters.
    pub p: Vec<f64>,
}

impl Point {
    /// Initial state and parameters of the spec, inputs zero, signals as they begin and at rest.
    pub fn initial(model: &dyn Model) -> Self {
        let info = model.info();
        let mut u = vec![0.0; info.input_len()];
        let signals = info.signal_inputs.iter();
        for (u, &(signal, order)) in u[info.declared_inputs..].iter_mut().zip(signals) {
            if let (0, Some(Ok(signal))) = (order, info.signals.get(signal).map(Signal::new)) {
                *u = signal.value(0.0);
            }
        }
        Self {
            x: info.initial_state(),
            u,
            p: info.default_parameters(),
        }
    }

    /// As an argument of a model.
    pub fn at(&self) -> At<'_> {
        At {
            t: 0.0,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }

    /// ẋ at this point.
    pub fn rates(&self, model: &dyn Model) -> Vec<f64> {
        let mut rates = vec![0.0; self.x.len()];
        model.rates(self.at(), &mut rates);
        rates
    }

    /// Outputs at this point.
    pub fn outputs(&self, model: &dyn Model) -> Vec<f64> {
        let mut outputs = vec![0.0; model.info().output_len()];
        model.outputs(self.at(), &mut outputs);
        outputs
    }
}

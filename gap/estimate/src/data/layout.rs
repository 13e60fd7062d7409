//! Order of the values on which a likelihood depends, in one list.

use super::setup::Setup;
use super::unknown::Unknown;
use crate::error::EstimateError;

/// Index of each value: parameters, disturbances, noise, biases, scales and delays of the channels,
/// lags, delays of inputs; then for each run the expected initial state and its spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    pub(crate) parameters: usize,
    pub(crate) disturbances: usize,
    pub(crate) channels: usize,
    pub(crate) lags: usize,
    pub(crate) delays: usize,
    pub(crate) states: usize,
    pub(crate) runs: usize,
}

impl Layout {
    pub(crate) fn of(setup: &Setup<'_>, runs: usize) -> Self {
        Self {
            parameters: setup.model.info().parameter_len(),
            disturbances: setup.disturbances.len(),
            channels: setup.channels.len(),
            lags: setup.lag_len(),
            delays: setup.delayed.len(),
            states: setup.state_len(),
            runs,
        }
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        self.first_run() + 2 * self.runs * self.states
    }

    /// Whether it is empty, which it never is.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Index of a value; an error if it does not exist.
    pub fn place(&self, unknown: Unknown) -> Result<usize, EstimateError> {
        let (what, index, len, start) = match unknown {
            Unknown::Parameter(i) => ("parameter", i, self.parameters, 0),
            Unknown::Disturbance(i) => ("disturbance", i, self.disturbances, self.parameters),
            Unknown::Noise(i) => ("channel", i, self.channels, self.channel(0, 0)),
            Unknown::Bias(i) => ("channel", i, self.channels, self.channel(1, 0)),
            Unknown::Scale(i) => ("channel", i, self.channels, self.channel(2, 0)),
            Unknown::SensorDelay(i) => ("channel", i, self.channels, self.channel(3, 0)),
            Unknown::Lag(i) => ("lag", i, self.lags, self.lag(0)),
            Unknown::InputDelay(i) => ("delay", i, self.delays, self.input_delay(0)),
            Unknown::Initial { run, .. } | Unknown::Spread { run, .. } if run >= self.runs => {
                ("run", run, self.runs, 0)
            }
            Unknown::Initial { run, state } => ("state", state, self.states, self.initial(run)),
            Unknown::Spread { run, state } => ("state", state, self.states, self.spread(run)),
        };
        let error = EstimateError::Unknown { what, index, len };
        (index < len).then_some(start + index).ok_or(error)
    }

    pub(crate) fn disturbance(&self, index: usize) -> usize {
        self.parameters + index
    }

    fn channel(&self, kind: usize, index: usize) -> usize {
        self.parameters + self.disturbances + kind * self.channels + index
    }

    pub(crate) fn noise(&self, channel: usize) -> usize {
        self.channel(0, channel)
    }

    pub(crate) fn bias(&self, channel: usize) -> usize {
        self.channel(1, channel)
    }

    pub(crate) fn scale(&self, channel: usize) -> usize {
        self.channel(2, channel)
    }

    pub(crate) fn sensor_delay(&self, channel: usize) -> usize {
        self.channel(3, channel)
    }

    pub(crate) fn lag(&self, index: usize) -> usize {
        self.channel(4, index)
    }

    pub(crate) fn input_delay(&self, index: usize) -> usize {
        self.lag(self.lags) + index
    }

    fn first_run(&self) -> usize {
        self.input_delay(self.delays)
    }

    pub(crate) fn initial(&self, run: usize) -> usize {
        self.first_run() + 2 * run * self.states
    }

    pub(crate) fn spread(&self, run: usize) -> usize {
        self.initial(run) + self.states
    }
}

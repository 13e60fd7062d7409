//! Where the numbers that a likelihood depends on stand in one list.

use super::error::EstimateError;
use super::setup::Setup;
use super::unknown::Unknown;

/// Where each number stands: parameters, disturbances, noise, biases, scales and delays of the
/// channels, lags, delays of inputs; then for each run the expected initial state and its spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    pub(super) parameters: usize,
    pub(super) disturbances: usize,
    pub(super) channels: usize,
    pub(super) lags: usize,
    pub(super) delays: usize,
    pub(super) states: usize,
    pub(super) runs: usize,
}

impl Layout {
    pub(super) fn of(setup: &Setup<'_>, runs: usize) -> Self {
        Self {
            parameters: setup.model.info().parameter_len(),
            disturbances: setup.disturbances.len(),
            channels: setup.channels.len(),
            lags: setup.lagging.len(),
            delays: setup.delayed.len(),
            states: setup.state_len(),
            runs,
        }
    }

    /// How many numbers there are.
    pub fn len(&self) -> usize {
        self.first_run() + 2 * self.runs * self.states
    }

    /// Whether there are none, which cannot be.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Place of a number; an error where there is no such thing.
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

    pub(super) fn disturbance(&self, index: usize) -> usize {
        self.parameters + index
    }

    fn channel(&self, kind: usize, index: usize) -> usize {
        self.parameters + self.disturbances + kind * self.channels + index
    }

    pub(super) fn noise(&self, channel: usize) -> usize {
        self.channel(0, channel)
    }

    pub(super) fn bias(&self, channel: usize) -> usize {
        self.channel(1, channel)
    }

    pub(super) fn scale(&self, channel: usize) -> usize {
        self.channel(2, channel)
    }

    pub(super) fn sensor_delay(&self, channel: usize) -> usize {
        self.channel(3, channel)
    }

    pub(super) fn lag(&self, index: usize) -> usize {
        self.channel(4, index)
    }

    pub(super) fn input_delay(&self, index: usize) -> usize {
        self.lag(self.lags) + index
    }

    fn first_run(&self) -> usize {
        self.input_delay(self.delays)
    }

    pub(super) fn initial(&self, run: usize) -> usize {
        self.first_run() + 2 * run * self.states
    }

    pub(super) fn spread(&self, run: usize) -> usize {
        self.initial(run) + self.states
    }
}

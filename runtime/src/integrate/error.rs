//! Why an integration could not be completed.

use std::fmt::Write as _;

/// The time, the state and the reason of a failed integration. Times in s, states in SI.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The rates stopped being numbers, however short the step, or the start is none.
    #[error(
        "state {component} or its rate is not finite at t = {t} s, x = {}",
        list(state)
    )]
    NonFinite {
        /// Last time with finite rates.
        t: f64,
        /// State at that time.
        state: Vec<f64>,
        /// The first state whose rate, or whose value, is infinite or not a number.
        component: usize,
    },
    /// The tolerances ask for a step that no longer changes the time.
    #[error(
        "the step shrank to {h} s at t = {t} s, x = {}: the motion is singular there, or stiffer than this method can follow",
        list(state)
    )]
    StepTooSmall {
        /// Time of the last accepted step.
        t: f64,
        /// The step that would have been needed, in s.
        h: f64,
        /// State at that time.
        state: Vec<f64>,
    },
    /// The limit on the number of steps was reached.
    #[error(
        "{steps} steps were not enough: stopped at t = {t} s, x = {}",
        list(state)
    )]
    TooManySteps {
        /// Time of the last accepted step.
        t: f64,
        /// Accepted and rejected steps.
        steps: usize,
        /// State at that time.
        state: Vec<f64>,
    },
    /// A coordinate left the range in which the equations are declared to hold.
    #[error("state {coordinate} leaves its range {} … {} at t = {t} s: {value}", range[0], range[1])]
    OutOfRange {
        /// When it reached the limit.
        t: f64,
        /// Index in the state.
        coordinate: usize,
        /// Its value then, in SI.
        value: f64,
        /// Lower and upper limit in SI.
        range: [f64; 2],
        /// State at that time.
        state: Vec<f64>,
    },
    /// A request that has no answer, such as an interval that ends before it begins.
    #[error("{what} cannot be {value}")]
    InvalidArgument {
        /// Name of the argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

impl IntegrationError {
    /// The time at which the integration ended; NaN for an invalid argument.
    pub fn time(&self) -> f64 {
        match self {
            Self::NonFinite { t, .. }
            | Self::StepTooSmall { t, .. }
            | Self::TooManySteps { t, .. }
            | Self::OutOfRange { t, .. } => *t,
            Self::InvalidArgument { .. } => f64::NAN,
        }
    }

    /// The state at which the integration ended; empty for an invalid argument.
    pub fn state(&self) -> &[f64] {
        match self {
            Self::NonFinite { state, .. }
            | Self::StepTooSmall { state, .. }
            | Self::TooManySteps { state, .. }
            | Self::OutOfRange { state, .. } => state,
            Self::InvalidArgument { .. } => &[],
        }
    }
}

fn list(values: &[f64]) -> String {
    let mut text = String::from("[");
    for (i, value) in values.iter().enumerate() {
        let separator = if i == 0 { "" } else { ", " };
        // Writing to a string cannot fail.
        let _ = write!(text, "{separator}{value:.6}");
    }
    text + "]"
}

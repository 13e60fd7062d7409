//! Why an integration could not be completed.

use super::events::EventHit;
use super::outcome::Statistics;
use std::fmt::Write as _;

/// Why there is no [`Outcome`](super::Outcome).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// An invalid argument, such as an interval that ends before it begins.
    #[error("{what} cannot be {value}")]
    InvalidArgument {
        /// Name of the argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The motion cannot be continued.
    #[error(transparent)]
    Failure(#[from] Failure),
}

/// A motion that cannot be continued: the cause, the time and the state reached.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("at t = {t} s, x = {}: {cause}", list(state))]
pub struct Failure {
    /// The reason.
    pub cause: Cause,
    /// Last time of the motion, in s.
    pub t: f64,
    /// State at that time, in SI.
    pub state: Vec<f64>,
    /// Events located until then, in the order of time.
    pub hits: Vec<EventHit>,
    /// Statistics up to that time.
    pub statistics: Statistics,
}

/// The reason of a failure.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Cause {
    /// The rates are not finite, however short the step, or the initial state is not.
    #[error("state {component} or its rate is not finite")]
    NonFinite {
        /// The first state whose rate, or whose value, is infinite or not a number.
        component: usize,
    },
    /// The tolerances require a step that no longer changes the time.
    #[error(
        "the step shrank to {h} s; the motion is singular here, or stiffer than this method can follow"
    )]
    StepTooSmall {
        /// The step that would have been needed, in s.
        h: f64,
    },
    /// The equations switch infinitely often within a finite time (Zeno behaviour or chattering).
    #[error(
        "the equations are switched to and fro without end, by time ever faster or because what they switch drives the \
         motion back to where it is switched; smooth it, as `smooth_sign` does"
    )]
    Chattering,
    /// The limit on the number of steps was reached.
    #[error("the limit of {steps} steps was reached")]
    TooManySteps {
        /// Accepted and rejected steps.
        steps: usize,
    },
    /// The position constraints have no solution near the state.
    #[error("the position constraints cannot be satisfied any longer")]
    Inconsistent,
    /// A state left the range in which the equations are declared to hold.
    #[error("state {component} leaves its range {} … {}", range[0], range[1])]
    OutOfRange {
        /// Index in the state.
        component: usize,
        /// Lower and upper limit in SI.
        range: [f64; 2],
    },
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

//! Initial value problems ẋ = f(t, x).
//!
//! [`Solver`] runs the embedded pairs [`Dop853`] and [`Dopri5`] with step-size control, [`Rk4`]
//! keeps a fixed step. All of them interpolate between steps, find events, land exactly on
//! switching times and end with a typed error where the motion cannot be continued.
//!
//! ```
//! use appell_runtime::integrate::{Dop853, NoObserver, Options, Solver, Watch};
//!
//! let mut x = [1.0, 0.0];
//! let oscillator = |_: f64, x: &[f64], rates: &mut [f64]| {
//!     rates[0] = x[1];
//!     rates[1] = -x[0];
//! };
//! let span = [0.0, std::f64::consts::TAU];
//! let options = Options::default();
//! Solver::<Dop853>::new()
//!     .integrate(oscillator, span, &mut x, &options, &mut Watch::default(), &mut NoObserver)?;
//! assert!((x[0] - 1.0).abs() < 1e-8);
//! # Ok::<(), appell_runtime::integrate::IntegrationError>(())
//! ```

mod dense_output;
mod dop853_coefficients;
mod error;
mod events;
mod pairs;
mod range;
mod rk4;
mod solver;
mod step_size;
mod stops;
mod tableau;
mod watch;

pub use dense_output::DenseOutput;
pub use error::{Cause, Failure, IntegrationError};
pub use events::{Direction, Event, EventFunction, EventHit};
pub use pairs::{Dop853, Dopri5, EmbeddedPair};
pub use range::Range;
pub use rk4::Rk4;
pub use solver::Solver;
pub use stops::{SwitchFunction, Switches};
pub use watch::{Ending, NoObserver, Observer, Projection, ProjectionFunction, Step, Watch};

/// Accuracy and limits of an adaptive integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Tolerated error per step relative to each state.
    pub rtol: f64,
    /// Tolerated error per step of states near zero, in SI.
    pub atol: f64,
    /// First step in s; chosen from the rates where absent.
    pub first_step: Option<f64>,
    /// Longest step in s. The last step before a switching time or the end may be 1 % longer.
    pub max_step: f64,
    /// Accepted and rejected steps after which the integration is given up.
    pub max_steps: usize,
}

impl Default for Options {
    /// Nine digits, a million steps.
    fn default() -> Self {
        Self {
            rtol: 1e-9,
            atol: 1e-9,
            first_step: None,
            max_step: f64::INFINITY,
            max_steps: 1_000_000,
        }
    }
}

impl Options {
    /// The default limits with other tolerances.
    pub fn with_tolerances(rtol: f64, atol: f64) -> Self {
        Self {
            rtol,
            atol,
            ..Self::default()
        }
    }

    /// The tolerated error of a state of this size; never zero, so that a state that stays zero
    /// has no error even without `atol`.
    fn scale(&self, size: f64) -> f64 {
        (self.atol + self.rtol * size).max(f64::MIN_POSITIVE)
    }

    fn check(&self, span: [f64; 2]) -> Result<(), IntegrationError> {
        let invalid = |what, value| Err(IntegrationError::InvalidArgument { what, value });
        if self.rtol.is_nan() || self.rtol < 0.0 {
            return invalid("rtol", self.rtol);
        }
        if self.atol.is_nan() || self.atol < 0.0 || self.atol + self.rtol == 0.0 {
            return invalid("atol", self.atol);
        }
        if self.max_step.is_nan() || self.max_step <= 0.0 {
            return invalid("max_step", self.max_step);
        }
        if let Some(h) = self.first_step.filter(|h| h.is_nan() || *h <= 0.0) {
            return invalid("first_step", h);
        }
        check_span(span)
    }
}

fn check_span([start, end]: [f64; 2]) -> Result<(), IntegrationError> {
    if !start.is_finite() {
        return Err(IntegrationError::InvalidArgument {
            what: "start of the interval",
            value: start,
        });
    }
    if !end.is_finite() || end < start {
        return Err(IntegrationError::InvalidArgument {
            what: "end of the interval",
            value: end,
        });
    }
    Ok(())
}

/// What an integration cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: usize,
    /// Rejected steps.
    pub rejected: usize,
    /// Evaluations of the rates.
    pub evaluations: usize,
}

/// How an integration ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Why it ended.
    pub ending: Ending,
    /// When it ended, in s.
    pub t: f64,
    /// Events found, in the order of time.
    pub hits: Vec<EventHit>,
    /// Its cost.
    pub statistics: Statistics,
}

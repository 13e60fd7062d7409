//! Simulation of a model with given inputs.

mod describe;
mod prepared;
mod recorder;
mod switches;
mod validity;

use crate::inputs::{InputSource, ModelInputs, ZeroInputs};
use crate::integrate::{
    BlockMotion, Cause, Dop853, Dopri5, Ending, Event, EventHit, Failure, IntegrationError,
    Observer, Options, Outcome, Rk4, SharedTimes, Solver, Statistics, Watch,
};
use crate::model::{At, Model};
use crate::positions::Inconsistent;
use crate::signal::SignalError;
use crate::trajectory::{Extras, Trajectory};
pub use describe::describe;
use prepared::projection;
pub use prepared::{Prepared, Viewer, observe_together};
pub use recorder::{Recorder, Sampling};
pub use validity::{Breach, Limit, Response, Validity};

/// Integration methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Dormand–Prince of order 8 with step-size control.
    Dop853,
    /// Dormand–Prince of order 5 with step-size control.
    Dopri5,
    /// Runge–Kutta of order 4 with a fixed step; the tolerances are ignored.
    Rk4 {
        /// The step in s.
        step: f64,
    },
}

/// A simulation to be run. Its fields are public; [`Simulation::new`] sets defaults.
pub struct Simulation<'a> {
    /// Equations of motion.
    pub model: &'a dyn Model,
    /// Parameters in SI.
    pub parameters: Vec<f64>,
    /// State at the start in SI.
    pub initial_state: Vec<f64>,
    /// The declared inputs.
    pub inputs: &'a dyn InputSource,
    /// Start and end in s.
    pub span: [f64; 2],
    /// The integrator.
    pub method: Method,
    /// Its tolerances and limits.
    pub options: Options,
    /// Recording times.
    pub sampling: Sampling,
    /// Columns recorded in addition to states and inputs.
    pub extras: Extras,
    /// Response to states at which the model is not valid.
    pub validity: Validity,
    /// Event functions.
    pub events: Vec<Event<'a>>,
    /// Called with the time in s after each step.
    pub progress: Option<Box<dyn FnMut(f64) + 'a>>,
}

impl std::fmt::Debug for Simulation<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Simulation")
            .field("model", &self.model.info().name)
            .field("parameters", &self.parameters)
            .field("initial_state", &self.initial_state)
            .field("span", &self.span)
            .field("method", &self.method)
            .field("options", &self.options)
            .field("sampling", &self.sampling)
            .finish_non_exhaustive()
    }
}

/// The result of a simulation with an observer.
#[derive(Debug, Clone)]
pub struct Observed {
    /// Final time in s.
    pub t: f64,
    /// Final state, in SI.
    pub state: Vec<f64>,
    /// Why it ended.
    pub ending: Result<Ending, Cause>,
    /// Events located, in the order of time.
    pub events: Vec<EventHit>,
    /// Limits of the model that it exceeds.
    pub breaches: Vec<Breach>,
    /// Statistics of the integration.
    pub statistics: Statistics,
}

/// Why there is no complete trajectory.
#[derive(Debug, Clone, thiserror::Error)]
pub enum SimulationError {
    /// A table of the model is not a valid function of time.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// The length of a vector does not match the model.
    #[error("{what}: {found} numbers given, {expected} needed")]
    Length {
        /// Name of the vector.
        what: &'static str,
        /// Length of the model's vector.
        expected: usize,
        /// Length of the given vector.
        found: usize,
    },
    /// The initial state contradicts the position constraints.
    #[error("{message}")]
    Inconsistent {
        /// Residual of the constraints.
        source: Inconsistent,
        /// Description in the names of the mechanism, with a remedy.
        message: String,
    },
    /// The pseudo-velocities do not determine the generalised velocities at the start.
    #[error(
        "at the start the pseudo-velocities do not determine the generalised velocities (condition number \
         {condition:.1e}): start elsewhere, or choose pseudo-velocities that are independent there; state:{state}"
    )]
    Undetermined {
        /// Condition number of the map from one to the other.
        condition: f64,
        /// The initial state in the names and units of the spec.
        state: String,
    },
    /// The sampling interval is not a positive number of seconds.
    #[error("the sampling interval cannot be {interval} s")]
    Sampling {
        /// The interval in s.
        interval: f64,
    },
    /// An invalid interval, tolerance or step.
    #[error("{what} cannot be {value}")]
    Argument {
        /// Name of the argument.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The motion cannot be continued.
    #[error("{}", describe(failure, trajectory.info()))]
    Integration {
        /// The cause, with time and state.
        failure: Failure,
        /// The motion up to the failure, with its statistics.
        trajectory: Box<Trajectory>,
    },
}

/// The trajectory of a recorded motion.
fn recorded(
    model: &dyn Model,
    p: &[f64],
    inputs: &ModelInputs<'_>,
    extras: Extras,
    (observed, mut recorder): (Observed, Recorder<'_>),
) -> Result<Trajectory, SimulationError> {
    recorder.finish(observed.t, &observed.state);
    let fill = |t: f64, x: &[f64], u: &mut [f64]| inputs.fill(t, x, u);
    let (times, mut states) = (recorder.times, recorder.states);
    // Dense output is as accurate as the tolerances.
    if let Some(mut projection) = projection(model, p, inputs) {
        let rows = states.chunks_mut(observed.state.len().max(1));
        for (&t, state) in times.iter().zip(rows) {
            (projection.0)(t, state);
        }
    }
    let mut motion = Trajectory::evaluate(model, p, times, &states, fill, extras);
    motion.breaches = observed.breaches;
    motion.events = observed.events;
    motion.statistics = observed.statistics;
    match observed.ending {
        Ok(ending) => {
            motion.ending = Some(ending);
            Ok(motion)
        }
        Err(cause) => Err(SimulationError::Integration {
            failure: Failure {
                cause,
                t: observed.t,
                state: observed.state,
                hits: motion.events.clone(),
                statistics: motion.statistics,
            },
            trajectory: Box::new(motion),
        }),
    }
}

/// Integrates and records many simulations of one model together; see [`observe_together`].
pub fn run_together<'w>(
    prepared: &'w [Prepared<'w>],
    sampling: Sampling,
    extras: Extras,
    integrate: impl FnOnce(
        &mut [BlockMotion<'w, Recorder<'w>>],
    ) -> Vec<Result<Outcome, IntegrationError>>,
) -> Vec<Result<Trajectory, SimulationError>> {
    let viewers = prepared.iter().map(|prepared| Viewer {
        events: Vec::new(),
        observer: Recorder::new(sampling, prepared.span(), prepared.start()),
    });
    let seen = observe_together(prepared, viewers.collect(), integrate);
    let all = prepared.iter().zip(seen);
    all.map(|(prepared, seen)| {
        let (model, inputs) = (prepared.model, prepared.inputs);
        recorded(model, prepared.p, inputs, extras, seen?)
    })
    .collect()
}

impl<'a> Simulation<'a> {
    /// Ten seconds from the spec's initial state with the spec's parameters and zero inputs, recorded at the steps,
    /// with ranges checked.
    pub fn new(model: &'a dyn Model) -> Self {
        let info = model.info();
        Self {
            model,
            parameters: info.default_parameters(),
            initial_state: info.initial_state(),
            inputs: &ZeroInputs,
            span: [0.0, 10.0],
            method: Method::Dop853,
            options: Options::default(),
            sampling: Sampling::Steps,
            extras: Extras::default(),
            validity: Validity::default(),
            events: Vec::new(),
            progress: None,
        }
    }

    /// Integrates and records.
    pub fn run(mut self) -> Result<Trajectory, SimulationError> {
        let (model, sampling, extras) = (self.model, self.sampling, self.extras);
        let (p, progress) = (self.parameters.clone(), self.progress.take());
        let inputs = ModelInputs::new(model.info(), self.inputs)?;
        let (observed, recorder) = self.observed(&inputs, |span, x| {
            let mut recorder = Recorder::new(sampling, span, x);
            recorder.progress = progress;
            recorder
        })?;
        recorded(model, &p, &inputs, extras, (observed, recorder))
    }

    /// Integrates and passes each step to an observer, which is created for the span and the initial state; nothing
    /// is recorded.
    pub fn observe<O: Observer>(
        self,
        observer: impl FnOnce([f64; 2], &[f64]) -> O,
    ) -> Result<(Observed, O), SimulationError> {
        let inputs = ModelInputs::new(self.model.info(), self.inputs)?;
        self.observed(&inputs, observer)
    }

    fn observed<O: Observer>(
        mut self,
        inputs: &ModelInputs<'_>,
        observer: impl FnOnce([f64; 2], &[f64]) -> O,
    ) -> Result<(Observed, O), SimulationError> {
        let events = std::mem::take(&mut self.events);
        let own = events.len();
        let prepared = Prepared::new(&self, inputs)?;
        let (model, p, span) = (self.model, prepared.p, prepared.span());
        let mut x = prepared.start().to_vec();
        let mut observer = observer(span, &x);
        let mut watch = prepared.watch(events, &SharedTimes::default());
        let mut u = vec![0.0; model.info().input_len()];
        let rates = |t: f64, x: &[f64], rates: &mut [f64]| {
            inputs.fill(t, x, &mut u);
            model.rates(At { t, x, u: &u, p }, rates);
        };
        let result = self.integrate(rates, span, &mut x, &mut watch, &mut observer);
        drop(watch);
        Ok((prepared.observed(x, result, own)?, observer))
    }

    /// Runs the selected integrator; `x` is overwritten with the final state.
    fn integrate<O: Observer>(
        &self,
        rates: impl FnMut(f64, &[f64], &mut [f64]),
        span: [f64; 2],
        x: &mut [f64],
        watch: &mut Watch<'_>,
        observer: &mut O,
    ) -> Result<Outcome, IntegrationError> {
        let options = &self.options;
        match self.method {
            Method::Dop853 => {
                Solver::<Dop853>::new().integrate(rates, span, x, options, watch, observer)
            }
            Method::Dopri5 => {
                Solver::<Dopri5>::new().integrate(rates, span, x, options, watch, observer)
            }
            Method::Rk4 { step } => Rk4::new().integrate(rates, span, x, step, watch, observer),
        }
    }

    fn check(&self) -> Result<(), SimulationError> {
        let info = self.model.info();
        for (what, expected, found) in [
            ("parameters", info.parameter_len(), self.parameters.len()),
            ("initial state", info.state_len(), self.initial_state.len()),
        ] {
            if expected != found {
                return Err(SimulationError::Length {
                    what,
                    expected,
                    found,
                });
            }
        }
        match self.sampling {
            Sampling::Every(interval) if interval.is_nan() || interval <= 0.0 => {
                Err(SimulationError::Sampling { interval })
            }
            _ => Ok(()),
        }
    }
}

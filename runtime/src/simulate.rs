//! The motion of a model under its inputs.

use crate::inputs::{InputSource, ModelInputs, ZeroInputs};
use crate::integrate::{
    Dop853, Dopri5, Event, IntegrationError, Observer, Options, Outcome, Range, Rk4, Solver, Step,
    Watch,
};
use crate::model::{At, Model, ModelInfo};
use crate::signal::SignalError;
use crate::trajectory::{Extras, Trajectory};
use std::fmt::Write as _;
use std::ops::ControlFlow;

/// How the equations are integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Order 8 with step-size control.
    Dop853,
    /// Order 5 with step-size control.
    Dopri5,
    /// Order 4 with steps of this many seconds; the tolerances do not matter.
    Rk4 {
        /// The step in s.
        step: f64,
    },
}

/// At which times the motion is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// At the start and after each step.
    Steps,
    /// From the start on at multiples of an interval in s, between steps by dense output. Where
    /// the motion ends early, by an event or a failure, its last state follows.
    Every(f64),
}

/// A simulation to be run. The fields are public: set what differs from [`Simulation::new`].
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
    /// What is recorded when.
    pub sampling: Sampling,
    /// What is recorded besides states and inputs.
    pub extras: Extras,
    /// Whether a state outside its declared range ends the simulation with an error.
    pub watch_ranges: bool,
    /// Events to be found.
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

/// Why there is no complete trajectory.
#[derive(Debug, Clone, thiserror::Error)]
pub enum SimulationError {
    /// A table of the model is not a function of time.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// A vector does not fit the model.
    #[error("{what}: {found} numbers given, {expected} needed")]
    Length {
        /// Which vector.
        what: &'static str,
        /// Length of the model's vector.
        expected: usize,
        /// Length that was given.
        found: usize,
    },
    /// The sampling interval is not a positive number of seconds.
    #[error("the sampling interval cannot be {interval} s")]
    Sampling {
        /// The interval in s.
        interval: f64,
    },
    /// The motion cannot be continued.
    #[error("{}", describe(cause, trajectory.info()))]
    Integration {
        /// The reason, with time and state.
        cause: IntegrationError,
        /// The motion up to there.
        trajectory: Box<Trajectory>,
    },
}

impl<'a> Simulation<'a> {
    /// Ten seconds from the spec's initial state with the spec's parameters and without inputs,
    /// recorded at the steps, with ranges watched.
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
            watch_ranges: true,
            events: Vec::new(),
            progress: None,
        }
    }

    /// Integrates and records.
    pub fn run(self) -> Result<Trajectory, SimulationError> {
        self.check()?;
        let info = self.model.info();
        let inputs = ModelInputs::new(info, self.inputs)?;
        let switching_times = inputs.switching_times();
        let ranges = if self.watch_ranges {
            declared_ranges(info)
        } else {
            Vec::new()
        };
        let mut watch = Watch {
            switching_times: &switching_times,
            ranges: &ranges,
            events: self.events,
        };
        let mut recorder = Recorder::new(self.sampling, self.span, &self.initial_state);
        recorder.progress = self.progress;

        let (model, parameters) = (self.model, &self.parameters);
        let mut u = vec![0.0; info.input_len()];
        let rates = |t: f64, x: &[f64], rates: &mut [f64]| {
            inputs.fill(t, x, &mut u);
            model.rates(
                At {
                    t,
                    x,
                    u: &u,
                    p: parameters,
                },
                rates,
            );
        };

        let mut x = self.initial_state.clone();
        let (span, options) = (self.span, &self.options);
        let outcome = match self.method {
            Method::Dop853 => Solver::<Dop853>::new().integrate(
                rates,
                span,
                &mut x,
                options,
                &mut watch,
                &mut recorder,
            ),
            Method::Dopri5 => Solver::<Dopri5>::new().integrate(
                rates,
                span,
                &mut x,
                options,
                &mut watch,
                &mut recorder,
            ),
            Method::Rk4 { step } => {
                Rk4::new().integrate(rates, span, &mut x, step, &mut watch, &mut recorder)
            }
        };

        let t_end = match &outcome {
            Ok(Outcome { t, .. }) => *t,
            Err(cause) => cause.time(),
        };
        recorder.finish(t_end, &x);
        let fill = |t: f64, x: &[f64], u: &mut [f64]| inputs.fill(t, x, u);
        let (times, states) = (recorder.times, recorder.states);
        let mut trajectory =
            Trajectory::evaluate(model, parameters, times, &states, fill, self.extras);
        match outcome {
            Ok(outcome) => {
                trajectory.ending = Some(outcome.ending);
                trajectory.events = outcome.hits;
                trajectory.statistics = outcome.statistics;
                Ok(trajectory)
            }
            Err(cause) => {
                let trajectory = Box::new(trajectory);
                Err(SimulationError::Integration { cause, trajectory })
            }
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

/// The states with a finite limit.
fn declared_ranges(info: &ModelInfo) -> Vec<Range> {
    let limited = |limits: [f64; 2]| limits.iter().any(|limit| limit.is_finite());
    let states = info.states.iter().enumerate();
    states
        .filter(|(_, state)| limited(state.range))
        .map(|(component, state)| Range {
            component,
            limits: state.range,
        })
        .collect()
}

/// Collects times and states.
struct Recorder<'a> {
    sampling: Sampling,
    span: [f64; 2],
    /// Number of the next sample on the grid.
    next: u32,
    times: Vec<f64>,
    states: Vec<f64>,
    x: Vec<f64>,
    progress: Option<Box<dyn FnMut(f64) + 'a>>,
}

impl Recorder<'_> {
    fn new(sampling: Sampling, span: [f64; 2], x: &[f64]) -> Self {
        Self {
            sampling,
            span,
            next: 1,
            times: vec![span[0]],
            states: x.to_vec(),
            x: x.to_vec(),
            progress: None,
        }
    }

    fn record(&mut self, t: f64, x: &[f64]) {
        self.times.push(t);
        self.states.extend_from_slice(x);
    }

    /// The next time of the grid; the interval's end where rounding alone keeps them apart.
    fn next_on_grid(&self, interval: f64) -> f64 {
        let [start, end] = self.span;
        let t = start + f64::from(self.next) * interval;
        if (t - end).abs() < 1e-9 * interval {
            end
        } else {
            t
        }
    }

    /// Records where the motion ended, which need not lie on the grid.
    fn finish(&mut self, t: f64, x: &[f64]) {
        if self.times.last().is_some_and(|last| *last < t) {
            self.record(t, x);
        }
    }
}

impl Observer for Recorder<'_> {
    fn wants_interior(&self, _: f64, t: f64) -> bool {
        match self.sampling {
            Sampling::Steps => false,
            Sampling::Every(interval) => self.next_on_grid(interval) < t,
        }
    }

    fn step(&mut self, step: &Step<'_>) -> ControlFlow<()> {
        match self.sampling {
            Sampling::Steps => self.record(step.t, step.x),
            Sampling::Every(interval) => {
                let mut t = self.next_on_grid(interval);
                while t < step.t {
                    if let Some(interior) = step.interior {
                        let mut x = std::mem::take(&mut self.x);
                        interior.state(t, &mut x);
                        self.record(t, &x);
                        self.x = x;
                    }
                    self.next += 1;
                    t = self.next_on_grid(interval);
                }
                if t <= step.t {
                    self.record(step.t, step.x);
                    self.next += 1;
                }
            }
        }
        if let Some(progress) = &mut self.progress {
            progress(step.t);
        }
        ControlFlow::Continue(())
    }
}

/// The failure in the names and units of the spec.
pub fn describe(cause: &IntegrationError, info: &ModelInfo) -> String {
    let name = |index: usize| {
        info.states
            .get(index)
            .map_or("?", |state| state.name.as_ref())
    };
    let reason = match cause {
        IntegrationError::NonFinite { component, .. } => {
            format!("`{}` or its rate is not finite", name(*component))
        }
        IntegrationError::StepTooSmall { h, .. } => format!(
            "the step shrank to {h:.1e} s: the motion is singular here, or too stiff for the method"
        ),
        IntegrationError::TooManySteps { steps, .. } => format!("{steps} steps were not enough"),
        IntegrationError::OutOfRange {
            coordinate, range, ..
        } => {
            let Some(state) = info.states.get(*coordinate) else {
                return cause.to_string();
            };
            let [lower, upper] = range.map(|limit| state.to_unit(limit));
            format!(
                "`{}` leaves its range {lower} … {upper} {}",
                state.name, state.unit
            )
        }
        IntegrationError::InvalidArgument { .. } => return cause.to_string(),
    };
    let mut text = format!("at t = {:.9} s {reason}; state:", cause.time());
    for (i, (state, &value)) in info.states.iter().zip(cause.state()).enumerate() {
        let separator = if i == 0 { "" } else { "," };
        let value = state.to_unit(value);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "{separator} {} = {value:.6} {}",
            state.name, state.unit
        );
    }
    text
}

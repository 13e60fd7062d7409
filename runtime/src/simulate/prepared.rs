//! A checked simulation with a consistent initial state.

use super::describe::describe_state;
use super::switches::switches;
use super::validity::Limits;
use super::{Breach, Observed, Response, Simulation, SimulationError};
use crate::condition::velocity_condition;
use crate::inputs::ModelInputs;
use crate::integrate::{
    BlockMotion, Ending, Event, Failure, IntegrationError, Observer, Outcome, Projection, Range,
    SharedTimes, Timetable, Watch,
};
use crate::model::{At, Model};
use crate::positions::{Moving, Positions};

/// Condition number above which a velocity has no significant digits.
const LOST: f64 = 1e15;

/// A simulation with valid arguments and a consistent initial state.
pub struct Prepared<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) inputs: &'a ModelInputs<'a>,
    pub(super) p: &'a [f64],
    start: Vec<f64>,
    span: [f64; 2],
    switching_times: Vec<f64>,
    ranges: Vec<Range>,
    limits: Limits<'a>,
    /// Limits exceeded at the start, and whether one of them ends the motion.
    breaches: Vec<Breach>,
    ends_at_once: bool,
}

impl std::fmt::Debug for Prepared<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Prepared")
            .field("model", &self.model.info().name)
            .field("start", &self.start)
            .field("span", &self.span)
            .finish_non_exhaustive()
    }
}

impl<'a> Prepared<'a> {
    /// Checks a simulation and computes its initial state. `inputs` are those of its model and source.
    pub fn new(
        simulation: &'a Simulation<'_>,
        inputs: &'a ModelInputs<'a>,
    ) -> Result<Self, SimulationError> {
        simulation.check()?;
        let (model, p) = (simulation.model, simulation.parameters.as_slice());
        let start = consistent_start(simulation, inputs)?;
        determined_start(simulation, inputs, &start)?;
        let limits = Limits::new(model, inputs, p, simulation.validity);
        let [from, to] = simulation.span;
        let (breaches, ends_at_once) = limits.at_start(from, &start);
        Ok(Self {
            model,
            inputs,
            p,
            start,
            span: [from, if ends_at_once { from } else { to }],
            switching_times: inputs.switching_times(),
            ranges: match simulation.validity.ranges {
                Response::Stop => Range::of(model.info()),
                _ => Vec::new(),
            },
            limits,
            breaches,
            ends_at_once,
        })
    }

    /// The initial state, in SI.
    pub fn start(&self) -> &[f64] {
        &self.start
    }

    /// Its parameters, in SI.
    pub fn parameters(&self) -> &[f64] {
        self.p
    }

    /// Start and end in s.
    pub fn span(&self) -> [f64; 2] {
        self.span
    }

    /// Ends it where it starts.
    pub fn end_at_start(&mut self) {
        self.span[1] = self.span[0];
    }

    /// What is known of its steps before it starts; nothing if the rates change more than a million times. Motions of one
    /// model with the same functions of time share it.
    pub fn timetable(&self, shared: &SharedTimes) -> Option<Timetable> {
        let mut switches = switches(self.model, self.p, self.inputs, shared);
        Timetable::new(self.span, &self.switching_times, switches.as_mut())
    }

    /// Switching times, ranges, projection and events. The events of the limits follow the simulation's own events.
    pub(super) fn watch<'w>(
        &'w self,
        mut events: Vec<Event<'w>>,
        shared: &SharedTimes,
    ) -> Watch<'w> {
        for event in self.limits.events() {
            events.push(event);
        }
        Watch {
            switching_times: &self.switching_times,
            switches: switches(self.model, self.p, self.inputs, shared),
            ranges: &self.ranges,
            projection: projection(self.model, self.p, self.inputs),
            events,
        }
    }

    /// The result of an integration. `own` is the number of the simulation's own events.
    pub(super) fn observed(
        &self,
        state: Vec<f64>,
        result: Result<Outcome, IntegrationError>,
        own: usize,
    ) -> Result<Observed, SimulationError> {
        let (t, hits, statistics, ending) = match result {
            Ok(outcome) => {
                let ending = match outcome.ending {
                    Ending::Event(event) if event >= own => Ending::Stopped,
                    Ending::Finished if self.ends_at_once => Ending::Stopped,
                    ending => ending,
                };
                (outcome.t, outcome.hits, outcome.statistics, Ok(ending))
            }
            Err(IntegrationError::Failure(failure)) => {
                let Failure { t, hits, .. } = failure;
                (t, hits, failure.statistics, Err(failure.cause))
            }
            Err(IntegrationError::InvalidArgument { what, value }) => {
                return Err(SimulationError::Argument { what, value });
            }
        };
        let (mut events, mut breaches) = (Vec::new(), self.breaches.clone());
        for hit in hits {
            match hit.event.checked_sub(own) {
                None => events.push(hit),
                Some(limit) => breaches.extend(self.limits.found(limit, hit)),
            }
        }
        Ok(Observed {
            t,
            state,
            ending,
            events,
            breaches,
            statistics,
        })
    }
}

/// Events and observer of one of several simulations.
#[derive(Debug)]
pub struct Viewer<'w, O> {
    /// Event functions.
    pub events: Vec<Event<'w>>,
    /// Receives the steps.
    pub observer: O,
}

/// Integrates many simulations of one model together, as [`BlockSolver`](crate::integrate::BlockSolver) does:
/// `integrate` receives their motions, in order.
///
/// # Panics
///
/// If the numbers of viewers and simulations differ.
pub fn observe_together<'w, O: Observer>(
    prepared: &'w [Prepared<'w>],
    viewers: Vec<Viewer<'w, O>>,
    integrate: impl FnOnce(&mut [BlockMotion<'w, O>]) -> Vec<Result<Outcome, IntegrationError>>,
) -> Vec<Result<(Observed, O), SimulationError>> {
    assert_eq!(prepared.len(), viewers.len(), "a viewer for each motion");
    let (mut own, shared) = (Vec::new(), SharedTimes::default());
    let motions = prepared.iter().zip(viewers).map(|(prepared, viewer)| {
        own.push(viewer.events.len());
        BlockMotion {
            span: prepared.span,
            x: prepared.start.clone(),
            parameters: prepared.p,
            watch: prepared.watch(viewer.events, &shared),
            observer: viewer.observer,
        }
    });
    let mut motions: Vec<BlockMotion<'_, O>> = motions.collect();
    let results = integrate(&mut motions);
    let ended = prepared.iter().zip(motions).zip(results).zip(own);
    ended
        .map(|(((prepared, motion), result), own)| {
            let observed = prepared.observed(motion.x, result, own)?;
            Ok((observed, motion.observer))
        })
        .collect()
}

/// The initial state with dependent coordinates computed by Newton's method, starting from their given values.
fn consistent_start(
    simulation: &Simulation<'_>,
    inputs: &ModelInputs<'_>,
) -> Result<Vec<f64>, SimulationError> {
    let (model, t) = (simulation.model, simulation.span[0]);
    let mut x = simulation.initial_state.clone();
    if let Some(mut positions) = Positions::of(model) {
        let mut u = vec![0.0; model.info().input_len()];
        inputs.fill(t, &x, &mut u);
        let p = &simulation.parameters;
        let restored = positions.restore(model, t, &mut x, &u, p, Moving::Dependent);
        restored.map_err(|source| SimulationError::Inconsistent {
            source,
            message: source.describe(model.info()),
        })?;
    }
    Ok(x)
}

/// An error if the generalised velocities are determined only by rounding errors.
fn determined_start(
    simulation: &Simulation<'_>,
    inputs: &ModelInputs<'_>,
    x: &[f64],
) -> Result<(), SimulationError> {
    let (model, t, p) = (simulation.model, simulation.span[0], &simulation.parameters);
    let mut u = vec![0.0; model.info().input_len()];
    inputs.fill(t, x, &mut u);
    let condition = velocity_condition(model, At { t, x, u: &u, p });
    if condition < LOST {
        return Ok(());
    }
    let state = describe_state(x, model.info());
    Err(SimulationError::Undetermined { condition, state })
}

/// The projection onto the position constraints of a model.
pub(super) fn projection<'a>(
    model: &'a dyn Model,
    p: &'a [f64],
    inputs: &'a ModelInputs<'_>,
) -> Option<Projection<'a>> {
    let mut positions = Positions::of(model)?;
    let mut u = vec![0.0; model.info().input_len()];
    Some(Projection(Box::new(move |t, x| {
        inputs.fill(t, x, &mut u);
        let restored = positions.restore(model, t, x, &u, p, Moving::All);
        restored.is_ok()
    })))
}

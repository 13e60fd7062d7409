//! Checks after each accepted step: ranges, events, observers.

use super::dense_output::{DenseOutput, Ends, HERMITE};
use super::error::{Cause, Failure, IntegrationError};
use super::events::{Crossings, Event, EventHit};
use super::outcome::{Ending, Outcome, Statistics};
use super::range::Range;
use super::stops::{Stops, sliver};
use super::switches::Switches;
use std::ops::ControlFlow;

/// Switching times, ranges, projection and events of an integration.
#[derive(Debug, Default)]
pub struct Watch<'a> {
    /// Times at which the rates jump or lose smoothness, in any order. A step ends exactly at
    /// each; the rates up to there are evaluated before it, those after at or after it.
    pub switching_times: &'a [f64],
    /// Functions of time and state at whose zeros the rates are discontinuous or not smooth.
    pub switches: Option<Switches<'a>>,
    /// Leaving one of these is an error.
    pub ranges: &'a [Range],
    /// Projection of the state onto the constraints after each step.
    pub projection: Option<Projection<'a>>,
    /// Event functions, whose zeros are located.
    pub events: Vec<Event<'a>>,
}

/// Projects a state onto the constraints at a time in s; false if that fails.
pub type ProjectionFunction<'a> = dyn FnMut(f64, &mut [f64]) -> bool + 'a;

/// A projection onto the admissible states.
pub struct Projection<'a>(pub Box<ProjectionFunction<'a>>);

impl std::fmt::Debug for Projection<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Projection")
    }
}

/// An accepted step, up to its end or to the event that ended it.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// Start in s.
    pub t_old: f64,
    /// End in s.
    pub t: f64,
    /// State at the start.
    pub x_old: &'a [f64],
    /// State at the end.
    pub x: &'a [f64],
    /// Dense output of the step, if [`Observer::wants_interior`] requested it.
    pub interior: Option<&'a DenseOutput>,
}

impl Watch<'_> {
    /// Rejects ranges of states that do not exist.
    pub(super) fn check(&self, states: usize) -> Result<(), IntegrationError> {
        let mut components = self.ranges.iter().map(|range| range.component);
        match components.find(|&component| component >= states) {
            None => Ok(()),
            Some(component) => Err(IntegrationError::InvalidArgument {
                what: "state of a range",
                value: component as f64,
            }),
        }
    }
}

/// Receives every accepted step. Closures are observers that request dense output.
pub trait Observer {
    /// Whether dense output between `t_old` and `t` is needed; it may cost evaluations.
    fn wants_interior(&self, t_old: f64, t: f64) -> bool {
        let _ = (t_old, t);
        true
    }

    /// Receives a step; breaking ends the integration there.
    fn step(&mut self, step: &Step<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Step<'_>) -> ControlFlow<()>> Observer for F {
    fn step(&mut self, step: &Step<'_>) -> ControlFlow<()> {
        self(step)
    }
}

/// An observer that does nothing.
#[derive(Debug, Clone, Copy)]
pub struct NoObserver;

impl Observer for NoObserver {
    fn wants_interior(&self, _: f64, _: f64) -> bool {
        false
    }

    fn step(&mut self, _: &Step<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Where an integration ended, and why.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) t: f64,
    pub(super) why: Result<Ending, Cause>,
}

impl End {
    pub(super) fn finished(t: f64) -> Self {
        let why = Ok(Ending::Finished);
        Self { t, why }
    }

    pub(super) fn failed(t: f64, cause: Cause) -> Self {
        let why = Err(cause);
        Self { t, why }
    }
}

/// The state of all checks during one integration.
pub(super) struct Watcher<'w, 'a, O> {
    pub(super) stops: Stops<'w, 'a>,
    ranges: &'a [Range],
    projection: Option<&'w mut Projection<'a>>,
    events: &'w mut [Event<'a>],
    observer: &'w mut O,
    crossings: Crossings,
    hits: Vec<EventHit>,
    /// Time of the zero of a switching function that ended the last step; below, the state and the rates there.
    switched: Option<f64>,
    at_switch: [Vec<f64>; 2],
    /// Consecutive steps of negligible length since such a switch.
    slivers: Option<usize>,
    /// The cubic Hermite interpolant of a step.
    between: DenseOutput,
}

/// A step is not shortened to a length above this fraction of it.
const NOT_SHORTER: f64 = 0.9;
/// More consecutive negligible steps than this after a switch count as chattering.
const MOST_SLIVERS: usize = 300;

impl<'w, 'a, O: Observer> Watcher<'w, 'a, O> {
    pub(super) fn new(watch: &'w mut Watch<'a>, observer: &'w mut O, span: [f64; 2]) -> Self {
        Self {
            stops: Stops::new(span, watch.switching_times, watch.switches.as_mut()),
            ranges: watch.ranges,
            projection: watch.projection.as_mut(),
            events: &mut watch.events,
            observer,
            crossings: Crossings::default(),
            hits: Vec::new(),
            switched: None,
            at_switch: Default::default(),
            slivers: None,
            between: DenseOutput::default(),
        }
    }

    /// Limits the step size so that no pulse of a function of time is stepped over.
    pub(super) fn paced(mut self, start: f64) -> Self {
        self.stops = self.stops.with_pace(start);
        self
    }

    /// Time of the switch at which the last accepted step ended; the integration restarts there.
    pub(super) fn switched(&self) -> Option<f64> {
        self.switched
    }

    /// Initialises the signs of the event functions; an error if the initial state is inadmissible.
    pub(super) fn start(&mut self, t: f64, x: &[f64]) -> Result<(), Cause> {
        if let Some(component) = x.iter().position(|value| !value.is_finite()) {
            return Err(Cause::NonFinite { component });
        }
        let left = |range: &&Range| range.passed(x[range.component]).is_some();
        if let Some(range) = self.ranges.iter().find(left) {
            return Err(range.cause());
        }
        self.crossings.start(self.events, t, x);
        Ok(())
    }

    /// Whether states are projected onto the constraints.
    pub(super) fn projects(&self) -> bool {
        self.projection.is_some()
    }

    /// Projects a state onto the constraints; false if that fails.
    pub(super) fn project(&mut self, t: f64, x: &mut [f64]) -> bool {
        match &mut self.projection {
            Some(projection) => (projection.0)(t, x),
            None => true,
        }
    }

    /// Whether the next call of `accept` needs dense output.
    pub(super) fn wants_interior(&self, ends: &Ends<'_>) -> bool {
        !self.events.is_empty()
            || self.stops.has_crossings()
            || self.ranges.iter().any(|range| range.may_be_left(ends))
            || self.observer.wants_interior(ends.t[0], ends.t[1])
    }

    /// Passes a step, up to an event, a limit, the located switch or its end, to the observer. `x` becomes the state
    /// there. Returns the end of the integration if it ends in this step.
    pub(super) fn accept(
        &mut self,
        ends: &Ends<'_>,
        interior: Option<&DenseOutput>,
        x: &mut [f64],
    ) -> Option<End> {
        let t = self.switched.unwrap_or(ends.t[1]);
        let is_sliver = t - ends.t[0] <= sliver(t);
        let before = self.slivers.or(self.switched.map(|_| 0));
        self.slivers = before.filter(|_| is_sliver).map(|slivers| slivers + 1);
        let end = if self.switched.is_some() {
            let at_switch = std::mem::take(&mut self.at_switch);
            let [start, rates] = [ends.x[0], ends.rates[0]];
            let cut = Ends {
                t: [ends.t[0], t],
                x: [start, &at_switch[0]],
                rates: [rates, &at_switch[1]],
            };
            let end = self.show(&cut, interior, x);
            self.at_switch = at_switch;
            end
        } else {
            self.show(ends, interior, x)
        };
        let chatters = self.slivers.is_some_and(|slivers| slivers > MOST_SLIVERS);
        let is_endless = chatters || self.stops.is_endless();
        end.or(is_endless.then(|| End::failed(t, Cause::Chattering)))
    }

    /// A shorter step to be tried if this one may step over a pulse of a function of the state.
    pub(super) fn too_long(&mut self, ends: &Ends<'_>) -> Option<f64> {
        if !self.stops.has_pulses() {
            return None;
        }
        self.between.prepare(ends.x[0].len(), HERMITE);
        self.between.set_hermite(ends);
        let longest = self.stops.longest(ends.t, &self.between);
        (longest < NOT_SHORTER * (ends.t[1] - ends.t[0])).then_some(longest)
    }

    /// A shorter step to be tried if a switch lies within this one; it ends just before the switch. Stages beyond the
    /// switch corrupt the interpolant, and the error estimate does not detect it in those of the dense output alone.
    pub(super) fn shorter(&mut self, ends: &Ends<'_>, dense: &DenseOutput) -> Option<f64> {
        let switch = self.switch_within(ends, dense)?;
        let (before, length) = (switch - ends.t[0], ends.t[1] - ends.t[0]);
        let near = sliver(switch);
        let is_within = near < before && near < length - before;
        is_within.then(|| {
            self.stops.expect(switch);
            before - 0.5 * near
        })
    }

    /// Locates the first switch within a step and stores the time, the state and the rates there.
    pub(super) fn switch_within(&mut self, ends: &Ends<'_>, dense: &DenseOutput) -> Option<f64> {
        self.switched = None;
        let (t, x) = self.stops.crossing(ends, dense)?;
        let [state, rates] = &mut self.at_switch;
        state.clear();
        state.extend_from_slice(x);
        rates.clear();
        rates.extend((0..x.len()).map(|i| dense.component_and_slope(t, i).1));
        if let Some(projection) = &mut self.projection {
            // If this fails, the next step reports it.
            (projection.0)(t, state);
        }
        self.switched = Some(t);
        self.switched
    }

    /// Passes a step up to an event or a limit within it to the observer.
    fn show(
        &mut self,
        ends: &Ends<'_>,
        interior: Option<&DenseOutput>,
        x: &mut [f64],
    ) -> Option<End> {
        x.copy_from_slice(ends.x[1]);
        let end = interior.and_then(|dense| {
            let end = self.end_within(ends, dense)?;
            dense.state(end.t, x);
            Some(end)
        });
        let t = end.map_or(ends.t[1], |end| end.t);
        let flow = self.observer.step(&Step {
            t_old: ends.t[0],
            t,
            x_old: ends.x[0],
            x,
            interior,
        });
        let why = Ok(Ending::Stopped);
        end.or(flow.is_break().then_some(End { t, why }))
    }

    /// The first terminal event or exceeded limit. Records the events before it.
    fn end_within(&mut self, ends: &Ends<'_>, dense: &DenseOutput) -> Option<End> {
        let left = self
            .ranges
            .iter()
            .filter_map(|range| Some((range.left_at(ends, dense)?, range.cause())))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (t_left, _) = left.unzip();
        let t_last = t_left.unwrap_or(ends.t[1]);
        let crossings = self.crossings.in_step(self.events, ends, dense);
        for &(t, event) in crossings.iter().take_while(|crossing| crossing.0 <= t_last) {
            let mut state = vec![0.0; ends.x[1].len()];
            dense.state(t, &mut state);
            self.hits.push(EventHit { event, t, state });
            if self.events[event].terminal {
                let why = Ok(Ending::Event(event));
                return Some(End { t, why });
            }
        }
        left.map(|(t, cause)| End::failed(t, cause))
    }

    /// The result of the integration, which ended in state `x`.
    pub(super) fn conclude(
        self,
        end: End,
        x: &[f64],
        statistics: Statistics,
    ) -> Result<Outcome, IntegrationError> {
        let (t, hits) = (end.t, self.hits);
        match end.why {
            Ok(ending) => Ok(Outcome {
                ending,
                t,
                hits,
                statistics,
            }),
            Err(cause) => Err(IntegrationError::Failure(Failure {
                cause,
                t,
                state: x.to_vec(),
                hits,
                statistics,
            })),
        }
    }
}

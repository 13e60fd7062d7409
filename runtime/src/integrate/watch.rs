//! What happens after each accepted step: ranges, events, observers.

use super::dense_output::DenseOutput;
use super::error::IntegrationError;
use super::events::{Crossings, Event, EventHit, brent};
use std::ops::ControlFlow;

/// The interval of a state outside which the equations do not hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Index in the state.
    pub component: usize,
    /// Lower and upper limit in SI; may be infinite.
    pub limits: [f64; 2],
}

/// What an integration has to look out for, besides the tolerances.
#[derive(Debug, Default)]
pub struct Watch<'a> {
    /// Times at which the rates jump or lose smoothness, in any order. A step ends exactly at
    /// each; the rates up to there are evaluated before it, those after at or after it.
    pub switching_times: &'a [f64],
    /// Leaving one of these is an error.
    pub ranges: &'a [Range],
    /// Functions whose zeros are sought.
    pub events: Vec<Event<'a>>,
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
    /// The solution between, if [`Observer::wants_interior`] asked for it.
    pub interior: Option<&'a DenseOutput>,
}

/// Someone who sees every accepted step. Closures are observers that want the interior.
pub trait Observer {
    /// Whether the solution between `t_old` and `t` is wanted; it may cost evaluations.
    fn wants_interior(&self, t_old: f64, t: f64) -> bool {
        let _ = (t_old, t);
        true
    }

    /// Sees a step; breaking ends the integration there.
    fn step(&mut self, step: &Step<'_>) -> ControlFlow<()>;
}

impl<F: FnMut(&Step<'_>) -> ControlFlow<()>> Observer for F {
    fn step(&mut self, step: &Step<'_>) -> ControlFlow<()> {
        self(step)
    }
}

/// The observer that looks at nothing.
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

/// Why an integration ended without an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The interval's end was reached.
    Finished,
    /// The terminal event of this index occurred.
    Event(usize),
    /// The observer broke off.
    Stopped,
}

/// The watch with its memory during one integration.
pub(super) struct Watcher<'w, 'a, O> {
    watch: &'w mut Watch<'a>,
    observer: &'w mut O,
    crossings: Crossings,
    x_end: Vec<f64>,
    pub(super) hits: Vec<EventHit>,
}

impl<'w, 'a, O: Observer> Watcher<'w, 'a, O> {
    /// Checks the state, the ranges and takes the signs of the events at the start.
    pub(super) fn start(
        watch: &'w mut Watch<'a>,
        observer: &'w mut O,
        t: f64,
        x: &[f64],
    ) -> Result<Self, IntegrationError> {
        if let Some(component) = x.iter().position(|value| !value.is_finite()) {
            return Err(IntegrationError::NonFinite {
                t,
                state: x.to_vec(),
                component,
            });
        }
        let mut crossings = Crossings::default();
        crossings.start(&mut watch.events, t, x);
        let watcher = Self {
            watch,
            observer,
            crossings,
            x_end: x.to_vec(),
            hits: Vec::new(),
        };
        match watcher.left_range(x) {
            None => Ok(watcher),
            Some((range, _)) => Err(out_of_range(range, t, x)),
        }
    }

    /// Whether the next call of `accept` needs the interpolant.
    pub(super) fn wants_interior(&self, t_old: f64, t: f64, x: &[f64]) -> bool {
        !self.watch.events.is_empty()
            || self.left_range(x).is_some()
            || self.observer.wants_interior(t_old, t)
    }

    /// Passes a step on to its first end: an event, a limit, or its own. Returns why to end and
    /// where; the state there is [`Watcher::x_end`].
    pub(super) fn accept(
        &mut self,
        step: &Step<'_>,
    ) -> Result<Option<(Ending, f64)>, IntegrationError> {
        let Some(dense) = step.interior else {
            return Ok(self.observe(step).map(|ending| (ending, step.t)));
        };
        let (mut t, mut ending, mut left) = (step.t, None, None);
        if let Some((range, limit)) = self.left_range(step.x) {
            let distance = |s: f64| dense.component(s, range.component) - limit;
            t = brent((step.t_old, step.t), distance);
            left = Some(range);
        }
        let crossings =
            self.crossings
                .in_step(&mut self.watch.events, (step.t_old, step.t), step.x, dense);
        for &(t_event, event) in crossings.iter().take_while(|crossing| crossing.0 <= t) {
            let mut state = vec![0.0; step.x.len()];
            dense.state(t_event, &mut state);
            self.hits.push(EventHit {
                event,
                t: t_event,
                state,
            });
            if self.watch.events[event].terminal {
                (t, ending, left) = (t_event, Some(Ending::Event(event)), None);
                break;
            }
        }
        if ending.is_none() && left.is_none() {
            return Ok(self.observe(step).map(|ending| (ending, step.t)));
        }
        dense.state(t, &mut self.x_end);
        let x_end = std::mem::take(&mut self.x_end);
        let stopped = self.observe(&Step {
            t,
            x: &x_end,
            ..*step
        });
        self.x_end = x_end;
        match left {
            Some(range) => Err(out_of_range(range, t, &self.x_end)),
            None => Ok(ending.or(stopped).map(|ending| (ending, t))),
        }
    }

    /// The state where the last step ended, if `accept` ended it early.
    pub(super) fn x_end(&self) -> &[f64] {
        &self.x_end
    }

    fn observe(&mut self, step: &Step<'_>) -> Option<Ending> {
        match self.observer.step(step) {
            ControlFlow::Continue(()) => None,
            ControlFlow::Break(()) => {
                self.x_end.copy_from_slice(step.x);
                Some(Ending::Stopped)
            }
        }
    }

    /// The first range that `x` lies outside of, and the limit it passed.
    fn left_range(&self, x: &[f64]) -> Option<(Range, f64)> {
        self.watch.ranges.iter().find_map(|&range| {
            let [lower, upper] = range.limits;
            let value = x.get(range.component)?;
            if *value < lower {
                Some((range, lower))
            } else if *value > upper {
                Some((range, upper))
            } else {
                None
            }
        })
    }
}

fn out_of_range(range: Range, t: f64, x: &[f64]) -> IntegrationError {
    IntegrationError::OutOfRange {
        t,
        coordinate: range.component,
        value: x[range.component],
        range: range.limits,
        state: x.to_vec(),
    }
}

//! Records samples of a motion during integration.

use crate::integrate::{Observer, Step};
use std::ops::ControlFlow;

/// Recording times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// At the start and after each step.
    Steps,
    /// From the start on at multiples of an interval in s, between steps by dense output. If the motion ends early,
    /// by an event or a failure, its final state is appended.
    Every(f64),
}

/// Collects times and states.
pub struct Recorder<'a> {
    sampling: Sampling,
    span: [f64; 2],
    /// Number of the next sample on the grid.
    next: u32,
    /// Times in s.
    pub(super) times: Vec<f64>,
    /// States one after the other.
    pub(super) states: Vec<f64>,
    /// An interpolated state.
    x: Vec<f64>,
    /// Called with the time in s after each step.
    pub(super) progress: Option<Box<dyn FnMut(f64) + 'a>>,
}

impl std::fmt::Debug for Recorder<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Recorder")
            .field("sampling", &self.sampling)
            .field("span", &self.span)
            .finish_non_exhaustive()
    }
}

impl Recorder<'_> {
    pub(super) fn new(sampling: Sampling, span: [f64; 2], x: &[f64]) -> Self {
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

    /// The next time of the grid; the end of the interval if they differ only by rounding.
    fn next_on_grid(&self, interval: f64) -> f64 {
        let [start, end] = self.span;
        let t = start + f64::from(self.next) * interval;
        if (t - end).abs() < 1e-9 * interval {
            end
        } else {
            t
        }
    }

    /// Records the final state, whose time need not lie on the grid.
    pub(super) fn finish(&mut self, t: f64, x: &[f64]) {
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

//! Admissible ranges of states.

use super::dense_output::{DenseOutput, Ends};
use super::error::Cause;
use super::events::brent;
use crate::model::ModelInfo;

/// The interval of a state outside which the equations do not hold.
///
/// A state is assumed to have at most one extremum within a step: it may leave and return if its rate points outwards
/// at the start and inwards at the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Index in the state.
    pub component: usize,
    /// Lower and upper limit in SI; may be infinite.
    pub limits: [f64; 2],
}

impl Range {
    /// The states of a model with a finite range.
    pub fn of(info: &ModelInfo) -> Vec<Self> {
        let limited = |limits: [f64; 2]| limits.iter().any(|limit| limit.is_finite());
        let states = info.states.iter().enumerate();
        states
            .filter(|(_, state)| limited(state.range))
            .map(|(component, state)| Self {
                component,
                limits: state.range,
            })
            .collect()
    }

    /// The limit that a value exceeds.
    pub(super) fn passed(&self, value: f64) -> Option<f64> {
        let [lower, upper] = self.limits;
        if value < lower {
            Some(lower)
        } else if value > upper {
            Some(upper)
        } else {
            None
        }
    }

    /// Whether the state may leave the range in a step, judged by the ends of the step: a curve without an inflection
    /// lies within its tangents.
    pub(super) fn may_be_left(&self, ends: &Ends<'_>) -> bool {
        let [x_old, x] = self.component_of(ends.x);
        let [rate_old, rate] = self.component_of(ends.rates);
        let h = ends.t[1] - ends.t[0];
        let tangents = [x_old + h * rate_old, x - h * rate];
        self.passed(x).is_some()
            || (rate_old * rate < 0.0 && tangents.iter().all(|&x| self.passed(x).is_some()))
    }

    /// The time at which the state first leaves the range in a step.
    pub(super) fn left_at(&self, ends: &Ends<'_>, dense: &DenseOutput) -> Option<f64> {
        if !self.may_be_left(ends) {
            return None;
        }
        let motion = |t: f64| dense.component_and_slope(t, self.component);
        let [start, end] = ends.t;
        let [rate_old, rate] = self.component_of(ends.rates);
        let turn = (rate_old * rate < 0.0).then(|| brent((start, end), |t| motion(t).1));
        // The state is monotonic between these times.
        let mut before = start;
        for t in turn.into_iter().chain([end]) {
            if let Some(limit) = self.passed(motion(t).0) {
                return Some(brent((before, t), |t| motion(t).0 - limit));
            }
            before = t;
        }
        None
    }

    /// The cause of failure for leaving the range.
    pub(super) fn cause(&self) -> Cause {
        Cause::OutOfRange {
            component: self.component,
            range: self.limits,
        }
    }

    fn component_of(&self, vectors: [&[f64]; 2]) -> [f64; 2] {
        vectors.map(|vector| vector[self.component])
    }
}

//! Switching functions of a motion; zeros of those of time alone are located by interval bounds.

use super::sign_changes::neighbours;
use crate::real::Enclosure;
use crate::switching::Counts;

/// The switching functions of the rates; see [`Switching`](crate::model::Switching).
pub struct Switches<'a> {
    /// Number of functions of each kind.
    pub counts: Counts,
    /// Writes the signs and truth values that depend on time alone, at a time in s.
    pub answers: SwitchFunction<'a>,
    /// Writes bounds on functions of time between two times in s: the switching functions, then the functions with
    /// pulses. Without it `answers` are compared at eighths of a step.
    pub within: Option<BoundFunction<'a>>,
    /// Writes the switching functions of time and state, then the functions with pulses.
    pub crossings: CrossingFunction<'a>,
    /// Writes bounds on these. Without it their signs are compared at eighths of a step and at minima of |g|.
    pub along: Option<StretchFunction<'a>>,
}

/// A segment of a motion within a step.
#[derive(Debug, Clone, Copy)]
pub struct Stretch<'a> {
    /// Start of the step in s.
    pub start: f64,
    /// Time.
    pub t: Enclosure,
    /// State.
    pub x: &'a [Enclosure],
}

/// Values at a time, boxed.
pub type SwitchFunction<'a> = Box<dyn FnMut(f64, &mut [f64]) + 'a>;
/// Bounds between two times, boxed.
pub type BoundFunction<'a> = Box<dyn FnMut([f64; 2], &mut [Enclosure]) + 'a>;
/// Values at a time and a state, boxed.
pub type CrossingFunction<'a> = Box<dyn FnMut(f64, &[f64], &mut [f64]) + 'a>;

/// Bounds along a segment, boxed.
pub type StretchFunction<'a> = Box<dyn FnMut(Stretch<'_>, &mut [Enclosure]) + 'a>;

impl std::fmt::Debug for Switches<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Switches")
            .field("counts", &self.counts)
            .finish_non_exhaustive()
    }
}

impl<'a> Switches<'a> {
    /// Switching by functions of time alone, without bounds.
    pub fn of_time(count: usize, answers: impl FnMut(f64, &mut [f64]) + 'a) -> Self {
        Self {
            counts: Counts {
                answers: count,
                ..Counts::default()
            },
            answers: Box::new(answers),
            within: None,
            crossings: Box::new(|_, _, _| {}),
            along: None,
        }
    }
}

/// Subintervals of a step in which switches without bounds are sought.
const PARTS: u8 = 8;
/// Most intervals examined in one step; beyond that, eighths of the remainder are compared.
const MOST_INTERVALS: usize = 4096;
/// The shortest of them, relative to the time: a few spacings of floating-point numbers.
const SHORTEST: f64 = 8.0 * f64::EPSILON;
const NEAR_ZERO: f64 = 1e-6;

/// Work arrays of the search.
#[derive(Debug, Default)]
pub(super) struct SwitchSearch {
    before: Vec<f64>,
    after: Vec<f64>,
    bounds: Vec<Enclosure>,
}

impl SwitchSearch {
    pub(super) fn new(counts: Counts) -> Self {
        Self {
            before: vec![0.0; counts.answers],
            after: vec![0.0; counts.answers],
            bounds: vec![Enclosure::UNKNOWN; counts.answers + counts.shapes],
        }
    }

    /// The first time after `t` and not after `t_new` at which a sign or truth value changes, to the last digit.
    ///
    /// Where bounds exclude zero from a function there is none, where they exclude zero from its slope there is at
    /// most one. Any other interval is bisected.
    pub(super) fn of_time(
        &mut self,
        switches: &mut Switches<'_>,
        [t, t_new]: [f64; 2],
    ) -> Option<f64> {
        if self.before.is_empty() {
            return None;
        }
        let count = self.before.len();
        let (before, after) = (&mut self.before, &mut self.after);
        (switches.answers)(t, before);
        let mut changed = |s: f64| {
            (switches.answers)(s, after);
            let bits = |value: &f64| value.to_bits();
            !before.iter().map(bits).eq(after.iter().map(bits))
        };
        let Some(within) = &mut switches.within else {
            return by_parts(changed, [t, t_new]);
        };
        let mut waiting = vec![[t, t_new]];
        for _ in 0..MOST_INTERVALS {
            let [from, to] = waiting.pop()?;
            within([from, to], &mut self.bounds);
            let functions = &self.bounds[..count];
            let mut undecided = functions.iter().filter(|of| !of.keeps_its_sign());
            if undecided.clone().next().is_none() {
                continue;
            }
            let is_short = to - from <= SHORTEST * to.abs().max(NEAR_ZERO);
            if is_short || undecided.all(Enclosure::is_monotonic) {
                if changed(to) {
                    return Some(neighbours(changed, [from, to])[1]);
                }
                continue;
            }
            let middle = f64::midpoint(from, to);
            waiting.extend([[middle, to], [from, middle]]);
        }
        let from = waiting.last().map_or(t, |&[from, _]| from);
        by_parts(changed, [from, t_new])
    }
}

/// The first change visible at eighths of an interval.
fn by_parts(mut changed: impl FnMut(f64) -> bool, [from, to]: [f64; 2]) -> Option<f64> {
    let part = |i: u8| match i {
        PARTS => to,
        _ => from + (to - from) * (f64::from(i) / f64::from(PARTS)),
    };
    let first = (1..=PARTS).find(|&i| changed(part(i)))?;
    Some(neighbours(changed, [part(first - 1), part(first)])[1])
}

//! Switching functions of a motion; zeros of those of time alone are located by interval bounds.

use super::shared::{Ahead, SharedTimes};
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
    /// What other motions with the same functions of time know.
    pub shared: Option<SharedTimes>,
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
            shared: None,
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

/// Intervals examined to find out how far no function changes.
const AHEAD: usize = 64;
/// Number of steps without a further look ahead after one that did not reach beyond its step.
const PAUSE: f64 = 8.0;

/// A search for changes of functions of time, with what it knows about the times ahead.
#[derive(Debug)]
pub(super) struct SwitchSearch {
    before: Vec<f64>,
    after: Vec<f64>,
    bounds: Vec<Enclosure>,
    /// From the first of these times to the second no function changes.
    clear: [f64; 2],
    /// Whether one changes at the second of them.
    is_change: bool,
    /// Time before which a look ahead does not pay.
    look_after: f64,
}

/// The result of a search.
enum Found {
    /// The first change.
    Change(f64),
    /// No change up to this time; beyond it nothing is known.
    Clear(f64),
}

impl SwitchSearch {
    pub(super) fn new(counts: Counts) -> Self {
        Self {
            before: vec![0.0; counts.answers],
            after: vec![0.0; counts.answers],
            bounds: vec![Enclosure::UNKNOWN; counts.answers + counts.shapes],
            clear: [f64::INFINITY, f64::NEG_INFINITY],
            is_change: false,
            look_after: f64::NEG_INFINITY,
        }
    }

    /// The first time after `t` and not after `t_new` at which a sign or truth value changes, to the last digit, in a
    /// motion up to `end`.
    pub(super) fn of_time(
        &mut self,
        switches: &mut Switches<'_>,
        [t, t_new]: [f64; 2],
        end: f64,
    ) -> Option<f64> {
        if self.before.is_empty() {
            return None;
        }
        if switches.within.is_none() {
            (switches.answers)(t, &mut self.before);
            return by_parts(|s| self.changed(switches, s), [t, t_new]);
        }
        if !(self.clear[0] <= t && t < self.clear[1]) && t >= self.look_after {
            self.look_ahead(switches, [t, t_new], end);
        }
        let [from, until] = self.clear;
        if from <= t && t < until {
            if self.is_change {
                return (until <= t_new).then_some(until);
            }
            if t_new <= until {
                return None;
            }
        }
        match self.search(switches, [t, t_new], MOST_INTERVALS) {
            Found::Change(change) => Some(change),
            Found::Clear(known) if known >= t_new => None,
            Found::Clear(known) => by_parts(|s| self.changed(switches, s), [known, t_new]),
        }
    }

    /// Finds out how far no function changes: a motion of many steps asks once.
    fn look_ahead(&mut self, switches: &mut Switches<'_>, [t, t_new]: [f64; 2], end: f64) {
        let span = [t, end.max(t_new)];
        let shared = switches.shared.clone();
        let mut find = || match self.search(switches, span, AHEAD) {
            Found::Change(until) => Ahead {
                until,
                is_change: true,
            },
            Found::Clear(until) => Ahead {
                until,
                is_change: false,
            },
        };
        let Ahead { until, is_change } = match shared {
            Some(shared) => shared.ahead(span, find),
            None => find(),
        };
        (self.clear, self.is_change) = ([t, until], is_change);
        if !is_change && until <= t_new {
            self.look_after = t + PAUSE * (t_new - t);
        }
    }

    /// Whether the answers differ from those before.
    fn changed(&mut self, switches: &mut Switches<'_>, t: f64) -> bool {
        (switches.answers)(t, &mut self.after);
        let bits = |value: &f64| value.to_bits();
        !self.before.iter().map(bits).eq(self.after.iter().map(bits))
    }

    /// The first change after `t` by at most so many bounds.
    ///
    /// Where bounds exclude zero from a function there is none, where they exclude zero from its slope there is at
    /// most one. Any other interval is bisected.
    fn search(&mut self, switches: &mut Switches<'_>, [t, end]: [f64; 2], most: usize) -> Found {
        (switches.answers)(t, &mut self.before);
        let count = self.before.len();
        let mut waiting = vec![[t, end]];
        for _ in 0..most {
            let Some([from, to]) = waiting.pop() else {
                return Found::Clear(end);
            };
            if let Some(within) = &mut switches.within {
                within([from, to], &mut self.bounds);
            }
            let functions = &self.bounds[..count];
            let mut undecided = functions.iter().filter(|of| !of.keeps_its_sign());
            if undecided.clone().next().is_none() {
                continue;
            }
            let is_short = to - from <= SHORTEST * to.abs().max(NEAR_ZERO);
            if is_short || undecided.all(Enclosure::is_monotonic) {
                if self.changed(switches, to) {
                    let [_, change] = neighbours(|s| self.changed(switches, s), [from, to]);
                    return Found::Change(change);
                }
                continue;
            }
            let middle = f64::midpoint(from, to);
            waiting.extend([[middle, to], [from, middle]]);
        }
        Found::Clear(waiting.last().map_or(end, |&[from, _]| from))
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

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::real::Real;

    /// Signs of two functions: of time up to 7, and of a wave of 3 rad/s. Counts the evaluations of their bounds.
    fn two(bounds: &Cell<usize>, shared: Option<SharedTimes>) -> Switches<'_> {
        let wave = |t: Enclosure| (t * Real::constant(3.0)).sin() - Real::constant(0.5);
        let mut switches = Switches::of_time(2, |t, answers| {
            answers[0] = f64::from(u8::from(t < 7.0));
            answers[1] = ((3.0 * t).sin() - 0.5).signum();
        });
        switches.within = Some(Box::new(move |[from, to], functions| {
            bounds.set(bounds.get() + 1);
            let t = Enclosure::time(from, to);
            functions[0] = t - Real::constant(7.0);
            functions[1] = wave(t);
        }));
        switches.shared = shared;
        switches
    }

    /// The changes that steps of a length find up to the end; the first step after each is tried with `first`.
    fn changes(switches: &mut Switches<'_>, [first, h]: [f64; 2], end: f64) -> Vec<f64> {
        let mut search = SwitchSearch::new(switches.counts);
        let (mut t, mut found) = (0.0, Vec::new());
        while t < end {
            let is_first = found.last().is_none_or(|&last| t <= last);
            let t_new = (t + if is_first { first } else { h }).min(end);
            t = match search.of_time(switches, [t, t_new], end) {
                Some(change) => {
                    found.push(change);
                    change
                }
                None => t_new,
            };
        }
        found
    }

    #[test]
    fn steps_of_any_length_find_the_same_changes() {
        let bounds = Cell::new(0);
        let expected = changes(&mut two(&bounds, None), [0.5; 2], 10.0);
        // 3 t = π/6 and 5 π/6, each 2 π later, and 7.
        assert_eq!(expected.len(), 11, "{expected:?}");
        for h in [[1e-3; 2], [0.03; 2], [2.0, 1e-2], [10.0; 2]] {
            let found = changes(&mut two(&bounds, None), h, 10.0);
            let bits = |all: &[f64]| all.iter().map(|t| t.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&found), bits(&expected), "steps of {h:?}");
        }
    }

    #[test]
    fn many_steps_and_many_motions_ask_for_few_bounds() {
        let bounds = Cell::new(0);
        let found = changes(&mut two(&bounds, None), [4.0, 1e-3], 10.0);
        let alone = bounds.get();
        assert!(alone < 40 * found.len(), "{alone} bounds in 10 000 steps");
        let shared = SharedTimes::default();
        for _ in 0..100 {
            let again = changes(&mut two(&bounds, Some(shared.clone())), [4.0, 1e-3], 10.0);
            assert_eq!(again, found);
        }
        assert!(bounds.get() <= 2 * alone, "{} bounds", bounds.get());
    }
}

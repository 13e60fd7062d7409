//! Zeros of switching functions of the state within a step, and step sizes that do not step over pulses of functions
//! of the state.
//!
//! Interval bounds along the interpolant decide: where they exclude zero from a function there is no switch, where
//! they exclude zero from its slope there is at most one, and any other interval is bisected.

use super::dense_output::{DenseOutput, Ends};
use super::pace::Pace;
use super::sign_changes::{first_change, neighbours};
use super::switches::{Stretch, Switches};
use crate::real::Enclosure;
use crate::switching::Counts;

/// Most intervals examined in one step; beyond that the functions are sampled.
const MOST_STRETCHES: usize = 512;
/// The shortest of them, as a fraction of the step.
const SHORTEST: f64 = 1e-13;
/// The time after which the sign of a function that is zero at the start is taken, as a fraction of the step.
const SOON: f64 = 1e-9;
/// Relative rounding error of a state in the equations.
const BEYOND: f64 = 64.0 * f64::EPSILON;
/// Work arrays of the search.
#[derive(Debug, Default)]
pub(super) struct CrossingSearch {
    /// Signs at the start of the step.
    signs: Vec<f64>,
    values: Vec<f64>,
    x: Vec<f64>,
    along: Vec<Enclosure>,
    bounds: Vec<Enclosure>,
    pulses: usize,
}

impl CrossingSearch {
    pub(super) fn new(counts: Counts) -> Self {
        let all = counts.crossings + counts.pulses;
        Self {
            signs: vec![0.0; counts.crossings],
            values: vec![0.0; all],
            bounds: vec![Enclosure::UNKNOWN; all],
            pulses: counts.pulses,
            ..Self::default()
        }
    }

    /// Whether there are switching functions of the state.
    pub(super) fn has_crossings(&self) -> bool {
        !self.signs.is_empty()
    }

    /// Whether there are functions of the state with pulses.
    pub(super) fn has_pulses(&self) -> bool {
        self.pulses > 0
    }

    /// The first zero of a switching function along the interpolant of a step, with the state there.
    pub(super) fn first(
        &mut self,
        switches: &mut Switches<'_>,
        ends: &Ends<'_>,
        dense: &DenseOutput,
    ) -> Option<(f64, &[f64])> {
        if !self.has_crossings() {
            return None;
        }
        let [t, t_new] = ends.t;
        self.start(switches, ends, dense);
        let mut known = vec![false; self.signs.len()];
        let mut first = self.by_bounds(switches, ends.t, dense, &mut known);
        for i in (0..self.signs.len()).filter(|&i| !known[i]) {
            let sign = self.signs[i];
            let g = |s: f64| self.at(switches, s, dense)[i];
            let to = first.unwrap_or(t_new);
            let change = first_change(g, |value| value * sign < 0.0, [t, to]);
            first = change.map(|[_, other]| other).or(first);
        }
        let first = first?;
        // Beyond the zero by the rounding error, so that the rates see the new sign.
        let t_new = (first + BEYOND * first.abs()).min(t_new);
        dense.state(t_new, &mut self.x);
        Some((t_new, &self.x))
    }

    /// The longest step from its start that does not step over a pulse along an interpolant.
    pub(super) fn longest(
        &mut self,
        switches: &mut Switches<'_>,
        [t, t_new]: [f64; 2],
        dense: &DenseOutput,
    ) -> f64 {
        let h = t_new - t;
        if self.pulses == 0 || switches.along.is_none() {
            return h;
        }
        let first = self.signs.len();
        let states = dense.states();
        self.x.resize(states, 0.0);
        let middle = f64::midpoint(t, t_new);
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.pulses];
        for s in [t, middle, t_new] {
            let values = self.at(switches, s, dense);
            for (range, value) in ranges.iter_mut().zip(&values[first..]) {
                *range = [range[0].min(*value), range[1].max(*value)];
            }
        }
        let of_step = self.bound(switches, t, [t, t_new], dense);
        let pulses = of_step[first..].iter().zip(&ranges).enumerate();
        let sought: Vec<usize> = pulses
            .filter(|(_, (of, [low, high]))| of.may_hide(high - low, h, 0.0))
            .map(|(i, _)| first + i)
            .collect();
        if sought.is_empty() {
            return h;
        }
        let mut known = None;
        let pace = Pace::new([t, t_new], sought.len(), |i, part| {
            if known != Some(part) {
                self.bound(switches, t, part, dense);
                known = Some(part);
            }
            self.bounds[sought[i]]
        });
        pace.longest(t, h)
    }

    /// The values of all functions at a time within a step.
    fn at(&mut self, switches: &mut Switches<'_>, t: f64, dense: &DenseOutput) -> &[f64] {
        dense.state(t, &mut self.x);
        (switches.crossings)(t, &self.x, &mut self.values);
        &self.values
    }

    /// Bounds on all functions between two times within a step.
    fn bound(
        &mut self,
        switches: &mut Switches<'_>,
        start: f64,
        part: [f64; 2],
        dense: &DenseOutput,
    ) -> &[Enclosure] {
        dense.within(part, &mut self.along);
        let [from, to] = part;
        if let Some(along) = &mut switches.along {
            let (t, x) = (Enclosure::time(from, to), &self.along[..]);
            along(Stretch { start, t, x }, &mut self.bounds);
        }
        &self.bounds
    }

    /// Determines the signs at the start of a step.
    fn start(&mut self, switches: &mut Switches<'_>, ends: &Ends<'_>, dense: &DenseOutput) {
        let count = self.signs.len();
        let [t, t_new] = ends.t;
        self.x.resize(ends.x[0].len(), 0.0);
        (switches.crossings)(t, ends.x[0], &mut self.values);
        self.signs.copy_from_slice(&self.values[..count]);
        if self.signs.contains(&0.0) {
            // A function that is zero at the start takes the sign just after it.
            self.at(switches, t + (t_new - t) * SOON, dense);
            for (sign, value) in self.signs.iter_mut().zip(&self.values) {
                if *sign == 0.0 {
                    *sign = *value;
                }
            }
        }
    }

    /// The first zero among the functions that have bounds. These are marked as known, unless the search is
    /// inconclusive.
    fn by_bounds(
        &mut self,
        switches: &mut Switches<'_>,
        [t, t_new]: [f64; 2],
        dense: &DenseOutput,
        known: &mut [bool],
    ) -> Option<f64> {
        switches.along.as_ref()?;
        let (mut waiting, mut part) = (Vec::new(), [t, t_new]);
        let bounds = self.bound(switches, t, part, dense);
        for (known, of) in known.iter_mut().zip(bounds) {
            let middle = of.middle();
            *known = middle.lo.is_finite() && middle.hi.is_finite();
        }
        for _ in 0..MOST_STRETCHES {
            let [from, to] = part;
            let bounds = self.bounds.iter().take(known.len()).enumerate();
            let undecided: Vec<(usize, bool)> = bounds
                .filter(|&(i, of)| known[i] && !of.keeps_its_sign())
                .map(|(i, of)| (i, of.is_monotonic()))
                .collect();
            let middle = f64::midpoint(from, to);
            let is_short = to - from <= SHORTEST * (t_new - t) || middle <= from || middle >= to;
            if is_short || undecided.iter().all(|(_, is_monotonic)| *is_monotonic) {
                let mut changed = |s: f64| {
                    self.at(switches, s, dense);
                    let signs = |&(i, _): &(usize, bool)| self.values[i] * self.signs[i] < 0.0;
                    undecided.iter().any(signs)
                };
                if !undecided.is_empty() && changed(to) {
                    return Some(neighbours(changed, [from, to])[1]);
                }
            } else {
                waiting.extend([[middle, to], [from, middle]]);
            }
            part = waiting.pop()?;
            self.bound(switches, t, part, dense);
        }
        known.fill(false);
        None
    }
}

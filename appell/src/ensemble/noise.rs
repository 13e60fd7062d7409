//! Noise over time: independent normal numbers, each held for an interval. A number is determined by seed, name, case
//! and its index in time.

use std::cell::Cell;

use appell_ensemble::normal;
use appell_ensemble::random::Stream;
use appell_runtime::inputs::InputSource;
use appell_runtime::model::{Along, Switching};
use appell_runtime::real::Enclosure;

use crate::inputs::closed_loop::Onto;
use crate::inputs::controller::Controller;

/// A noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    stream: Stream,
    pub(super) onto: Onto,
    deviation: f64,
    every: f64,
}

impl Noise {
    pub(super) fn new(seed: u64, name: &str, onto: Onto, deviation: f64, every: f64) -> Self {
        Self {
            stream: Stream::new(seed, &format!("{name} (noise)")),
            onto,
            deviation,
            every,
        }
    }

    /// Count of numbers up to a time: at a multiple of the interval the next one counts, just before it does not.
    fn place(&self, t: f64) -> u64 {
        // A time of a motion.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let mut place = (t / self.every).max(0.0) as u64;
        while place > 0 && place as f64 * self.every > t {
            place -= 1;
        }
        while (place + 1) as f64 * self.every <= t {
            place += 1;
        }
        place
    }

    /// Count of numbers for a motion up to a time.
    pub(super) fn count(&self, until: f64) -> usize {
        usize::try_from(self.place(until)).map_or(usize::MAX, |last| last.saturating_add(1))
    }

    /// The interval in s for which a number is held.
    pub(super) fn every(&self) -> f64 {
        self.every
    }

    /// The value at a time; `from` is the index of its first score.
    fn value(&self, draws: Draws<'_>, from: usize, t: f64) -> f64 {
        self.number(draws, from, self.place(t))
    }

    /// A number by its place among those of a motion.
    fn number(&self, draws: Draws<'_>, from: usize, place: u64) -> f64 {
        let score = match draws {
            Draws::Case(case) => normal::quantile(self.stream.uniform(case, place)),
            Draws::Scores(scores) => {
                let place = usize::try_from(place)
                    .ok()
                    .and_then(|p| p.checked_add(from));
                place.and_then(|p| scores.get(p)).copied().unwrap_or(0.0)
            }
        };
        self.deviation * score
    }
}

/// Source of random numbers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Draws<'a> {
    /// From the number of the case.
    Case(u64),
    /// From normal scores: those of the drawn factors, then those of each noise.
    Scores(&'a [f64]),
}

/// A controller under noise.
pub(super) struct Noisy<'a> {
    pub(super) controller: Controller<'a>,
    pub(super) noises: &'a [Noise],
    pub(super) draws: Draws<'a>,
    /// Number of drawn factors, whose scores are first.
    pub(super) drawn: usize,
    pub(super) until: f64,
    /// Buffers for state and parameters.
    pub(super) scratch: Cell<[Vec<f64>; 2]>,
}

impl Noisy<'_> {
    /// The noises at a time.
    fn values(&self, t: f64) -> impl Iterator<Item = (Onto, f64)> {
        let mut from = self.drawn;
        self.noises.iter().map(move |noise| {
            let value = noise.value(self.draws, from, t);
            from = from.saturating_add(noise.count(self.until));
            (noise.onto, value)
        })
    }

    /// Appends the numbers of all noises, one noise after another.
    #[cfg(feature = "cuda")]
    pub(super) fn numbers(&self, numbers: &mut Vec<f64>) {
        let mut from = self.drawn;
        for noise in self.noises {
            let count = noise.count(self.until);
            numbers.extend((0..count as u64).map(|place| noise.number(self.draws, from, place)));
            from = from.saturating_add(count);
        }
    }

    /// Writes the noises at a time to parameters.
    pub(super) fn parameters_at(&self, t: f64, p: &mut [f64]) {
        for (onto, value) in self.values(t) {
            if let Onto::Parameter(parameter) = onto {
                p[parameter] = value;
            }
        }
    }

    /// Calls a function with the parameters and the state as laws measure them.
    fn with_seen(&self, t: f64, x: &[f64], call: impl FnOnce(&[f64], &[f64])) {
        let parameters = self.controller.parameters();
        if self.noises.is_empty() {
            call(parameters, x);
            return;
        }
        let [mut measured, mut seen] = self.scratch.take();
        measured.clear();
        measured.extend_from_slice(x);
        seen.clear();
        seen.extend_from_slice(parameters);
        for (onto, value) in self.values(t) {
            match onto {
                Onto::Measured(state) => measured[state] += value,
                Onto::Parameter(parameter) => seen[parameter] = value,
            }
        }
        call(&seen, &measured);
        self.scratch.set([measured, seen]);
    }

    /// The inputs of the closed loop: external ones, then the noises.
    pub(super) fn fill_outside(&self, t: f64, x: &[f64], u: &mut [f64]) {
        let (outside, noises) = u.split_at_mut(u.len() - self.noises.len());
        self.with_seen(t, x, |p, x| self.controller.fill_outside(p, t, x, outside));
        for (noise, (_, value)) in noises.iter_mut().zip(self.values(t)) {
            *noise = value;
        }
    }
}

impl InputSource for Noisy<'_> {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        self.with_seen(t, x, |p, x| self.controller.inputs_with(p, t, x, u));
    }

    fn switching_times(&self) -> Vec<f64> {
        let mut times = self.controller.switching_times();
        for noise in self.noises {
            let last = noise.place(self.until);
            times.extend((1..=last).map(|place| place as f64 * noise.every));
        }
        // Noises of one interval switch together.
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    fn bounds(&self, along: &Along<'_>, u: &mut [Enclosure]) {
        if self.noises.is_empty() {
            self.controller.bounds(along, u);
        } else {
            u.fill(Enclosure::UNKNOWN);
        }
    }

    fn switching(&self) -> Option<&dyn Switching> {
        self.controller.switching()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_held_up_to_the_next_multiple() {
        for every in [0.1, 0.01, 1.0 / 3.0] {
            let noise = Noise::new(1, "gust", Onto::Parameter(0), 1.0, every);
            for place in 1..2000_u64 {
                let t = place as f64 * every;
                assert_eq!(noise.place(t), place);
                assert_eq!(noise.place(t.next_down()), place - 1);
            }
        }
    }
}

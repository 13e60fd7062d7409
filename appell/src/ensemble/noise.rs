//! Noise over time: independent normal numbers, each held for a while. A number follows from seed, name, case and
//! its place in time.

use std::cell::Cell;

use appell_ensemble::normal;
use appell_ensemble::random::Stream;
use appell_runtime::inputs::InputSource;

use crate::inputs::controller::Controller;

/// What has the noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Onto {
    /// A state, as laws and inputs measure it.
    Measured(usize),
    /// A quantity of the study's own.
    Parameter(usize),
}

/// A noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    stream: Stream,
    onto: Onto,
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

    /// How many numbers have come at a time. At a multiple of the interval the next one is there, just before not.
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

    /// How many numbers a motion up to a time needs.
    pub(super) fn count(&self, until: f64) -> usize {
        usize::try_from(self.place(until)).map_or(usize::MAX, |last| last.saturating_add(1))
    }

    /// The value at a time; `from` is where its scores begin.
    fn value(&self, draws: Draws<'_>, from: usize, t: f64) -> f64 {
        let place = self.place(t);
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

/// Where random numbers come from.
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
    /// Number of factors that are drawn, whose scores come first.
    pub(super) drawn: usize,
    pub(super) until: f64,
    /// State and parameters, kept to be written anew.
    pub(super) scratch: Cell<[Vec<f64>; 2]>,
}

impl InputSource for Noisy<'_> {
    fn inputs(&self, t: f64, x: &[f64], u: &mut [f64]) {
        if self.noises.is_empty() {
            self.controller.inputs(t, x, u);
            return;
        }
        let [mut measured, mut parameters] = self.scratch.take();
        measured.clear();
        measured.extend_from_slice(x);
        parameters.clear();
        parameters.extend_from_slice(self.controller.parameters());
        let mut from = self.drawn;
        for noise in self.noises {
            let value = noise.value(self.draws, from, t);
            from = from.saturating_add(noise.count(self.until));
            match noise.onto {
                Onto::Measured(state) => measured[state] += value,
                Onto::Parameter(parameter) => parameters[parameter] = value,
            }
        }
        self.controller.inputs_with(&parameters, t, &measured, u);
        self.scratch.set([measured, parameters]);
    }

    fn switching_times(&self) -> Vec<f64> {
        let mut times = self.controller.switching_times();
        for noise in self.noises {
            let last = noise.place(self.until);
            times.extend((1..=last).map(|place| place as f64 * noise.every));
        }
        times
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

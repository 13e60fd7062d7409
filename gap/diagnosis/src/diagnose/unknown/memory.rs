//! Forces with a hidden state, each kind with one parameter on a grid: the natural frequency of a hidden mass, the
//! presliding displacement of hysteresis.
//!
//! The hidden state is computed from the recordings once, and then used like a recorded channel.

use std::f64::consts::TAU;

use appell_estimate::Measured;
use appell_runtime::model::At;

use super::super::Bench;
use super::hidden::{self, Trace};
use crate::effects::Memory;
use appell_recordings::Run;

/// The kind of a hidden state.
#[derive(Clone, Copy)]
enum Kind {
    Swing,
    Way,
}

/// Forces of a kind along a coordinate, one for each value of the parameter.
pub(super) struct Memories {
    kind: Kind,
    coordinate: String,
    /// The values of the parameter, the smallest first.
    sizes: Vec<f64>,
    /// For each whole run its times, and a value of each term at each.
    runs: Vec<(Vec<f64>, Vec<Vec<f64>>)>,
    /// The whole run of each recording.
    places: Vec<usize>,
}

impl Memories {
    /// Along all measured coordinates. In windows the state depends on the run before them.
    pub(super) fn all(bench: &Bench<'_>) -> Vec<Self> {
        let info = bench.effects.info();
        let place = |run: &Run| bench.whole.iter().position(|whole| whole.name == run.name);
        let places: Option<Vec<usize>> = bench.set.runs.iter().map(place).collect();
        let mut all = Vec::new();
        for (channel, shown) in bench.set.measured(info) {
            let columns = bench.set.channels.iter();
            let column = columns
                .take_while(|own| own.column != channel.column)
                .count();
            let Measured::State(state) = shown else {
                continue;
            };
            if state < info.speeds {
                continue;
            }
            let trace = |run: &Run| Trace::of(run, column);
            let traces: Vec<Trace> = bench.whole.iter().map(trace).collect();
            for kind in [Kind::Swing, Kind::Way] {
                let name = &info.states[state].name;
                all.extend(
                    places
                        .clone()
                        .map(|places| Self::of(kind, name, &traces, places)),
                );
            }
        }
        all.retain(|one| !one.sizes.is_empty());
        all
    }

    fn of(kind: Kind, coordinate: &str, traces: &[Trace], places: Vec<usize>) -> Self {
        let noise = hidden::noise(traces);
        let sizes = match kind {
            Kind::Swing => hidden::frequencies(traces),
            Kind::Way => hidden::ways(traces, noise),
        };
        let of_run = |trace: &Trace| {
            let terms = sizes.iter().flat_map(|&size| match kind {
                Kind::Swing => hidden::swing_terms(trace, size).to_vec(),
                Kind::Way => hidden::way_terms(trace, noise, size).to_vec(),
            });
            (trace.times.clone(), terms.collect())
        };
        Self {
            kind,
            coordinate: coordinate.to_owned(),
            runs: traces.iter().map(of_run).collect(),
            places,
            sizes,
        }
    }

    /// Number of forces.
    pub(super) const fn len(&self) -> usize {
        self.sizes.len()
    }

    /// The terms of one of them.
    pub(super) fn terms(&self, number: usize) -> Vec<usize> {
        let each = self.count() / self.len();
        (each * number..each * (number + 1)).collect()
    }

    /// Total number of terms.
    pub(super) fn count(&self) -> usize {
        self.runs[0].1.len()
    }

    /// The terms at a time.
    pub(super) fn at(&self, run: usize, at: At<'_>, to: &mut [f64]) {
        let (times, values) = &self.runs[self.places[run]];
        let row = times.partition_point(|&own| own <= at.t).saturating_sub(1);
        for (to, value) in to.iter_mut().zip(values) {
            *to = value[row];
        }
    }

    /// One of them in words.
    pub(super) fn name(&self, number: usize) -> String {
        let coordinate = &self.coordinate;
        match self.kind {
            Kind::Swing => {
                let hertz = self.sizes[number] / TAU;
                format!("an oscillation of a hidden mass at {coordinate} with {hertz:.2} Hz")
            }
            Kind::Way => format!("the travel of {coordinate} since its last reversal"),
        }
    }

    /// One of them with its prior, from a first estimate of its coefficient.
    pub(super) fn first(&self, number: usize, term: f64) -> Memory {
        let own = self.sizes[number];
        let next = self.sizes.get(number + 1);
        let known = [own, next.map_or(own, |next| next - own)];
        let coordinate = self.coordinate.clone();
        // The force opposes the hysteresis state.
        match self.kind {
            Kind::Swing => Memory::HiddenMass {
                behind: coordinate,
                mass: [-term, -term],
                rate: known,
                damping: [hidden::DAMPING, hidden::DAMPING],
            },
            Kind::Way => Memory::Hysteresis {
                along: coordinate,
                force: [-term, -term],
                way: known,
            },
        }
    }

    /// The one with the largest gain, if it is inside the range of the parameter: at an end another law is likely.
    pub(super) fn best(gains: &[f64]) -> Option<usize> {
        let best = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]))?;
        (best > 0 && best + 1 < gains.len()).then_some(best)
    }
}

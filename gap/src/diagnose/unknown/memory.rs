//! Forces that depend on what was before, each kind with one number that says how far back: the frequency of a mass
//! that swings by itself, the way over which a force follows a turn.
//!
//! What they remember is computed from the recordings, once: it stands beside them as a channel would.

use appell_estimate::Measured;
use appell_runtime::model::At;

use super::super::bench::Bench;
use super::trace::Trace;
use super::{hysteresis, swing};
use crate::effects::Memory;
use appell_recordings::Run;

/// What a force remembers.
#[derive(Clone, Copy)]
enum Kind {
    Swing,
    Way,
}

/// Forces of a kind behind a coordinate, one of each size.
pub(super) struct Memories {
    kind: Kind,
    coordinate: String,
    /// The numbers that say how far back, the smallest first.
    sizes: Vec<f64>,
    /// For each whole run its times, and a value of each term at each.
    runs: Vec<(Vec<f64>, Vec<Vec<f64>>)>,
    /// The whole run of each recording.
    places: Vec<usize>,
}

impl Memories {
    /// Behind all coordinates that are measured. Windows remember the run before them.
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
        let noise = hysteresis::noise(traces);
        let sizes = match kind {
            Kind::Swing => swing::frequencies(traces),
            Kind::Way => hysteresis::ways(traces, noise),
        };
        let of_run = |trace: &Trace| {
            let terms = sizes.iter().flat_map(|&size| match kind {
                Kind::Swing => swing::terms(trace, size).to_vec(),
                Kind::Way => hysteresis::terms(trace, noise, size).to_vec(),
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

    /// How many there are.
    pub(super) const fn len(&self) -> usize {
        self.sizes.len()
    }

    /// The terms of one of them.
    pub(super) fn terms(&self, number: usize) -> Vec<usize> {
        let each = self.count() / self.len();
        (each * number..each * (number + 1)).collect()
    }

    /// How many terms they have together.
    pub(super) fn count(&self) -> usize {
        self.runs[0].1.len()
    }

    /// The terms at a place.
    pub(super) fn at(&self, run: usize, at: At<'_>, to: &mut [f64]) {
        let (times, values) = &self.runs[self.places[run]];
        let row = times.partition_point(|&own| own <= at.t).saturating_sub(1);
        for (to, value) in to.iter_mut().zip(values) {
            *to = value[row];
        }
    }

    /// One of them in words.
    pub(super) fn name(&self, number: usize) -> String {
        match self.kind {
            Kind::Swing => swing::name(&self.coordinate, self.sizes[number]),
            Kind::Way => hysteresis::name(&self.coordinate),
        }
    }

    /// What is known beforehand of one of them, from a first estimate of its term.
    pub(super) fn first(&self, number: usize, term: f64) -> Memory {
        let own = self.sizes[number];
        let next = self.sizes.get(number + 1);
        let known = [own, next.map_or(own, |next| next - own)];
        // It acts against what it remembers.
        match self.kind {
            Kind::Swing => swing::first(&self.coordinate, known, -term),
            Kind::Way => hysteresis::first(&self.coordinate, known, -term),
        }
    }

    /// The one that gains most, if its size lies within the range: at its ends it looks like something else.
    pub(super) fn best(gains: &[f64]) -> Option<usize> {
        let best = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]))?;
        (best > 0 && best + 1 < gains.len()).then_some(best)
    }
}

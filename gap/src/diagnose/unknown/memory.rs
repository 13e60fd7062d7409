//! Forces that depend on what was before, each kind with one number that says how far back: the frequency of a mass
//! that swings by itself, the way over which a force follows a turn.
//!
//! What they remember is computed from the recordings, once: it stands beside them as a channel would.

use appell_estimate::Measured;
use appell_runtime::model::At;

use super::super::bench::Bench;
use super::{hysteresis, swing};
use crate::effects::Memory;
use appell_recordings::Run;

/// A coordinate in a run.
pub(super) struct Trace {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
}

impl Trace {
    pub(super) fn duration(&self) -> f64 {
        self.times[self.times.len() - 1] - self.times[0]
    }

    pub(super) fn step(&self) -> f64 {
        self.duration() / (self.times.len() - 1) as f64
    }

    /// How far each row is off the line through its neighbours, in what the noise of all three lets expect.
    pub(super) fn off_the_line(&self) -> impl Iterator<Item = f64> {
        self.times
            .windows(3)
            .zip(self.values.windows(3))
            .map(|(t, v)| {
                let part = (t[1] - t[0]) / (t[2] - t[0]);
                let line = v[0] + part * (v[2] - v[0]);
                (v[1] - line).abs() / (1.0 + part * part + (1.0 - part) * (1.0 - part)).sqrt()
            })
    }

    pub(super) fn longest_row(&self) -> f64 {
        let pairs = self.values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        pairs.fold(0.0, f64::max)
    }
}

/// A range of positive numbers.
pub(super) struct Span(pub(super) f64, pub(super) f64);

impl Span {
    /// So many of them, each by the same factor larger; none where there is no range.
    pub(super) fn places(&self, count: usize) -> Vec<f64> {
        let &Self(low, high) = self;
        if !(low > 0.0 && high > low) {
            return Vec::new();
        }
        let part = |place: usize| place as f64 / (count - 1) as f64;
        (0..count)
            .map(|i| low * (high / low).powf(part(i)))
            .collect()
    }
}

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
            let trace = |run: &Run| Trace {
                times: run.times.clone(),
                values: filled(run.values[column].clone()),
            };
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

/// What is missing keeps the value before.
fn filled(mut values: Vec<f64>) -> Vec<f64> {
    let first = values.iter().copied().find(|value| !value.is_nan());
    let mut last = first.unwrap_or(0.0);
    for value in &mut values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
    values
}

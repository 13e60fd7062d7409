//! Experiment design for model discrimination: the input that separates two tied hypotheses best.
//!
//! One hypothesis simulates a recording without noise; the filter of the other one is run on it. Its whitened
//! innovations are the difference of the two, minimised over the parameters within their present
//! uncertainty: with innovations r, sensitivities S and the information I of the
//! fit, d² = min over z of |r + S z|² + zᵀ I z. Two models with separation d differ by d²/2 in log likelihood.

use appell_estimate::{Estimation, Recording, Unknown};
use nalgebra::{DMatrix, DVector};

use super::gram::moving;
use super::prediction::taken_over;
use super::{Bench, Comparison, Experiment, Fitted, Limit, Result};
use crate::experiment::Excitation;
use appell_recordings::{DataSet, Role};

/// Longest experiment in s.
const LONGEST: f64 = 20.0;
/// Largest number of its rows.
const MOST_ROWS: f64 = 1e6;
/// Amplitudes that are tried, relative to the limits.
const SIZES: [f64; 4] = [1.0, 0.7, 0.4, 0.2];
/// Without a stated limit, a measured channel may exceed its recorded range by this part of it.
const ROOM: f64 = 0.25;

/// The constraints of the experiment.
struct Rig<'a> {
    bench: &'a Bench<'a>,
    step: f64,
    duration: f64,
    /// Limits of the inputs by their index; `None` for those that cannot be commanded.
    inputs: Vec<Option<[f64; 2]>>,
    /// Limits of the measured channels.
    channels: Vec<[f64; 2]>,
}

/// A test signal on one input.
#[derive(Clone, Copy)]
struct TestSignal {
    /// Index of the input.
    input: usize,
    /// Limits of the input.
    limits: [f64; 2],
    /// Course over time.
    shape: Excitation,
    /// Amplitude relative to the limits.
    size: f64,
}

/// The best experiment for two hypotheses; `None` if no input that was tried keeps the motion
/// within its limits.
pub(super) fn experiment(
    bench: &Bench<'_>,
    comparison: &Comparison,
    pair: [&[String]; 2],
    limits: &[Limit],
) -> Result<Option<Experiment>> {
    let fit = |effects: &[String]| {
        let mut fits = comparison.fits.iter().map(|(fitted, _)| fitted);
        fits.find(|fitted| {
            let names = fitted.members.iter().map(|&m| bench.candidate(m).name());
            names.eq(effects.iter().cloned())
        })
    };
    let (Some(truth), Some(rival)) = (fit(pair[0]), fit(pair[1])) else {
        return Ok(None);
    };
    let rig = Rig::new(bench, limits);
    let mut best: Option<(f64, TestSignal, Recording)> = None;
    for (input, limits) in rig.inputs.iter().enumerate() {
        let Some(limits) = limits else { continue };
        // A motion that leaves its limits without input does so with any.
        let idle = TestSignal {
            input,
            limits: *limits,
            shape: Excitation::library(rig.duration, rig.step)[0],
            size: 0.0,
        };
        if rig.made(truth, idle)?.is_none() {
            continue;
        }
        for shape in Excitation::library(rig.duration, rig.step) {
            // Smaller inputs if larger ones leave the limits.
            for size in SIZES {
                let signal = TestSignal {
                    shape,
                    size,
                    ..idle
                };
                let Some(recording) = rig.made(truth, signal)? else {
                    continue;
                };
                let d = distance(bench, rival, &recording)?;
                if d.is_finite() && best.as_ref().is_none_or(|best| d > best.0) {
                    best = Some((d, signal, recording));
                }
                break;
            }
        }
    }
    let Some((d, signal, recording)) = best else {
        return Ok(None);
    };
    let gap = truth.evidence.log_likelihood - rival.evidence.log_likelihood;
    let now = (2.0 * gap.abs()).sqrt();
    let name = |input: usize| bench.effects.info().inputs[input].name.to_string();
    Ok(Some(Experiment {
        separates: pair.map(<[String]>::to_vec),
        about: format!(
            "{} on {}, {:.0} % of its limits",
            signal.shape,
            name(signal.input),
            100.0 * signal.size
        ),
        separation_now: now,
        separation_then: now.hypot(d),
        inputs: rig.driven(&recording, name),
        times: recording.times().to_vec(),
    }))
}

impl<'a> Rig<'a> {
    fn new(bench: &'a Bench<'a>, limits: &[Limit]) -> Self {
        let set = &bench.set;
        let info = bench.effects.info();
        let stated = |column: &str| {
            let own = limits.iter().find(|(own, _)| own == column);
            own.map(|(_, limit)| *limit)
        };
        let mut inputs = vec![None; info.declared_inputs];
        for (column, channel) in set.channels.iter().enumerate() {
            if let Role::Input(input) = channel.role {
                let range = stated(&channel.column).or_else(|| range(set, column));
                inputs[input] = range.filter(|[low, high]| high > low);
            }
        }
        let measured = set.measured(info);
        let channels = measured.iter().map(|(channel, _)| {
            let mut columns = set.channels.iter();
            let column = columns.position(|own| own.column == channel.column);
            let recorded = column.and_then(|column| range(set, column));
            let wide = recorded.map(|[low, high]| {
                let room = ROOM * (high - low);
                [low - room, high + room]
            });
            let all = [f64::NEG_INFINITY, f64::INFINITY];
            stated(&channel.column).or(wide).unwrap_or(all)
        });
        let durations = bench.recordings.iter().map(|run| {
            let times = run.times();
            times[times.len() - 1] - times[0]
        });
        let longest = durations.fold(0.0_f64, f64::max);
        Self {
            bench,
            step: bench.step.max(longest.min(LONGEST) / MOST_ROWS),
            duration: longest.min(LONGEST),
            inputs,
            channels: channels.collect(),
        }
    }

    /// The recording without noise that a hypothesis predicts; `None` if the motion leaves its limits.
    fn made(&self, truth: &Fitted, signal: TestSignal) -> Result<Option<Recording>> {
        let samples = signal.shape.samples(self.duration, self.step);
        let (rows, columns, channels) = (samples.len(), self.inputs.len(), self.channels.len());
        let mut inputs = vec![0.0; rows * columns];
        let [low, high] = signal.limits;
        let (centre, half) = (0.5 * (low + high), 0.5 * signal.size * (high - low));
        for (row, sample) in samples.iter().enumerate() {
            inputs[row * columns + signal.input] = centre + half * sample;
        }
        let times = (0..rows).map(|row| row as f64 * self.step).collect();
        // The first row is missing; at all others the innovations against zero are the negative predictions.
        let mut nothing = vec![0.0; rows * channels];
        nothing[..channels].fill(f64::NAN);
        let blank = vec![Recording::new(times, inputs, nothing)?];
        let setup = self.bench.setup(&truth.members);
        let estimation = Estimation::new(&setup, &blank)?;
        let mut values = taken_over(self.bench, truth, &estimation)?;
        // The positions at the beginning of the first run, at rest.
        let info = setup.model.info();
        for state in 0..info.state_len() {
            let unknown = Unknown::Initial { run: 0, state };
            let begun = truth.fit.values[truth.layout.place(unknown)?];
            let at = if state < info.speeds { 0.0 } else { begun };
            values[estimation.layout().place(unknown)?] = at;
        }
        let mut shown = vec![f64::NAN; rows * channels];
        for one in estimation.predictions(&values, 0, f64::INFINITY, &[0])? {
            let value = -one.residual;
            let [low, high] = self.channels[one.channel];
            if !(low..=high).contains(&value) {
                return Ok(None);
            }
            shown[one.row * channels + one.channel] = value;
        }
        Ok(Some(blank[0].with_measurements(shown)?))
    }

    /// The inputs that can be commanded.
    fn driven(
        &self,
        recording: &Recording,
        name: impl Fn(usize) -> String,
    ) -> Vec<(String, Vec<f64>)> {
        let rows = recording.times().len();
        let driven = (0..self.inputs.len()).filter(|&input| self.inputs[input].is_some());
        let values = |input: usize| (0..rows).map(|row| recording.inputs(row)[input]).collect();
        driven.map(|input| (name(input), values(input))).collect()
    }
}

/// Smallest and largest value of a column in the training runs.
fn range(set: &DataSet, column: usize) -> Option<[f64; 2]> {
    let values = set.runs.iter().flat_map(|run| &run.values[column]);
    let seen = values.filter(|value| value.is_finite());
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let range = seen.fold(none, |[low, high], &value| {
        [low.min(value), high.max(value)]
    });
    (range[0] <= range[1]).then_some(range)
}

/// Separation of a hypothesis from the recording of another one after its parameters have adapted.
fn distance(bench: &Bench<'_>, rival: &Fitted, recording: &Recording) -> Result<f64> {
    let recordings = [recording.clone()];
    let setup = bench.setup(&rival.members);
    let estimation = Estimation::new(&setup, &recordings)?;
    let values = taken_over(bench, rival, &estimation)?;
    let directions = moving(&rival.fit);
    let tangent = estimation.tangent(&values, &directions, None)?;
    let rest = DVector::from_iterator(
        tangent.samples.len(),
        tangent.samples.iter().map(|(_, sample)| sample.whitened()),
    );
    let score = &tangent.slopes * &rest;
    let mut squares = &tangent.slopes * tangent.slopes.transpose() + known(rival);
    let size = squares.diagonal().amax();
    for i in 0..squares.nrows() {
        squares[(i, i)] += 1e-12 * size;
    }
    let adapted = squares
        .cholesky()
        .map_or(0.0, |factor| score.dot(&factor.solve(&score)));
    Ok((rest.norm_squared() - adapted).max(0.0).sqrt())
}

/// Information of the present recordings about the values that affect the predicted mean.
fn known(fitted: &Fitted) -> DMatrix<f64> {
    let moves = |i: &usize| !fitted.fit.free[*i].unknown.is_level();
    let own: Vec<usize> = (0..fitted.fit.free.len()).filter(moves).collect();
    // From coordinates to values.
    let stretch = |i: usize| {
        let free = &fitted.fit.free[i];
        free.stretch(free.to_value(fitted.fit.coordinates[i]))
    };
    DMatrix::from_fn(own.len(), own.len(), |i, j| {
        let (i, j) = (own[i], own[j]);
        fitted.fit.information[(i, j)] / (stretch(i) * stretch(j))
    })
}

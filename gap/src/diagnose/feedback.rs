//! Inputs that know the motion better than the recordings do.
//!
//! A controller that sees the state by sensors which are not recorded puts what it sees into its
//! command. Then the command correlates with the error of the filter, although it acts as the model
//! says; a delay or a gain of the actuator would explain a part of that. What such an input could tell is
//! a kick at each change that no recorded sample predicts, in any direction, and every hypothesis has such kicks.
//! They are bounded: a command knows no more of the state than what the filter does not know.

use appell_estimate::{Along, Direction, EstimateError, Estimation, Fit, Recording, Shapes};
use appell_runtime::model::At;
use nalgebra::{DMatrix, DVector};

use super::gram::Gram;
use super::nuisance::{known, moves_the_mean};

/// Earlier samples from which a command is predicted.
const LAGS: usize = 4;
/// Earlier samples of the measurements, beside those of the same row.
const SEEN: usize = 2;
/// Kicks that follow an innovation of the input.
const KICKS: usize = 2;
/// Innovations smaller than this part of the input are ignored.
const PREDICTED: f64 = 1e-3;
/// An input follows the motion where the measurements predict more of it than chance would in one of
/// so many recordings; the logarithm of the ratio of likelihoods beyond one for each regressor.
const SURE: f64 = 7.0;

/// Innovations of the inputs that follow the motion: for each run and row, a value for each such input.
#[derive(Debug, Clone, Default)]
pub(super) struct InputInnovations {
    /// Inputs that follow the motion.
    pub(super) count: usize,
    /// For each run its times.
    times: Vec<Vec<f64>>,
    /// For each run and row.
    values: Vec<Vec<Vec<f64>>>,
}

impl InputInnovations {
    pub(super) fn of(recordings: &[Recording]) -> Self {
        let inputs = recordings.first().map_or(0, Recording::input_len);
        let mut input_innovations = Self {
            count: 0,
            times: recordings.iter().map(|run| run.times().to_vec()).collect(),
            values: recordings
                .iter()
                .map(|run| vec![Vec::new(); run.times().len()])
                .collect(),
        };
        for input in 0..inputs {
            let Some(innovation) = innovation(recordings, input) else {
                continue;
            };
            input_innovations.count += 1;
            for (rows, own) in input_innovations.values.iter_mut().zip(innovation) {
                for (row, own) in rows.iter_mut().zip(own) {
                    row.push(own);
                }
            }
        }
        input_innovations
    }

    /// Calls with the kicks as candidate additions, with none where no input follows the motion.
    pub(super) fn with_kicks<T>(&self, call: impl FnOnce(Option<Shapes<'_>>) -> T) -> T {
        let kicks = |run: usize, at: At<'_>, to: &mut [f64]| self.kicks(run, at.t, to);
        call((self.count > 0).then_some(Shapes {
            along: Along::Disturbances,
            count: self.count * KICKS,
            values: &kicks,
        }))
    }

    /// Writes the kicks at a time of a run: for each input that follows the motion, by its last
    /// innovations.
    fn kicks(&self, run: usize, t: f64, to: &mut [f64]) {
        let row = self.times[run].partition_point(|&own| own <= t);
        for (place, to) in to.iter_mut().enumerate() {
            let (input, back) = (place / KICKS, place % KICKS + 1);
            let innovation = row.checked_sub(back).map(|row| &self.values[run][row]);
            *to = innovation.map_or(0.0, |innovation| innovation[input]);
        }
    }
}

/// How much recordings whose rows have a `weight` speak for kicks beside a fit, as a logarithm of a Bayes factor; zero
/// where they speak against them.
pub(super) fn for_kicks(
    own: &InputInnovations,
    weight: f64,
    (estimation, fit): (&Estimation<'_>, &Fit),
) -> Result<f64, EstimateError> {
    if own.count == 0 {
        return Ok(0.0);
    }
    let free: Vec<(Direction, Option<[f64; 2]>)> = (fit.free.iter().zip(&fit.coordinates))
        .map(|(free, coordinate)| (Direction::Value(free.unknown), known(free, *coordinate)))
        .filter(|(direction, _)| moves_the_mean(*direction))
        .collect();
    let directions: Vec<Direction> = free.iter().map(|(direction, _)| *direction).collect();
    let tangent = own.with_kicks(|kicks| estimation.tangent(&fit.values, &directions, kicks))?;
    let samples = tangent.samples.iter();
    let samples = samples.map(|(_, sample)| sample.whitened());
    let rest = DVector::from_iterator(tangent.samples.len(), samples);
    let mut squares = weight * tangent.slopes.tr_mul(&tangent.slopes);
    let mut scores = weight * tangent.slopes.tr_mul(&rest);
    for (place, (_, known)) in free.iter().enumerate() {
        if let Some([off, slope]) = known {
            squares[(place, place)] += slope * slope;
            scores[place] += slope * off;
        }
    }
    let beside = Gram::beside(0..free.len(), (&squares, &scores), 0.0);
    Ok(bounded(&beside, &tangent.added_squares, estimation))
}

/// The evidence for kicks by their squares and scores; `deviations` are the squares of a unit of each in deviations
/// of the filter.
fn bounded(gram: &Gram, deviations: &[f64], estimation: &Estimation<'_>) -> f64 {
    /// Each bound that is tried is so many times firmer than the one before.
    const FIRMER: f64 = 2.0;
    const TRIED: usize = 200;
    // Parts of the variance of what the filter does not know along each disturbance.
    let most = estimation.setup().disturbances.len() as f64;
    let known: Vec<usize> = (0..deviations.len())
        .filter(|&i| deviations[i] > 0.0 && !gram.is_imitated[i])
        .collect();
    let scale: Vec<f64> = known.iter().map(|&i| deviations[i].sqrt()).collect();
    let squares = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        gram.squares[(known[i], known[j])] / (scale[i] * scale[j])
    });
    let scores = DVector::from_fn(known.len(), |i, _| -gram.scores[known[i]] / scale[i]);
    if known.is_empty() {
        return 0.0;
    }
    let eigen = squares.symmetric_eigen();
    let along = eigen.eigenvectors.tr_mul(&scores);
    let mut firmness = 1.0;
    for _ in 0..TRIED {
        let sizes: Vec<f64> = along
            .iter()
            .zip(eigen.eigenvalues.iter())
            .map(|(score, square)| score / (square.max(0.0) + firmness))
            .collect();
        if sizes.iter().map(|size| size * size).sum::<f64>() <= most {
            let parts = (sizes.iter().zip(along.iter())).zip(eigen.eigenvalues.iter());
            let gain: f64 = parts
                .map(|((size, score), square)| {
                    let grown = 1.0 + square.max(0.0);
                    size * score - 0.5 * grown * size * size - 0.5 * grown.ln()
                })
                .sum();
            return gain.max(0.0);
        }
        firmness *= FIRMER;
    }
    0.0
}

/// The innovations of an input, for each run and row: what neither its past nor the measurements predict;
/// `None` where the input does not follow the motion.
fn innovation(recordings: &[Recording], input: usize) -> Option<Vec<Vec<f64>>> {
    let first = LAGS.max(SEEN);
    let channels = recordings[0].channel_len();
    let mut rows: Vec<(usize, usize)> = Vec::new();
    for (run, recording) in recordings.iter().enumerate() {
        let complete = |row: &usize| {
            let mut seen = (row - SEEN..=*row).flat_map(|row| recording.measured(row));
            seen.all(|value| !value.is_nan())
        };
        let own = (first..recording.times().len()).filter(complete);
        rows.extend(own.map(|row| (run, row)));
    }
    let (own, then, now) = (1 + LAGS, SEEN * channels, channels);
    if rows.len() < 10 * (own + then + now) {
        return None;
    }
    let command = DVector::from_fn(rows.len(), |i, _| {
        let (run, row) = rows[i];
        recordings[run].inputs(row)[input]
    });
    let regressors = DMatrix::from_fn(rows.len(), own + then + now, |i, column| {
        let (run, row) = rows[i];
        let recording = &recordings[run];
        match column {
            0 => 1.0,
            lag if lag < own => recording.inputs(row - lag)[input],
            seen => {
                let (back, channel) = ((seen - own) / channels, (seen - own) % channels);
                // Those before the row first, then those of the row.
                let back = if back < SEEN { back + 1 } else { 0 };
                recording.measured(row - back)[channel]
            }
        }
    });
    let alone = rest(&regressors.columns(0, own).into_owned(), &command)?;
    let with_motion = rest(&regressors.columns(0, own + then).into_owned(), &command)?;
    let (before, after) = (alone.norm_squared(), with_motion.norm_squared());
    let ratio = 0.5 * rows.len() as f64 * (before / after.max(f64::MIN_POSITIVE)).ln();
    let rest = rest(&regressors, &command)?;
    let is_predicted = rest.norm() < PREDICTED * command.norm();
    if is_predicted || ratio - (then as f64) < SURE {
        return None;
    }
    let mut all: Vec<Vec<f64>> = recordings
        .iter()
        .map(|run| vec![0.0; run.times().len()])
        .collect();
    for (&(run, row), &rest) in rows.iter().zip(rest.iter()) {
        all[run][row] = rest;
    }
    Some(all)
}

/// What a regression leaves.
fn rest(regressors: &DMatrix<f64>, values: &DVector<f64>) -> Option<DVector<f64>> {
    /// Keeps regressors that follow from others in place, relative to their size.
    const FLOOR: f64 = 1e-9;
    let scale: Vec<f64> = regressors
        .column_iter()
        .map(|c| c.norm().max(f64::MIN_POSITIVE))
        .collect();
    let scaled = DMatrix::from_fn(regressors.nrows(), regressors.ncols(), |i, j| {
        regressors[(i, j)] / scale[j]
    });
    let mut squares = scaled.tr_mul(&scaled);
    for i in 0..squares.nrows() {
        squares[(i, i)] += FLOOR;
    }
    let solution = squares.cholesky()?.solve(&scaled.tr_mul(values));
    Some(values - scaled * solution)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests may panic")]
mod tests {
    use super::*;

    /// Uniform numbers of variance 1, the same in every run.
    fn noise(random: &mut fastrand::Rng) -> f64 {
        (random.f64() - 0.5) * 12.0_f64.sqrt()
    }

    /// A mass that a command pushes, seen with noise: the command is a sum of sines, or it knows the
    /// position.
    fn recording(follows: bool) -> Recording {
        let (mut random, h) = (fastrand::Rng::with_seed(7), 0.01);
        let (mut x, mut v) = (0.3, 0.0);
        let (mut times, mut inputs, mut measured) = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..800 {
            let t = f64::from(row) * h;
            let u = if follows {
                -40.0 * x - 4.0 * v
            } else {
                (3.0 * t).sin() + (7.3 * t).cos()
            };
            times.push(t);
            inputs.push(u);
            measured.push(x + 1e-3 * noise(&mut random));
            v += h * (u + 3.0 * noise(&mut random));
            x += h * v;
        }
        Recording::new(times, inputs, measured).unwrap()
    }

    #[test]
    fn a_command_that_knows_the_motion_is_told_from_one_that_does_not() {
        assert_eq!(InputInnovations::of(&[recording(false)]).count, 0);
        let told = InputInnovations::of(&[recording(true)]);
        assert_eq!(told.count, 1);
        let mut kicks = [f64::NAN; KICKS];
        told.kicks(0, 5.005, &mut kicks);
        assert!(kicks.iter().all(|kick| kick.is_finite() && *kick != 0.0));
        told.kicks(0, -1.0, &mut kicks);
        assert!(kicks.iter().all(|kick| kick.abs() < f64::MIN_POSITIVE));
    }
}

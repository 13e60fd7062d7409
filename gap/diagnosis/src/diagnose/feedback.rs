//! Feedback inputs from measurements that are not recorded.
//!
//! If a controller uses sensors that are not recorded, its command is correlated with the error of the filter, although
//! it acts as in the model; a delay or a gain of the actuator would explain a part of that correlation. Every hypothesis
//! therefore has impulses on the equations in proportion to the innovation of such an input, the part that no recorded
//! sample predicts. They are bounded: as a correlation cannot exceed one, their variance is at most that of the filter's
//! own error.

use appell_estimate::{Along, EstimateError, Estimation, Fit, Recording, Shapes};
use appell_runtime::model::At;
use nalgebra::{DMatrix, DVector};

use super::gram::{Gram, Normal, moving, priors, whitened};

/// Number of earlier samples from which a command is predicted.
const LAGS: usize = 4;
/// Number of earlier samples of the measurements, in addition to those of the same row.
const SEEN: usize = 2;
/// Number of impulses after an innovation of the input.
const KICKS: usize = 2;
/// Innovations smaller than this part of the input are ignored.
const PREDICTED: f64 = 1e-3;
/// Threshold of the log likelihood ratio, in excess of one for each regressor, by which measurements must improve the
/// prediction of a feedback input.
const SURE: f64 = 7.0;

/// Innovations of feedback inputs.
#[derive(Debug, Clone, Default)]
pub(super) struct InputInnovations {
    /// Whether an input depends on the measurements, recorded or not.
    pub(super) is_closed: bool,
    /// For each run its times.
    times: Vec<Vec<f64>>,
    /// For each feedback input, run and row.
    values: Vec<Vec<Vec<f64>>>,
}

impl InputInnovations {
    pub(super) fn of(recordings: &[Recording]) -> Self {
        let inputs = recordings.first().map_or(0, Recording::input_len);
        let mut all = Self {
            is_closed: false,
            times: recordings.iter().map(|run| run.times().to_vec()).collect(),
            values: Vec::new(),
        };
        for feedback in (0..inputs).filter_map(|input| feedback(recordings, input)) {
            all.is_closed = true;
            all.values.extend(feedback.innovation);
        }
        all
    }

    /// Number of feedback inputs.
    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    /// Calls a function with the impulses as additional columns, or with `None` without feedback inputs.
    pub(super) fn with_kicks<T>(&self, call: impl FnOnce(Option<Shapes<'_>>) -> T) -> T {
        let kicks = |run: usize, at: At<'_>, to: &mut [f64]| self.kicks(run, at.t, to);
        call((self.count() > 0).then_some(Shapes {
            along: Along::Disturbances,
            count: self.kick_count(),
            values: &kicks,
        }))
    }

    /// Number of impulses on each equation.
    pub(super) fn kick_count(&self) -> usize {
        self.count() * KICKS
    }

    /// Writes the impulses at a time of a run: the last innovations of each feedback input.
    pub(super) fn kicks(&self, run: usize, t: f64, to: &mut [f64]) {
        let row = self.times[run].partition_point(|&own| own <= t);
        for (place, to) in to.iter_mut().enumerate() {
            let (input, back) = (place / KICKS, place % KICKS + 1);
            let row = row.checked_sub(back);
            *to = row.map_or(0.0, |row| self.values[input][run][row]);
        }
    }
}

/// Log Bayes factor for impulses in addition to a fit, with rows of this likelihood weight; at least zero.
pub(super) fn for_kicks(
    own: &InputInnovations,
    weight: f64,
    estimation: &Estimation<'_>,
    fit: &Fit,
) -> Result<f64, EstimateError> {
    if own.count() == 0 {
        return Ok(0.0);
    }
    let directions = moving(fit);
    let tangent = own.with_kicks(|kicks| estimation.tangent(&fit.values, &directions, kicks))?;
    let normal = Normal::of(&tangent, &whitened(&tangent), weight, &priors(fit));
    let nuisances: Vec<usize> = (0..directions.len()).collect();
    let beside = normal.beside(&nuisances, nuisances.len()..tangent.slopes.nrows());
    Ok(bounded(&beside, &tangent.added_squares, estimation))
}

/// The evidence for impulses from their Gram matrix and scores; `deviations` are the squares of a unit of each in
/// standard deviations of the filter.
fn bounded(gram: &Gram, deviations: &[f64], estimation: &Estimation<'_>) -> f64 {
    /// Factor between successive values of the regularisation.
    const FIRMER: f64 = 2.0;
    const TRIED: usize = 200;
    // The bound: the error variance of the filter along each process noise.
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

/// An input that depends on the measurements.
struct Feedback {
    /// The part that neither its past nor the measurements predict, for each run and row; `None` if they predict it all,
    /// or if the measurements of the same row alone do.
    innovation: Option<Vec<Vec<f64>>>,
}

/// The feedback of an input; `None` without.
fn feedback(recordings: &[Recording], input: usize) -> Option<Feedback> {
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
                // The earlier samples first, then those of the row.
                let back = if back < SEEN { back + 1 } else { 0 };
                recording.measured(row - back)[channel]
            }
        }
    });
    let alone = rest(&regressors.columns(0, own).into_owned(), &command)?;
    let with_motion = rest(&regressors.columns(0, own + then).into_owned(), &command)?;
    let (before, after) = (alone.norm_squared(), with_motion.norm_squared());
    let rest = rest(&regressors, &command)?;
    let is_small = |rest: f64| rest < PREDICTED.powi(2) * command.norm_squared();
    let is_told = |rest: f64, count: usize| {
        let ratio = 0.5 * rows.len() as f64 * (before / rest.max(f64::MIN_POSITIVE)).ln();
        ratio - count as f64 >= SURE
    };
    let is_closed = !is_small(before) && is_told(rest.norm_squared(), then + now);
    if is_small(rest.norm_squared()) || !is_told(after, then) {
        return is_closed.then_some(Feedback { innovation: None });
    }
    let all = recordings.iter().map(|run| vec![0.0; run.times().len()]);
    let mut all: Vec<Vec<f64>> = all.collect();
    for (&(run, row), &rest) in rows.iter().zip(rest.iter()) {
        all[run][row] = rest;
    }
    Some(Feedback {
        innovation: Some(all),
    })
}

/// The residual of a regression.
fn rest(regressors: &DMatrix<f64>, values: &DVector<f64>) -> Option<DVector<f64>> {
    /// Relative regularisation for linearly dependent regressors.
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

    /// A mass driven by a command, measured with noise: the command is a sum of sines, or feedback of the
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
        let open = InputInnovations::of(&[recording(false)]);
        assert!(open.count() == 0 && !open.is_closed);
        let told = InputInnovations::of(&[recording(true)]);
        assert!(told.count() == 1 && told.is_closed);
        let mut kicks = [f64::NAN; KICKS];
        told.kicks(0, 5.005, &mut kicks);
        assert!(kicks.iter().all(|kick| kick.is_finite() && *kick != 0.0));
        told.kicks(0, -1.0, &mut kicks);
        assert!(kicks.iter().all(|kick| kick.abs() < f64::MIN_POSITIVE));
    }
}

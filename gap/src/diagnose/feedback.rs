//! Inputs that know the motion better than the recordings do.
//!
//! A controller that sees the state by sensors which are not recorded puts what it sees into its
//! command. Then the command correlates with the error of the filter, although it acts as the model
//! says; a delay or a gain of the actuator would explain a part of that. What such an input could tell is
//! a kick at each change that nothing recorded foretells, in any direction: no effect may claim it.

use appell_estimate::Recording;
use nalgebra::{DMatrix, DVector};

/// Earlier samples that foretell a command.
const LAGS: usize = 4;
/// Earlier samples of the measurements, beside those of the same row.
const SEEN: usize = 2;
/// Kicks that follow a surprise.
pub(super) const KICKS: usize = 2;
/// Surprises that are smaller than this part of the input tell nothing.
const FORETOLD: f64 = 1e-3;
/// An input follows the motion where the measurements foretell more of it than chance would in one of
/// so many recordings; the logarithm of the ratio of likelihoods beyond one for each regressor.
const SURE: f64 = 7.0;

/// Surprises of the inputs that follow the motion: for each run and row, a value for each such input.
#[derive(Debug, Clone, Default)]
pub(super) struct Surprises {
    /// Inputs that follow the motion.
    pub(super) count: usize,
    /// For each run its times.
    times: Vec<Vec<f64>>,
    /// For each run and row.
    values: Vec<Vec<Vec<f64>>>,
}

impl Surprises {
    pub(super) fn of(recordings: &[Recording]) -> Self {
        let inputs = recordings.first().map_or(0, Recording::input_len);
        let mut surprises = Self {
            count: 0,
            times: recordings.iter().map(|run| run.times().to_vec()).collect(),
            values: recordings
                .iter()
                .map(|run| vec![Vec::new(); run.times().len()])
                .collect(),
        };
        for input in 0..inputs {
            let Some(surprise) = surprise(recordings, input) else {
                continue;
            };
            surprises.count += 1;
            for (rows, own) in surprises.values.iter_mut().zip(surprise) {
                for (row, own) in rows.iter_mut().zip(own) {
                    row.push(own);
                }
            }
        }
        surprises
    }

    /// Writes the kicks at a time of a run: for each input that follows the motion, by its last
    /// surprises.
    pub(super) fn kicks(&self, run: usize, t: f64, to: &mut [f64]) {
        let row = self.times[run].partition_point(|&own| own <= t);
        for (place, to) in to.iter_mut().enumerate() {
            let (input, back) = (place / KICKS, place % KICKS + 1);
            let surprise = row.checked_sub(back).map(|row| &self.values[run][row]);
            *to = surprise.map_or(0.0, |surprise| surprise[input]);
        }
    }
}

/// What nothing recorded foretells of an input, for each run and row; `None` where it does not follow
/// the motion.
fn surprise(recordings: &[Recording], input: usize) -> Option<Vec<Vec<f64>>> {
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
    let is_foretold = rest.norm() < FORETOLD * command.norm();
    if is_foretold || ratio - (then as f64) < SURE {
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
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((*seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12.0_f64.sqrt()
    }

    /// A mass that a command pushes, seen with noise: the command is a sum of sines, or it knows the
    /// position.
    fn recording(follows: bool) -> Recording {
        let (mut seed, h) = (7, 0.01);
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
            measured.push(x + 1e-3 * noise(&mut seed));
            v += h * (u + 3.0 * noise(&mut seed));
            x += h * v;
        }
        Recording::new(times, inputs, measured).unwrap()
    }

    #[test]
    fn a_command_that_knows_the_motion_is_told_from_one_that_does_not() {
        assert_eq!(Surprises::of(&[recording(false)]).count, 0);
        let told = Surprises::of(&[recording(true)]);
        assert_eq!(told.count, 1);
        let mut kicks = [f64::NAN; KICKS];
        told.kicks(0, 5.005, &mut kicks);
        assert!(kicks.iter().all(|kick| kick.is_finite() && *kick != 0.0));
        told.kicks(0, -1.0, &mut kicks);
        assert!(kicks.iter().all(|kick| kick.abs() < f64::MIN_POSITIVE));
    }
}

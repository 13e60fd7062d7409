//! The search for an optimum, and its starting points.
//!
//! Where the model does not reproduce the recordings, process noise does; it masks the sensitivity to the parameters,
//! and the likelihood has many local optima. If the predictions of a fitted model miss the recordings by far more than
//! their noise, or if a search ended before an optimum, the search is therefore repeated from two other points: from the
//! optimum with so little process noise that the model itself has to reproduce the recordings, as in an output-error fit
//! (L. Ljung, *System Identification*, 1999), and from the result of multiple shooting. All results are compared by the
//! same posterior; the most probable one is taken.

use appell_estimate::{Effort, EstimateError, Estimation, Fit, Free, Predicted, Unknown};

use super::options::Begin;
use super::problem::{EFFORT, Problem, most_likely};
use super::{IdentifyError, Options, shooting};
use crate::held_out::{AHEAD, origins};

/// Tolerated error of a free run of a fitted model, relative to the recorded motion (root mean squares).
const MISSED: f64 = 0.05;
/// Tolerated error of predictions a second ahead, in units of the sensor noise.
const MISSED_AHEAD: f64 = 3.0;
/// Largest number of rows of a run from which predictions a second ahead start.
const ORIGINS: usize = 20;
/// A free run begins after this part of a recording, when the filter has converged.
const KNOWN: usize = 8;
/// Small process noise relative to the forces, over one second.
const SMALL: [f64; 2] = [1e-3, 1e-4];
/// Searches for a start need not end at an optimum.
const START: Effort = Effort {
    gain: EFFORT.gain,
    steps: 40,
    floor: f64::NEG_INFINITY,
};

/// A search for the free values of a problem.
pub(super) struct Search<'p, 'e> {
    pub(super) estimation: &'p Estimation<'e>,
    pub(super) problem: &'p Problem,
    pub(super) options: &'p Options,
}

/// Prediction errors of a model, of the channel with the largest one.
#[derive(Default)]
struct Missed {
    /// By free runs, relative to the recorded motion.
    of_motion: f64,
    /// A second ahead, relative to the noise of the sensor.
    of_noise: f64,
}

impl Search<'_, '_> {
    /// The optimum of the noise levels for the nominal parameters.
    pub(super) fn levels(&self, start: &[f64]) -> Result<Fit, EstimateError> {
        self.of(start, &self.problem.levels)
    }

    /// The most probable optimum of all free values, given the noise levels of the nominal model.
    pub(super) fn best(
        &self,
        nominal: &Fit,
        stage: &mut dyn FnMut(&'static str),
    ) -> Result<Fit, IdentifyError> {
        let first = self.options.begin;
        let found = self.from(first, nominal, stage);
        if self.problem.wanted.is_empty() {
            return found;
        }
        let is_enough = |fit: &&Fit| fit.is_optimum() || self.options.rough;
        let ended = found.as_ref().ok().filter(is_enough);
        let missed = self.missed(ended)?;
        if missed.of_motion <= MISSED && missed.of_noise <= MISSED_AHEAD {
            return found;
        }
        stage("fitting with little process noise");
        let mut best = found;
        let is_likelier = |best: &Result<Fit, _>, fit: &Fit| {
            (best.as_ref()).map_or(true, |best| best.log_posterior < fit.log_posterior)
        };
        let mut quiet = SMALL.iter().filter_map(|&part| self.quiet(part).ok());
        if let Some(start) = quiet.find(|fit| is_likelier(&best, fit)) {
            stage("fitting the parameters");
            let again = self.all(&start.values).ok();
            let fits = again.into_iter().chain([start]);
            best = likelier(fits).map_or(best, Ok);
        }
        if self.missed(best.as_ref().ok())?.of_motion <= MISSED {
            return best;
        }
        let other = match first {
            Begin::Nominal => Begin::Shooting,
            Begin::Shooting => Begin::Nominal,
        };
        let other = self.from(other, nominal, stage);
        likelier(best.iter().chain(&other).cloned()).map_or(best, Ok)
    }

    fn from(
        &self,
        begin: Begin,
        nominal: &Fit,
        stage: &mut dyn FnMut(&'static str),
    ) -> Result<Fit, IdentifyError> {
        let start = match begin {
            Begin::Nominal => nominal.values.clone(),
            Begin::Shooting => {
                stage("shooting at the recordings");
                // Noise levels that are likely for wrong parameters mislead.
                let start = &self.problem.start;
                let shots = shooting::shots(self.estimation, self.problem, start)?;
                // The filter may fail although the simulation did not.
                let levels = shots.iter().filter_map(|shot| {
                    let start = most_likely(self.estimation, shot, &self.problem.sizes).ok()?;
                    self.levels(&start).ok()
                });
                likelier(levels).map_or_else(|| nominal.values.clone(), |best| best.values)
            }
        };
        stage("fitting the parameters");
        Ok(self.all(&start)?)
    }

    /// All free values.
    fn free(&self) -> Vec<Free> {
        [self.problem.wanted.as_slice(), &self.problem.levels].concat()
    }

    /// The optimum of all free values from a start.
    fn all(&self, start: &[f64]) -> Result<Fit, EstimateError> {
        self.of(start, &self.free())
    }

    /// The optimum near that with process noise held at this part of the forces.
    fn quiet(&self, part: f64) -> Result<Fit, EstimateError> {
        let layout = self.estimation.layout();
        let mut start = self.problem.start.clone();
        for (index, size) in self.problem.sizes.iter().enumerate() {
            start[layout.place(Unknown::Disturbance(index))?] = part * size;
        }
        let mut free = self.free();
        free.retain(|free| !matches!(free.unknown, Unknown::Disturbance(_)));
        let held = Fit::quick(self.estimation, &start, &free, START)?;
        Fit::quick(self.estimation, &held.values, &self.free(), START)
    }

    /// An optimum; where the likelihood is rough and scoring stops before one, its last iterate, whose deviations
    /// include the step that was not taken.
    fn of(&self, start: &[f64], free: &[Free]) -> Result<Fit, EstimateError> {
        if self.options.rough {
            return Fit::quick(self.estimation, start, free, EFFORT);
        }
        match Fit::of(self.estimation, start, free, EFFORT) {
            Err(EstimateError::Stuck { .. }) => Fit::quick(self.estimation, start, free, EFFORT),
            found => found,
        }
    }

    /// The prediction errors of a fitted model; infinite without one.
    fn missed(&self, fit: Option<&Fit>) -> Result<Missed, IdentifyError> {
        let Some(fit) = fit else {
            return Ok(Missed {
                of_motion: f64::INFINITY,
                of_noise: f64::INFINITY,
            });
        };
        let mut runs = Vec::new();
        for (run, recording) in self.estimation.recordings().iter().enumerate() {
            let predictions = |horizon: f64, origins: &[usize]| {
                self.estimation
                    .predictions(&fit.values, run, horizon, origins)
            };
            let origin = recording.times().len() / KNOWN;
            let free_run = predictions(f64::INFINITY, &[origin])?;
            let ahead = predictions(AHEAD, &origins(recording, ORIGINS))?;
            runs.push((recording, free_run, ahead));
        }
        let mut missed = Missed::default();
        for channel in 0..self.estimation.setup().channels.len() {
            let own = |one: &&Predicted| one.channel == channel;
            let squares = |list: &[Predicted]| -> f64 {
                list.iter()
                    .filter(own)
                    .map(|one| one.residual.powi(2))
                    .sum()
            };
            // Sums of squares: of the recorded motion about its mean, and of the errors.
            let (mut motion, mut of_free_run, mut of_ahead, mut count) = (0.0, 0.0, 0.0, 0.0);
            for (recording, free_run, ahead) in &runs {
                let values = free_run.iter().filter(own);
                let values = values.map(|one| recording.measured(one.row)[channel]);
                let mean = values.clone().sum::<f64>() / values.clone().count().max(1) as f64;
                motion += values.map(|value| (value - mean).powi(2)).sum::<f64>();
                of_free_run += squares(free_run);
                of_ahead += squares(ahead);
                count += ahead.iter().filter(own).count() as f64;
            }
            let noise = Unknown::Noise(channel);
            let noise = self.problem.start[self.estimation.layout().place(noise)?];
            let of_motion = relative(of_free_run, motion);
            let of_noise = relative(of_ahead, count * noise.powi(2));
            missed.of_motion = missed.of_motion.max(of_motion);
            missed.of_noise = missed.of_noise.max(of_noise);
        }
        Ok(missed)
    }
}

/// The root of a ratio of sums of squares, which may be empty or have overflowed.
fn relative(squares: f64, to: f64) -> f64 {
    let part = (squares / to.max(f64::MIN_POSITIVE)).sqrt();
    if part.is_nan() { f64::INFINITY } else { part }
}

/// The most likely one of some fits.
fn likelier(fits: impl Iterator<Item = Fit>) -> Option<Fit> {
    fits.filter(|fit| fit.log_posterior.is_finite())
        .max_by(|a, b| a.log_posterior.total_cmp(&b.log_posterior))
}

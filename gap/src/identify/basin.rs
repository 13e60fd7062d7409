//! The search for an optimum, and its start: at the parameters of the rig, or at those of multiple shooting.
//!
//! Where the model does not do what was recorded, its disturbances do; they hide which parameters would do better, and
//! the likelihood has an optimum near wherever the search began. An optimum whose motion runs away from the recordings
//! is therefore held against the one from the other start, and the more likely one counts.

use appell_estimate::{EstimateError, Estimation, Fit, Free};

use super::options::Begin;
use super::problem::{EFFORT, Problem, most_likely};
use super::{IdentifyError, Options, shooting};

/// Part of a recorded motion, as a root mean square, that a free run of a fitted model may miss.
const MISSED: f64 = 0.05;
/// A free run begins after this part of a recording, when the filter knows the state.
const KNOWN: usize = 8;

/// A search for the free values of a problem.
pub(super) struct Search<'p, 'e> {
    pub(super) estimation: &'p Estimation<'e>,
    pub(super) problem: &'p Problem,
    pub(super) options: &'p Options,
}

impl Search<'_, '_> {
    /// The optimum of the levels for the nominal parameters.
    pub(super) fn levels(&self, start: &[f64]) -> Result<Fit, EstimateError> {
        self.of(start, &self.problem.levels)
    }

    /// The optimum of all free values, from the nominal one of the levels.
    pub(super) fn best(
        &self,
        nominal: &Fit,
        stage: &mut dyn FnMut(&'static str),
    ) -> Result<Fit, IdentifyError> {
        let first = self.options.begin;
        let found = self.from(first, nominal, stage);
        let is_poor = match &found {
            Ok(fit) => self.misses(fit)? > MISSED,
            Err(_) => true,
        };
        if !is_poor || self.problem.wanted.is_empty() {
            return found;
        }
        let other = match first {
            Begin::Nominal => Begin::Shooting,
            Begin::Shooting => Begin::Nominal,
        };
        match (found, self.from(other, nominal, stage)) {
            (Ok(fit), Ok(other)) if other.log_posterior > fit.log_posterior => Ok(other),
            (Ok(fit), _) => Ok(fit),
            (Err(_), Ok(other)) => Ok(other),
            (Err(error), Err(_)) => Err(error),
        }
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
                let shots = shooting::shots(self.estimation, self.problem, &nominal.values)?;
                let mut best: Option<Fit> = None;
                for shot in &shots {
                    // The filter may fail although the motion did not.
                    let levels = most_likely(self.estimation, shot, &self.problem.sizes)
                        .and_then(|start| Ok(self.levels(&start)?));
                    if let Ok(levels) = levels
                        && (best.as_ref())
                            .is_none_or(|best| best.log_posterior < levels.log_posterior)
                    {
                        best = Some(levels);
                    }
                }
                best.map_or_else(|| nominal.values.clone(), |best| best.values)
            }
        };
        stage("fitting the parameters");
        let all = [self.problem.wanted.as_slice(), &self.problem.levels].concat();
        Ok(self.of(&start, &all)?)
    }

    /// An optimum; where the likelihood is rough and no better values are found, what scoring reaches, with the step
    /// that it could not take in the deviations.
    fn of(&self, start: &[f64], free: &[Free]) -> Result<Fit, EstimateError> {
        if self.options.rough {
            return Fit::quick(self.estimation, start, free, EFFORT);
        }
        match Fit::of(self.estimation, start, free, EFFORT) {
            Err(EstimateError::Stuck { .. }) => Fit::quick(self.estimation, start, free, EFFORT),
            found => found,
        }
    }

    /// The largest part of a channel that free runs of the model miss.
    fn misses(&self, fit: &Fit) -> Result<f64, IdentifyError> {
        let recordings = self.estimation.recordings();
        let channels = self.estimation.setup().channels.len();
        let (mut left, mut size) = (vec![0.0; channels], vec![0.0; channels]);
        for (run, recording) in recordings.iter().enumerate() {
            let origin = recording.times().len() / KNOWN;
            let predicted =
                self.estimation
                    .predictions(&fit.values, run, f64::INFINITY, &[origin])?;
            for channel in 0..channels {
                let own = || predicted.iter().filter(|one| one.channel == channel);
                let values = own().map(|one| recording.measured(one.row)[channel]);
                let count = own().count().max(1) as f64;
                let mean = values.clone().sum::<f64>() / count;
                size[channel] += values.map(|value| (value - mean).powi(2)).sum::<f64>();
                left[channel] += own().map(|one| one.residual.powi(2)).sum::<f64>();
            }
        }
        let parts = left.iter().zip(&size).map(|(left, size)| {
            let part = (left / f64::max(*size, f64::MIN_POSITIVE)).sqrt();
            if part.is_nan() { f64::INFINITY } else { part }
        });
        Ok(parts.fold(0.0, f64::max))
    }
}

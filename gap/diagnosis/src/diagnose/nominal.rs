//! Fits of the nominal model.

use appell_estimate::{Effort, Estimation, Fit};

use super::bench::{ROUGHLY, SHARES};
use super::starts::scale_process_noise;
use super::{Bench, Fitted, Result};

/// Largest number of tenfold increases of the process noise if the filter diverges.
const LOST: usize = 4;
/// Factor on the process noise for a second search of the levels of a robot.
const QUIETER: f64 = 0.1;

impl Bench<'_> {
    /// The nominal model, its parameters within their tolerances. Noise levels are fitted first: with levels that are
    /// far too small the parameters would leave their tolerances to fit noise. If the filter diverges, as with a wrong
    /// model of an unstable mechanism, the search is repeated with larger initial process noise.
    pub(super) fn nominal(&self) -> Result<Fitted> {
        let setup = self.setup(&[]);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let mut start = self.problem.start.clone();
        let mut fitted = self.nominal_from(&estimation, &start);
        for _ in 0..LOST {
            if fitted.is_ok() {
                break;
            }
            scale_process_noise(&estimation, &mut start, 10.0)?;
            fitted = self.nominal_from(&estimation, &start);
        }
        fitted
    }

    /// The model as stated, with the noise levels that fit.
    pub(super) fn stated(&self) -> Result<Fitted> {
        let setup = self.setup(&[]);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let mut start = self.problem.start.clone();
        self.loosen(&estimation, &mut start)?;
        let levels = Fit::quick(&estimation, &start, &self.problem.levels, ROUGHLY)?.values;
        let as_it_is = Effort {
            steps: 0,
            ..ROUGHLY
        };
        self.fit(as_it_is, &[], &estimation, &levels)
    }

    /// Noise levels, or likelier ones that a search finds from less process noise: the rates of stiff servos may be taken
    /// for process noise or for measured ones, and a search does not cross from one to the other.
    fn quieter(&self, estimation: &Estimation<'_>, first: Fit) -> Result<Vec<f64>> {
        let mut start = first.values.clone();
        scale_process_noise(estimation, &mut start, QUIETER)?;
        let second = Fit::quick(estimation, &start, &self.problem.levels, ROUGHLY);
        Ok(match second {
            Ok(second) if second.log_likelihood > first.log_likelihood => second.values,
            _ => first.values,
        })
    }

    fn nominal_from(&self, estimation: &Estimation<'_>, start: &[f64]) -> Result<Fitted> {
        let mut start = start.to_vec();
        self.loosen(estimation, &mut start)?;
        let levels = Fit::quick(estimation, &start, &self.problem.levels, ROUGHLY)?;
        // One step ahead a robot needs its noise levels only.
        if self.is_of_robot && !self.is_over_windows() {
            let levels = self.quieter(estimation, levels)?;
            return self.fit(SHARES, &[], estimation, &levels);
        }
        let levels = levels.values;
        let fitted = self.fit(self.effort(), &[], estimation, &levels)?;
        if fitted.fit.is_optimum() || self.is_over_windows() {
            return Ok(fitted);
        }
        // Far from an optimum Newton's method may progress where Fisher scoring does not.
        let further = self.fit_by(Fit::of, self.effort(), &[], estimation, &levels);
        Ok(further.unwrap_or(fitted))
    }
}

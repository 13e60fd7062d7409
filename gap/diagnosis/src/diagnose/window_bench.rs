//! The estimation problem of free-running predictions over windows: there is no process noise, the noise variance is
//! that of the prediction errors, and small differences do not count.

use appell_estimate::{Effort, Estimation, Fit, Free, Layout, Unknown};

use super::calibration::TIED;
use super::scales::deviation;
use super::starts::likeliest;
use super::{Bench, Fitted, Result};
use crate::identify::Problem;
use appell_recordings::{DataSet, Run};

/// Factors on the sensor noise, of which the most likely one is the initial noise of a search over windows.
const LARGER: [f64; 3] = [30.0, 6.0, 1.0];
/// Factor on its upper limit: errors of a model over a window may be large.
const MOST_LARGER: f64 = 1e4;
/// Largest error of a model that predicts, relative to the motion.
const PREDICTS: f64 = 0.3;
/// Largest effective sample size of a window for each pseudo-velocity: its disturbance is a single history, whatever
/// the number of rows.
const EACH: f64 = 4.0;
/// Part of the mean square error over windows that is one unit of log likelihood: smaller differences do not count.
pub(super) const TOLERANCE: f64 = 0.05;

impl Bench<'_> {
    /// The noise levels of a hypothesis.
    pub(super) fn levels(&self, fitted: &Fitted) -> Result<Vec<(Unknown, f64)>> {
        let levels = self.problem.levels.iter().map(|free| {
            let value = fitted.fit.values[fitted.layout.place(free.unknown)?];
            Ok((free.unknown, value))
        });
        levels.collect()
    }

    /// For windows of the recordings of another problem. With these noise levels the filter estimates the state before
    /// a prediction.
    pub(super) fn over(windows: &DataSet, from: &Self, levels: &[(Unknown, f64)]) -> Result<Self> {
        let mut negligible = Vec::new();
        let quiet = |estimation: &Estimation<'_>, problem: &mut Problem| {
            let layout = estimation.layout();
            for free in &mut problem.levels {
                let start = &mut problem.start[layout.place(free.unknown)?];
                let [low, high] = free.range;
                if matches!(free.unknown, Unknown::Disturbance(_)) {
                    *start = 0.0;
                    negligible.push(low);
                } else {
                    *free = Free::of(free.unknown).within(low, MOST_LARGER * high);
                }
            }
            problem
                .levels
                .retain(|free| matches!(free.unknown, Unknown::Noise(_)));
            Ok(())
        };
        let mut bench = Self::of(windows, from.effects, quiet)?;
        bench.whole.clone_from(&from.whole);
        bench.negligible = negligible;
        let independent = independent(windows, &bench.whole);
        let each = (2.0 / TOLERANCE).min(EACH * independent);
        let speeds = bench.effects.info().speeds;
        // Rates and torques of a robot's drives have errors of their own.
        let histories = if from.is_of_robot {
            speeds.max(bench.measured.len())
        } else {
            speeds
        };
        bench.told = each * histories as f64;
        let samples = bench.recordings.iter().flat_map(|run| {
            let rows = 0..run.times().len();
            rows.flat_map(move |row| run.measured(row))
        });
        let samples = samples.filter(|value| !value.is_nan()).count();
        bench.weight = (bench.told / samples.max(1) as f64).min(1.0);
        bench.predicting = levels.to_vec();
        bench.is_of_robot = from.is_of_robot;
        Ok(bench)
    }

    /// Whether there is no process noise.
    pub(super) fn is_over_windows(&self) -> bool {
        self.told.is_finite()
    }

    /// Noise of the sensors, if the noise levels are those of prediction errors; otherwise `None`.
    pub(super) fn noise_of_sensors(&self) -> Option<Vec<f64>> {
        let is_noise = |(unknown, _): &&(Unknown, f64)| matches!(unknown, Unknown::Noise(_));
        let noise = self.predicting.iter().filter(is_noise);
        self.is_over_windows()
            .then(|| noise.map(|(_, value)| *value).collect())
    }

    /// Whether the errors of a robot over windows are so close to the noise of its sensors that no law for the rest can
    /// gain much.
    pub(super) fn leaves_nothing(&self, fitted: &Fitted) -> Result<bool> {
        let Some(sensors) = self.noise_of_sensors().filter(|_| self.is_of_robot) else {
            return Ok(false);
        };
        let mut most = 0.0;
        for (channel, sensor) in sensors.into_iter().enumerate() {
            let error = fitted.fit.values[fitted.layout.place(Unknown::Noise(channel))?];
            let rows = self.recordings.iter();
            let readings = rows.flat_map(|run| {
                (0..run.times().len()).filter(move |&row| !run.measured(row)[channel].is_nan())
            });
            most += readings.count() as f64 * (error / sensor).ln().max(0.0);
        }
        Ok(self.weight * most < TIED)
    }

    /// Whether a hypothesis predicts: errors over windows are far smaller than the motion.
    pub(super) fn predicts(&self, fitted: &Fitted) -> Result<bool> {
        let measured = self.set.measured(self.effects.info());
        for (place, (channel, _)) in measured.iter().enumerate() {
            let mut columns = self.set.channels.iter();
            let Some(column) = columns.position(|own| own.column == channel.column) else {
                continue;
            };
            let error = fitted.fit.values[fitted.layout.place(Unknown::Noise(place))?];
            if error > PREDICTS * deviation(&self.set, column) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Ratio of the mean square errors after and before a gain in log likelihood, as the noise levels are those of the
    /// errors.
    pub(super) fn left(&self, gain: f64) -> f64 {
        (-2.0 * gain / self.told).exp()
    }

    /// A fit of another problem on these rows with noise levels that are fitted from initial ones.
    pub(super) fn with_levels(
        &self,
        from: &Self,
        fitted: &Fitted,
        (levels, places): (&[f64], &Layout),
        effort: Effort,
    ) -> Result<Fitted> {
        let setup = self.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let layout = estimation.layout();
        let mut values = from.carried(fitted, &estimation);
        for free in &self.problem.levels {
            values[layout.place(free.unknown)?] = levels[places.place(free.unknown)?];
        }
        for index in 0..estimation.setup().disturbances.len() {
            let unknown = Unknown::Disturbance(index);
            values[layout.place(unknown)?] = levels[places.place(unknown)?];
        }
        self.begin(&estimation, &mut values)?;
        self.hide(&fitted.members, &estimation, &mut values)?;
        self.loosen(&estimation, &mut values)?;
        let free = &self.problem.levels;
        let fit = self.weighed(&estimation, &values, free, Fit::quick, effort)?;
        Ok(Fitted {
            layout,
            fit,
            ..fitted.clone()
        })
    }

    /// Increases the initial noise of a search from that of the sensors towards the errors of the model over windows.
    pub(super) fn loosen(&self, estimation: &Estimation<'_>, values: &mut [f64]) -> Result<()> {
        if !self.is_over_windows() {
            return Ok(());
        }
        let layout = estimation.layout();
        let levels = self.problem.levels.iter();
        let places = levels.map(|free| layout.place(free.unknown));
        let places: Vec<usize> = places.collect::<Result<_, _>>()?;
        let larger = LARGER.map(|factor| {
            let mut larger = values.to_vec();
            for &place in &places {
                larger[place] *= factor;
            }
            larger
        });
        if let Some(larger) = likeliest(estimation, larger) {
            values.copy_from_slice(&larger);
        }
        Ok(())
    }

    /// Refits a hypothesis of another problem to these windows; returns the gain and the fit.
    pub(super) fn fitted_again(&self, from: &Self, fitted: &Fitted) -> Result<(f64, Fitted)> {
        let levels = (&self.problem.start[..], &self.layout);
        let taken = self.with_levels(from, fitted, levels, self.effort())?;
        let setup = self.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let again = self.fit(
            self.effort(),
            &fitted.members,
            &estimation,
            &taken.fit.values,
        )?;
        let gain = again.fit.log_likelihood - taken.fit.log_likelihood;
        Ok((gain, again))
    }
}

/// Number of windows without common rows.
fn independent(windows: &DataSet, whole: &[Run]) -> f64 {
    let longest = windows.runs.iter().map(Run::duration).fold(0.0, f64::max);
    let total: f64 = whole.iter().map(Run::duration).sum();
    (total / longest).clamp(1.0, windows.runs.len() as f64)
}

//! How far the gap closes: prediction errors on the held-out runs.
//!
//! No earlier step has access to these runs: they are taken from the data set here, and no
//! function of this file passes them on.

use appell_estimate::{Estimation, Recording};

use super::alternative::columns;
use super::budget::{self, Ends};
use super::calibration::IMMATERIAL;
use super::law::FittedLaw;
use super::prediction::{Errors, Paired, noise, stated, taken_over};
use super::{
    Ahead, Bench, Comparison, DiagnoseError, ErrorOf, Fitted, HowFar, Options, Result, Share,
    Trace, whole,
};
use crate::held_out::{AHEAD, HORIZONS, origins};
use appell_recordings::{DataSet, Part};

/// Horizon at which the gap is reported, in s and in steps at least, but no more than half of a run.
const HORIZON: f64 = 1.0;
const STEPS: f64 = 10.0;
const PART: f64 = 0.5;
/// Factor on the horizon for an unstable mechanism, for which the best hypothesis expects errors larger than the
/// variation of the channels.
const SHORTER: f64 = 0.1;

/// Largest number of rows of a run from which predictions start.
const ORIGINS: usize = 75;
/// Number of rows from which expected errors are computed.
const EXPECTED_FROM: usize = 25;
/// Length of a block relative to the horizon, over which errors are correlated.
const BLOCK: f64 = 1.0;
/// The same in s for predictions of one step and of whole runs.
const BLOCK_S: f64 = 2.0;
/// Largest number of points of a trace.
const POINTS: usize = 1000;

/// The held-out runs.
pub(super) struct HeldOut {
    pub(super) names: Vec<String>,
    pub(super) recordings: Vec<Recording>,
}

/// The leading hypothesis, with the held-out runs bound to its model.
#[derive(Clone)]
pub(super) struct Leader<'l> {
    pub(super) bench: &'l Bench<'l>,
    pub(super) fitted: &'l Fitted,
    pub(super) runs: &'l HeldOut,
    /// Noise of its channels; infinite for those that are not compared.
    pub(super) noise: Vec<f64>,
    /// Its name, where it is another model.
    pub(super) alternative: Option<&'l str>,
    /// The measured law of its residual.
    pub(super) law: Option<&'l FittedLaw<'l>>,
}

impl Leader<'_> {
    pub(super) fn errors(&self, horizon: f64) -> Result<Errors> {
        self.runs
            .errors(self.bench, self.fitted, &self.noise, horizon)
    }

    pub(super) fn floor(&self, horizon: f64) -> Result<f64> {
        self.runs
            .floor(self.bench, self.fitted, &self.noise, horizon)
    }
}

impl HeldOut {
    /// All runs of a data set of held-out runs.
    pub(super) fn of(set: &DataSet, bench: &Bench<'_>) -> Result<Self> {
        let set = set.bound_to(&bench.effects.mechanism);
        let recordings = set.recordings(Part::Test, bench.effects.info())?;
        Ok(Self {
            names: set.runs.into_iter().map(|run| run.name).collect(),
            recordings,
        })
    }

    /// The errors of the nominal model, the re-fitted one and the leading hypothesis, and the shares of the gap;
    /// with the errors of the nominal model on `others`, in the same units.
    pub(super) fn how_far(
        &self,
        bench: &Bench<'_>,
        comparison: &Comparison,
        leader: &Leader<'_>,
        others: Option<&Self>,
        options: &Options,
    ) -> Result<Option<HowFar>> {
        if self.recordings.is_empty() {
            return Ok(None);
        }
        let refitted = comparison.nominal();
        let noise = noise(bench, comparison.best())?;
        let mut horizon = options
            .horizon
            .unwrap_or_else(|| self::horizon(&self.recordings));
        let tolerance = options.tolerance.unwrap_or(IMMATERIAL);
        let mut floor = leader.floor(horizon)?;
        let expected = if leader.bench.is_over_windows() {
            leader.errors(horizon)?.mean().sqrt()
        } else {
            floor
        };
        let is_lost =
            expected.is_nan() || expected > spread(&leader.runs.recordings, &leader.noise);
        if options.horizon.is_none() && is_lost {
            horizon *= SHORTER;
            floor = leader.floor(horizon)?;
        }
        let errors = |fitted: &Fitted| self.errors(bench, fitted, &noise, horizon);
        let stated = stated(bench, refitted)?;
        let before = others.map(|others| {
            let own_floor = |runs: &Self| runs.floor(bench, &stated, &noise, horizon);
            let errors = others.errors(bench, &stated, &noise, horizon)?;
            // Expected errors depend on the motion.
            Ok::<f64, DiagnoseError>(errors.mean().sqrt() * own_floor(self)? / own_floor(others)?)
        });
        let stated = errors(&stated)?;
        let (refit, effect) = (errors(refitted)?, leader.errors(horizon)?);
        let all = [&stated, &refit, &effect];
        let budget = if let Some(name) = leader.alternative {
            budget::of_alternative(name, &Paired::of(&all), floor, tolerance)
        } else {
            let (best, law) = match leader.law {
                Some(law) => {
                    let law_errors = law.runs.errors(&law.bench, &law.fitted, &noise, horizon)?;
                    (law.base, Some(law_errors))
                }
                None => (comparison.best(), None),
            };
            let effects = errors(best)?;
            let ends = Ends {
                stated: &stated,
                refitted: &refit,
                effects: &effects,
                law: law.as_ref(),
                floor,
                tolerance,
            };
            let parts = budget::effects(bench.effects, &best.members);
            budget::of(&parts, &ends, |members| {
                errors(&budget::with(bench, comparison, best, members)?)
            })?
        };
        let runs = self.names.clone();
        let channels = ErrorOf::all(all, bench, leader, &noise);
        Ok(Some(HowFar {
            before: before.transpose()?,
            channels,
            ..HowFar::of(all, horizon, floor, budget, runs)
        }))
    }
}

impl HeldOut {
    /// Errors of a fitted hypothesis, in units of the `noise` of each channel; where that is infinite they do not count.
    pub(super) fn errors(
        &self,
        bench: &Bench<'_>,
        fitted: &Fitted,
        noise: &[f64],
        horizon: f64,
    ) -> Result<Errors> {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let mut errors = Errors::default();
        let length = if horizon > 0.0 && horizon.is_finite() {
            BLOCK * horizon
        } else {
            BLOCK_S
        };
        for (run, recording) in self.recordings.iter().enumerate() {
            let mut origins = origins(recording, ORIGINS);
            if horizon.is_infinite() {
                origins.truncate(1);
            }
            for one in estimation.predictions(&values, run, horizon, &origins)? {
                if noise[one.channel].is_infinite() {
                    continue;
                }
                let block = (recording.times()[one.origin] - recording.times()[0]) / length;
                let square = (one.residual / noise[one.channel]).powi(2);
                errors.add([run, whole(block)], one.channel, square);
            }
        }
        Ok(errors)
    }

    /// The expected error of a true hypothesis, root of the mean square.
    pub(super) fn floor(
        &self,
        bench: &Bench<'_>,
        fitted: &Fitted,
        noise: &[f64],
        horizon: f64,
    ) -> Result<f64> {
        if let Some(sensors) = bench.noise_of_sensors() {
            let parts = sensors.iter().zip(noise);
            let parts = parts.filter(|(_, unit)| unit.is_finite());
            let squares = parts.map(|(sensor, unit)| (sensor / unit).powi(2));
            let squares: Vec<f64> = squares.collect();
            return Ok((squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt());
        }
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for (run, recording) in self.recordings.iter().enumerate() {
            let origins = origins(recording, EXPECTED_FROM);
            for (_, channel, variance) in
                estimation.expected_errors(&values, run, horizon, &origins)?
            {
                if noise[channel].is_finite() {
                    squares += variance / noise[channel].powi(2);
                    count += 1.0;
                }
            }
        }
        Ok((squares / count.max(1.0)).sqrt())
    }
}

/// Plots: channels with their predictions, and errors over the horizon.
impl HeldOut {
    /// Errors at all horizons.
    pub(super) fn horizons(
        &self,
        bench: &Bench<'_>,
        comparison: &Comparison,
        leader: &Leader<'_>,
    ) -> Result<Vec<Ahead>> {
        if self.recordings.is_empty() {
            return Ok(Vec::new());
        }
        let refitted = comparison.nominal();
        let noise = noise(bench, comparison.best())?;
        let nominal = stated(bench, refitted)?;
        let ahead = |horizon: f64| {
            let error = |fitted: &Fitted| -> Result<f64> {
                Ok(self.errors(bench, fitted, &noise, horizon)?.mean().sqrt())
            };
            let floor = if horizon.is_finite() {
                Some(leader.floor(horizon)?)
            } else {
                None
            };
            Ok(Ahead {
                horizon,
                nominal: error(&nominal)?,
                refitted: error(refitted)?,
                with_effect: leader.errors(horizon)?.mean().sqrt(),
                noise_floor: floor,
            })
        };
        HORIZONS.into_iter().map(ahead).collect()
    }

    /// The channels of the first run.
    pub(super) fn traces(
        &self,
        bench: &Bench<'_>,
        comparison: &Comparison,
        leader: &Leader<'_>,
    ) -> Result<Vec<Trace>> {
        let Some(recording) = self.recordings.first() else {
            return Ok(Vec::new());
        };
        let refitted = comparison.nominal();
        let nominal = self.predicted(bench, &stated(bench, refitted)?)?;
        let refitted = self.predicted(bench, refitted)?;
        let with_effect = leader.runs.predicted(leader.bench, leader.fitted)?;
        let deviations = leader.runs.deviations(leader.bench, leader.fitted)?;
        let led = columns(leader.bench);
        let rows = recording.times().len();
        let channels = bench.set.measured(bench.effects.info());
        let mut traces = Vec::new();
        for (index, (channel, _)) in channels.iter().enumerate() {
            let Some(own) = led.iter().position(|column| *column == channel.column) else {
                continue;
            };
            let told: Vec<usize> = (0..rows)
                .filter(|&row| nominal[index][row].is_finite() || with_effect[own][row].is_finite())
                .collect();
            let of = |values: &dyn Fn(usize) -> f64| -> Vec<f64> {
                let rows = told.iter();
                rows.map(|&row| channel.unit.from_si(values(row))).collect()
            };
            traces.push(Trace {
                run: self.names[0].clone(),
                column: channel.column.clone(),
                unit: channel.unit.text.clone(),
                times: told.iter().map(|&row| recording.times()[row]).collect(),
                measured: of(&|row| recording.measured(row)[index]),
                nominal: of(&|row| nominal[index][row]),
                refitted: of(&|row| refitted[index][row]),
                with_effect: of(&|row| with_effect[own][row]),
                deviation: channel.unit.from_si(deviations[own]),
            });
        }
        Ok(traces)
    }

    /// Predictions of the first run in SI, by channel and row; NaN without a prediction.
    fn predicted(&self, bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Vec<f64>>> {
        let recording = &self.recordings[0];
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let rows = recording.times().len();
        let mut predicted = vec![vec![f64::NAN; rows]; bench.measured.len()];
        for one in estimation.predictions(&values, 0, AHEAD, &origins(recording, POINTS))? {
            let value = recording.measured(one.row)[one.channel] - one.residual;
            predicted[one.channel][one.row] = value;
        }
        Ok(predicted)
    }

    /// Expected standard deviations of the errors of a true hypothesis in SI, by channel.
    fn deviations(&self, bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<f64>> {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let origins = origins(&self.recordings[0], EXPECTED_FROM);
        let mut sums = vec![(0.0, 0.0); bench.measured.len()];
        for (_, channel, variance) in estimation.expected_errors(&values, 0, AHEAD, &origins)? {
            sums[channel].0 += variance;
            sums[channel].1 += 1.0;
        }
        let means = sums.into_iter();
        Ok(means
            .map(|(sum, count): (f64, f64)| (sum / count.max(1.0)).sqrt())
            .collect())
    }
}

impl ErrorOf {
    /// Of all channels that are compared, in the units of the recordings: of the stated model, the re-fitted one and the
    /// leading hypothesis, whose model may measure more channels.
    fn all(
        errors: [&Errors; 3],
        bench: &Bench<'_>,
        leader: &Leader<'_>,
        noise: &[f64],
    ) -> Vec<Self> {
        let of_leader = columns(leader.bench);
        let measured = bench.set.measured(bench.effects.info());
        let compared = measured.iter().zip(noise).enumerate();
        let compared = compared.filter(|(_, (_, noise))| noise.is_finite());
        let all = compared.map(|(place, ((channel, _), noise))| {
            let of_leader = of_leader.iter().position(|own| *own == channel.column);
            let of_leader = of_leader.unwrap_or(place);
            let in_unit =
                |errors: &Errors, place| channel.unit.from_si(errors.rms_of(place) * noise);
            let [stated, refit, effect] = errors;
            Self {
                name: channel.column.clone(),
                unit: channel.unit.text.clone(),
                nominal: in_unit(stated, place),
                refitted: in_unit(refit, place),
                with_effect: in_unit(effect, of_leader),
            }
        });
        all.collect()
    }
}

impl HowFar {
    /// From the errors of the stated model, the re-fitted one and the leading hypothesis.
    pub(super) fn of(
        errors: [&Errors; 3],
        horizon_s: f64,
        floor: f64,
        budget: Vec<Share>,
        runs: Vec<String>,
    ) -> Self {
        let paired = Paired::of(&errors);
        let bettered = |base: usize| paired.interval95(|means| 1.0 - means[2] / means[base]);
        let closed = |from: f64, to: f64| (from - to) / (from - floor * floor);
        let means = paired.means();
        Self {
            horizon_s,
            nominal: means[0].sqrt(),
            refitted: means[1].sqrt(),
            with_effect: means[2].sqrt(),
            noise_floor: floor,
            closed: closed(means[0], means[2]),
            closed_ci95: paired.interval95(|means| closed(means[0], means[2])),
            closed_vs_refitted: closed(means[1], means[2]),
            budget,
            bettered_ci95: [0, 1].map(bettered),
            is_worse: paired.interval95(|means| means[1] - means[2])[1] < 0.0,
            runs,
            ..Self::default()
        }
    }
}

/// The horizon in s that recordings allow.
pub(super) fn horizon(recordings: &[Recording]) -> f64 {
    let (mut longest, mut step) = (0.0_f64, 0.0_f64);
    for run in recordings {
        let times = run.times();
        let duration = times[times.len() - 1] - times[0];
        longest = longest.max(duration);
        step = step.max(duration / (times.len() - 1) as f64);
    }
    HORIZON.max(STEPS * step).min(PART * longest)
}

/// Variation of the channels, in units of the noise: root of the mean square.
pub(super) fn spread(recordings: &[Recording], noise: &[f64]) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0_f64);
    let compared = noise.iter().enumerate();
    for (channel, noise) in compared.filter(|(_, noise)| noise.is_finite()) {
        for run in recordings {
            let rows = (0..run.times().len()).map(|row| run.measured(row)[channel]);
            let seen: Vec<f64> = rows.filter(|value| !value.is_nan()).collect();
            let mean = seen.iter().sum::<f64>() / seen.len().max(1) as f64;
            let square = |value: &f64| ((value - mean) / noise).powi(2);
            squares += seen.iter().map(square).sum::<f64>();
            count += seen.len() as f64;
        }
    }
    (squares / count.max(1.0)).sqrt()
}

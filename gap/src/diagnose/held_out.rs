//! How far the gap closes: errors of predictions on the runs that were held out.
//!
//! Nothing before this step can see these runs: they are taken from the data set here, and no
//! function of this file hands them on.

use appell_estimate::{Estimation, Recording, Unknown};

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::Comparison;
use super::hypothesis::Fitted;
use super::report::HowFar;
use crate::data::{DataSet, Part};
use crate::identify::begin;

/// Horizon in s at which the gap is told.
const HORIZON: f64 = 1.0;
/// The same where a mechanism falls over so soon that the best hypothesis expects larger errors than
/// the channels vary.
const SHORT: f64 = 0.1;
/// Most rows of a run from which predictions start.
const ORIGINS: usize = 150;
/// Rows from which expected errors are told.
const EXPECTED_FROM: usize = 25;
/// Time in s that the filter has to find the state, but no more than a tenth of the run.
const WARM_UP: f64 = 0.5;
/// Times that disturbances are raised tenfold at most.
const MORE: usize = 6;
/// Draws of the bootstrap.
const DRAWS: usize = 1000;
/// Blocks of errors last so many seconds: errors that overlap depend on each other.
const BLOCK: f64 = 2.0;

/// The runs that were held out.
pub(super) struct HeldOut {
    pub(super) names: Vec<String>,
    pub(super) recordings: Vec<Recording>,
}

/// The hypothesis that leads, with the runs that were held out as its model takes them.
pub(super) struct Leader<'l> {
    pub(super) bench: &'l Bench<'l>,
    pub(super) fitted: &'l Fitted,
    pub(super) runs: &'l HeldOut,
    /// Noise of its channels; infinite for those that are not compared.
    pub(super) noise: Vec<f64>,
}

impl Leader<'_> {
    pub(super) fn errors(&self, horizon: f64) -> Result<Vec<(usize, usize, f64)>, DiagnoseError> {
        self.runs
            .errors(self.bench, self.fitted, &self.noise, horizon)
    }

    pub(super) fn floor(&self, horizon: f64) -> Result<f64, DiagnoseError> {
        self.runs
            .floor(self.bench, self.fitted, &self.noise, horizon)
    }
}

/// Sums of squared errors, in units of the noise, of one block of a run.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    nominal: f64,
    refitted: f64,
    effect: f64,
    count: f64,
}

impl HeldOut {
    /// Of a data set that has nothing else.
    pub(super) fn of(set: &DataSet, bench: &Bench<'_>) -> Result<Self, DiagnoseError> {
        let set = set.bound_to(&bench.effects.mechanism);
        let recordings = set.recordings(Part::Test, bench.effects.info())?;
        Ok(Self {
            names: set.runs.into_iter().map(|run| run.name).collect(),
            recordings,
        })
    }

    /// The errors of the nominal model, the re-fitted one and the leading hypothesis.
    pub(super) fn how_far(
        &self,
        bench: &Bench<'_>,
        comparison: &Comparison,
        leader: &Leader<'_>,
    ) -> Result<Option<HowFar>, DiagnoseError> {
        if self.recordings.is_empty() {
            return Ok(None);
        }
        let refitted = comparison.nominal();
        let nominal = stated(bench, refitted);
        let noise = noise(bench, comparison.best())?;
        let (mut horizon, mut floor) = (HORIZON, leader.floor(HORIZON)?);
        if floor.is_nan() || floor > leader.runs.spread(&leader.noise) {
            (horizon, floor) = (SHORT, leader.floor(SHORT)?);
        }
        let errors = |fitted: &Fitted| self.errors(bench, fitted, &noise, horizon);
        let (nominal, refitted) = (errors(&nominal)?, errors(refitted)?);
        let effect = leader.errors(horizon)?;
        let blocks: Vec<Block> = blocks(&nominal, &refitted, &effect);
        let total = sum(&blocks);
        let closed = |e0: f64, e: f64| (e0 - e) / (e0 - floor * floor);
        let mean = |sum: f64, of: &Block| sum / of.count.max(1.0);
        let of = |block: &Block| closed(mean(block.nominal, block), mean(block.effect, block));
        let mut drawn: Vec<f64> = Draws(1).over(&blocks, DRAWS).iter().map(of).collect();
        drawn.sort_by(f64::total_cmp);
        let at = |part: usize| {
            drawn
                .get(part * drawn.len() / 1000)
                .copied()
                .unwrap_or(f64::NAN)
        };
        Ok(Some(HowFar {
            horizon_s: horizon,
            nominal: mean(total.nominal, &total).sqrt(),
            refitted: mean(total.refitted, &total).sqrt(),
            with_effect: mean(total.effect, &total).sqrt(),
            noise_floor: floor,
            closed: of(&total),
            closed_ci95: [at(25), at(975)],
            closed_vs_refitted: closed(mean(total.refitted, &total), mean(total.effect, &total)),
            runs: self.names.clone(),
        }))
    }

    /// How much the channels vary, in units of the noise: root of the mean square.
    fn spread(&self, noise: &[f64]) -> f64 {
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for (channel, noise) in noise
            .iter()
            .enumerate()
            .filter(|(_, noise)| noise.is_finite())
        {
            for run in &self.recordings {
                let rows = (0..run.times().len()).map(|row| run.measured(row)[channel]);
                let seen: Vec<f64> = rows.filter(|value| !value.is_nan()).collect();
                let mean = seen.iter().sum::<f64>() / seen.len().max(1) as f64;
                squares += seen
                    .iter()
                    .map(|value| ((value - mean) / noise).powi(2))
                    .sum::<f64>();
                count += seen.len() as f64;
            }
        }
        (squares / count.max(1.0)).sqrt()
    }

    /// Squared errors in units of the noise, with run and block.
    pub(super) fn errors(
        &self,
        bench: &Bench<'_>,
        fitted: &Fitted,
        noise: &[f64],
        horizon: f64,
    ) -> Result<Vec<(usize, usize, f64)>, DiagnoseError> {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let mut errors = Vec::new();
        for (run, recording) in self.recordings.iter().enumerate() {
            let mut origins = origins(recording, ORIGINS);
            if horizon.is_infinite() {
                origins.truncate(1);
            }
            for one in estimation.predictions(&values, run, horizon, &origins)? {
                if noise[one.channel].is_infinite() {
                    continue;
                }
                let block = (recording.times()[one.origin] - recording.times()[0]) / BLOCK;
                // A count of blocks in memory.
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                let block = block as usize;
                let error = (one.residual / noise[one.channel]).powi(2);
                errors.push((run, block, error));
            }
        }
        Ok(errors)
    }

    /// The error that remains where the hypothesis is right.
    pub(super) fn floor(
        &self,
        bench: &Bench<'_>,
        fitted: &Fitted,
        noise: &[f64],
        horizon: f64,
    ) -> Result<f64, DiagnoseError> {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        let values = taken_over(bench, fitted, &estimation)?;
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for (run, recording) in self.recordings.iter().enumerate() {
            let origins = origins(recording, EXPECTED_FROM);
            for (channel, variance) in
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

/// The rig as the data set states it, with the levels of a fit.
pub(super) fn stated(bench: &Bench<'_>, fitted: &Fitted) -> Fitted {
    let mut stated = fitted.clone();
    for (index, parameter) in bench.set.parameters.iter().enumerate() {
        stated.fit.values[index] = parameter.value;
    }
    stated
}

/// Values of a fit on these recordings. A filter that trusts its model so much that it loses a run
/// which it has not seen gets more disturbance, until it follows.
pub(super) fn taken_over(
    bench: &Bench<'_>,
    fitted: &Fitted,
    estimation: &Estimation<'_>,
) -> Result<Vec<f64>, DiagnoseError> {
    let mut values = bench.carried(fitted, estimation);
    begin(estimation, &mut values)?;
    bench.hide(&fitted.members, estimation, &mut values)?;
    let layout = estimation.layout();
    for _ in 0..MORE {
        if estimation.log_likelihood(&values).is_ok() {
            break;
        }
        for index in 0..estimation.setup().disturbances.len() {
            values[layout.place(Unknown::Disturbance(index))?] *= 10.0;
        }
    }
    Ok(values)
}

/// Noise of the channels under a hypothesis.
pub(super) fn noise(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<f64>, DiagnoseError> {
    let channels = 0..bench.measured.len();
    let noise = channels.map(|channel| {
        let place = fitted.layout.place(Unknown::Noise(channel))?;
        Ok(fitted.fit.values[place])
    });
    noise.collect()
}

/// Rows from which predictions start.
pub(super) fn origins(recording: &Recording, most: usize) -> Vec<usize> {
    let times = recording.times();
    let (start, end) = (times[0], times[times.len() - 1]);
    let from = start + WARM_UP.min(0.1 * (end - start));
    let first = times.partition_point(|&t| t < from);
    let every = (times.len() - first).div_ceil(most).max(1);
    (first..times.len()).step_by(every).collect()
}

type Errors = [(usize, usize, f64)];

/// Errors of the three models in the same blocks.
fn blocks(nominal: &Errors, refitted: &Errors, effect: &Errors) -> Vec<Block> {
    let mut blocks: std::collections::BTreeMap<(usize, usize), [f64; 4]> =
        std::collections::BTreeMap::new();
    for (place, errors) in [nominal, refitted, effect].into_iter().enumerate() {
        for &(run, block, error) in errors {
            let sums = blocks.entry((run, block)).or_default();
            sums[place] += error;
            if place == 0 {
                sums[3] += 1.0;
            }
        }
    }
    let sums = blocks.into_values();
    sums.map(|[nominal, refitted, effect, count]| Block {
        nominal,
        refitted,
        effect,
        count,
    })
    .collect()
}

fn sum(blocks: &[Block]) -> Block {
    blocks.iter().fold(Block::default(), |sum, block| Block {
        nominal: sum.nominal + block.nominal,
        refitted: sum.refitted + block.refitted,
        effect: sum.effect + block.effect,
        count: sum.count + block.count,
    })
}

/// Draws with replacement, the same in every run of the program (Steele, Lea and Flood, *Fast
/// splittable pseudorandom number generators*, 2014).
struct Draws(u64);

impl Draws {
    fn over(mut self, blocks: &[Block], draws: usize) -> Vec<Block> {
        (0..draws)
            .map(|_| {
                let drawn: Vec<Block> = (0..blocks.len())
                    .map(|_| blocks[self.below(blocks.len())])
                    .collect();
                sum(&drawn)
            })
            .collect()
    }

    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        usize::try_from(z % count.max(1) as u64).unwrap_or(0)
    }
}

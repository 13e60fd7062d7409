//! Errors of predictions over a horizon, in units of the noise, by blocks of time.
//!
//! A prediction starts from the filtered state at a row and uses no later measurement, so that process noise cannot
//! absorb a missing effect. Errors of overlapping predictions are
//! correlated: intervals come from a bootstrap over whole blocks (H. R. Künsch, *The jackknife and the
//! bootstrap for general stationary observations*, Annals of Statistics 17, 1989).

use std::collections::BTreeMap;

use appell_estimate::{Estimation, Unknown};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use super::starts::scale_process_noise;
use super::{Bench, Fitted, Result};

/// Largest number of tenfold increases of the process noise.
const MORE: usize = 6;
/// Number of bootstrap samples.
const DRAWS: usize = 1000;

/// Sums of squared errors with their counts.
#[derive(Debug, Clone, Default)]
pub(super) struct Errors {
    /// By run and block.
    blocks: BTreeMap<[usize; 2], (f64, f64)>,
    /// By channel.
    channels: BTreeMap<usize, (f64, f64)>,
}

impl Errors {
    /// Adds a squared error of a channel, in a block of a run.
    pub(super) fn add(&mut self, block: [usize; 2], channel: usize, square: f64) {
        let block = self.blocks.entry(block).or_default();
        for (sum, count) in [block, self.channels.entry(channel).or_default()] {
            *sum += square;
            *count += 1.0;
        }
    }

    /// Root of the mean square of a channel.
    pub(super) fn rms_of(&self, channel: usize) -> f64 {
        let sums = self.channels.get(&channel);
        sums.map_or(f64::NAN, |(sum, count)| (sum / count).sqrt())
    }

    /// Mean square.
    pub(super) fn mean(&self) -> f64 {
        let (sum, count) = (self.blocks.values()).fold((0.0, 0.0), |(sum, count), (square, n)| {
            (sum + square, count + n)
        });
        sum / f64::max(count, 1.0)
    }
}

/// Errors of several models in the same blocks.
#[derive(Debug, Clone)]
pub(super) struct Paired {
    /// Sums by block and model.
    sums: Vec<Vec<f64>>,
    counts: Vec<f64>,
    /// Number of models.
    models: usize,
}

impl Paired {
    pub(super) fn of(models: &[&Errors]) -> Self {
        let blocks = models.first().map(|first| first.blocks.iter());
        let blocks: Vec<_> = blocks.into_iter().flatten().collect();
        let sum = |place, model: &&Errors| model.blocks.get(place).map_or(0.0, |(sum, _)| *sum);
        Self {
            sums: (blocks.iter())
                .map(|(place, _)| models.iter().map(|model| sum(*place, model)).collect())
                .collect(),
            counts: blocks.iter().map(|(_, (_, count))| *count).collect(),
            models: models.len(),
        }
    }

    /// Mean squares of the models.
    pub(super) fn means(&self) -> Vec<f64> {
        self.over(0..self.sums.len())
    }

    fn over(&self, blocks: impl Iterator<Item = usize>) -> Vec<f64> {
        let mut means = vec![0.0; self.models];
        let mut count = 0.0;
        for block in blocks {
            for (mean, sum) in means.iter_mut().zip(&self.sums[block]) {
                *mean += sum;
            }
            count += self.counts[block];
        }
        for mean in &mut means {
            *mean /= f64::max(count, 1.0);
        }
        means
    }

    /// Quantiles 2.5 and 97.5 % of a function of the mean squares; with a fixed seed.
    pub(super) fn interval95(&self, number: impl Fn(&[f64]) -> f64) -> [f64; 2] {
        let mut random = SplitMix64::seed_from_u64(1);
        let count = self.sums.len();
        let mut below = || usize::try_from(random.next_u64() % count.max(1) as u64).unwrap_or(0);
        let numbers = (0..DRAWS).map(|_| {
            let blocks: Vec<usize> = (0..count).map(|_| below()).collect();
            number(&self.over(blocks.into_iter()))
        });
        let mut drawn: Vec<f64> = numbers.collect();
        drawn.sort_by(f64::total_cmp);
        let at = |part: usize| {
            let one = drawn.get(part * drawn.len() / 1000);
            one.copied().unwrap_or(f64::NAN)
        };
        [at(25), at(975)]
    }
}

/// The model with the parameters stated by the data set, and the noise levels of a fit.
pub(super) fn stated(bench: &Bench<'_>, fitted: &Fitted) -> Result<Fitted> {
    let mut stated = fitted.clone();
    bench.perfected(&mut stated)?;
    // Models without creeping contacts have fewer parameters: the first ones.
    let own = bench.effects.with(&fitted.members).info().parameter_len();
    for (value, parameter) in stated.fit.values[..own]
        .iter_mut()
        .zip(&bench.set.parameters)
    {
        *value = parameter.value;
    }
    Ok(stated)
}

/// Values of a fit on these recordings. If the filter diverges on a run that was not fitted, its process noise is
/// increased until it converges.
pub(super) fn taken_over(
    bench: &Bench<'_>,
    fitted: &Fitted,
    estimation: &Estimation<'_>,
) -> Result<Vec<f64>> {
    let mut values = bench.carried(fitted, estimation);
    bench.begin(estimation, &mut values)?;
    bench.hide(&fitted.members, estimation, &mut values)?;
    let layout = estimation.layout();
    for (unknown, value) in &bench.predicting {
        values[layout.place(*unknown)?] = *value;
    }
    for _ in 0..MORE {
        if estimation.log_likelihood(&values).is_ok() {
            break;
        }
        scale_process_noise(estimation, &mut values, 10.0)?;
    }
    Ok(values)
}

/// Values of a fit with process noise, estimated on its training runs: fits over windows have none.
pub(super) fn followed(
    bench: &Bench<'_>,
    fitted: &Fitted,
    estimation: &Estimation<'_>,
) -> Result<Vec<f64>> {
    if bench.is_over_windows() {
        taken_over(bench, fitted, estimation)
    } else {
        Ok(fitted.fit.values.clone())
    }
}

/// Noise of the channels under a hypothesis.
pub(super) fn noise(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<f64>> {
    let channels = 0..bench.measured.len();
    let noise = channels.map(|channel| {
        let place = fitted.layout.place(Unknown::Noise(channel))?;
        Ok(fitted.fit.values[place])
    });
    noise.collect()
}

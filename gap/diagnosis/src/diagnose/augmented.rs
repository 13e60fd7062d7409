//! Screening of candidates with an additional coordinate, such as backlash.
//!
//! They have no effect to first order, and their models are expensive. They are therefore tried on a grid of
//! sizes, and only if innovations are biased after reversals of the drive, when the contact changes
//! sides. Sizes are compared on the first rows of the recordings; the best ones are evaluated on all rows, if their gain
//! there is nearly enough for a fit.

use std::collections::BTreeMap;

use appell_estimate::{Estimation, Innovation, Recording, Setup, in_parallel};

use super::screen::{LEAST_GAIN, QUIET, Screened, directions, least};
use super::starts::scale_process_noise;
use super::{Bench, Fitted, Result};
use crate::effects::{Candidate, Drive, Part};

/// Sizes that are tried, relative to the range of the coordinate: most gears have less backlash than the largest, and
/// less than the smallest is hardly detectable.
const PARTS: [f64; 7] = [5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1.6e-2, 3.2e-2];
/// Factors of the shape at which fits start.
const FACTORS: [f64; 3] = [0.6, 1.2, 2.4];
/// Factors of the shape that are tried if a channel measures the additional coordinate, the first one with all sizes;
/// and the number of starting points that are retained.
const SHAPES: [f64; 4] = [1.8, 0.6, 3.6, 7.2];
const STARTS: usize = 2;
/// Ends, in s after a reversal of the drive, of the intervals whose mean innovation is tested: in some of
/// them the gap is crossed.
const AFTER: [f64; 4] = [0.05, 0.1, 0.2, 0.4];
/// Significance of the mean innovation of such an interval, in standard deviations.
const BIASED: f64 = 4.0;
/// Largest gain of such a candidate relative to that of removing the mean innovations of these intervals. If another
/// candidate gains more, this one is tried together with that.
const MOST: f64 = 2.0;
/// Number of rows at the beginnings of the recordings on which sizes are compared, and the smallest one per recording.
const SAMPLE: usize = 500;
const FEWEST_ROWS: usize = 100;
/// Number of sizes that are evaluated on all rows, if the expected gain is this part of the least one for a fit.
const BEST: usize = 2;
const PROMISING: f64 = 0.5;

/// The candidates with a positive gain at some size. A feedback input biases the innovations after its reversals in
/// any case: the gain that it explains, at most `by_inputs`, is subtracted. `best` is the largest gain of the
/// other candidates.
pub(super) fn screened(
    bench: &Bench<'_>,
    fitted: &Fitted,
    by_inputs: f64,
    best: f64,
) -> Result<Vec<Screened>> {
    let effects = bench.effects;
    // With feedback inputs, innovations of an unconverged fit carry no information about reversals.
    if bench.input_innovations.count() > 0 && !fitted.fit.is_optimum() {
        return Ok(Vec::new());
    }
    // One additional coordinate at a time, and none together with creeping contacts.
    let mut members = fitted.members.iter();
    if members.any(|&member| effects.stands_alone(member)) {
        return Ok(Vec::new());
    }
    let p = &fitted.fit.values[..effects.with(&[]).info().parameter_len()];
    // Through an encoder on the motor backlash is visible for some rows only: too short for windows.
    let is_seen =
        |own: &Candidate| own.shows.is_empty() || bench.is_shown(own) && !bench.is_over_windows();
    let all = effects.candidates.iter().enumerate();
    let seen = all.filter(|(_, own)| is_seen(own));
    let seen = seen.filter_map(|(index, own)| Some((index, own.brings?)));
    let seen: Vec<(usize, usize)> = seen.collect();
    if seen.is_empty() {
        return Ok(Vec::new());
    }
    let setup = bench.setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let runs = estimation.innovations(&fitted.fit.values);
    let runs = runs.unwrap_or_default();
    let mut drives: BTreeMap<usize, Option<Drive>> = BTreeMap::new();
    let mut brought = Vec::new();
    for (index, beside) in seen {
        let drive = drives.entry(beside).or_insert_with(|| {
            let drive = Drive::of(effects.with(&[]), p, beside);
            drive.filter(|drive| is_biased(bench, &runs, drive, best))
        });
        brought.extend(drive.clone().map(|drive| (index, drive)));
    }
    if brought.is_empty() {
        return Ok(Vec::new());
    }
    let sample = Sample::of(bench, fitted);
    let list = in_parallel(brought, |(index, drive)| {
        if !effects.augment(index, &drive) {
            return Ok(None);
        }
        let members = [fitted.members.as_slice(), &[index]].concat();
        let grid = Grid {
            bench,
            fitted,
            candidate: index,
            setup: bench.setup(&members),
            sample: sample.as_ref(),
            least: least(best),
        };
        Ok(best_size(&grid)?.map(|one| one.beyond_inputs(by_inputs)))
    });
    let list: Result<Vec<_>> = list.into_iter().collect();
    Ok(list?.into_iter().flatten().collect())
}

/// Whether innovations are biased after reversals of the drive, by so much that no other candidate can gain more than
/// backlash.
fn is_biased(bench: &Bench<'_>, runs: &[Vec<Innovation>], drive: &Drive, best: f64) -> bool {
    let mut sums = vec![(0.0_f64, 0.0_f64); AFTER.len() * bench.measured.len()];
    for (recording, innovations) in bench.recordings.iter().zip(runs) {
        let times = recording.times();
        let signs: Vec<f64> = (0..times.len())
            .map(|row| drive.force(recording.inputs(row)).signum())
            .collect();
        let mut reversed = f64::NEG_INFINITY;
        let mut last = 0;
        for one in innovations {
            for row in last + 1..=one.row {
                if signs[row] * signs[row - 1] < 0.0 {
                    reversed = times[row];
                }
            }
            last = last.max(one.row);
            let window = AFTER.iter().position(|end| one.t - reversed < *end);
            if let Some(window) = window {
                let sum = &mut sums[AFTER.len() * one.channel + window];
                sum.0 += one.whitened() * signs[one.row];
                sum.1 += 1.0;
            }
        }
    }
    let stands_out = |(sum, count): &(f64, f64)| sum.abs() > BIASED * count.sqrt();
    let gains = (sums.iter()).map(|(sum, count)| 0.5 * sum * sum / count.max(1.0));
    let gain = bench.weight * gains.sum::<f64>();
    sums.iter().any(stands_out) && MOST * gain >= best.max(LEAST_GAIN)
}

/// The first rows of the recordings.
struct Sample {
    recordings: Vec<Recording>,
    /// Log likelihood of the hypothesis on these rows.
    log_likelihood: f64,
    /// Ratio of the number of all rows to that of these.
    scale: f64,
}

impl Sample {
    /// `None` if there are few rows, or the filter of the hypothesis diverges.
    fn of(bench: &Bench<'_>, fitted: &Fitted) -> Option<Self> {
        let rows = |recordings: &[Recording]| -> usize {
            recordings.iter().map(|run| run.times().len()).sum()
        };
        let all = rows(&bench.recordings);
        let part = |run: &Recording| run.part(0..run.times().len() * SAMPLE / all);
        let short = |run: &Recording| run.times().len() * SAMPLE < FEWEST_ROWS * all;
        if all < 2 * SAMPLE || bench.recordings.iter().any(short) {
            return None;
        }
        let recordings: Vec<Recording> = bench.recordings.iter().map(part).collect();
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &recordings).ok()?;
        let values = bench.carried(fitted, &estimation);
        let log_likelihood = bench.weight * estimation.log_likelihood(&values).ok()?;
        Some(Self {
            log_likelihood,
            scale: all as f64 / rows(&recordings) as f64,
            recordings,
        })
    }
}

/// A size and a shape with the parameter values and the gain.
struct Tried {
    gain: f64,
    size: f64,
    factor: f64,
    own: Vec<(usize, f64)>,
}

/// The size with the largest gain.
fn best_size(grid: &Grid<'_, '_>) -> Result<Option<Screened>> {
    let (bench, candidate) = (grid.bench, grid.candidate);
    let info = bench.effects.info();
    let site = bench.candidate(candidate).site.as_str();
    let state = info.states.iter().position(|state| state.name == site);
    let Some((low, high)) = state.and_then(|state| bench.range(state)) else {
        return Ok(None);
    };
    let sizes = PARTS.map(|part| part * (high - low));
    let shows = !bench.candidate(candidate).shows.is_empty();
    let (levels, mut tried) = if shows {
        // A channel that measures the additional coordinate determines the size whatever the shape, then the shape.
        let [first, others @ ..] = SHAPES;
        let mut tried = grid.tried(&sizes.map(|size| (size, first)), QUIET)?;
        if let Some(size) = tried.first().map(|best| best.size) {
            tried.extend(grid.tried(&others.map(|factor| (size, factor)), QUIET)?);
        }
        (QUIET, tried)
    } else {
        (1.0, grid.tried(&sizes.map(|size| (size, 1.0)), 1.0)?)
    };
    tried.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let Some(best) = tried.first().filter(|best| best.gain > 0.0) else {
        return Ok(None);
    };
    let starts = if shows {
        let best = tried.iter().take(STARTS);
        best.map(|one| one.own.clone()).collect()
    } else {
        // The product of size and shape is the best determined quantity: it is kept constant.
        let product = |factor: f64| grid.values(best.size / factor, factor);
        FACTORS.map(product).to_vec()
    };
    let sizes = vec![best.size; directions(bench, candidate).len()];
    Ok(Some(Screened {
        candidate,
        gain: best.gain,
        deviations: vec![0.0; sizes.len()],
        sizes,
        starts,
        levels,
    }))
}

/// A grid search over sizes and shapes of a candidate.
struct Grid<'g, 'b> {
    bench: &'g Bench<'b>,
    fitted: &'g Fitted,
    candidate: usize,
    setup: Setup<'g>,
    sample: Option<&'g Sample>,
    least: f64,
}

impl Grid<'_, '_> {
    /// The values of the candidate's parameters.
    fn values(&self, size: f64, factor: f64) -> Vec<(usize, f64)> {
        let (bench, info) = (self.bench, self.bench.effects.info());
        let own = bench.own(bench.candidate(self.candidate)).into_iter();
        let value = |(place, role): (usize, Part)| match role {
            Part::Size | Part::Term(_) => size,
            Part::Shape(_) => factor * info.parameters[place].value,
            Part::Switch => 1.0,
        };
        own.map(|one| (one.0, value(one))).collect()
    }

    /// Evaluates sizes and factors of the shape, the best first, with process noise multiplied by `levels`. If none is
    /// promising, the gains are those extrapolated from the sample.
    fn tried(&self, all: &[(f64, f64)], levels: f64) -> Result<Vec<Tried>> {
        let on_all_rows = |all: &[(f64, f64)]| {
            let log_likelihood = self.fitted.fit.log_likelihood;
            self.gains(all, levels, &self.bench.recordings, log_likelihood)
        };
        let Some(sample) = self.sample else {
            return on_all_rows(all);
        };
        let mut rough = self.gains(all, levels, &sample.recordings, sample.log_likelihood)?;
        for one in &mut rough {
            one.gain *= sample.scale;
        }
        if rough
            .first()
            .is_none_or(|best| best.gain < PROMISING * self.least)
        {
            return Ok(rough);
        }
        let best = rough.iter().take(BEST).map(|one| (one.size, one.factor));
        on_all_rows(&best.collect::<Vec<_>>())
    }

    /// Their gains on some recordings, relative to this log likelihood of the hypothesis, without those at which the
    /// filter diverges.
    fn gains(
        &self,
        all: &[(f64, f64)],
        levels: f64,
        recordings: &[Recording],
        log_likelihood: f64,
    ) -> Result<Vec<Tried>> {
        let (bench, fitted) = (self.bench, self.fitted);
        let estimation = Estimation::new(&self.setup, recordings)?;
        let mut tried = Vec::new();
        for &(size, factor) in all {
            let own = self.values(size, factor);
            let mut values = bench.carried(fitted, &estimation);
            for &(place, value) in &own {
                values[place] = value;
            }
            scale_process_noise(&estimation, &mut values, levels)?;
            bench.hide(&[self.candidate], &estimation, &mut values)?;
            if let Ok(likelihood) = estimation.log_likelihood(&values) {
                let gain = bench.weight * likelihood - log_likelihood;
                tried.push(Tried {
                    gain,
                    size,
                    factor,
                    own,
                });
            }
        }
        tried.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(tried)
    }
}

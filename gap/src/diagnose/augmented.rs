//! Candidates that bring a coordinate of their own, such as play: what they would gain.
//!
//! They do nothing to first order, and their models cost more than others. So they are tried on a grid of
//! sizes, and only where innovations are biased after reversals of the drive: there the teeth change
//! sides. Sizes are compared at the beginnings of the recordings; the best ones are tried on all rows, if they
//! gain about enough there to be fitted.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use appell_estimate::{Estimation, Innovation, Recording, Setup, in_parallel};

use super::DiagnoseError;
use super::bench::Bench;
use super::evidence::Fitted;
use super::screen::{LEAST_GAIN, QUIET, Screened, directions, least, quieten};
use crate::effects::{Drive, Part};

/// Sizes that are tried, as parts of the range of the coordinate: most gears have less play, and less
/// than the smallest is hardly seen.
const PARTS: [f64; 7] = [5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 1.6e-2, 3.2e-2];
/// Factors of the shape from which fits begin.
const FACTORS: [f64; 3] = [0.6, 1.2, 2.4];
/// Those at which sizes are tried where a channel shows the coordinate, the first one at all sizes, and starts that
/// are kept.
const SHAPES: [f64; 4] = [1.8, 0.6, 3.6, 7.2];
const STARTS: usize = 2;
/// Ends of the times in s after a reversal of the drive that are looked at: some of them are those in
/// which the gap is crossed.
const AFTER: [f64; 4] = [0.05, 0.1, 0.2, 0.4];
/// Standard deviations by which the mean innovation in one of these times stands out.
const BIASED: f64 = 4.0;
/// What such a coordinate gains at most, relative to what it would by taking the means out of these times. Where
/// another candidate gains more, it is tried beside that one.
const MOST: f64 = 2.0;
/// Rows at the beginnings of the recordings on which sizes are compared, and the fewest of one of them.
const SAMPLE: usize = 500;
const FEWEST_ROWS: usize = 100;
/// Of these the best ones are tried on all rows, if they promise this part of what makes a candidate worth a fit.
const BEST: usize = 2;
const PROMISING: f64 = 0.5;

/// Those that gain at some size. An input that follows the motion biases the innovations after its reversals
/// whatever the cause: it claims first what it can tell, `told_by_inputs` at most. All others gain `best` at most.
pub(super) fn screened(
    (bench, fitted): (&Bench<'_>, &Fitted),
    told_by_inputs: f64,
    best: f64,
) -> Result<Vec<Screened>, DiagnoseError> {
    let effects = bench.effects;
    // A filter that feedback holds up, and that is lost, says nothing of reversals.
    if bench.input_innovations.count > 0 && !fitted.fit.is_optimum() {
        return Ok(Vec::new());
    }
    // One such coordinate at a time, and none where contacts creep.
    if fitted
        .members
        .iter()
        .any(|&member| effects.stands_alone(member))
    {
        return Ok(Vec::new());
    }
    let p = &fitted.fit.values[..effects.with(&[]).info().parameter_len()];
    let mut drives: BTreeMap<usize, Option<Drive>> = BTreeMap::new();
    let mut innovations: Option<Vec<Vec<Innovation>>> = None;
    let mut brought = Vec::new();
    for (index, candidate) in effects.candidates.iter().enumerate() {
        // What an encoder behind the gap shows is over within some rows: windows see little of it.
        let is_seen =
            candidate.shows.is_empty() || bench.is_shown(candidate) && !bench.is_over_windows();
        let Some(beside) = candidate.brings.filter(|_| is_seen) else {
            continue;
        };
        if let Entry::Vacant(unknown) = drives.entry(beside) {
            if innovations.is_none() {
                let setup = bench.setup(&fitted.members);
                let estimation = Estimation::new(&setup, &bench.recordings)?;
                innovations = Some(
                    estimation
                        .innovations(&fitted.fit.values)
                        .unwrap_or_default(),
                );
            }
            let runs = innovations.as_deref().unwrap_or_default();
            let drive = Drive::of(effects.with(&[]), p, beside);
            unknown.insert(drive.filter(|drive| is_biased(bench, runs, drive, best)));
        }
        if let Some(drive) = &drives[&beside] {
            brought.push((index, drive.clone()));
        }
    }
    if brought.is_empty() {
        return Ok(Vec::new());
    }
    let sample = Sample::of(bench, fitted);
    let list = in_parallel(brought, |(index, drive)| {
        if !effects.augment(index, &drive) {
            return Ok(None);
        }
        let grid = Grid::of((bench, fitted), index, (sample.as_ref(), least(best)));
        Ok(best_size(&grid)?.map(|one| one.told(told_by_inputs)))
    });
    let list: Result<Vec<_>, DiagnoseError> = list.into_iter().collect();
    Ok(list?.into_iter().flatten().collect())
}

/// Whether innovations lean to one side after the drive has changed sign, so far that nothing else gains more than
/// a gap.
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

/// The beginnings of the recordings.
struct Sample {
    recordings: Vec<Recording>,
    /// What the hypothesis says of them.
    log_likelihood: f64,
    /// All rows per row of them.
    scale: f64,
}

impl Sample {
    /// Nothing where there are few rows, or a hypothesis loses them.
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

/// A size and a shape, as values, with what they gain.
struct Tried {
    gain: f64,
    size: f64,
    factor: f64,
    own: Vec<(usize, f64)>,
}

/// The size that gains most.
fn best_size(grid: &Grid<'_, '_>) -> Result<Option<Screened>, DiagnoseError> {
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
        // A channel that shows the coordinate tells the size whatever the shape, then the shape.
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
        // Recordings tell the product of size and shape best: it is kept.
        let product = |factor: f64| grid.values(best.size / factor, factor);
        FACTORS.map(product).to_vec()
    };
    let sizes = vec![best.size; directions(bench, candidate).len()];
    let screened = Screened::tried(candidate, best.gain, sizes, starts);
    Ok(Some(screened.beside(levels)))
}

/// Where sizes and shapes of a candidate are tried.
struct Grid<'g, 'b> {
    bench: &'g Bench<'b>,
    fitted: &'g Fitted,
    candidate: usize,
    setup: Setup<'g>,
    sample: Option<&'g Sample>,
    least: f64,
}

impl<'g, 'b> Grid<'g, 'b> {
    fn of(
        (bench, fitted): (&'g Bench<'b>, &'g Fitted),
        candidate: usize,
        (sample, least): (Option<&'g Sample>, f64),
    ) -> Self {
        let members = [fitted.members.as_slice(), &[candidate]].concat();
        Self {
            bench,
            fitted,
            candidate,
            setup: bench.setup(&members),
            sample,
            least,
        }
    }

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

    /// Some sizes with factors of the shape, the best first, with disturbances multiplied by `levels`. Those that
    /// promise too little have the gain that the sample lets expect.
    fn tried(&self, all: &[(f64, f64)], levels: f64) -> Result<Vec<Tried>, DiagnoseError> {
        let whole = (
            self.bench.recordings.as_slice(),
            self.fitted.fit.log_likelihood,
        );
        let Some(sample) = self.sample else {
            return self.gains(all, levels, whole);
        };
        let beginnings = (sample.recordings.as_slice(), sample.log_likelihood);
        let mut rough = self.gains(all, levels, beginnings)?;
        for one in &mut rough {
            one.gain *= sample.scale;
        }
        if rough
            .first()
            .is_none_or(|best| best.gain < PROMISING * self.least)
        {
            return Ok(rough);
        }
        let best: Vec<_> = rough
            .iter()
            .take(BEST)
            .map(|one| (one.size, one.factor))
            .collect();
        self.gains(&best, levels, whole)
    }

    /// What they gain on some recordings, of which the hypothesis has this likelihood. One at which the filter is lost
    /// is none.
    fn gains(
        &self,
        all: &[(f64, f64)],
        levels: f64,
        (recordings, log_likelihood): (&[Recording], f64),
    ) -> Result<Vec<Tried>, DiagnoseError> {
        let (bench, fitted) = (self.bench, self.fitted);
        let estimation = Estimation::new(&self.setup, recordings)?;
        let mut tried = Vec::new();
        for &(size, factor) in all {
            let own = self.values(size, factor);
            let mut values = bench.carried(fitted, &estimation);
            for &(place, value) in &own {
                values[place] = value;
            }
            quieten(&estimation, &mut values, levels)?;
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

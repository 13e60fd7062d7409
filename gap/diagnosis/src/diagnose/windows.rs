//! The gap in time and in the state space: where the innovations are more likely under the best hypothesis
//! than under the nominal model.

use std::collections::BTreeMap;

use appell_estimate::{Estimation, chi_squared_probability};

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::Comparison;
use super::evidence::Fitted;
use super::report::{Region, Where, Window};

/// Smallest length of a window in s, and in steps.
const WINDOW_S: f64 = 0.5;
const STEPS: f64 = 10.0;
/// False discovery rate of the reported windows (Y. Benjamini and D. Yekutieli, *The control of the
/// false discovery rate in multiple testing under dependency*, 2001).
const FALSE_DISCOVERY_RATE: f64 = 0.05;
/// Largest number of reported windows.
const MOST_WINDOWS: usize = 20;
/// Number of cells of a variable, with equally many samples.
const CELLS: usize = 12;
/// Significance of the gain of a cell in standard deviations.
const STANDS_OUT: f64 = 4.0;

/// The gain in log likelihood of a row by the best hypothesis.
struct Sample {
    run: usize,
    row: usize,
    t: f64,
    gain: f64,
}

/// Adds the windows and the region to a gap whose equations are known.
pub(super) fn tell(
    bench: &Bench<'_>,
    comparison: &Comparison,
    place: &mut Where,
) -> Result<(), DiagnoseError> {
    let best = comparison.best();
    if best.members.is_empty() {
        return Ok(());
    }
    let gains = gains(bench, comparison.nominal(), best)?;
    let equation = place.equations.first();
    let equation = equation.map_or_else(String::new, |first| first.name.clone());
    place.windows = windows(bench, &gains, &equation);
    place.region = region(bench, best, &gains)?.into_iter().collect();
    Ok(())
}

fn gains(bench: &Bench<'_>, nominal: &Fitted, best: &Fitted) -> Result<Vec<Sample>, DiagnoseError> {
    let mut rows: BTreeMap<(usize, usize), (f64, [f64; 2])> = BTreeMap::new();
    for (place, fitted) in [nominal, best].into_iter().enumerate() {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let runs = estimation.innovations(&fitted.fit.values)?;
        let samples = runs.iter().enumerate();
        for (run, sample) in samples.flat_map(|(run, all)| all.iter().map(move |one| (run, one))) {
            let row = rows
                .entry((run, sample.row))
                .or_insert((sample.t, [0.0; 2]));
            row.1[place] += sample.log_likelihood();
        }
    }
    Ok(rows
        .into_iter()
        .map(|((run, row), (t, [nominal, best]))| Sample {
            run,
            row,
            t,
            gain: bench.weight * (best - nominal),
        })
        .collect())
}

/// Length of a window in s.
pub(super) fn length(bench: &Bench<'_>) -> f64 {
    WINDOW_S.max(STEPS * bench.step)
}

/// Windows with a significant gain, the largest first.
fn windows(bench: &Bench<'_>, gains: &[Sample], equation: &str) -> Vec<Window> {
    let mut sums: BTreeMap<(usize, u64), f64> = BTreeMap::new();
    let start = |run: usize| bench.recordings[run].times()[0];
    let length = length(bench);
    for one in gains {
        // The index of a window is small and not negative.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let index = ((one.t - start(one.run)) / length).max(0.0) as u64;
        *sums.entry((one.run, index)).or_default() += one.gain;
    }
    let count = sums.len() as f64;
    let harmonic: f64 = (1..=sums.len()).map(|i| (i as f64).recip()).sum();
    let mut tested: Vec<((usize, u64), f64, f64)> = sums
        .into_iter()
        .map(|(place, gain)| {
            let square = 2.0 * gain.max(0.0);
            (
                place,
                square.sqrt(),
                1.0 - chi_squared_probability(square, 1.0),
            )
        })
        .collect();
    tested.sort_by(|a, b| a.2.total_cmp(&b.2).then(b.1.total_cmp(&a.1)));
    let level = |rank: usize| FALSE_DISCOVERY_RATE * (rank + 1) as f64 / (count * harmonic);
    let found = (0..tested.len())
        .rev()
        .find(|&rank| tested[rank].2 <= level(rank));
    tested.truncate(found.map_or(0, |last| last + 1).min(MOST_WINDOWS));
    tested
        .into_iter()
        .map(|((run, index), z, _)| {
            let from = start(run) + length * index as f64;
            Window {
                run: bench.set.runs[run].name.clone(),
                from,
                to: from + length,
                equation: equation.to_owned(),
                z,
                unexplained: None,
            }
        })
        .collect()
}

/// The cell of a state or input with the most significant gain.
fn region(
    bench: &Bench<'_>,
    best: &Fitted,
    gains: &[Sample],
) -> Result<Option<Region>, DiagnoseError> {
    let setup = bench.setup(&best.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let info = setup.model.info();
    let mut variables: Vec<Vec<f64>> = Vec::with_capacity(gains.len());
    let smoothed: Result<Vec<_>, _> = (0..bench.recordings.len())
        .map(|run| estimation.smoothed(&best.fit.values, run))
        .collect();
    let smoothed = smoothed?;
    for one in gains {
        let state = &smoothed[one.run][one.row].state[..info.state_len()];
        let inputs = bench.recordings[one.run].inputs(one.row);
        variables.push([state, inputs].concat());
    }
    let mean = gains.iter().map(|one| one.gain).sum::<f64>() / gains.len().max(1) as f64;
    let square = gains
        .iter()
        .map(|one| (one.gain - mean).powi(2))
        .sum::<f64>();
    let deviation = (square / gains.len().max(1) as f64).sqrt();
    let mut out: Option<(f64, Region)> = None;
    for (index, quantity) in info.states.iter().chain(info.inputs.iter()).enumerate() {
        if variables.first().is_none_or(|first| index >= first.len()) {
            continue;
        }
        let mut order: Vec<usize> = (0..gains.len()).collect();
        order.sort_by(|&a, &b| variables[a][index].total_cmp(&variables[b][index]));
        for cell in order.chunks(gains.len().div_ceil(CELLS).max(1)) {
            let own = cell.iter().map(|&i| gains[i].gain).sum::<f64>() / cell.len() as f64;
            let z = (own - mean) * (cell.len() as f64).sqrt() / deviation.max(f64::MIN_POSITIVE);
            if z > out.as_ref().map_or(STANDS_OUT, |(most, _)| *most) {
                let [from, to] =
                    [cell[0], cell[cell.len() - 1]].map(|i| variables[i][index] / quantity.scale);
                let description = format!("{from:.3} to {to:.3} {}", quantity.unit);
                let variable = quantity.name.to_string();
                out = Some((
                    z,
                    Region {
                        variable,
                        description,
                        z,
                    },
                ));
            }
        }
    }
    Ok(out.map(|(_, region)| region))
}

//! Localisation of the gap: the equations in which the best hypothesis acts, and where in time and in the state space the
//! innovations are more likely under it than under the nominal model.
//!
//! The members add the force M Δω̇ to Appell's equation of a pseudo-velocity along the recordings. Its mean square,
//! relative to the process noise of the equation, is the share of that equation in the gap.

use std::collections::BTreeMap;

use appell_estimate::{Estimation, Unknown, chi_squared_probability};
use appell_runtime::model::At;
use appell_spec::Mechanism;
use appell_spec::mechanism::SpeedId;
use appell_spec::units::Unit;

use super::{Bench, Comparison, Fitted, Region, Result, ShareOf, Where, Window, whole};
use crate::effects::{Acts, EffectModel};

/// Number of points along the recordings.
const PLACES: usize = 400;
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

/// The equations of the best hypothesis.
pub(super) fn place(bench: &Bench<'_>, comparison: &Comparison) -> Result<Where> {
    let best = comparison.best();
    let Some(&first) = best.members.first() else {
        return Ok(Where::default());
    };
    let setup = bench.setup(&best.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let (augmented, layout) = (estimation.setup().model, estimation.layout());
    // Without the member, its additional coordinate is locked.
    let model = bench.effects.with(&bench.locked(&best.members));
    let info = model.info();
    let (n, s, k) = (info.state_len(), info.speeds, info.parameter_len());
    let m = info.input_len();
    let values = &best.fit.values;
    let p = &values[..k];
    let mut added = vec![0.0; s];
    let mut count = 0.0_f64;
    let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
    let (mut rates, mut a, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
    let plain = bench.without(best);
    let mut moving = vec![0.0; augmented.info().state_len()];
    for run in 0..bench.recordings.len() {
        let recording = &bench.recordings[run];
        let states = estimation.smoothed(values, run)?;
        let rows = states.len();
        let stride = (rows * bench.recordings.len() / PLACES).max(1);
        for row in (1..rows).step_by(stride) {
            let state = &states[row].state[..moving.len()];
            let x = &bench.own_states(state, augmented)[..];
            let mut u = vec![0.0; m];
            u[..recording.input_len()].copy_from_slice(recording.inputs(row));
            let t = recording.times()[row];
            let at = At { t, x, u: &u, p };
            augmented.rates(At { x: state, ..at }, &mut moving);
            let mut difference = bench.own_states(&moving, augmented);
            model.rates(At { p: &plain, ..at }, &mut rates);
            for (with, without) in difference.iter_mut().zip(&rates) {
                *with -= without;
            }
            for &member in &best.members {
                if let Acts::Lag(input) | Acts::Delay(input) = bench.candidate(member).acts {
                    model.jacobians(at, &mut rates, &mut a, &mut b);
                    let jump = recording.inputs(row)[input] - recording.inputs(row - 1)[input];
                    for state in 0..n {
                        difference[state] += b[state * m + input] * jump;
                    }
                }
            }
            model.appell(at, &mut mass, &mut bias, &mut forces);
            for i in 0..s {
                let force: f64 = (0..s).map(|j| mass[i * s + j] * difference[j]).sum();
                added[i] += force * force;
            }
            count += 1.0;
        }
    }
    let gain = best.evidence.log_likelihood - comparison.nominal().evidence.log_likelihood;
    let mut energies = Vec::new();
    for i in 0..s {
        let level = values[layout.place(Unknown::Disturbance(i))?];
        let level = level.max(bench.negligible.get(i).copied().unwrap_or_default());
        energies.push(added[i] / level.powi(2).max(f64::MIN_POSITIVE));
    }
    let added = Added {
        squares: added,
        energies,
        count,
        gain,
    };
    Ok(added.place(bench.effects, first))
}

/// Forces that a hypothesis adds to each equation.
pub(super) struct Added {
    /// Sums of their squares.
    pub(super) squares: Vec<f64>,
    /// The same relative to the noise of the equation.
    pub(super) energies: Vec<f64>,
    /// Number of forces.
    pub(super) count: f64,
    /// Gain in log likelihood by the hypothesis.
    pub(super) gain: f64,
}

impl Added {
    /// The equations by their shares; `first` is the first member of the hypothesis.
    pub(super) fn place(&self, model: &EffectModel, first: usize) -> Where {
        let info = model.info();
        let p_value = 1.0 - chi_squared_probability(2.0 * self.gain, 1.0);
        let whole: f64 = self.energies.iter().sum();
        let equations = self.energies.iter().zip(&self.squares).enumerate();
        let equations = equations.map(|(equation, (energy, square))| ShareOf {
            name: info.states[equation].name.to_string(),
            share: if whole > 0.0 { energy / whole } else { 0.0 },
            p_value,
            rms: (square / self.count.max(1.0)).sqrt(),
            unit: force_unit(&model.mechanism, equation),
        });
        let mut equations: Vec<ShareOf> = equations.collect();
        equations.sort_by(|a, b| b.share.total_cmp(&a.share));
        Where {
            domain: model.candidate(first).family.domain(),
            equations,
            ..Where::default()
        }
    }
}

/// SI unit of the force along a pseudo-velocity: a watt divided by its unit.
pub(super) fn force_unit(mechanism: &Mechanism, equation: usize) -> String {
    let speed = &mechanism.pseudo_velocities[SpeedId::new(equation)]
        .label
        .unit;
    let speed = Unit::si(speed.dimension).text;
    match speed.as_str() {
        "m/s" => "N".to_owned(),
        // An angle has no dimension.
        "1/s" | "rad/s" => "N m".to_owned(),
        other => format!("W/({other})"),
    }
}

/// The gain in log likelihood of a row by the best hypothesis.
struct Sample {
    run: usize,
    row: usize,
    t: f64,
    gain: f64,
}

/// Adds the windows and the region to a gap whose equations are known.
pub(super) fn tell(bench: &Bench<'_>, comparison: &Comparison, place: &mut Where) -> Result<()> {
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

fn gains(bench: &Bench<'_>, nominal: &Fitted, best: &Fitted) -> Result<Vec<Sample>> {
    let mut rows: BTreeMap<(usize, usize), (f64, [f64; 2])> = BTreeMap::new();
    for (place, fitted) in [nominal, best].into_iter().enumerate() {
        let runs = bench.innovations(fitted)?;
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
    let mut sums: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    let start = |run: usize| bench.recordings[run].times()[0];
    let length = length(bench);
    for one in gains {
        let index = whole(((one.t - start(one.run)) / length).max(0.0));
        *sums.entry((one.run, index)).or_default() += one.gain;
    }
    let count = sums.len() as f64;
    let harmonic: f64 = (1..=sums.len()).map(|i| (i as f64).recip()).sum();
    let mut tested: Vec<((usize, usize), f64, f64)> = sums
        .into_iter()
        .map(|(place, gain)| {
            let square = 2.0 * gain.max(0.0);
            let p_value = 1.0 - chi_squared_probability(square, 1.0);
            (place, square.sqrt(), p_value)
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
fn region(bench: &Bench<'_>, best: &Fitted, gains: &[Sample]) -> Result<Option<Region>> {
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
    let squares = gains.iter().map(|one| (one.gain - mean).powi(2));
    let deviation = (squares.sum::<f64>() / gains.len().max(1) as f64).sqrt();
    let mut out: Option<Region> = None;
    for (index, quantity) in info.states.iter().chain(info.inputs.iter()).enumerate() {
        if variables.first().is_none_or(|first| index >= first.len()) {
            continue;
        }
        let mut order: Vec<usize> = (0..gains.len()).collect();
        order.sort_by(|&a, &b| variables[a][index].total_cmp(&variables[b][index]));
        for cell in order.chunks(gains.len().div_ceil(CELLS).max(1)) {
            let own = cell.iter().map(|&i| gains[i].gain).sum::<f64>() / cell.len() as f64;
            let z = (own - mean) * (cell.len() as f64).sqrt() / deviation.max(f64::MIN_POSITIVE);
            if z > out.as_ref().map_or(STANDS_OUT, |most| most.z) {
                let [from, to] =
                    [cell[0], cell[cell.len() - 1]].map(|i| variables[i][index] / quantity.scale);
                let description = format!("{from:.3} to {to:.3} {}", quantity.unit);
                out = Some(Region {
                    variable: quantity.name.to_string(),
                    description,
                    z,
                });
            }
        }
    }
    Ok(out)
}

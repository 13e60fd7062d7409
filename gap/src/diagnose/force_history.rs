//! When the gap is there: the missing force of each equation in parts of the runs.
//!
//! The states are those of the smoother under the nominal model, whose disturbance is free to be the
//! missing force.

use appell_estimate::Estimation;

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::Comparison;
use super::forces::Forces;
use super::localise::force_unit;
use super::prediction::followed;
use super::report::{ForceHistory, MissingForce};
use super::windows;

/// Most parts of all runs; more cannot be told apart.
const PARTS: f64 = 160.0;
/// Most steps that are looked at in a run.
const STEPS: usize = 2000;

/// Of all runs that were fitted.
pub(super) fn force_history(
    bench: &Bench<'_>,
    comparison: &Comparison,
) -> Result<ForceHistory, DiagnoseError> {
    let nominal = comparison.nominal();
    let setup = bench.setup(&nominal.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let values = followed(bench, nominal, &estimation)?;
    let info = setup.model.info();
    let p = &nominal.fit.values[..info.parameter_len()];
    let ends = |run: usize| {
        let times = bench.recordings[run].times();
        (times[0], times[times.len() - 1])
    };
    let length: f64 = (0..bench.recordings.len())
        .map(ends)
        .map(|(from, to)| to - from)
        .sum();
    let part = windows::length(bench).max(length / PARTS);
    let mut runs = Vec::new();
    let mut squares: Vec<Vec<(f64, f64)>> = vec![Vec::new(); info.speeds];
    for (run, recording) in bench.recordings.iter().enumerate() {
        let (from, to) = ends(run);
        // Parts are few.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let parts = ((to - from) / part).ceil().max(1.0) as usize;
        let first = squares[0].len();
        for own in &mut squares {
            own.resize(first + parts, (0.0, 0.0));
        }
        let states = estimation.smoothed(&values, run)?;
        let stride = states.len().div_ceil(STEPS).max(1);
        for row in (1..states.len()).step_by(stride) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let index = ((recording.times()[row] - from) / part) as usize;
            let forces = Forces::new(setup.model, recording, &states, row).missing(p);
            for (own, force) in squares.iter_mut().zip(&forces) {
                let (sum, count) = &mut own[first + index.min(parts - 1)];
                *sum += force * force;
                *count += 1.0;
            }
        }
        runs.push((bench.set.runs[run].name.clone(), from, parts));
    }
    let equations = squares
        .iter()
        .enumerate()
        .map(|(equation, squares)| MissingForce {
            name: info.states[equation].name.to_string(),
            unit: force_unit(bench, equation),
            rms: squares
                .iter()
                .map(|(sum, count)| (sum / count.max(1.0)).sqrt())
                .collect(),
        });
    Ok(ForceHistory {
        part,
        runs,
        equations: equations.collect(),
    })
}

//! Initial parameters if those of the rig are far from the truth, by multiple shooting without a
//! filter, with and without continuity between the segments.

use appell_estimate::{Estimation, Free, Recording, Shooting, Unknown};

use super::IdentifyError;
use super::problem::Problem;
use super::start::{of_channels, start};

/// Least number of rows of a segment.
const ROWS: usize = 10;
/// Length of a segment in s.
const LENGTH: f64 = 0.25;

/// Values with the results of shooting.
pub(super) fn shots(
    estimation: &Estimation<'_>,
    problem: &Problem,
    values: &[f64],
) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let (layout, setup) = (estimation.layout(), estimation.setup());
    let is_shot = |free: &&Free| {
        matches!(
            free.unknown,
            Unknown::Parameter(_) | Unknown::Bias(_) | Unknown::Scale(_) | Unknown::Lag(_)
        )
    };
    let free: Vec<Free> = problem.wanted.iter().filter(is_shot).copied().collect();
    let channels = of_channels(estimation, values)?;
    let parameters = &values[..setup.model.info().parameter_len()];
    let guess = |part: &Recording| {
        let lags = setup.lagging.iter().map(|&input| part.inputs(0)[input]);
        let drifting = setup.drifting.iter().map(|&index| parameters[index]);
        let state = start(setup, &channels, parameters, part).state;
        state.into_iter().chain(lags).chain(drifting).collect()
    };
    let rows = rows(estimation.recordings());
    let shots = Shooting::new(estimation, values, &free, rows, guess)?.shots()?;
    let mut all = Vec::with_capacity(shots.len());
    for shot in shots {
        let mut found = values.to_vec();
        for free in &free {
            let place = layout.place(free.unknown)?;
            found[place] = shot.values[place];
        }
        all.push(found);
    }
    Ok(all)
}

/// Rows of a segment.
fn rows(recordings: &[Recording]) -> usize {
    let count: usize = recordings.iter().map(|r| r.times().len() - 1).sum();
    let lengths = recordings.iter().map(|recording| {
        let times = recording.times();
        times[times.len() - 1] - times[0]
    });
    let rows = LENGTH * count as f64 / lengths.sum::<f64>();
    // A count of rows in memory.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    ROWS.max(rows.ceil() as usize)
}

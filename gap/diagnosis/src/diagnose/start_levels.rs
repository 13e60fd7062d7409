//! Levels of process noise and initial deviations from which the fits of all hypotheses start.

use appell_estimate::{Estimation, Unknown};

use super::Result;
use crate::identify::Problem;

/// Maximises the likelihood over the process noise of each equation in turn, by powers of ten: the levels of different
/// equations are nearly independent.
pub(super) fn level(estimation: &Estimation<'_>, problem: &mut Problem) -> Result<()> {
    let layout = estimation.layout();
    let mut best = estimation.log_likelihood(&problem.start)?;
    for index in 0..estimation.setup().disturbances.len() {
        let place = layout.place(Unknown::Disturbance(index))?;
        let mut levels = problem.levels.iter();
        let level = levels.find(|free| free.unknown == Unknown::Disturbance(index));
        let Some([low, high]) = level.map(|free| free.range) else {
            continue;
        };
        for factor in [10.0, 0.1] {
            let mut moved = problem.start.clone();
            loop {
                moved[place] *= factor;
                if !(low..=high).contains(&moved[place]) {
                    break;
                }
                match estimation.log_likelihood(&moved) {
                    Ok(likelihood) if likelihood > best => {
                        best = likelihood;
                        problem.start.clone_from(&moved);
                    }
                    _ => break,
                }
            }
        }
    }
    Ok(())
}

/// Initial standard deviations of the states: typical sizes of unmeasured ones.
pub(super) fn sizes(estimation: &Estimation<'_>, problem: &Problem) -> Result<Vec<f64>> {
    let layout = estimation.layout();
    let states = 0..estimation.setup().model.info().state_len();
    let size = |state| {
        let mut most = 0.0_f64;
        for run in 0..estimation.recordings().len() {
            most = most.max(problem.start[layout.place(Unknown::Spread { run, state })?]);
        }
        Ok(most)
    };
    states.map(size).collect()
}

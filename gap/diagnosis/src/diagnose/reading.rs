//! Whether the torques of a robot were recorded as means over the interval about their rows, or at the rows.
//!
//! They jump with the commands, so that the wrong one of the two is an error of half a jump, which would be taken for
//! friction or a delay of the drives. The more likely one under the model as stated is used.

use appell_estimate::Estimation;
use appell_recordings::{DataSet, Measured, Reading, Role};

use super::{Bench, Result};
use crate::effects::EffectModel;

/// The more likely way of reading; that of the data set if there are no such channels.
pub(super) fn likely(set: &DataSet, effects: &EffectModel) -> Result<Reading> {
    let is_output = |role| matches!(role, Role::Measures(Measured::Output(_)));
    if set.robot.is_none() || !set.channels.iter().any(|own| is_output(own.role)) {
        return Ok(set.reading);
    }
    let likelihood = |reading: Reading| -> Result<f64> {
        let set = DataSet {
            reading,
            ..set.clone()
        };
        let bench = Bench::of(&set, effects, |_, _| Ok(()))?;
        let setup = bench.setup(&[]);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let likelihood = estimation.log_likelihood(&bench.problem.start);
        Ok(likelihood.unwrap_or(f64::NEG_INFINITY))
    };
    let [mean, at_row] = [Reading::Mean, Reading::AtRow].map(likelihood);
    Ok(if at_row? > mean? {
        Reading::AtRow
    } else {
        Reading::Mean
    })
}

//! Inputs that were computed from recorded motions.

use appell_gap::inverse::Answer;
use appell_runtime::model::ModelInfo;

use super::{Figure, Panel};

/// Number of runs drawn.
const DRAWN_RUNS: usize = 3;

impl Figure {
    /// The inputs of the first runs, each with its 95 % band.
    pub fn of_inputs(info: &ModelInfo, answer: &Answer) -> Self {
        let panels = answer.inputs.iter().take(DRAWN_RUNS).flat_map(|run| {
            let inputs = info.inputs.iter().take(info.declared_inputs).enumerate();
            inputs.map(|(input, quantity)| {
                let name = format!("{}, {}", quantity.name, run.run);
                let (values, stds) = (&run.values[input], &run.stds[input]);
                Panel::with_band(
                    [&name, "95 % from", "to"],
                    quantity,
                    &run.times,
                    values,
                    stds,
                )
            })
        });
        Self::over_t(
            format!("{}: inputs of recorded motions", info.name),
            panels.collect(),
        )
    }
}

//! Inputs that were computed from recorded motions.

use appell_gap::identify::HALF_WIDTH_95;
use appell_gap::inverse::Answer;
use appell_runtime::model::ModelInfo;

use super::{Figure, Panel, Series};

/// Number of runs drawn.
const DRAWN_RUNS: usize = 3;

impl Figure {
    /// The inputs of the first runs, each with its 95 % band.
    pub fn of_inputs(info: &ModelInfo, answer: &Answer) -> Self {
        let panels = answer.inputs.iter().take(DRAWN_RUNS).flat_map(|run| {
            let inputs = info.inputs.iter().take(info.declared_inputs).enumerate();
            inputs.map(|(input, quantity)| {
                let shifted = |sign: f64| -> Vec<f64> {
                    let values = run.values[input].iter().zip(&run.stds[input]);
                    values
                        .map(|(value, std)| quantity.to_unit(value + sign * HALF_WIDTH_95 * std))
                        .collect()
                };
                let series = |label: String, y: Vec<f64>| Series {
                    label,
                    x: run.times.clone(),
                    y,
                };
                Panel {
                    unit: quantity.unit.to_string(),
                    series: vec![
                        series(format!("{}, {}", quantity.name, run.run), shifted(0.0)),
                        series("95 % from".to_owned(), shifted(-1.0)),
                        series("to".to_owned(), shifted(1.0)),
                    ],
                }
            })
        });
        Self {
            title: format!("{}: inputs of recorded motions", info.name),
            x_label: "t [s]".to_owned(),
            panels: panels.collect(),
            marks: Vec::new(),
            equal_axes: false,
        }
    }
}

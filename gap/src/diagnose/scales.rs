//! Typical sizes in recordings, which set the widths of rounded corners and the levels that are tried.

use appell_runtime::signal::savitzky_golay::weights;

use crate::data::{DataSet, Measured, Role, Run};
use crate::effects::Scales;

/// Samples of a parabola whose slope tells a rate.
const WINDOW: usize = 15;
/// Places along a run at which rates are looked at.
const PLACES: usize = 200;

/// Of the runs to fit.
pub(super) fn of(set: &DataSet) -> Scales {
    let mechanism = &set.mechanism;
    let column = |role: Role| set.channels.iter().position(|channel| channel.role == role);
    let rate = |coordinate: usize| {
        let column = column(Role::Measures(Measured::Coordinate(coordinate)))?;
        let slopes: Vec<f64> = set
            .runs
            .iter()
            .flat_map(|run| slopes(run, column))
            .collect();
        let squares: f64 = slopes.iter().map(|slope| slope * slope).sum();
        let rate = (squares / slopes.len() as f64).sqrt();
        (rate.is_finite() && rate > 0.0).then_some(rate)
    };
    let largest = |input: usize| {
        let column = column(Role::Input(input))?;
        let values = set.runs.iter().flat_map(|run| &run.values[column]);
        Some(values.fold(0.0_f64, |most, value| most.max(value.abs())))
    };
    let tolerant = |index: &usize| set.parameters[*index].std.is_some_and(|std| std > 0.0);
    Scales {
        rates: (0..mechanism.coordinates.len())
            .map(|q| rate(q).unwrap_or(1.0))
            .collect(),
        largest: (0..mechanism.inputs.len())
            .map(|input| largest(input).unwrap_or(0.0))
            .collect(),
        channels: set
            .channels
            .iter()
            .filter(|channel| channel.is_measured())
            .map(|channel| channel.column.clone())
            .collect(),
        uncertain: (0..set.parameters.len()).filter(tolerant).collect(),
    }
}

/// Slopes of a channel at places along a run.
fn slopes(run: &Run, column: usize) -> Vec<f64> {
    let samples: Vec<(f64, f64)> = run
        .times
        .iter()
        .zip(&run.values[column])
        .filter(|(_, value)| !value.is_nan())
        .map(|(&t, &value)| (t, value))
        .collect();
    let slope = |samples: &[(f64, f64)]| -> Option<f64> {
        let times: Vec<f64> = samples.iter().map(|(t, _)| *t).collect();
        let weights = weights(&times, times[times.len() / 2], 2, 1)?;
        Some(weights.iter().zip(samples).map(|(w, (_, y))| w * y).sum())
    };
    let stride = (samples.len() / PLACES).max(1);
    let windows = samples.windows(WINDOW).step_by(stride);
    windows.filter_map(slope).collect()
}

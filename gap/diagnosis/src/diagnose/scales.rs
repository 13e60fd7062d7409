//! Typical magnitudes in recordings, which determine the widths of smoothed corners and initial levels.

mod extremes;

use appell_recordings::{DataSet, Measured, Role, Run};

use crate::effects::{Scales, controlled};
use crate::slope::{Slope, WINDOW};
pub(super) use extremes::exerted;
use extremes::{largest_of, reached};

/// Number of points along a run at which rates are evaluated.
const PLACES: usize = 200;
/// Width over which the sign function is smoothed, relative to the uncertainty of such a rate: a filter diverges at a
/// step far below its resolution, and with a wider one a sticking mechanism creeps.
const ROUNDED: f64 = 0.17;
/// Limits of that width relative to the typical rate: narrower ones are too stiff.
const NARROW: [f64; 2] = [0.002, 0.005];

/// The typical magnitudes of the training runs.
pub(super) fn of(set: &DataSet) -> Scales {
    let mechanism = &set.mechanism;
    let column = |role: Role| set.channels.iter().position(|channel| channel.role == role);
    let rates = |coordinate: usize| -> [f64; 2] {
        let measured = Role::Measures(Measured::Coordinate(coordinate));
        column(measured)
            .and_then(|column| rates(set, column))
            .unwrap_or([1.0, NARROW[1]])
    };
    let rates = (0..mechanism.coordinates.len()).map(rates);
    let (rates, narrow) = rates.map(|[rate, narrow]| (rate, narrow)).unzip();
    let largest = |input: usize| {
        let column = column(Role::Input(input))?;
        let values = set.runs.iter().flat_map(|run| &run.values[column]);
        Some(values.fold(0.0_f64, |most, value| most.max(value.abs())))
    };
    let reached = |coordinate: usize| {
        let measured = Role::Measures(Measured::Coordinate(coordinate));
        column(measured).and_then(|column| reached(set, column))
    };
    let loads = mechanism.loads.iter();
    let loads = loads.map(|load| controlled(load).map_or(0.0, |(_, law)| largest_of(set, law)));
    let measured = || set.channels.iter().filter(|channel| channel.is_measured());
    let tolerant = |index: &usize| set.parameters[*index].std.is_some_and(|std| std > 0.0);
    Scales {
        rates,
        narrow,
        largest: (0..mechanism.inputs.len())
            .map(|input| largest(input).unwrap_or(0.0))
            .collect(),
        reached: (0..mechanism.coordinates.len()).map(reached).collect(),
        loads: loads.collect(),
        channels: measured().map(|channel| channel.column.clone()).collect(),
        coordinates: measured()
            .map(|channel| match channel.role {
                Role::Measures(Measured::Coordinate(coordinate)) => Some(coordinate),
                _ => None,
            })
            .collect(),
        speeds: measured()
            .map(|channel| match channel.role {
                Role::Measures(Measured::PseudoVelocity(speed)) => Some(speed),
                _ => None,
            })
            .collect(),
        uncertain: (0..set.parameters.len()).filter(tolerant).collect(),
    }
}

/// Typical rate of a channel, and the width over which its sign is smoothed.
pub(super) fn rates(set: &DataSet, column: usize) -> Option<[f64; 2]> {
    let runs = set.runs.iter();
    let slopes: Vec<Slope> = runs.flat_map(|run| slopes(run, column)).collect();
    let squares = |of: fn(&Slope) -> f64| -> f64 { slopes.iter().map(|own| of(own).powi(2)).sum() };
    let typical = |squares: f64| (squares / slopes.len() as f64).sqrt();
    let rate = typical(squares(|own| own.value));
    if !(rate.is_finite() && rate > 0.0) {
        return None;
    }
    let noise = set.channels[column].noise.map(|noise| noise.std);
    let uncertain = noise.map(|noise| noise * typical(squares(|own| own.deviation)) / rate);
    let [low, high] = NARROW;
    let part = uncertain.map_or(high, |part| (ROUNDED * part).clamp(low, high));
    Some([rate, part * rate])
}

/// Slopes of a channel at points along a run.
fn slopes(run: &Run, column: usize) -> Vec<Slope> {
    let samples: Vec<(f64, f64)> = run
        .times
        .iter()
        .zip(&run.values[column])
        .filter(|(_, value)| !value.is_nan())
        .map(|(&t, &value)| (t, value))
        .collect();
    let slope = |samples: &[(f64, f64)]| -> Option<Slope> {
        let times: Vec<f64> = samples.iter().map(|(t, _)| *t).collect();
        let values = samples.iter().map(|(_, y)| *y);
        Slope::at(times[times.len() / 2], &times, values)
    };
    let stride = (samples.len() / PLACES).max(1);
    let windows = samples.windows(WINDOW).step_by(stride);
    windows.filter_map(slope).collect()
}

/// Standard deviation of a channel in its runs.
pub(super) fn deviation(set: &DataSet, column: usize) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0_f64);
    for run in &set.runs {
        let seen = run.values[column].iter().filter(|value| value.is_finite());
        let (sum, rows) = seen.clone().fold((0.0, 0.0_f64), |(sum, rows), value| {
            (sum + value, rows + 1.0)
        });
        let mean = sum / rows.max(1.0);
        squares += seen.map(|value| (value - mean).powi(2)).sum::<f64>();
        count += rows;
    }
    (squares / count.max(1.0)).sqrt()
}

//! Typical magnitudes in recordings, which determine the widths of smoothed corners and initial levels; ranges of
//! coordinates and largest loads.

use appell_recordings::{DataSet, Measured, Role, Run};
use appell_spec::expr::{Expr, ExprKind, Quantity, Response};
use appell_spec::mechanism::Output;

use crate::effects::{Scales, controlled};
use crate::slope::{Slope, WINDOW};

/// Number of points along a run at which rates are evaluated.
const PLACES: usize = 200;
/// Width over which the sign function is smoothed, relative to the uncertainty of such a rate: a filter diverges at a
/// step far below its resolution, and with a wider one a sticking mechanism creeps.
const ROUNDED: f64 = 0.17;
/// Limits of that width relative to the typical rate: narrower ones are too stiff.
const NARROW: [f64; 2] = [0.002, 0.005];
/// Part of the rows that may lie beyond an end of the range, and part of a run at whose ends a reversal is not
/// recognised.
const RARE: f64 = 0.002;
const ENDS: f64 = 0.01;

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
    let samples = run.times.iter().zip(&run.values[column]);
    let samples = samples.map(|(&t, &value)| (t, value));
    let samples: Vec<(f64, f64)> = samples.filter(|(_, value)| !value.is_nan()).collect();
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

/// The range of a channel; `None` if it reversed at neither end.
fn reached(set: &DataSet, column: usize) -> Option<[f64; 2]> {
    let of_run = |run: &Run| -> Vec<(f64, bool)> {
        let rows = run.values[column].len() as f64;
        let ends = |row: usize| (row as f64) < ENDS * rows || (row as f64) > (1.0 - ENDS) * rows;
        let rows = run.values[column].iter().enumerate();
        let rows = rows.filter(|(_, value)| value.is_finite());
        rows.map(|(row, &value)| (value, ends(row))).collect()
    };
    let mut rows: Vec<(f64, bool)> = set.runs.iter().flat_map(of_run).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let beyond = whole(RARE * rows.len() as f64);
    let least = *rows.get(beyond)?;
    let most = *rows.get(rows.len() - 1 - beyond)?;
    let came_back = !least.1 || !most.1;
    (came_back && most.0 > least.0).then_some([least.0, most.0])
}

/// The largest magnitude of a load that an output measures, but for rare rows.
pub(super) fn exerted(set: &DataSet, load: &str) -> Option<f64> {
    let loads = &set.mechanism.loads;
    let is_of_load = |output: &Output| match output.value.kind {
        ExprKind::Quantity(Quantity::Response(Response::Force(own, None))) => {
            loads[own].name == load
        }
        _ => false,
    };
    let output = set.mechanism.outputs.iter().position(is_of_load)?;
    let role = Role::Measures(Measured::Output(output));
    let column = set
        .channels
        .iter()
        .position(|channel| channel.role == role)?;
    let values = set.runs.iter().flat_map(|run| &run.values[column]);
    let mut sizes: Vec<f64> = values
        .filter(|value| value.is_finite())
        .map(|value| value.abs())
        .collect();
    sizes.sort_by(f64::total_cmp);
    let rare = whole((RARE * sizes.len() as f64).ceil());
    sizes.get(sizes.len().checked_sub(rare)?).copied()
}

/// The largest magnitude of an expression along the runs; zero if one of its quantities was not recorded.
fn largest_of(set: &DataSet, law: &Expr) -> f64 {
    let mut largest = 0.0_f64;
    for run in &set.runs {
        let rows = run.times.len();
        let stride = (rows / PLACES).max(1);
        for first in (0..rows.saturating_sub(WINDOW)).step_by(stride) {
            let value = law
                .value(&|quantity| known(set, run, first, quantity))
                .abs();
            if value.is_finite() {
                largest = largest.max(value);
            }
        }
    }
    largest
}

/// A quantity in the middle of a window of a run; not finite if it was not recorded.
fn known(set: &DataSet, run: &Run, first: usize, quantity: Quantity) -> f64 {
    let column = |role: Role| set.channels.iter().position(|channel| channel.role == role);
    let window = first..first + WINDOW;
    let middle = first + WINDOW / 2;
    let shown = |role: Role| column(role).map(|column| run.values[column][middle]);
    let rate = |coordinate: usize| {
        let column = column(Role::Measures(Measured::Coordinate(coordinate)))?;
        let times = &run.times[window.clone()];
        let values = run.values[column][window.clone()].iter().copied();
        Some(Slope::at(run.times[middle], times, values)?.value)
    };
    let found = match quantity {
        Quantity::Parameter(parameter) => Some(set.parameters[parameter.index()].value),
        Quantity::Coordinate(q) => shown(Role::Measures(Measured::Coordinate(q.index()))),
        Quantity::Rate(q) => rate(q.index()),
        Quantity::PseudoVelocity(speed) => {
            let definition = &set.mechanism.pseudo_velocities[speed].definition;
            let measured = shown(Role::Measures(Measured::PseudoVelocity(speed.index())));
            measured.or_else(|| match definition.kind {
                ExprKind::Quantity(Quantity::Rate(q)) => rate(q.index()),
                _ => None,
            })
        }
        Quantity::Input(input) => shown(Role::Input(input.index())),
        Quantity::Time => Some(run.times[middle]),
        _ => None,
    };
    found.unwrap_or(f64::NAN)
}

/// A count or an index in memory: a number that is small and not negative, rounded down.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(super) const fn whole(number: f64) -> usize {
    number as usize
}

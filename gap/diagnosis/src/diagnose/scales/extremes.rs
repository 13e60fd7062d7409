//! Ranges of coordinates and largest loads in recordings.

use appell_recordings::{DataSet, Measured, Role, Run};
use appell_spec::expr::{Expr, ExprKind, Quantity, Response};
use appell_spec::mechanism::Output;

use super::PLACES;
use crate::slope::{Slope, WINDOW};

/// Part of the rows that may lie beyond an end of the range, and part of a run at whose ends a reversal is not
/// recognised.
const RARE: f64 = 0.002;
const ENDS: f64 = 0.01;

/// The range of a channel; `None` if it reversed at neither end.
pub(super) fn reached(set: &DataSet, column: usize) -> Option<[f64; 2]> {
    let of_run = |run: &Run| -> Vec<(f64, bool)> {
        let rows = run.values[column].len() as f64;
        let ends = |row: usize| (row as f64) < ENDS * rows || (row as f64) > (1.0 - ENDS) * rows;
        let rows = run.values[column].iter().enumerate();
        let rows = rows.filter(|(_, value)| value.is_finite());
        rows.map(|(row, &value)| (value, ends(row))).collect()
    };
    let mut rows: Vec<(f64, bool)> = set.runs.iter().flat_map(of_run).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of them"
    )]
    let beyond = (RARE * rows.len() as f64) as usize;
    let least = *rows.get(beyond)?;
    let most = *rows.get(rows.len() - 1 - beyond)?;
    let came_back = !least.1 || !most.1;
    (came_back && most.0 > least.0).then_some([least.0, most.0])
}

/// The largest magnitude of a load that an output measures, but for rare rows.
pub(in super::super) fn exerted(set: &DataSet, load: &str) -> Option<f64> {
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
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a part of them"
    )]
    let rare = (RARE * sizes.len() as f64).ceil() as usize;
    sizes.get(sizes.len().checked_sub(rare)?).copied()
}

/// The largest magnitude of an expression along the runs; zero if one of its quantities was not recorded.
pub(super) fn largest_of(set: &DataSet, law: &Expr) -> f64 {
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

//! A run from its table: values in SI, inputs held, angles unwrapped.

use std::f64::consts::TAU;

use crate::channel::{Channel, Measured, Role};
use crate::clock::Sampling;
use crate::finding::{Finding, FindingKind, counted};
use crate::frame::Source;
use crate::limits::MAX_NUMBERS;
use crate::set::{Part, Run};
use crate::table::Table;
use crate::time::Stated;
use crate::topics::hold;
use crate::{DataError, jumps};

/// Largest number of successive rows without an input; over a longer dropout the input is unknown.
const LOST: usize = 5;

/// The runs of a data set from their sources; the errors of all of them.
pub(crate) fn read_all<'s>(
    sources: impl Iterator<Item = (String, Part, Option<Source<'s>>)>,
    time: &Stated,
    channels: &[Channel],
    findings: &mut Vec<Finding>,
) -> Result<Vec<Run>, DataError> {
    let mut budget = MAX_NUMBERS;
    let (mut runs, mut errors) = (Vec::new(), Vec::new());
    for (name, part, source) in sources {
        let table = source
            .ok_or_else(|| DataError::whole(&*name, "no run of this name was given"))
            .and_then(|(logged, episode)| logged.read(time, channels, episode, &mut budget));
        match table {
            Ok(table) => runs.push(read(name, part, table, channels, findings)),
            Err(error) => errors.push(error),
        }
    }
    if errors.is_empty() {
        Ok(runs)
    } else {
        Err(DataError::several(errors))
    }
}

/// A run from its table, with dropouts reported, inputs held and angles unwrapped.
fn read(
    name: String,
    part: Part,
    table: Table,
    channels: &[Channel],
    findings: &mut Vec<Finding>,
) -> Run {
    let table = without_lost_inputs(table, channels);
    let sampling = Sampling::of(&table.times);
    findings.extend(table.findings.into_iter().map(|f| f.in_run(&name)));
    findings.extend(sampling.findings().into_iter().map(|f| f.in_run(&name)));
    let mut values = table.columns;
    for (channel, values) in channels.iter().zip(&mut values) {
        let mut tell = |kind, message: String| {
            let finding = Finding::new(kind, message);
            findings.push(finding.in_run(&name).of_channel(&channel.column));
        };
        let missing = values.iter().filter(|value| value.is_nan()).count();
        if missing > 0 {
            let (rows, all) = (counted(missing, "value"), values.len());
            if matches!(channel.role, Role::Input(_)) {
                let first = values.iter().copied().find(|value| !value.is_nan());
                hold(values, first.unwrap_or(0.0));
                let message = format!("{rows} of {all} missing; the value before holds on");
                tell(FindingKind::HeldInput, message);
            } else {
                tell(FindingKind::Dropouts, format!("{rows} of {all} missing"));
            }
        }
        let times = &table.times;
        let place = |row: usize| format!("row {} (t = {:.3} s)", row + 1, times[row]);
        if channel.is_angle()
            && let Some(wrapped) = jumps::wrapped(values, channel.turn.unwrap_or(TAU))
        {
            let (steps, place) = (counted(wrapped.count, "time"), place(wrapped.row));
            let message = format!("the angle wraps {steps}, first in {place}; it is unwrapped");
            tell(FindingKind::Unwrapped, message);
        }
        let is_position = matches!(channel.role, Role::Measures(Measured::Coordinate(_)));
        if is_position && let Some(others) = jumps::others(values) {
            let size = channel.unit.from_si(others.size);
            let message = format!(
                "the value jumps {}, first by {size:.4} {} in {}: no motion, but a dead zone, an angle that starts anew \
                 at other ends than those of a turn, or a fault; correct the column or cut the run there",
                counted(others.count, "time"),
                channel.unit.text,
                place(others.row)
            );
            tell(FindingKind::Jump, message);
        }
    }
    Run {
        name,
        part,
        times: table.times,
        values,
        sampling,
        earlier: Vec::new(),
        between: Vec::new(),
        differences: Vec::new(),
    }
}

/// Leaves out rows where an input is missing for long, which makes a gap of them.
fn without_lost_inputs(mut table: Table, channels: &[Channel]) -> Table {
    let mut lost = vec![false; table.times.len()];
    let columns = channels.iter().zip(&table.columns);
    for (_, values) in columns.filter(|(channel, _)| matches!(channel.role, Role::Input(_))) {
        let mut first = 0;
        for part in values.chunk_by(|a, b| a.is_nan() == b.is_nan()) {
            let is_lost = part[0].is_nan() && part.len() > LOST && part.len() < values.len();
            if is_lost {
                lost[first..first + part.len()].fill(true);
            }
            first += part.len();
        }
    }
    let kept = |values: &[f64]| -> Vec<f64> {
        let rows = values.iter().zip(&lost);
        rows.filter_map(|(value, lost)| (!lost).then_some(*value))
            .collect()
    };
    if lost.contains(&true) {
        table.times = kept(&table.times);
        for column in &mut table.columns {
            *column = kept(column);
        }
    }
    table
}

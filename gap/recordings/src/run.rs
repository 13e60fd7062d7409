//! A run from its table: values in SI, inputs held, angles unwrapped.

use std::f64::consts::TAU;

use appell_estimate::smoothing::angle::unwrap;

use crate::channel::{Channel, Role};
use crate::clock::Sampling;
use crate::finding::{Finding, FindingKind, counted};
use crate::set::{Part, Run};
use crate::table::Table;

/// Largest number of successive rows without an input; over a longer dropout the input is unknown.
const LOST: usize = 5;
/// Range in turns beyond which an angle is not wrapped.
const MOST_TURNS: f64 = 3.0;

/// A run from its table, with dropouts reported, inputs held and angles unwrapped.
pub(crate) fn read(
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
                hold(values);
                let message = format!("{rows} of {all} missing; the value before holds on");
                tell(FindingKind::HeldInput, message);
            } else {
                tell(FindingKind::Dropouts, format!("{rows} of {all} missing"));
            }
        }
        if channel.is_angle() && may_be_wrapped(values) {
            let steps = unwrap(values);
            if steps > 0 {
                let steps = counted(steps, "time");
                let message = format!("the angle starts anew {steps}; it is counted on");
                tell(FindingKind::Unwrapped, message);
            }
        }
    }
    Run {
        name,
        part,
        times: table.times,
        values,
        sampling,
        earlier: Vec::new(),
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

/// Whether an angle may be wrapped; one with a range of several turns is not.
fn may_be_wrapped(values: &[f64]) -> bool {
    let present = || values.iter().copied().filter(|value| !value.is_nan());
    let [low, high] = [
        present().fold(f64::INFINITY, f64::min),
        present().fold(f64::NEG_INFINITY, f64::max),
    ];
    high - low < MOST_TURNS * TAU
}

/// Replaces missing values by the previous one; at the beginning by the first one present.
fn hold(values: &mut [f64]) {
    let first = values.iter().copied().find(|value| !value.is_nan());
    let mut last = first.unwrap_or(0.0);
    for value in values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
}

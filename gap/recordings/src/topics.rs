//! Topics of a log that have their own times: commands hold until their next message, and rows are those of the
//! measurements.

use crate::channel::{Channel, Role};
use crate::{Finding, FindingKind};

/// Part of the rows that may lack a value by a fault; with more, the messages come at other times.
const FAULTS: f64 = 0.05;

/// Holds commands between their messages, and leaves out rows without any measurement and those before the first command.
pub(crate) fn joined(
    times: &mut Vec<f64>,
    columns: &mut [Vec<f64>],
    channels: &[Channel],
) -> Option<Finding> {
    let most = FAULTS * times.len() as f64;
    let mut is_kept = vec![true; times.len()];
    let mut is_held = false;
    for (channel, values) in channels.iter().zip(columns.iter_mut()) {
        let missing = values.iter().filter(|value| value.is_nan()).count();
        if !matches!(channel.role, Role::Input(_)) || missing as f64 <= most {
            continue;
        }
        is_held = true;
        hold(values, f64::NAN);
        for (value, is_kept) in values.iter().zip(&mut is_kept) {
            *is_kept &= !value.is_nan();
        }
    }
    let measured = || {
        let all = channels.iter().zip(columns.iter());
        all.filter(|(channel, _)| channel.is_measured())
    };
    let lacks = |row: usize| measured().all(|(_, values)| values[row].is_nan());
    let without: Vec<usize> = (0..times.len()).filter(|&row| lacks(row)).collect();
    if !is_held && without.len() as f64 <= most {
        return None;
    }
    for row in without {
        is_kept[row] = false;
    }
    // A log without any row that has all is refused for what its columns lack.
    if is_kept.contains(&true) {
        for values in columns.iter_mut().chain([times]) {
            let mut kept = is_kept.iter();
            values.retain(|_| kept.next() == Some(&true));
        }
    }
    let message = "messages of commands and of measurements have their own times: a command holds until the next one, and \
                   rows are those of the measurements";
    Some(Finding::new(FindingKind::Asynchronous, message))
}

/// Replaces missing values by the previous one, those at the beginning by `first`.
pub(crate) fn hold(values: &mut [f64], first: f64) {
    let mut last = first;
    for value in values {
        if value.is_nan() {
            *value = last;
        }
        last = *value;
    }
}

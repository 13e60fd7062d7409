//! Increasing times: rows in order, lengths of steps, gaps.

use appell_spec::{Code, Diagnostic, Report, shown};

use crate::finding::{counted, listed};
use crate::limits::MAX_LEFT_OUT;
use crate::time::{self, TIME};
use crate::{DataError, Finding, FindingKind};

/// Length of a step, relative to the median, beyond which it is a gap.
const GAP: f64 = 5.0;

/// Rows this many seconds apart and more miss the motion of a mechanism. Far more often their times are
/// not in seconds: rows up to a kilohertz, counted in milliseconds, look like this.
const SLOW: f64 = 1.0;

/// Accepts rows whose time is later than all before, and counts the others.
#[derive(Default)]
pub(crate) struct Clock {
    latest: Option<f64>,
    rows: usize,
    repeated: Skipped,
    backward: Skipped,
    missing: Skipped,
}

/// Rows omitted for one reason.
#[derive(Default)]
struct Skipped {
    count: usize,
    /// Number and text of the first line.
    first: Option<(usize, String)>,
}

impl Clock {
    /// Whether a row comes later than all before.
    pub(crate) fn accept(&mut self, t: f64, line: usize, text: &str) -> bool {
        self.rows += 1;
        let skipped = if t.is_nan() {
            &mut self.missing
        } else if self.latest.is_some_and(|latest| t < latest) {
            &mut self.backward
        } else if self.latest == Some(t) {
            &mut self.repeated
        } else {
            self.latest = Some(t);
            return true;
        };
        skipped.count += 1;
        skipped.first.get_or_insert_with(|| (line, text.to_owned()));
        false
    }

    /// The omitted rows; an error if they are too many for logging errors.
    pub(crate) fn findings(self, file: &str) -> Result<Vec<Finding>, DataError> {
        let most = MAX_LEFT_OUT * self.rows as f64;
        let kinds = [
            (
                self.backward,
                FindingKind::BackwardTime,
                "the time goes back",
                "where the clock starts anew, split the file into two runs",
            ),
            (
                self.repeated,
                FindingKind::RepeatedTime,
                "the time stands still",
                "write the times with more digits, or keep one row for each time",
            ),
            (
                self.missing,
                FindingKind::MissingTime,
                "the time is missing",
                "every row needs its time",
            ),
        ];
        let mut findings = Vec::new();
        for (skipped, kind, what, help) in kinds {
            let Some((line, text)) = skipped.first else {
                continue;
            };
            let rows = counted(skipped.count, "row");
            if skipped.count as f64 > most {
                let message = format!(
                    "{what}, here and in {} of {} rows",
                    skipped.count, self.rows
                );
                let diagnostic = Diagnostic::error(Code::SignalTable, message);
                let diagnostic = diagnostic.at(0..text.len(), "").help(help);
                return Err(Report::new(file, text, vec![diagnostic])
                    .from_line(line)
                    .into());
            }
            let message = format!("{what}: {rows} of {} left out", self.rows);
            findings.push(Finding::new(kind, message).on_line(line));
        }
        Ok(findings)
    }
}

/// Differences of neighbouring values.
pub(crate) fn steps(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// The median, of an even number of values the larger one in the middle; zero without values.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Steps between times.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// Median step in s.
    pub step: f64,
    /// Shortest step in s.
    pub shortest: f64,
    /// Longest step in s.
    pub longest: f64,
    /// Start and end of gaps in s.
    pub gaps: Vec<[f64; 2]>,
}

impl Sampling {
    pub(crate) fn of(times: &[f64]) -> Self {
        let steps = steps(times);
        let step = median(steps.clone());
        let gaps = times
            .windows(2)
            .filter(|pair| pair[1] - pair[0] > GAP * step);
        Self {
            step,
            shortest: steps.iter().copied().fold(f64::INFINITY, f64::min),
            longest: steps.iter().copied().fold(0.0, f64::max),
            gaps: gaps.map(|pair| [pair[0], pair[1]]).collect(),
        }
    }

    /// Whether the times of a column appear to be in another unit than seconds.
    pub(crate) fn doubt(&self, column: &str) -> Option<Finding> {
        // Of the units of loggers the one in which rows come at 1 Hz to 1 kHz.
        let unit = match self.step {
            step if step < SLOW => return None,
            step if step < 1e3 * SLOW => "ms",
            step if step < 1e6 * SLOW => "us",
            _ => "ns",
        };
        let line = |unit: &str| match column {
            TIME => format!("`{TIME} = {{ unit = \"{unit}\" }}`"),
            other => time::line(other, unit),
        };
        let message = format!(
            "a row every {} s ({} Hz): `{}` is read in seconds; if these are {unit}, write {} in `[channels]` of \
             recording.toml, or convert them; if they are seconds, write {}",
            (1e3 * self.step).round() / 1e3,
            (1e3 / self.step).round() / 1e3,
            shown(column),
            line(unit),
            line("s")
        );
        Some(Finding::new(FindingKind::SlowClock, message).of_channel(column))
    }

    pub(crate) fn findings(&self) -> Option<Finding> {
        if self.gaps.is_empty() {
            return None;
        }
        let gaps = self.gaps.iter();
        let gaps: Vec<String> = gaps
            .map(|[from, to]| format!("{:.3} s after {from:.3} s", to - from))
            .collect();
        let message = format!(
            "{} in steps of {:.3} ms: {}",
            counted(self.gaps.len(), "gap"),
            1e3 * self.step,
            listed(&gaps)
        );
        Some(Finding::new(FindingKind::Gap, message))
    }
}

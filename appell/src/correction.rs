//! A spec or a robot file corrected by a hypothesis of a gap report.

mod wanted;

use std::fmt::Write as _;
use std::path::Path;

use appell_robots::{Change, Corrected};
use serde_json::{Value, json};

use crate::gap_report::GapReport;
use crate::{Error, robot};

use wanted::{Part, Wanted};

/// A spec or a robot file with the changes of a hypothesis.
pub struct Correction {
    /// The text of the file.
    pub text: String,
    /// What it is, in words.
    pub(crate) about: String,
    /// The changes and what the file cannot express, a line each.
    pub lines: String,
    pub(crate) edits: Value,
}

/// Why a file stays as it is.
const NO_GAP: &str = "no gap beyond noise and tolerances, and no number that has to change: the file stays as it is; \
    the first hypothesis of the report has the numbers that were fitted within their tolerances";

/// The robot file `path` with a hypothesis of a gap report, numbered from 1; by default the most probable one. All but
/// the numbers that change stays as it is, and all of it where there is no gap.
pub fn correct(
    path: &Path,
    text: &str,
    report: &GapReport,
    hypothesis: Option<usize>,
) -> Result<Correction, Error> {
    let hypothesis = report.for_robot(hypothesis)?;
    let format = robot::Format::of(text).map(robot::Format::word);
    if let (Some(format), Some(diagnosed)) = (format, report.robot.as_deref())
        && format != diagnosed
    {
        let message =
            format!("the report is about a file of {diagnosed}, and this one is {format}");
        return Err(Error::data(path.to_string_lossy(), message));
    }
    let Some(hypothesis) = &hypothesis else {
        let text = text.to_owned();
        let stays = Corrected {
            text,
            edits: Vec::new(),
        };
        return Ok(Correction::of(path, stays, &[NO_GAP.to_owned()], &[]));
    };
    let (parts, mut remarks) = Wanted::of(path, text, hypothesis, &report.locked)?;
    let whole = |parts: &[Part], remarks: &[String]| {
        let changes: Vec<Change> = parts.iter().flat_map(|part| part.changes.clone()).collect();
        robot::corrected(path, text, &changes, remarks)
    };
    let corrected = match whole(&parts, &remarks) {
        Ok(corrected) => corrected,
        Err(error) => {
            // The parts that the file refuses are left to the reader.
            let mut possible = Vec::new();
            for part in parts {
                match whole(std::slice::from_ref(&part), &[]) {
                    Ok(_) => possible.push(part),
                    Err(why) => {
                        let why = reason(&why);
                        remarks.push(format!("not written: {}: {why}", part.name));
                    }
                }
            }
            if possible.is_empty() {
                return Err(error);
            }
            whole(&possible, &remarks)?
        }
    };
    let rivals = report.rivals(hypothesis);
    Ok(Correction::of(path, corrected, &remarks, &rivals))
}

/// The first sentence of an error.
fn reason(error: &Error) -> String {
    let first = match error {
        Error::Report(report) => report.diagnostics().first(),
        _ => None,
    };
    first.map_or_else(|| error.to_string(), |first| first.message.clone())
}

impl Correction {
    /// Of a robot file.
    fn of(path: &Path, corrected: Corrected, remarks: &[String], rivals: &[&str]) -> Self {
        let Corrected { text, edits } = corrected;
        let mut lines = String::new();
        // Writing to a string cannot fail.
        for line in &edits {
            let _ = writeln!(lines, "  changed   {line}");
        }
        for line in remarks {
            let _ = writeln!(lines, "  {line}");
        }
        Self {
            text,
            about: format!("{} corrected", path.display()),
            lines: lines + &tied(rivals),
            edits: json!({ "edits": edits, "remarks": remarks, "tied_with": rivals }),
        }
    }

    /// The changes, and what the file cannot express, as JSON.
    pub fn json(&self) -> Value {
        self.edits.clone()
    }

    /// What was written to `file`, and what belongs elsewhere.
    pub fn summary(&self, file: &str) -> String {
        format!("{file}: {}\n{}", self.about, self.lines)
    }
}

/// A line for each hypothesis that the recordings cannot distinguish from the one that is applied.
pub(crate) fn tied(rivals: &[&str]) -> String {
    let line = |rival| format!("  tied with {rival}: these recordings cannot distinguish them\n");
    rivals.iter().map(line).collect()
}

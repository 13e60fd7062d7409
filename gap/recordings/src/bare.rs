//! CSV files without a description: columns have the names and units of the spec.

use std::path::PathBuf;

use appell_spec::Mechanism;

use crate::channel::{Channel, Measured, Role};
use crate::clock::Sampling;
use crate::frame::Frame;
use crate::limits::{MAX_RUNS, MIN_ROWS};
use crate::time::Stated;
use crate::{
    DataError, DataSet, Finding, FindingKind, Logged, Parameter, Part, Reading, Run, Spec, run,
    stretches,
};

/// Held-out fraction: the last third of several runs, or of one.
const HELD_OUT: usize = 3;
/// Separation of the parts of one run in s, so that the second does not continue the first.
const APART: f64 = 1.0;

/// Reads CSV files whose columns have the names and units of the spec. The last third of the files is
/// held out; of a single file, the last third after a gap of one second.
pub fn read_bare(spec: Spec, files: &[PathBuf]) -> Result<DataSet, DataError> {
    assemble(spec, files.iter().cloned().map(Logged::File).collect())
}

/// The same of runs in memory.
pub fn read_bare_frames(spec: Spec, frames: &[Frame]) -> Result<DataSet, DataError> {
    assemble(spec, frames.iter().map(Logged::Frame).collect())
}

fn assemble(spec: Spec, files: Vec<Logged<'_>>) -> Result<DataSet, DataError> {
    let mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
    let Some(first) = files.first() else {
        return Err(DataError::whole(spec.file, "there is no recording"));
    };
    if files.len() > MAX_RUNS {
        let message = format!("a data set has at most {MAX_RUNS} runs");
        return Err(DataError::whole(first.name(), message));
    }
    let channels = channels(&first.header()?, &mechanism);
    if !channels.iter().any(Channel::is_measured) {
        let message = format!(
            "no column is a quantity of `{}`; it has {}; describe columns with other names and units in \
             a recording.toml",
            mechanism.name,
            Measured::names(&mechanism).join(", ")
        );
        return Err(DataError::whole(first.name(), message));
    }
    let count = files.len();
    let held_out = match count {
        1 => 0,
        count => (count / HELD_OUT).max(1),
    };
    let sources = files.into_iter().enumerate().map(|(index, source)| {
        let is_fitted = index + held_out < count;
        let part = if is_fitted { Part::Fit } else { Part::Test };
        (source.name(), part, Some((source, None)))
    });
    let mut findings = Vec::new();
    let mut runs = run::read_all(sources, &Stated::default(), &channels, &mut findings)?;
    if held_out > 0 {
        let message = format!("the last {held_out} of {count} runs are held out");
        findings.push(Finding::new(FindingKind::Split, message));
    } else {
        split(&mut runs, &mut findings);
    }
    let own = mechanism.parameters.iter();
    let set = DataSet {
        reading: Reading::default(),
        parameters: own.map(Parameter::stated).collect(),
        spec,
        robot: None,
        mechanism,
        description: String::new(),
        channels,
        runs,
        findings,
    };
    Ok(set.judged())
}

/// The columns with names of the spec.
fn channels(header: &[String], mechanism: &Mechanism) -> Vec<Channel> {
    let known = header.iter().filter_map(|column| {
        let measured = Measured::named(column, mechanism).map(Role::Measures);
        let role = measured.or_else(|| Role::input(column, mechanism))?;
        let unit = role.label(mechanism)?.unit.clone();
        Some(Channel::new(column, role, unit, None))
    });
    known.collect()
}

/// Splits the only run in time.
fn split(runs: &mut Vec<Run>, findings: &mut Vec<Finding>) {
    let [run] = &runs[..] else { return };
    let end = run.times.last().copied().unwrap_or(0.0);
    let kept = run.duration() / HELD_OUT as f64;
    let fitted = run.times.partition_point(|t| *t <= end - kept);
    let tested = run.times.partition_point(|t| *t <= end - kept + APART);
    if run.times.len() - tested < MIN_ROWS || fitted < MIN_ROWS {
        let message = "the only run is too short to hold a part of it out";
        findings.push(Finding::new(FindingKind::NoTestRun, message));
        return;
    }
    let message = format!(
        "one run only: it is fitted up to {:.3} s and held out from {:.3} s; another run would tell more",
        run.times[fitted - 1],
        run.times[tested]
    );
    findings.push(Finding::new(FindingKind::Split, message));
    let piece = |rows: std::ops::Range<usize>, part| Run {
        part,
        sampling: Sampling::of(&run.times[rows.clone()]),
        earlier: Vec::new(),
        ..stretches::cut(run, rows)
    };
    *runs = vec![
        piece(0..fitted, Part::Fit),
        piece(tested..run.times.len(), Part::Test),
    ];
}

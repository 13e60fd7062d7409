//! CSV files without a description: columns have the names and units of the spec.

use std::path::PathBuf;

use appell_spec::Mechanism;

use crate::channel::{Channel, Measured, Role};
use crate::clock::Sampling;
use crate::frame::{Frame, Source};
use crate::limits::{MAX_NUMBERS, MAX_RUNS, MIN_ROWS};
use crate::stretches;
use crate::time::Stated;
use crate::{
    DataError, DataSet, Finding, FindingKind, Parameter, Part, Reading, Run, Spec, noise, run,
};

/// Held-out fraction: the last third of several runs, or of one.
const HELD_OUT: usize = 3;
/// Separation of the parts of one run in s, so that the second does not continue the first.
const APART: f64 = 1.0;

/// Reads CSV files whose columns have the names and units of the spec. The last third of the files is
/// held out; of a single file, the last third after a gap of one second.
pub fn read_bare(spec: Spec, files: &[PathBuf]) -> Result<DataSet, DataError> {
    let sources: Vec<Source<'_>> = files.iter().cloned().map(Source::File).collect();
    assemble(spec, &sources)
}

/// The same of runs in memory.
pub fn read_bare_frames(spec: Spec, frames: &[Frame]) -> Result<DataSet, DataError> {
    let sources: Vec<Source<'_>> = frames.iter().map(Source::Frame).collect();
    assemble(spec, &sources)
}

fn assemble(spec: Spec, files: &[Source<'_>]) -> Result<DataSet, DataError> {
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
    let held_out = match files.len() {
        1 => 0,
        count => (count / HELD_OUT).max(1),
    };
    let (mut runs, mut findings, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    let mut budget = MAX_NUMBERS;
    for (index, source) in files.iter().enumerate() {
        let part = if index + held_out < files.len() {
            Part::Fit
        } else {
            Part::Test
        };
        match source.read(&Stated::default(), &channels, &mut budget) {
            Ok(table) => {
                runs.push(run::read(
                    source.name(),
                    part,
                    table,
                    &channels,
                    &mut findings,
                ));
            }
            Err(error) => errors.push(error),
        }
    }
    if !errors.is_empty() {
        return Err(DataError::several(errors));
    }
    if held_out > 0 {
        let message = format!("the last {held_out} of {} runs are held out", files.len());
        findings.push(Finding::new(FindingKind::Split, message));
    } else {
        split(&mut runs, &mut findings);
    }
    let runs = stretches::uninterrupted(runs, &channels, &mut findings);
    let own = mechanism.parameters.iter();
    let mut set = DataSet {
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
    noise::find(&mut set);
    set.tell_what_lacks();
    set.tell_smooth_inputs();
    set.findings.sort_by_key(Finding::order);
    Ok(set)
}

/// The columns with names of the spec.
fn channels(header: &[String], mechanism: &Mechanism) -> Vec<Channel> {
    let known = header.iter().filter_map(|column| {
        let input = mechanism
            .inputs
            .iter()
            .position(|i| i.label.name == *column);
        let role = Measured::named(column, mechanism)
            .map(Role::Measures)
            .or(input.map(Role::Input))?;
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
        name: run.name.clone(),
        part,
        sampling: Sampling::of(&run.times[rows.clone()]),
        times: run.times[rows.clone()].to_vec(),
        values: run
            .values
            .iter()
            .map(|values| values[rows.clone()].to_vec())
            .collect(),
        earlier: Vec::new(),
        between: Vec::new(),
        differences: run.differences.clone(),
    };
    *runs = vec![
        piece(0..fitted, Part::Fit),
        piece(tested..run.times.len(), Part::Test),
    ];
}

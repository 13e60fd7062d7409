//! Data sets: a folder with `recording.toml` and a file for each run, or such files alone.
//!
//! ```text
//! recording.toml --manifest--> mechanism, parameters, channels, runs
//! run.csv, …     --table----> rows, --clock--> increasing times, --channel--> SI, whole angles
//! runs           --noise----> noise level of each channel
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `manifest.rs`, `fields.rs` | what `recording.toml` says, with its places |
//! | `bare.rs` | files without one: columns with names of the spec; which part is held out |
//! | `table.rs` | a run from a file of any format, which the end of its name tells |
//! | `csv.rs`, `motive.rs` | rows of numbers, line by line; the header of Motive |
//! | `c3d.rs` | points and analog channels of motion capture |
//! | `mcap.rs`, `parquet.rs` | logs of robots, tables of data stores; each where its feature is on |
//! | `clock.rs` | which rows are in order; steps and gaps |
//! | `channel.rs` | what a column measures, and its values in SI |
//! | `quantum.rs`, `noise.rs` | the step of a sensor; the noise level, stated and found |
//! | `observed.rs` | the runs as the estimation core takes them |
//! | `rebound.rs` | the same recordings for another spec |
//! | `stretches.rs` | some rows of long recordings |
//! | `finding.rs`, `error.rs` | what was mended or looks wrong; what cannot be read |
//! | `limits.rs` | how large a data set may be |
//!
//! The same numbers come out whatever the units of the file. What a test run holds enters neither
//! noise levels nor anything else that is computed here; its findings are about its form.

mod bare;
mod c3d;
mod channel;
mod clock;
pub mod csv;
mod error;
pub(crate) mod fields;
mod finding;
pub mod limits;
mod manifest;
#[cfg(feature = "mcap")]
mod mcap;
mod motive;
mod noise;
mod observed;
#[cfg(feature = "parquet")]
mod parquet;
mod quantum;
mod rebound;
mod stretches;
pub(crate) mod table;

use std::path::Path;

use appell_spec::Mechanism;

pub use bare::read_bare;
pub use channel::{Channel, Measured, Role};
pub use clock::Sampling;
pub use error::DataError;
pub use finding::{Finding, FindingKind};
pub use noise::{Noise, NoiseSource};

use manifest::Manifest;

/// Name of the file that describes a data set.
pub const MANIFEST: &str = "recording.toml";

/// The text of a spec and the name that messages call it by.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spec {
    /// Name or path.
    pub file: String,
    /// The text.
    pub text: String,
}

/// Specs that can be named without a path, by name.
pub type Library<'l> = &'l [(&'l str, Spec)];

/// A data set that passed every check.
#[derive(Debug, Clone)]
pub struct DataSet {
    /// The spec of the mechanism.
    pub spec: Spec,
    /// The mechanism.
    pub mechanism: Mechanism,
    /// What people say about the recordings.
    pub description: String,
    /// The parameters of this rig, in the order of the spec.
    pub parameters: Vec<Parameter>,
    /// What the columns of all runs hold.
    pub channels: Vec<Channel>,
    /// The runs, those to fit first.
    pub runs: Vec<Run>,
    /// What was mended, and what looks wrong.
    pub findings: Vec<Finding>,
}

/// A parameter of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Value in SI.
    pub value: f64,
    /// Tolerance in SI, one standard deviation; zero where the value is known exactly, nothing where
    /// nobody says.
    pub std: Option<f64>,
}

/// What a run may be used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// To find and fit.
    Fit,
    /// To measure the gap before and after, and nothing else.
    Test,
}

/// One uninterrupted recording.
#[derive(Debug, Clone)]
pub struct Run {
    /// Name of its file.
    pub name: String,
    /// What it may be used for.
    pub part: Part,
    /// Times in s, strictly increasing.
    pub times: Vec<f64>,
    /// Values in SI for each channel; NaN where a measurement is missing. An input is held from its
    /// time to the next.
    pub values: Vec<Vec<f64>>,
    /// Steps and gaps.
    pub sampling: Sampling,
}

impl Run {
    /// From the first time to the last, in s.
    pub fn duration(&self) -> f64 {
        match self.times[..] {
            [first, .., last] => last - first,
            _ => 0.0,
        }
    }
}

/// Reads a data set: a folder with a `recording.toml`, or the path of such a file. `instead` replaces
/// the mechanism that the file names.
pub fn read(
    path: &Path,
    library: Library<'_>,
    instead: Option<Spec>,
) -> Result<DataSet, DataError> {
    let file = if path.is_dir() {
        path.join(MANIFEST)
    } else {
        path.to_owned()
    };
    if path.is_dir() && !file.exists() {
        return Err(DataError::NoManifest {
            folder: path.to_owned(),
        });
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let Manifest {
        spec,
        mechanism,
        description,
        parameters,
        time,
        channels,
        runs,
    } = manifest::read(&file, library, instead)?;
    let mut findings = Vec::new();
    let mut budget = limits::MAX_NUMBERS;
    let mut read_runs = Vec::new();
    let mut errors = Vec::new();
    for (name, part) in runs {
        let path = folder.join(&name);
        match table::read(&path, time.as_ref(), &channels, &mut budget) {
            Ok(table) => {
                let run = channel::run(name, part, table, &channels, &mut findings);
                // Whoever states the unit has thought of it.
                if time.is_none() {
                    findings.extend(run.sampling.doubt().map(|doubt| doubt.in_run(&run.name)));
                }
                read_runs.push(run);
            }
            Err(error) => errors.push(error),
        }
    }
    if !errors.is_empty() {
        return Err(DataError::several(errors));
    }
    let mut set = DataSet {
        spec,
        mechanism,
        description,
        parameters,
        channels,
        runs: read_runs,
        findings,
    };
    noise::find(&mut set);
    set.tell_what_lacks();
    set.findings.sort_by_key(Finding::order);
    Ok(set)
}

impl DataSet {
    /// Inputs without a column, and parameters without a tolerance.
    fn tell_what_lacks(&mut self) {
        for (index, input) in self.mechanism.inputs.iter().enumerate() {
            let recorded = |channel: &Channel| channel.role == Role::Input(index);
            if !self.channels.iter().any(recorded) {
                let message = format!(
                    "no column is the input `{}`, so zero is taken for it",
                    input.label.name
                );
                self.findings
                    .push(Finding::new(FindingKind::NoInput, message));
            }
        }
        if !self.parameters.is_empty() && self.parameters.iter().all(|own| own.std.is_none()) {
            let message = "no parameter has a tolerance `std`, so all are taken as they are";
            self.findings
                .push(Finding::new(FindingKind::NoTolerance, message));
        }
    }
}

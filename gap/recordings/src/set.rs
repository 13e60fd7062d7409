//! A data set: a mechanism, the parameters of a rig, channels and runs.

use std::borrow::Cow;

use appell_spec::{Mechanism, mechanism};

use crate::channel::Channel;
use crate::clock::Sampling;
use crate::finding::{Finding, FindingKind};
use crate::robot::Robot;

/// The text of a spec and its name in messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spec {
    /// Name or path.
    pub file: String,
    /// The text.
    pub text: String,
}

/// A data set that passed every check.
#[derive(Debug, Clone)]
pub struct DataSet {
    /// The spec of the mechanism.
    pub spec: Spec,
    /// The robot whose file the spec was made from.
    pub robot: Option<Robot>,
    /// The mechanism.
    pub mechanism: Mechanism,
    /// Description of the recordings.
    pub description: String,
    /// The parameters of this rig, in the order of the spec.
    pub parameters: Vec<Parameter>,
    /// The columns of all runs.
    pub channels: Vec<Channel>,
    /// The runs, training runs first.
    pub runs: Vec<Run>,
    /// Repairs and warnings.
    pub findings: Vec<Finding>,
    /// How the torques of a robot were recorded.
    pub reading: Reading,
}

/// How outputs that jump with the commands were recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reading {
    /// As means from half a row before their row to half a row after it.
    #[default]
    Mean,
    /// At the time of their row, with its command.
    AtRow,
}

/// A parameter of the rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Value in SI.
    pub value: f64,
    /// Tolerance in SI, one standard deviation; zero if the value is known exactly, `None` if not
    /// stated.
    pub std: Option<f64>,
}

impl Parameter {
    /// As the spec states it.
    pub(crate) fn stated(parameter: &mechanism::Parameter) -> Self {
        Self {
            value: parameter.value,
            std: parameter.std,
        }
    }
}

/// Role of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Training.
    Fit,
    /// Test, held out from all fits.
    Test,
}

/// One uninterrupted recording.
#[derive(Debug, Clone)]
pub struct Run {
    /// Name of its file.
    pub name: String,
    /// Its role.
    pub part: Part,
    /// Times in s, strictly increasing.
    pub times: Vec<f64>,
    /// Values in SI for each channel; NaN where a measurement is missing. An input is held from its
    /// time to the next, unless its channel is joined by lines.
    pub values: Vec<Vec<f64>>,
    /// Steps and gaps.
    pub sampling: Sampling,
    /// Rows before its first one, of a window of a run: inputs that are delayed act later. Measurements of them do not
    /// count.
    pub earlier: Vec<Row>,
    /// Of a subsampled window all rows from its first to its last one: the inputs at their full rate.
    pub between: Vec<Row>,
    /// Parameters that differ from those of the other runs.
    pub differences: Vec<Difference>,
}

/// A parameter of a run that differs from that of all runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Name of the parameter in the spec.
    pub parameter: String,
    /// Its value in the run minus that of all runs, in SI.
    pub by: f64,
}

/// A row: its time, and a value for each channel.
#[derive(Debug, Clone)]
pub struct Row {
    /// Time in s.
    pub t: f64,
    /// Values in SI for each channel.
    pub values: Vec<f64>,
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

impl DataSet {
    /// A text about it, with numbers of a robot under the names of its file.
    pub fn named<'t>(&self, text: &'t str) -> Cow<'t, str> {
        match &self.robot {
            Some(robot) => robot.named(text).into(),
            None => text.into(),
        }
    }

    /// The name in the spec of a quantity, which a robot file may call otherwise.
    pub fn in_spec<'n>(&'n self, name: &'n str) -> &'n str {
        let robot = self.robot.as_ref();
        let of_file = robot.and_then(|robot| robot.dictionary.in_spec(name));
        of_file.unwrap_or(name)
    }

    /// The values of the parameters in a run, in the order of the spec, in SI.
    pub fn parameters_in(&self, run: &Run) -> Vec<f64> {
        let mut values: Vec<f64> = self.parameters.iter().map(|own| own.value).collect();
        for difference in &run.differences {
            let mut names = self.mechanism.parameters.iter().map(|own| &own.label.name);
            if let Some(index) = names.position(|name| *name == difference.parameter) {
                values[index] += difference.by;
            }
        }
        values
    }

    /// Adds a doubt about a channel.
    pub fn doubt(&mut self, kind: FindingKind, column: &str, message: String) {
        let finding = Finding::new(kind, message);
        self.findings.push(finding.of_channel(column));
        self.findings.sort_by_key(Finding::order);
    }
}

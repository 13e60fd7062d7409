//! What a column holds, and its values in SI.

use appell_estimate::smoothing::angle::unwrap;
use appell_spec::Mechanism;
use appell_spec::mechanism::{CoordinateId, InputId, Label, OutputId, SpeedId};
use appell_spec::units::{Dimension, Unit};

use super::clock::Sampling;
use super::finding::counted;
use super::noise::Noise;
use super::table::Table;
use super::{Finding, FindingKind, Part, Run};

/// A column of every run.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Name of the column.
    pub column: String,
    /// What it holds.
    pub role: Role,
    /// Unit in the files.
    pub unit: Unit,
    /// Noise level as stated, in SI.
    pub stated_noise: Option<f64>,
    /// Noise level to work with; nothing for inputs, for what is only recorded, and where nothing
    /// tells it.
    pub noise: Option<Noise>,
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A quantity of the model, seen with noise.
    Measures(Measured),
    /// What was commanded, by the index of the input.
    Input(usize),
    /// A quantity that the model does not know.
    Recorded,
}

/// A quantity of the model, by its index in the mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measured {
    /// A coordinate.
    Coordinate(usize),
    /// A pseudo-velocity.
    PseudoVelocity(usize),
    /// A named output.
    Output(usize),
}

impl Measured {
    /// The quantity of a name.
    pub(super) fn named(name: &str, mechanism: &Mechanism) -> Option<Self> {
        let coordinate = mechanism.coordinates.iter();
        let speed = mechanism.pseudo_velocities.iter();
        let output = mechanism.outputs.iter();
        coordinate
            .map(|q| &q.label.name)
            .position(|own| own == name)
            .map(Self::Coordinate)
            .or_else(|| {
                let at = speed.map(|w| &w.label.name).position(|own| own == name);
                at.map(Self::PseudoVelocity)
            })
            .or_else(|| {
                let at = output.map(|y| &y.label.name).position(|own| own == name);
                at.map(Self::Output)
            })
    }

    /// Name, sentence and unit.
    pub fn label(self, mechanism: &Mechanism) -> &Label {
        match self {
            Self::Coordinate(i) => &mechanism.coordinates[CoordinateId::new(i)].label,
            Self::PseudoVelocity(i) => &mechanism.pseudo_velocities[SpeedId::new(i)].label,
            Self::Output(i) => &mechanism.outputs[OutputId::new(i)].label,
        }
    }

    /// Everything that can be measured.
    pub(super) fn names(mechanism: &Mechanism) -> Vec<&str> {
        let coordinates = mechanism.coordinates.iter().map(|q| &q.label);
        let speeds = mechanism.pseudo_velocities.iter().map(|w| &w.label);
        let outputs = mechanism.outputs.iter().map(|y| &y.label);
        let labels = coordinates.chain(speeds).chain(outputs);
        labels.map(|label| label.name.as_str()).collect()
    }
}

impl Role {
    /// Name, sentence and unit of the quantity in the spec.
    pub fn label(self, mechanism: &Mechanism) -> Option<&Label> {
        match self {
            Self::Measures(measured) => Some(measured.label(mechanism)),
            Self::Input(i) => Some(&mechanism.inputs[InputId::new(i)].label),
            Self::Recorded => None,
        }
    }
}

impl Channel {
    pub(crate) fn new(column: &str, role: Role, unit: Unit, stated_noise: Option<f64>) -> Self {
        Self {
            column: column.to_owned(),
            role,
            unit,
            stated_noise,
            noise: None,
        }
    }

    /// Whether it measures a quantity of the model.
    pub fn is_measured(&self) -> bool {
        matches!(self.role, Role::Measures(_))
    }

    /// Whether it is an angle in a unit of angles, which may start anew after a turn.
    pub(super) fn is_angle(&self) -> bool {
        let angle = self.unit.dimension == Dimension::NONE
            && (self.unit.pi_power != 0 || self.unit.text == "rad");
        angle && matches!(self.role, Role::Measures(Measured::Coordinate(_)))
    }
}

/// A run from its table, with dropouts told, inputs held and angles counted on.
pub(super) fn run(
    name: String,
    part: Part,
    table: Table,
    channels: &[Channel],
    findings: &mut Vec<Finding>,
) -> Run {
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
        if channel.is_angle() {
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
    }
}

/// Puts the value before in place of a missing one; at the beginning the first one that is there.
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

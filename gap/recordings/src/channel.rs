//! Kind of a column.

use appell_spec::Mechanism;
use appell_spec::mechanism::{CoordinateId, InputId, Interpolation, Label, OutputId, SpeedId};
use appell_spec::units::Unit;

use crate::level::Noise;

/// A column of every run.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Name of the column.
    pub column: String,
    /// Its role.
    pub role: Role,
    /// Unit in the files.
    pub unit: Unit,
    /// File, line and column where the description states the unit.
    pub unit_at: Option<(String, usize, usize)>,
    /// Whether the description vouches for the unit.
    pub unit_checked: bool,
    /// Whether its positive sense is opposite to that of the spec, where it is stated.
    pub reversed: Option<bool>,
    /// A turn of its encoder in SI, after which the angle begins anew; `None` for a whole turn of the joint.
    pub turn: Option<f64>,
    /// The number in its column that is zero.
    pub zero: f64,
    /// Interpolation of an input between rows, if stated.
    pub interpolation: Option<Interpolation>,
    /// Relative standard deviation of its scale, of an input that of the gain of its actuator, as stated.
    pub tolerance: Option<f64>,
    /// Noise level as stated, in SI.
    pub stated_noise: Option<f64>,
    /// Noise level that is used; `None` for inputs, for unused columns, and if unknown.
    pub noise: Option<Noise>,
}

/// Kind of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A measured quantity of the model.
    Measures(Measured),
    /// An input, by its index.
    Input(usize),
    /// A quantity that is not in the model.
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
    /// All measurable quantities, with their labels.
    fn all(mechanism: &Mechanism) -> impl Iterator<Item = (Self, &Label)> {
        let coordinates = mechanism.coordinates.iter().enumerate();
        let speeds = mechanism.pseudo_velocities.iter().enumerate();
        let outputs = mechanism.outputs.iter().enumerate();
        coordinates
            .map(|(i, q)| (Self::Coordinate(i), &q.label))
            .chain(speeds.map(|(i, w)| (Self::PseudoVelocity(i), &w.label)))
            .chain(outputs.map(|(i, y)| (Self::Output(i), &y.label)))
    }

    /// The quantity of a name.
    pub(crate) fn named(name: &str, mechanism: &Mechanism) -> Option<Self> {
        let mut all = Self::all(mechanism);
        all.find_map(|(own, label)| (label.name == name).then_some(own))
    }

    /// Name, sentence and unit.
    pub fn label(self, mechanism: &Mechanism) -> &Label {
        match self {
            Self::Coordinate(i) => &mechanism.coordinates[CoordinateId::new(i)].label,
            Self::PseudoVelocity(i) => &mechanism.pseudo_velocities[SpeedId::new(i)].label,
            Self::Output(i) => &mechanism.outputs[OutputId::new(i)].label,
        }
    }

    /// The names of all measurable quantities.
    pub(crate) fn names(mechanism: &Mechanism) -> Vec<&str> {
        let labels = Self::all(mechanism).map(|(_, label)| label);
        labels.map(|label| label.name.as_str()).collect()
    }
}

impl Role {
    /// The input of a name.
    pub(crate) fn input(name: &str, mechanism: &Mechanism) -> Option<Self> {
        let mut inputs = mechanism.inputs.iter();
        let place = inputs.position(|input| input.label.name == name);
        place.map(Self::Input)
    }

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
    /// Factor from the numbers of its column to SI, negative if it is reversed.
    pub fn scale(&self) -> f64 {
        let sign = if self.reversed == Some(true) {
            -1.0
        } else {
            1.0
        };
        sign * self.unit.scale
    }

    /// A number of its column in SI.
    pub(crate) fn in_si(&self, number: f64) -> f64 {
        (number - self.zero) * self.scale()
    }

    pub(crate) fn new(column: &str, role: Role, unit: Unit, stated_noise: Option<f64>) -> Self {
        Self {
            column: column.to_owned(),
            role,
            unit,
            unit_at: None,
            unit_checked: false,
            reversed: None,
            turn: None,
            zero: 0.0,
            interpolation: None,
            tolerance: None,
            stated_noise,
            noise: None,
        }
    }

    /// Whether it measures a quantity of the model.
    pub fn is_measured(&self) -> bool {
        matches!(self.role, Role::Measures(_))
    }

    /// Whether it measures an angle, which may be wrapped.
    pub fn is_angle(&self) -> bool {
        let has_turns = self.unit.is_angle() || self.turn.is_some();
        has_turns && matches!(self.role, Role::Measures(Measured::Coordinate(_)))
    }
}

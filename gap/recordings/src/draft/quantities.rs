//! What columns may be: joints with rates and torques, actuators; or the quantities of a spec.

use appell_spec::Mechanism;
use appell_spec::mechanism::{CoordinateId, Label, SpeedId};
use appell_spec::units::Dimension;

use super::words::{Kind, words};
use crate::robot::Robot;

/// A quantity that a column may be.
#[derive(Debug, Clone)]
pub(super) struct Quantity {
    pub(super) kind: Kind,
    /// As a description names it.
    pub(super) name: String,
    /// Words of the names that columns may have for it: its own first, then those of its joint.
    pub(super) words: Vec<Vec<String>>,
    /// Number of its axis: a joint or a coordinate.
    pub(super) axis: Option<usize>,
    /// Its unit in SI.
    pub(super) unit: String,
    pub(super) dimension: Dimension,
    /// Whether it is an angle or a rate of one.
    pub(super) has_angle: bool,
    /// Whether its unit is only a note: it is the control signal of an actuator as it stands.
    pub(super) is_note: bool,
    /// Its range in SI, where one is declared.
    pub(super) range: Option<[f64; 2]>,
}

impl Quantity {
    fn new(kind: Kind, name: &str, label: &Label, axis: Option<usize>) -> Self {
        Self {
            kind,
            name: name.to_owned(),
            words: vec![words(name)],
            axis,
            unit: label.unit.text.clone(),
            dimension: label.unit.dimension,
            has_angle: label.unit.has_angle(),
            is_note: false,
            range: None,
        }
    }

    /// Whether it is an angle, or a length.
    pub(super) fn is_angle_or_length(&self, is_angle: bool) -> bool {
        let wanted = if is_angle {
            Dimension::NONE
        } else {
            Dimension::LENGTH
        };
        self.has_angle == is_angle && self.dimension == wanted
    }

    /// A command of a position, which the position follows.
    pub(super) fn is_position_command(&self) -> bool {
        self.kind == Kind::Command && self.is_angle_or_length(self.has_angle)
    }
}

/// All quantities.
pub(super) fn quantities(mechanism: &Mechanism, robot: Option<&Robot>) -> Vec<Quantity> {
    match robot {
        Some(robot) => of_robot(mechanism, robot),
        None => of_spec(mechanism),
    }
}

fn of_robot(mechanism: &Mechanism, robot: &Robot) -> Vec<Quantity> {
    let mut all = Vec::new();
    let names = &robot.dictionary;
    for (axis, joint) in names.joints.iter().enumerate() {
        let mut coordinates = mechanism.coordinates.iter();
        let Some(own) = coordinates.find(|q| q.label.name == joint.coordinate) else {
            continue;
        };
        let mut quantity = Quantity::new(Kind::Position, &joint.name, &own.label, Some(axis));
        quantity.range = own.range;
        all.push(quantity);
        let mut speeds = mechanism.pseudo_velocities.iter();
        let rate = speeds.find(|w| w.label.name == joint.velocity);
        let mut outputs = mechanism.outputs.iter();
        let torque = outputs.find(|own| joint.torque.as_ref() == Some(&own.label.name));
        let others = [
            (Kind::Rate, "velocity", rate.map(|own| &own.label)),
            (Kind::Torque, "torque", torque.map(|own| &own.label)),
        ];
        for (kind, what, label) in others {
            all.extend(label.map(|label| Quantity {
                words: vec![words(&joint.name)],
                ..Quantity::new(kind, &format!("{}.{what}", joint.name), label, Some(axis))
            }));
        }
    }
    for actuator in &names.actuators {
        let mut inputs = mechanism.inputs.iter();
        let Some(own) = inputs.find(|input| input.label.name == actuator.input) else {
            continue;
        };
        let joint = actuator.joint.as_ref();
        let axis = joint.and_then(|joint| names.joints.iter().position(|own| own.name == *joint));
        let mut quantity = Quantity::new(Kind::Command, &actuator.name, &own.label, axis);
        let of_joint = joint.map(String::as_str).map(words);
        quantity.words.extend(of_joint);
        quantity.is_note = !actuator.is_servo;
        all.push(quantity);
    }
    if names.actuators.is_empty() {
        // A file without actuators, such as a URDF: efforts of the joints, `tau_elbow`.
        for own in &mechanism.inputs {
            let name = &own.label.name;
            let mut joints = names.joints.iter();
            let axis = joints.position(|joint| name.ends_with(&format!("_{}", joint.coordinate)));
            let mut quantity = Quantity::new(Kind::Command, name, &own.label, axis);
            let joint = axis.map(|axis| words(&names.joints[axis].name));
            quantity.words.extend(joint);
            all.push(quantity);
        }
    }
    all
}

fn of_spec(mechanism: &Mechanism) -> Vec<Quantity> {
    let mut all = Vec::new();
    for (index, own) in mechanism.coordinates.iter().enumerate() {
        let name = &own.label.name;
        let mut quantity = Quantity::new(Kind::Position, name, &own.label, Some(index));
        quantity.range = own.range;
        all.push(quantity);
    }
    for (index, own) in mechanism.pseudo_velocities.iter().enumerate() {
        let axis = mechanism
            .coordinates
            .ids()
            .find(|id: &CoordinateId| mechanism.speed_of(*id) == Some(SpeedId::new(index)));
        let name = &own.label.name;
        let axis = axis.map(CoordinateId::index);
        let mut quantity = Quantity::new(Kind::Rate, name, &own.label, axis);
        let coordinate = axis.map(|axis| &mechanism.coordinates[CoordinateId::new(axis)]);
        quantity
            .words
            .extend(coordinate.map(|own| words(&own.label.name)));
        all.push(quantity);
    }
    let outputs = mechanism.outputs.iter();
    let outputs = outputs.map(|own| (Kind::Torque, &own.label));
    let inputs = mechanism.inputs.iter();
    let inputs = inputs.map(|own| (Kind::Command, &own.label));
    let others = outputs.chain(inputs);
    all.extend(others.map(|(kind, label)| Quantity::new(kind, &label.name, label, None)));
    all
}

//! Coordinates with their inputs, passive forces and couplings.

use crate::letters::plain;
use crate::model::{Joint, Motion};
use crate::rotation::Pose;
use crate::table::{Item, list};

use super::resistances::{Owner, Property};
use super::units::Units;
use super::{Writer, operand, sentence};

const ARMATURE: Property<'_> = Property::new("armature", "armature", "inertia of the drive");

impl Writer<'_> {
    /// The coordinate of a joint with its pseudo-velocity, input and passive forces.
    pub(super) fn joint(&mut self, index: usize) {
        let joint = &self.tree.bodies[index].joint;
        if !joint.motion.has_axis() {
            self.several_coordinates(index);
            return;
        }
        let q = self.called.coordinates[index].clone();
        let units = Units::of(joint.motion);
        let rate = format!("dot({q})");
        self.coordinate(index, &q, &units);
        if self.driven {
            self.drive(joint, &q, &units);
        }
        let owner = Owner {
            called: &q,
            of: &joint.name,
            kind: "joint",
            along: ("coordinate", &q),
            units: &units,
        };
        self.damping(&owner, joint.damping, &rate);
        self.spring(&owner, joint.stiffness, joint.relaxed);
        self.friction(&owner, joint.friction, &rate);
        if joint.armature != 0.0 || self.numbers.patterns.names(&joint.name, "armature") {
            let inertia = self.of_owner(&owner, ARMATURE, joint.armature, units.inertia);
            self.turning_rotor(&q, &q, inertia, &units, &format!("joint {}", joint.name));
        }
    }

    /// The input of a joint, along its coordinate.
    fn drive(&mut self, joint: &Joint, q: &str, units: &Units) {
        let (letter, what) = match joint.motion {
            Motion::Turning => ("tau", "torque"),
            _ => ("force", "force"),
        };
        let input = self.quantities.new_one(&format!("{letter}_{q}"));
        let about = sentence(&format!("{what} at joint {}", joint.name));
        let item = Item::default().text("unit", units.force);
        self.inputs.add(&input, &item.text("about", &about));
        let load = Item::generalized(("coordinate", q), &input);
        self.loads.add(&format!("drive_{q}"), &load);
    }

    /// The coordinates of a body with a ball joint or a free joint.
    fn several_coordinates(&mut self, index: usize) {
        let body = &self.tree.bodies[index];
        let named = sentence(&format!("joint {}", body.joint.name));
        let is_free = body.joint.motion == Motion::Free;
        // The initial orientation of a ball joint is that of its file.
        let drawn = if is_free { body.start } else { Pose::IDENTITY };
        let start = match self.start {
            Some(start) => drawn.then(start.turned[body.link]),
            None => drawn,
        };
        let place = start.position.map(|value| (value, "m"));
        let attitude = start.rotation.to_quaternion();
        let attitude = attitude.map(|value| (value, "1"));
        let values = place[if is_free { 0 } else { 3 }..].iter().chain(&attitude);
        for (name, &(value, unit)) in self.called.several[index].iter().zip(values) {
            let item = Item::default().text("unit", unit).text("about", &named);
            let item = item.raw_if(value != 0.0, "initial", &plain(value));
            self.coordinates.add(name, &item);
        }
    }

    /// Their pseudo-velocities: the velocity components in the ground frame, and the angular velocity relative to the
    /// parent, in the frame of the body.
    pub(super) fn several_speeds(&mut self, index: usize, followers: &[usize]) {
        let body = &self.tree.bodies[index];
        let q = self.called.coordinates[index].clone();
        if body.joint.motion == Motion::Free {
            let axes = ["x", "y", "z"].iter().enumerate();
            for ((component, axis), name) in axes.zip(self.called.several[index].clone()) {
                if followers.contains(&component) {
                    continue;
                }
                let speed = self.quantities.new_one(&format!("v_{q}_{axis}"));
                let item = Item::default().text("value", &format!("dot({name})"));
                self.speeds.add(&speed, &item.text("unit", "m/s"));
                self.along(index, axis, &speed, &Units::of(Motion::Sliding));
            }
        }
        let own = self.called.frames[index].clone();
        for axis in ["x", "y", "z"] {
            let of = |frame: &str| format!("angular_velocity({frame}, {axis}, {own})");
            let value = match body.parent.map(|parent| &self.called.frames[parent]) {
                Some(parent) => format!("{} - {}", of(&own), of(parent)),
                None => of(&own),
            };
            let speed = self.quantities.new_one(&format!("w_{q}_{axis}"));
            let item = Item::default().text("value", &value);
            self.speeds.add(&speed, &item.text("unit", "rad/s"));
            self.along(index, axis, &speed, &Units::of(Motion::Turning));
        }
        if body.joint.armature != 0.0 {
            self.armature_of_several(index);
        }
    }

    /// Input and passive forces along one of several pseudo-velocities. A free body has no input.
    fn along(&mut self, index: usize, axis: &str, speed: &str, units: &Units) {
        let joint = &self.tree.bodies[index].joint;
        let q = self.called.coordinates[index].clone();
        if joint.motion == Motion::Ball && self.driven {
            let input = self.quantities.new_one(&format!("tau_{q}_{axis}"));
            let about = sentence(&format!("torque at joint {}, {axis}", joint.name));
            let declared = Item::default().text("unit", units.force);
            self.inputs.add(&input, &declared.text("about", &about));
            let load = Item::generalized(("velocity", speed), &input);
            self.loads.add(&format!("drive_{q}_{axis}"), &load);
        }
        let owner = Owner {
            called: speed,
            of: &joint.name,
            kind: "joint",
            along: ("velocity", speed),
            units,
        };
        self.damping(&owner, joint.damping, speed);
        self.friction(&owner, joint.friction, speed);
    }

    /// Armature of a ball joint or a free joint.
    fn armature_of_several(&mut self, index: usize) {
        let joint = &self.tree.bodies[index].joint;
        let q = self.called.coordinates[index].clone();
        let is_free = joint.motion == Motion::Free;
        let of = format!("joint {}", joint.name);
        let owner = Owner {
            called: &q,
            of: &joint.name,
            kind: "joint",
            along: ("coordinate", &q),
            units: &Units::of(Motion::Turning),
        };
        let inertia = self.of_owner(&owner, ARMATURE, joint.armature, "kg*m^2");
        let rotor = self.places.new_one(&format!("rotor_{q}"));
        if is_free {
            let mass = Property::new("armature_mass", "armature_mass", "inertia of the drive");
            let mass = self.of_owner(&owner, mass, joint.armature, "kg");
            let point = self.called.points[index].clone();
            let frame = self.called.frames[index].clone();
            self.weightless
                .push((q.clone(), point.clone(), mass.clone()));
            return self.rotor(&rotor, &frame, &point, &mass, &inertia, &of);
        }
        let all = &self.called.several[index];
        let quaternion = all[all.len() - 4..].to_vec();
        let item = Item::default().text("parent", "ground");
        self.frames
            .add(&rotor, &item.raw("quaternion", &list(&quaternion)));
        self.rotor(&rotor, &rotor, "O", "0", &inertia, &of);
    }

    fn coordinate(&mut self, index: usize, q: &str, units: &Units) {
        let body = &self.tree.bodies[index];
        let joint = &body.joint;
        let item = Item::default().text("unit", units.coordinate);
        let about = sentence(&format!("joint {}", joint.name));
        let item = item.text_if(joint.name != q, "about", &about);
        let range = list(&joint.range.unwrap_or_default().map(plain));
        let item = item.raw_if(joint.range.is_some(), "range", &range);
        let start = match self.start {
            Some(start) => joint.zero + start.ways[body.link],
            None => joint.start(),
        };
        let item = item.raw_if(start != 0.0, "initial", &plain(start));
        self.coordinates.add(q, &item);
    }

    /// Inertia of a rotor that moves with a joint or tendon only: a body at rest on the ground but for a turn by a sum of coordinates.
    pub(super) fn turning_rotor(
        &mut self,
        called: &str,
        by: &str,
        inertia: String,
        units: &Units,
        of: &str,
    ) {
        let rotor = self.places.new_one(&format!("rotor_{called}"));
        let (by, inertia) = match units.coordinate {
            "rad" => (by.to_owned(), inertia),
            // A turn of a radian a metre.
            _ => (
                format!("{}/(1 [m])", operand(by)),
                format!("{inertia}*(1 [m])^2"),
            ),
        };
        let item = Item::default()
            .text("parent", "ground")
            .text("about_axis", "z");
        self.frames.add(&rotor, &item.text("by", &by));
        self.rotor(&rotor, &rotor, "O", "0", &inertia, of);
    }

    /// A body with an inertia about every axis of a frame.
    fn rotor(
        &mut self,
        rotor: &str,
        frame: &str,
        centre: &str,
        mass: &str,
        inertia: &str,
        of: &str,
    ) {
        let tensor = Item::default().text("in", frame);
        let tensor = tensor.raw(
            "diagonal",
            &list(&[inertia, inertia, inertia].map(str::to_owned)),
        );
        let item = Item::default()
            .text("frame", frame)
            .text("centre", centre)
            .expression("mass", mass)
            .raw("inertia", &tensor.table())
            .text(
                "about",
                &sentence(&format!("inertia of the drive of {of} (armature)")),
            );
        self.bodies.add(rotor, &item);
    }
}

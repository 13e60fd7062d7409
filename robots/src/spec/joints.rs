//! Coordinates, what drives and resists them, and what couples them.

use crate::letters::{Kind, Number, plain, quantity};
use crate::loops::Meeting;
use crate::model::{Coupling, Joint, Motion};
use crate::table::{Item, list};

use super::{Writer, plus, sentence};

/// Rates below which dry friction fades out.
const SLOW: f64 = 0.01;

/// Units of what belongs to a kind of joint.
struct Units {
    coordinate: &'static str,
    rate: &'static str,
    force: &'static str,
    damping: &'static str,
    stiffness: &'static str,
    inertia: &'static str,
}

impl Units {
    fn of(motion: Motion) -> Self {
        match motion {
            Motion::Turning => Self {
                coordinate: "rad",
                rate: "rad/s",
                force: "N*m",
                damping: "N*m*s",
                stiffness: "N*m",
                inertia: "kg*m^2",
            },
            // What has several coordinates has no unit of its own.
            Motion::Sliding | Motion::Ball | Motion::Free => Self {
                coordinate: "m",
                rate: "m/s",
                force: "N",
                damping: "N*s/m",
                stiffness: "N/m",
                inertia: "kg",
            },
        }
    }
}

impl Writer<'_> {
    /// A number of a joint, as an expression.
    fn of_joint(
        &mut self,
        joint: &Joint,
        q: &str,
        value: f64,
        (letter, unit, about): (&str, &'static str, &str),
    ) -> String {
        let number = Number {
            value,
            unit,
            letter: &format!("{letter}_{q}"),
            of: &joint.name,
            about: &format!("{about} of joint {}", joint.name),
            kind: Kind::Other,
            never_negative: letter != "relaxed",
        };
        self.numbers.write(number, &mut self.quantities)
    }

    /// The coordinate of a joint, its speed, its input, and what resists it.
    pub(super) fn joint(&mut self, index: usize) {
        let joint = &self.tree.bodies[index].joint;
        if !joint.motion.has_axis() {
            self.several_coordinates(index);
            return;
        }
        let q = self.called.coordinates[index].clone();
        let units = Units::of(joint.motion);
        let rate = format!("dot({q})");
        self.coordinate(joint, &q, &units);
        self.drive(joint, &q, &units);
        if joint.damping != 0.0 {
            let damping = self.of_joint(
                joint,
                &q,
                joint.damping,
                ("damping", units.damping, "damping"),
            );
            let item = Item::default()
                .text("kind", "damper")
                .text("coordinate", &q);
            self.loads.add(
                &format!("damping_{q}"),
                &item.expression("damping", &damping),
            );
        }
        if joint.stiffness != 0.0 {
            let stiffness = self.of_joint(
                joint,
                &q,
                joint.stiffness,
                ("stiffness", units.stiffness, "stiffness of the spring"),
            );
            let relaxed = self.of_joint(
                joint,
                &q,
                joint.relaxed,
                (
                    "relaxed",
                    units.coordinate,
                    "coordinate of the relaxed spring",
                ),
            );
            let item = Item::default()
                .text("kind", "spring")
                .text("coordinate", &q);
            let item = item.expression("stiffness", &stiffness);
            let item = if relaxed == "0" {
                item
            } else {
                item.expression("relaxed", &relaxed)
            };
            self.loads.add(&format!("spring_{q}"), &item);
        }
        if joint.friction != 0.0 {
            let friction = self.of_joint(
                joint,
                &q,
                joint.friction,
                ("friction", units.force, "dry friction"),
            );
            let slow = quantity(
                SLOW,
                if joint.motion == Motion::Turning {
                    "rad/s"
                } else {
                    units.rate
                },
            );
            let force = format!("-{friction}*smooth_sign({rate}, {slow})");
            let item = Item::default()
                .text("kind", "generalized")
                .text("coordinate", &q);
            self.loads
                .add(&format!("friction_{q}"), &item.text("force", &force));
        }
        if joint.armature != 0.0 {
            self.armature(joint, &q, &units);
        }
    }

    /// What drives a joint: an input along its coordinate.
    fn drive(&mut self, joint: &Joint, q: &str, units: &Units) {
        let input = self.quantities.new_one(&format!(
            "{}_{q}",
            if joint.motion == Motion::Turning {
                "tau"
            } else {
                "force"
            }
        ));
        let what = if joint.motion == Motion::Turning {
            "torque"
        } else {
            "force"
        };
        let item = Item::default().text("unit", units.force);
        self.inputs.add(
            &input,
            &item.text(
                "about",
                &sentence(&format!("{what} at joint {}", joint.name)),
            ),
        );
        let item = Item::default()
            .text("kind", "generalized")
            .text("coordinate", q);
        self.loads
            .add(&format!("drive_{q}"), &item.text("force", &input));
    }

    /// The coordinates of a body that turns about every axis, and moves anywhere or does not.
    fn several_coordinates(&mut self, index: usize) {
        let body = &self.tree.bodies[index];
        let named = sentence(&format!("joint {}", body.joint.name));
        let is_free = body.joint.motion == Motion::Free;
        let place = body.start.position.map(|value| (value, "m"));
        // A ball joint begins as its file has it.
        let attitude = if is_free {
            body.start.rotation.to_quaternion()
        } else {
            [1.0, 0.0, 0.0, 0.0]
        };
        let attitude = attitude.map(|value| (value, "1"));
        let values = place[if is_free { 0 } else { 3 }..].iter().chain(&attitude);
        for (name, &(value, unit)) in self.called.several[index].iter().zip(values) {
            let item = Item::default().text("unit", unit).text("about", &named);
            let item = if value == 0.0 {
                item
            } else {
                item.raw("initial", &plain(value))
            };
            self.coordinates.add(name, &item);
        }
    }

    /// Their speeds: those of the place in the ground, and the angular velocity from what carries the joint, in the
    /// frame of the body.
    fn several_speeds(&mut self, index: usize, followers: &[usize]) {
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

    /// What drives and resists one of several speeds. Nothing drives a free body.
    fn along(&mut self, index: usize, axis: &str, speed: &str, units: &Units) {
        let joint = &self.tree.bodies[index].joint;
        let q = self.called.coordinates[index].clone();
        let item = |force: &str| {
            let item = Item::default().text("kind", "generalized");
            item.text("velocity", speed).text("force", force)
        };
        if joint.motion == Motion::Ball {
            let input = self.quantities.new_one(&format!("tau_{q}_{axis}"));
            let about = sentence(&format!("torque at joint {}, {axis}", joint.name));
            let declared = Item::default().text("unit", units.force);
            self.inputs.add(&input, &declared.text("about", &about));
            self.loads.add(&format!("drive_{q}_{axis}"), &item(&input));
        }
        if joint.damping != 0.0 {
            let damping = self.of_joint(
                joint,
                &q,
                joint.damping,
                ("damping", units.damping, "damping"),
            );
            self.loads.add(
                &format!("damping_{q}_{axis}"),
                &item(&format!("-{damping}*{speed}")),
            );
        }
    }

    /// Inertia of what turns with a ball joint alone.
    fn armature_of_several(&mut self, index: usize) {
        let joint = &self.tree.bodies[index].joint;
        let q = self.called.coordinates[index].clone();
        let inertia = self.of_joint(
            joint,
            &q,
            joint.armature,
            ("armature", "kg*m^2", "inertia of the drive"),
        );
        let rotor = self.places.new_one(&format!("rotor_{q}"));
        let all = &self.called.several[index];
        let quaternion = all[all.len() - 4..].to_vec();
        let item = Item::default().text("parent", "ground");
        self.frames
            .add(&rotor, &item.raw("quaternion", &list(&quaternion)));
        self.rotor(&rotor, &inertia, joint);
    }

    fn coordinate(&mut self, joint: &Joint, q: &str, units: &Units) {
        let item = Item::default().text("unit", units.coordinate);
        let item = if joint.name == q {
            item
        } else {
            item.text("about", &sentence(&format!("joint {}", joint.name)))
        };
        let item = match joint.range {
            Some(range) => item.raw("range", &list(&range.map(plain))),
            None => item,
        };
        let start = match joint.range {
            Some([from, to]) if !(from..=to).contains(&joint.zero) => f64::midpoint(from, to),
            _ => joint.zero,
        };
        let item = if start == 0.0 {
            item
        } else {
            item.raw("initial", &plain(start))
        };
        self.coordinates.add(q, &item);
    }

    /// Inertia of a drive that turns with its joint alone: a body at rest on the ground but for that turn.
    fn armature(&mut self, joint: &Joint, q: &str, units: &Units) {
        let inertia = self.of_joint(
            joint,
            q,
            joint.armature,
            ("armature", units.inertia, "inertia of the drive"),
        );
        let rotor = self.places.new_one(&format!("rotor_{q}"));
        let (by, inertia) = match joint.motion {
            Motion::Turning => (q.to_owned(), inertia),
            // A turn of a radian a metre.
            _ => (format!("{q}/(1 [m])"), format!("{inertia}*(1 [m])^2")),
        };
        let item = Item::default()
            .text("parent", "ground")
            .text("about_axis", "z");
        self.frames.add(&rotor, &item.text("by", &by));
        self.rotor(&rotor, &inertia, joint);
    }

    /// A body without mass at the origin, with an inertia about it.
    fn rotor(&mut self, rotor: &str, inertia: &str, joint: &Joint) {
        let tensor = Item::default().text("in", rotor);
        let tensor = tensor.raw(
            "diagonal",
            &list(&[inertia, inertia, inertia].map(str::to_owned)),
        );
        let item = Item::default()
            .text("frame", rotor)
            .text("centre", "O")
            .raw("mass", "0")
            .raw("inertia", &tensor.table())
            .text(
                "about",
                &sentence(&format!(
                    "inertia of the drive of joint {} (armature)",
                    joint.name
                )),
            );
        self.bodies.add(rotor, &item);
    }

    /// Speeds of the coordinates that are free, and the equations of the others.
    pub(super) fn couplings(
        &mut self,
        couplings: &[Coupling],
        meetings: &[(String, Vec<Meeting>)],
    ) {
        let find = |name: &str| {
            self.tree
                .bodies
                .iter()
                .position(|body| body.joint.motion.has_axis() && body.joint.name == name)
        };
        let mut follows = vec![false; self.tree.bodies.len()];
        let rows = || {
            meetings
                .iter()
                .flat_map(|(_, of)| of)
                .flat_map(|meeting| &meeting.rows)
        };
        for coupling in couplings {
            let Some(own) = find(&coupling.joint) else {
                continue;
            };
            let other = coupling.other.as_deref().and_then(find);
            follows[own] = true;
            let unit = |body: usize| Units::of(self.tree.bodies[body].joint.motion).coordinate;
            let shifted = |body: usize, zero: f64| {
                let q = &self.called.coordinates[body];
                plus(q, &quantity(-zero, unit(body)))
            };
            let mut value = "0".to_owned();
            for (power, coefficient) in coupling.coefficients.iter().enumerate() {
                if *coefficient == 0.0 {
                    continue;
                }
                let term = match (power, other) {
                    (0, _) => quantity(*coefficient, unit(own)),
                    (_, None) => continue,
                    (_, Some(other)) => {
                        let x = shifted(other, coupling.zeros[1]);
                        let x = if x.contains(' ') { format!("({x})") } else { x };
                        let x = if power == 1 {
                            x
                        } else {
                            format!("{x}^{power}")
                        };
                        let factor = match (unit(own), unit(other)) {
                            (y, x) if y == x && (power == 1 || y == "rad") => plain(*coefficient),
                            ("m", "m") => format!("{} [1/m^{}]", plain(*coefficient), power - 1),
                            ("m", _) => format!("{} [m]", plain(*coefficient)),
                            _ => format!("{} [1/m^{power}]", plain(*coefficient)),
                        };
                        if factor == "1" {
                            x
                        } else {
                            format!("{factor}*{x}")
                        }
                    }
                };
                value = plus(&value, &term);
            }
            let zero = shifted(own, coupling.zeros[0]);
            let zero = if value == "0" {
                zero
            } else if value.contains([' ', '-']) {
                format!("{zero} - ({value})")
            } else {
                format!("{zero} - {value}")
            };
            let item = Item::default()
                .text("kind", "position")
                .text("zero", &zero)
                .text("dependent", &self.called.coordinates[own]);
            self.constraints.add(
                &crate::names::Names::default().new_one(&coupling.name),
                &item,
            );
        }
        for (index, body) in self.tree.bodies.iter().enumerate() {
            let followers: Vec<usize> = rows()
                .filter(|(_, follower)| follower.body == index)
                .map(|(_, follower)| follower.component)
                .collect();
            if !body.joint.motion.has_axis() {
                self.several_speeds(index, &followers);
            } else if !follows[index] && followers.is_empty() {
                let q = &self.called.coordinates[index];
                let name = self.quantities.new_one(&format!("v_{q}"));
                let item = Item::default().text("value", &format!("dot({q})"));
                self.speeds
                    .add(&name, &item.text("unit", Units::of(body.joint.motion).rate));
            }
        }
    }
}

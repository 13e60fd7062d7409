//! Actuators: inputs, and the forces that follow from them.

use crate::dictionary::{ActuatorName, Entry};
use crate::letters::{Number, quantity};
use crate::model::{Drive, Law, On, Robot, Tendon, is};
use crate::names::short;
use crate::table::Item;

use super::units::Units;
use super::{Writer, minus, plus, sentence};

/// The transmission of an actuator, as expressions.
struct Way {
    /// The key and the value that give the direction of the load.
    along: (&'static str, String),
    length: String,
    rate: String,
    units: Units,
}

/// What actuators exert on a joint.
#[derive(Debug, Clone, Default)]
pub(super) struct Exerted {
    terms: Vec<String>,
    /// Whether it is within the bounds of the joint: by the load of its only actuator.
    bounded: bool,
}

/// A product; a factor of 1 is not written.
pub(super) fn times(factor: &str, expression: &str) -> String {
    match (factor, expression) {
        ("0", _) | (_, "0") => "0".to_owned(),
        ("1", _) => expression.to_owned(),
        (_, "1") => factor.to_owned(),
        ("-1", _) => format!("-{}", single(expression)),
        _ => format!("{}*{}", single(factor), single(expression)),
    }
}

/// An expression that can be a factor: names, numbers and calls as they are, all else in brackets.
fn single(expression: &str) -> String {
    let inner = expression.strip_suffix(')').and_then(|rest| {
        let (name, inner) = rest.split_once('(')?;
        (!name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_')).then_some(inner)
    });
    let mut depth = 0_i32;
    let is_call = inner.is_some_and(|inner| {
        inner.chars().all(|c| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            depth >= 0
        })
    });
    let (number, unit) = expression.split_once(" [").unwrap_or((expression, "]"));
    let is_number = number.parse::<f64>().is_ok() && unit.find(']') == Some(unit.len() - 1);
    let is_name = expression.chars().all(|c| c.is_alphanumeric() || c == '_');
    if is_call || is_number || is_name {
        expression.to_owned()
    } else {
        format!("({expression})")
    }
}

/// An expression between two bounds.
fn limited(expression: &str, bounds: &[String; 2]) -> String {
    let [from, to] = bounds;
    format!("min(max({expression}, {from}), {to})")
}

/// A number with its unit, also where it is zero.
fn bound(value: f64, unit: &str) -> String {
    match (quantity(value, unit), unit) {
        (zero, "1" | "rad" | "rad/s") if zero == "0" => zero,
        (zero, unit) if zero == "0" => format!("0 [{unit}]"),
        (number, _) => number,
    }
}

impl Writer<'_> {
    /// The inputs and forces of actuators.
    pub(super) fn drives(&mut self, robot: &Robot) {
        let Some(drives) = &robot.drives else {
            return;
        };
        self.torques = vec![Exerted::default(); self.tree.bodies.len()];
        for drive in drives {
            if let Some(way) = self.way(drive, &robot.tendons) {
                self.drive_of(drive, robot, way);
                self.mark(&drive.place);
            }
        }
        self.joint_torques();
    }

    /// What an actuator acts along; `None` if that is rigid.
    fn way(&self, drive: &Drive, tendons: &[Tendon]) -> Option<Way> {
        match &drive.on {
            On::Joint(name) => {
                let body = *self.tree.by_joint.get(name)?;
                let q = self.called.coordinates[body].clone();
                Some(Way {
                    along: ("coordinate", q.clone()),
                    rate: format!("dot({q})"),
                    length: q,
                    units: Units::of(self.tree.bodies[body].joint.motion),
                })
            }
            On::Tendon(name) => {
                let tendon = tendons.iter().find(|tendon| tendon.name == *name)?;
                let units = self.units(&tendon.length);
                let rate = self.sum(&tendon.length, &units, |q| format!("dot({q})"));
                let length = self.sum(&tendon.length, &units, str::to_owned);
                let constant = quantity(tendon.length.constant, units.coordinate);
                (rate != "0").then(|| Way {
                    along: ("velocity", rate.clone()),
                    length: plus(&length, &constant),
                    rate,
                    units,
                })
            }
        }
    }

    /// A number of an actuator.
    fn of_drive(
        &mut self,
        (drive, called): (&Drive, &str),
        attribute: &'static str,
        about: &str,
        value: f64,
        unit: &'static str,
    ) -> String {
        let number = Number {
            value,
            unit,
            letter: &format!("{attribute}_{called}"),
            of: &drive.name,
            attribute,
            about: &format!("{about} of actuator {}", drive.name),
            never_negative: value >= 0.0 && attribute != "bias",
            ..Number::default()
        };
        self.numbers.write(number, &mut self.quantities)
    }

    /// The input and the load of an actuator.
    fn drive_of(&mut self, drive: &Drive, robot: &Robot, way: Way) {
        let name = short(&drive.name);
        let called = self.quantities.free_one(&name, &format!("ctrl_{name}"));
        let units = &way.units;
        let unit = match drive.law() {
            Law::Position => units.coordinate,
            Law::Velocity => units.rate,
            Law::Force => units.force,
            Law::Modulated => "1",
        };
        let about = format!("command of the actuator {} ({})", drive.name, drive.kind);
        let input = Item::default().text("unit", unit);
        self.inputs
            .add(&called, &input.text("about", &sentence(&about)));
        let mut command = called.clone();
        for range in [drive.ctrl_range, drive.act_range].into_iter().flatten() {
            command = limited(&command, &range.map(|end| bound(end, unit)));
        }
        let own = (drive, called.as_str());
        // Patterns choose gears that are there: those of motors, and others than 1.
        let geared = !is(drive.gear, 1.0)
            || drive.kind == "motor"
            || self.numbers.patterns.names(&drive.name, "gear");
        let gear = if geared {
            self.of_drive(own, "gear", "gear", drive.gear, "1")
        } else {
            "1".to_owned()
        };
        let along = way.along.clone();
        let way = Way {
            length: times(&gear, &way.length),
            rate: times(&gear, &way.rate),
            ..way
        };
        let force = self.force(own, &command, &way);
        let force = self.bounded(own, force, &way.units);
        let shared = self.shared(drive, robot);
        let range = shared.map(|range| range.map(|end| bound(end, way.units.force)));
        let force = match (range, &drive.on) {
            (Some(range), On::Tendon(_)) => times(&gear, &limited(&force, &range)),
            (Some(range), On::Joint(_)) => limited(&times(&gear, &force), &range),
            (None, _) => times(&gear, &force),
        };
        let about = sentence(&format!("force of the actuator {}", drive.name));
        let item = Item::generalized((along.0, &along.1), &force).text("about", &about);
        let load = self.loads.add(&called, &item);
        self.exerts(drive, &robot.tendons, &load, shared.is_some());
        self.record(drive, called, load);
    }

    /// The force of an actuator before its bounds and its gear.
    fn force(&mut self, own: (&Drive, &str), command: &str, way: &Way) -> String {
        let (drive, _) = own;
        let (length, rate) = (&way.length, &way.rate);
        let [by_length, by_rate] = [way.units.stiffness[0], way.units.damping[0]];
        let [gain, gains @ ..] = drive.gain;
        let [bias, back @ ..] = drive.bias;
        let affine = |constant: &str, [length_factor, rate_factor]: [f64; 2]| {
            let elastic = times(&quantity(length_factor, by_length), length);
            let viscous = times(&quantity(rate_factor, by_rate), rate);
            plus(&plus(constant, &elastic), &viscous)
        };
        let force = match drive.law() {
            Law::Position => {
                let kp = self.of_drive(own, "kp", "stiffness", gain, by_length);
                let kv = self.of_drive(own, "kv", "damping", -back[1], by_rate);
                let elastic = times(&kp, &minus(command, length));
                minus(&elastic, &times(&kv, rate))
            }
            Law::Velocity => {
                let kv = self.of_drive(own, "kv", "damping", gain, by_rate);
                times(&kv, &minus(command, rate))
            }
            Law::Force => {
                let gain = if drive.kind == "motor" {
                    quantity(gain, "1")
                } else {
                    self.of_drive(own, "gain", "gain", gain, "1")
                };
                plus(&times(&gain, command), &affine("0", back))
            }
            Law::Modulated if drive.kind == "damper" => {
                let kv = self.of_drive(own, "kv", "damping", -gains[1], by_rate);
                let driven = format!("{}*{}", times(&kv, command), single(rate));
                plus(&minus("0", &driven), &affine("0", back))
            }
            Law::Modulated => {
                let gain = affine(&quantity(gain, way.units.force), gains);
                plus(&times(&gain, command), &affine("0", back))
            }
        };
        let bias = self.of_drive(own, "bias", "constant force", bias, way.units.force);
        plus(&force, &bias)
    }

    /// Records the names of an actuator, and its times that are not in the spec.
    fn record(&mut self, drive: &Drive, input: String, load: String) {
        self.dictionary.actuators.push(ActuatorName {
            name: drive.name.clone(),
            input,
            load,
            joint: match &drive.on {
                On::Joint(joint) => Some(joint.clone()),
                On::Tendon(_) => None,
            },
            lag: drive.lag,
            delay: drive.delay,
            is_servo: matches!(drive.law(), Law::Position | Law::Velocity),
            gear: drive.gear,
            gain: drive.gain[0],
            bias: drive.bias[0],
            follows_motion: [drive.gain, drive.bias]
                .iter()
                .any(|[_, of_motion @ ..]| of_motion.iter().any(|factor| *factor != 0.0)),
        });
        for (attribute, value) in [("timeconst", drive.lag), ("delay", drive.delay)] {
            if self.numbers.patterns.choose(&drive.name, attribute, value) {
                self.numbers.entries.push(Entry {
                    element: drive.name.clone(),
                    attribute,
                    parameter: String::new(),
                    value,
                    relative: false,
                });
            }
        }
    }

    /// A force within the bounds of its actuator.
    fn bounded(&mut self, own: (&Drive, &str), force: String, units: &Units) -> String {
        let (drive, called) = own;
        let Some([from, to]) = drive.force_range else {
            return force;
        };
        let about = format!("largest force of actuator {}", drive.name);
        let letter = format!("forcerange_{called}");
        let number = Number {
            value: to,
            unit: units.force,
            letter: &letter,
            of: &drive.name,
            attribute: "forcerange",
            about: &about,
            never_negative: true,
            ..Number::default()
        };
        let written = |value: f64| bound(value, units.force);
        if is(from, -to) {
            let to = self.numbers.write(number, &mut self.quantities);
            return limited(&force, &[format!("-{to}"), to]);
        }
        match self.numbers.factor(number, &mut self.quantities) {
            Some(factor) => limited(&force, &[from, to].map(|end| times(&factor, &written(end)))),
            None => limited(&force, &[from, to].map(written)),
        }
    }

    /// Bounds of the sum of all forces on what an actuator drives, if that is its own force alone.
    fn shared(&self, drive: &Drive, robot: &Robot) -> Option<[f64; 2]> {
        let tendon = |name: &str| robot.tendons.iter().find(|tendon| tendon.name == *name);
        match &drive.on {
            On::Joint(name) => {
                let drives = |other: &&Drive| match &other.on {
                    On::Joint(joint) => joint == name,
                    On::Tendon(other) => tendon(other).is_some_and(|tendon| {
                        tendon.length.terms.iter().any(|(joint, _)| joint == name)
                    }),
                };
                let alone = robot.drives.iter().flatten().filter(drives).count() == 1;
                let body = self.tree.by_joint.get(name).filter(|_| alone)?;
                self.tree.bodies[*body].joint.drive_range
            }
            On::Tendon(name) => tendon(name)?.drive_range,
        }
    }

    /// Records what the load of an actuator exerts on joints.
    fn exerts(&mut self, drive: &Drive, tendons: &[Tendon], load: &str, bounded: bool) {
        let force = format!("force({load})");
        match &drive.on {
            On::Joint(name) => {
                if let Some(body) = self.tree.by_joint.get(name) {
                    self.torques[*body].terms.push(force);
                    self.torques[*body].bounded |= bounded;
                }
            }
            On::Tendon(name) => {
                let Some(tendon) = tendons.iter().find(|tendon| tendon.name == *name) else {
                    return;
                };
                let length = self.units(&tendon.length).coordinate;
                for (joint, factor) in &tendon.length.terms {
                    let Some(body) = self.tree.by_joint.get(joint) else {
                        continue;
                    };
                    let own = Units::of(self.tree.bodies[*body].joint.motion).coordinate;
                    let unit = if own == length { "1" } else { "m" };
                    self.torques[*body]
                        .terms
                        .push(times(&quantity(*factor, unit), &force));
                }
            }
        }
    }

    /// Outputs: what all actuators exert on a joint. Where the joint bounds the sum of several, a load takes off the rest.
    fn joint_torques(&mut self) {
        for (index, exerted) in std::mem::take(&mut self.torques).into_iter().enumerate() {
            if exerted.terms.is_empty() {
                continue;
            }
            let q = self.called.coordinates[index].clone();
            let joint = &self.tree.bodies[index].joint;
            let units = Units::of(joint.motion);
            let terms = exerted.terms.iter();
            let mut total = terms.fold("0".to_owned(), |sum, term| plus(&sum, term));
            if let Some(range) = joint.drive_range.filter(|_| !exerted.bounded) {
                let range = range.map(|end| bound(end, units.force));
                let beyond = minus(&limited(&total, &range), &format!("({total})"));
                let item = Item::generalized(("coordinate", &q), &beyond);
                let item = item.text("about", "bounds the sum of the forces of actuators");
                let load = self.loads.add(&format!("bound_{q}"), &item);
                total = plus(&total, &format!("force({load})"));
            }
            let word = if units.coordinate == "rad" {
                "torque"
            } else {
                "force"
            };
            let name = self.quantities.new_one(&format!("{word}_{q}"));
            let about = sentence(&format!("{word} of the actuators on joint {}", joint.name));
            let item = Item::default()
                .text("value", &total)
                .text("unit", units.force)
                .text("about", &about);
            self.outputs.add(&name, &item);
            let own = self.dictionary.joints.iter_mut();
            for one in own.filter(|one| one.coordinate == q) {
                one.torque = Some(name.clone());
            }
        }
    }
}

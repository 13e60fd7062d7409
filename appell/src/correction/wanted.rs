//! Changes of a robot file by the effects of a hypothesis.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use appell_gap::diagnose::{Changes, Refitted};
use appell_report::text::{number, with_unit};
use appell_robots::{
    ActuatorName, Amount, Change, Dictionary, Format, JointNumber, Letters, Lock, Options,
};
use appell_spec::units;
use toml::de::{DeTable, DeValue};

use crate::gap_report::{Found, Hypothesis};
use crate::{Error, robot};

/// Attributes of joints.
const JOINT_NUMBERS: [(&str, JointNumber); 6] = [
    ("damping", JointNumber::Damping),
    ("frictionloss", JointNumber::Frictionloss),
    ("armature", JointNumber::Armature),
    ("stiffness", JointNumber::Stiffness),
    ("springref", JointNumber::Springref),
    ("ref", JointNumber::Ref),
];
/// Effects that add to a number of a joint: the number, and the names of their sizes.
const AT_JOINTS: [(&str, JointNumber, &[&str]); 4] = [
    ("coulomb_friction", JointNumber::Frictionloss, &["force"]),
    ("viscous_friction", JointNumber::Damping, &["coefficient"]),
    ("added_inertia", JointNumber::Armature, &["inertia", "mass"]),
    // The nearest expression of friction that depends on the rate.
    ("stribeck_friction", JointNumber::Frictionloss, &["sliding"]),
];
/// The site of an effect at all joints or all actuators.
const DRIVES: &str = "drives";
const AXES: [&str; 3] = ["x", "y", "z"];
/// No change.
const STAYS: Amount = Amount::Add(0.0);

/// Changes that belong together: those of an effect, or of a number that was fitted.
pub(super) struct Part {
    /// The name of the effect or the number.
    pub(super) name: String,
    pub(super) changes: Vec<Change>,
}

/// Changes of a robot file, and comments on what it cannot express.
pub(super) struct Wanted<'h> {
    /// The nominal robot.
    dictionary: Dictionary,
    /// Bodies that were diagnosed together with others beyond a locked joint.
    merged: BTreeSet<String>,
    format: Format,
    hypothesis: &'h Hypothesis,
    of_spec: Changes,
    /// Numbers of the file that were fitted, by their names.
    fitted: BTreeMap<String, f64>,
    parts: Vec<Part>,
    remarks: Vec<String>,
}

impl<'h> Wanted<'h> {
    /// The changes of a file by a hypothesis, and comments on what the file cannot express.
    pub(super) fn of(
        path: &Path,
        text: &str,
        hypothesis: &'h Hypothesis,
        locked: &[String],
    ) -> Result<(Vec<Part>, Vec<String>), Error> {
        let options = Options {
            letters: Letters::Matching(vec!["*.com".to_owned()]),
            actuators: true,
            ..Options::default()
        };
        let imported = robot::read_text(path, text, None, &options)?;
        let lock = locked.iter().map(|joint| Lock {
            joint: joint.clone(),
            value: None,
        });
        let reduced = robot::read_text(
            path,
            text,
            None,
            &Options {
                lock: lock.collect(),
                ..options
            },
        )?;
        let names = |of: &Dictionary| of.bodies.iter().map(|own| own.name.clone()).collect();
        let mut merged: BTreeSet<String> = names(&imported.dictionary);
        merged.retain(|name| {
            let of_both = [&imported.dictionary, &reduced.dictionary];
            let [whole, reduced] = of_both.map(|of| companions(of, name));
            whole != reduced
        });
        let of_spec = hypothesis.changes();
        let fitted = of_spec.parameters.iter();
        let mut wanted = Self {
            merged,
            dictionary: imported.dictionary,
            format: imported.format,
            hypothesis,
            fitted: fitted.map(|one| (one.name.clone(), one.value)).collect(),
            parts: Vec::new(),
            remarks: Vec::new(),
            of_spec,
        };
        for refitted in wanted.of_spec.parameters.clone() {
            wanted.refit(&refitted);
        }
        for (index, effect) in hypothesis.effects.iter().enumerate() {
            // The components of a vector have one name.
            if !hypothesis.effects[..index].contains(effect) {
                wanted.effect(effect);
            }
        }
        Ok((wanted.parts, wanted.remarks))
    }

    /// A number of the file that was fitted beside the effects.
    fn refit(&mut self, one: &Refitted) {
        let change = self.refitted(one);
        let expressed = change.filter(|change| change.is_expressed_by(self.format));
        if let Some(change) = expressed {
            self.parts.push(Part {
                name: one.name.clone(),
                changes: vec![change],
            });
        } else {
            let value = with_unit(&number(one.value), &one.unit);
            let name = &one.name;
            self.remarks.push(format!("not written: {name} = {value}"));
        }
    }

    fn refitted(&self, one: &Refitted) -> Option<Change> {
        let (element, attribute) = element_of(&one.name)?;
        let (amount, factor) = (Amount::To(one.value), one.value);
        let is_of_body = matches!(attribute, "mass" | "inertia" | "com.x" | "com.y" | "com.z");
        if is_of_body && self.merged.contains(element) {
            return None;
        }
        // It is one of these.
        let [body, joint, actuator] = [element; 3].map(str::to_owned);
        Some(match attribute {
            "mass" => Change::Mass { body, amount },
            "inertia" => Change::Inertia { body, factor },
            "com.x" | "com.y" | "com.z" => {
                let axis = attribute.strip_prefix("com.")?;
                let amounts = AXES.map(|own| if own == axis { amount } else { STAYS });
                Change::Centre { body, amounts }
            }
            "kp" => Change::Kp { actuator, amount },
            "kv" => Change::Kv { actuator, amount },
            "gear" => Change::Gear { actuator, amount },
            "forcerange" => {
                // Bounds of different size have a common factor.
                let amount = match one.unit.as_str() {
                    "1" => Amount::Times(factor),
                    _ => amount,
                };
                Change::ForceRange { actuator, amount }
            }
            _ if element == "option" => Change::Gravity(self.gravity()),
            _ => {
                let mut known = JOINT_NUMBERS.iter();
                let (_, attribute) = *known.find(|(word, _)| *word == attribute)?;
                Change::Joint {
                    joint,
                    attribute,
                    amount,
                }
            }
        })
    }

    /// The centre of mass of a body with all that is fixed to it, in its frame.
    fn centre(&self, body: &str) -> [f64; 3] {
        AXES.map(|axis| {
            let attribute = format!("com.{axis}");
            let mut entries = self.dictionary.entries.iter();
            let own = entries.find(|own| own.element == body && own.attribute == attribute);
            let fitted = self.fitted.get(&format!("{body}.{attribute}")).copied();
            fitted.or(own.map(|own| own.value)).unwrap_or_default()
        })
    }

    /// The transmission ratio of an actuator.
    fn gear(&self, actuator: &ActuatorName) -> f64 {
        let fitted = self.fitted.get(&format!("{}.gear", actuator.name));
        fitted.copied().unwrap_or(actuator.gear)
    }

    /// The acceleration of gravity, as fitted. Parameters are the magnitudes of its components.
    fn gravity(&self) -> [f64; 3] {
        let stated = self.dictionary.gravity;
        let count = stated.iter().filter(|one| **one != 0.0).count();
        std::array::from_fn(|axis| {
            if stated[axis] == 0.0 {
                return 0.0;
            }
            let name = match count {
                1 => "option.gravity".to_owned(),
                _ => format!("option.gravity.{}", AXES[axis]),
            };
            let magnitude = self.fitted.get(&name).copied();
            magnitude.map_or(stated[axis], |own| own.copysign(stated[axis]))
        })
    }

    /// A joint, by its name or that of its coordinate.
    fn joint(&self, site: &str) -> Option<String> {
        let joints = || self.dictionary.joints.iter();
        let found = joints().find(|joint| joint.name == site);
        let found = found.or_else(|| joints().find(|joint| joint.coordinate == site));
        found.map(|joint| joint.name.clone())
    }

    /// An actuator, by its name or that of its input or load.
    fn actuator(&self, site: &str) -> Option<&ActuatorName> {
        let actuators = || self.dictionary.actuators.iter();
        let found = actuators().find(|own| own.name == site);
        found.or_else(|| actuators().find(|own| own.input == site || own.load == site))
    }

    /// The body of the file that has the joint of a body of the spec, and a vector of that one in its axes.
    fn in_body(&self, site: &str, vector: [f64; 3]) -> Option<(String, [f64; 3])> {
        let mut bodies = self.dictionary.bodies.iter();
        let own = bodies.find(|own| own.body == site)?;
        if self.merged.contains(&own.name) {
            return None;
        }
        let along = |row: &[f64; 3]| row.iter().zip(vector).map(|(a, b)| a * b).sum();
        Some((own.name.clone(), own.axes.each_ref().map(along)))
    }

    /// The names and the values in SI of a size of an effect: at its site, or at all drives.
    fn at_sites(&self, effect: &str, site: &str, size: &str) -> Vec<(String, f64)> {
        let sizes = self.sizes(effect);
        let values = sizes.filter_map(|(own, found)| {
            let value = in_si(found)?;
            match own.strip_suffix(size)?.strip_suffix('_') {
                Some(drive) if site == DRIVES => Some(vec![(drive.to_owned(), value)]),
                _ if own != size => None,
                _ if site == DRIVES => {
                    let joints = self.dictionary.joints.iter().map(|one| &one.name);
                    let actuators = self.dictionary.actuators.iter().map(|one| &one.name);
                    let all = if effect.starts_with("actuator") {
                        actuators.cloned().collect::<Vec<_>>()
                    } else {
                        joints.cloned().collect()
                    };
                    Some(all.into_iter().map(|name| (name, value)).collect())
                }
                _ => Some(vec![(site.to_owned(), value)]),
            }
        });
        values.flatten().collect()
    }

    /// The sizes of an effect: the part of the name after the effect.
    fn sizes(&self, effect: &str) -> impl Iterator<Item = (&'h str, &'h Found)> {
        let parameters = self.hypothesis.parameters.iter();
        let prefix = format!("{effect}.");
        parameters.filter_map(move |found| Some((found.name.strip_prefix(&prefix)?, found)))
    }

    /// A vector whose components are effects of one name: sizes among the items of the spec. `axis` finds that of an
    /// item of `section`.
    fn vector(
        &self,
        effect: [&str; 2],
        section: &str,
        axis: fn(&DeTable<'_>) -> Option<usize>,
    ) -> Option<[f64; 3]> {
        let items = DeTable::parse(&self.of_spec.items).ok()?;
        let table = |name: &str| items.get_ref().get(name)?.get_ref().as_table();
        let (own, sizes) = (effect.join("_"), table("parameters")?);
        let mut vector = None;
        for (name, item) in table(section)? {
            let is_own = |rest: &str| rest.is_empty() || rest.starts_with('_');
            let name = name.get_ref().as_ref();
            let item = item.get_ref().as_table();
            let item = item.filter(|_| name.strip_prefix(&*own).is_some_and(is_own));
            let Some(axis) = item.and_then(axis) else {
                continue;
            };
            let mut sizes = sizes.iter();
            let (_, size) = sizes.find(|(size, _)| {
                let rest = size.get_ref().strip_prefix(name);
                rest.is_some_and(|rest| rest.starts_with('_'))
            })?;
            let size = size.get_ref().as_table()?;
            let value = match size.get("value")?.get_ref() {
                DeValue::Float(float) => float.as_str().parse().ok()?,
                DeValue::Integer(whole) => whole.as_str().parse::<f64>().ok()?,
                _ => return None,
            };
            let unit = units::parse(size.get("unit")?.get_ref().as_str()?).ok()?;
            vector.get_or_insert([0.0; 3])[axis] += value * unit.scale;
        }
        vector
    }

    /// An effect, with its sizes.
    fn effect(&mut self, effect: &str) {
        let (kind, site) = effect.split_once('@').unwrap_or((effect, ""));
        let changes = self.changes_of(effect, kind, site);
        let expressed = changes.filter(|all| {
            let mut all = all.iter();
            all.all(|change| change.is_expressed_by(self.format))
        });
        if kind == "stribeck_friction" || expressed.is_none() {
            self.remark(effect, kind);
        }
        self.parts.extend(expressed.map(|changes| Part {
            name: effect.to_owned(),
            changes,
        }));
    }

    /// The changes by an effect; `None` where the file cannot express it.
    fn changes_of(&self, effect: &str, kind: &str, site: &str) -> Option<Vec<Change>> {
        let at_joints = AT_JOINTS.iter().find(|(own, ..)| *own == kind);
        if let Some((_, attribute, sizes)) = at_joints {
            let values = sizes.iter().map(|size| self.at_sites(effect, site, size));
            let values = values.flatten().map(|(site, value)| {
                Some(Change::Joint {
                    joint: self.joint(&site)?,
                    attribute: *attribute,
                    amount: Amount::Add(value),
                })
            });
            return some(values.collect());
        }
        if let Some(changes) = self.of_actuators(effect, kind, site) {
            return some(changes.into_iter().collect());
        }
        let value = |name: &str| {
            let mut sizes = self.sizes(effect);
            let found = sizes.find(|(own, _)| *own == name);
            found.and_then(|(_, found)| in_si(found))
        };
        let change = match kind {
            // Its number is among those that were fitted.
            "parameter_error" => return Some(Vec::new()),
            "spring" => {
                let stiffness = value("stiffness").filter(|stiffness| *stiffness != 0.0)?;
                Change::Spring {
                    joint: self.joint(site)?,
                    stiffness,
                    relaxed_at: value("preload").unwrap_or(0.0) / stiffness,
                }
            }
            "backlash" => Change::Play {
                joint: self.joint(site)?,
                gap: 2.0 * value("half_gap")?,
            },
            "sensor_bias" => Change::Reading {
                joint: self.measured(effect, site)?,
                bias: value("bias")?,
            },
            "payload" => {
                let mass = value("mass")?;
                let away = AXES.map(|axis| value(axis).unwrap_or_default());
                let (body, away) = self.in_body(site, away)?;
                let centre = self.centre(&body);
                let at = std::array::from_fn(|axis| centre[axis] + away[axis]);
                Change::Payload { body, mass, at }
            }
            "mass_offset" => {
                let away = self.vector([kind, site], "points", |point| {
                    let mut at = point.get("at")?.get_ref().as_array()?.iter();
                    at.position(|part| {
                        let part = part.get_ref().as_str();
                        part.is_some_and(|part| part.starts_with("1*"))
                    })
                })?;
                let (body, away) = self.in_body(site, away)?;
                let amounts = away.map(Amount::Add);
                Change::Centre { body, amounts }
            }
            "ground_slope" => {
                let down = self.vector([kind, site], "loads", |load| {
                    let down = load.get("down")?.get_ref().as_str()?;
                    AXES.iter().position(|axis| *axis == down)
                })?;
                let gravity = self.gravity();
                let magnitude = gravity.iter().map(|one| one * one).sum::<f64>().sqrt();
                Change::Gravity(std::array::from_fn(|axis| {
                    gravity[axis] + magnitude * down[axis]
                }))
            }
            _ => return None,
        };
        Some(vec![change])
    }

    /// The changes by an effect on actuators; `None` for another effect, and in it for an unknown actuator.
    fn of_actuators(&self, effect: &str, kind: &str, site: &str) -> Option<Vec<Option<Change>>> {
        let by_actuators = |size: &str, change: fn(&Self, &ActuatorName, String, f64) -> Change| {
            let values = self.at_sites(effect, site, size).into_iter();
            let changes = values.map(|(site, value)| {
                let own = self.actuator(&site)?;
                Some(change(self, own, own.name.clone(), value))
            });
            changes.collect::<Vec<Option<Change>>>()
        };
        let changes = match kind {
            "actuator_gain" => by_actuators("gain", |_, _, actuator, gain| {
                let factor = 1.0 + gain;
                Change::Gain { actuator, factor }
            }),
            // Of a servo the bias of its force, of all others that of the command.
            "actuator_bias" => by_actuators("bias", |wanted, own, actuator, bias| {
                let add = if own.follows_motion {
                    bias / wanted.gear(own)
                } else {
                    bias * own.gain
                };
                Change::Bias { actuator, add }
            }),
            // Beside a lag or a delay that the file has.
            "actuator_lag" => by_actuators("time_constant", |_, own, actuator, more| {
                let seconds = own.lag + more;
                Change::Lag { actuator, seconds }
            }),
            "actuator_delay" => by_actuators("delay", |_, own, actuator, more| {
                let seconds = own.delay + more;
                Change::Delay { actuator, seconds }
            }),
            // Likewise.
            "actuator_saturation" | "saturation" => {
                by_actuators("limit", |wanted, own, actuator, limit| {
                    let (middle, half) = if own.follows_motion {
                        (0.0, limit / wanted.gear(own).abs())
                    } else {
                        (own.bias, limit * own.gain.abs())
                    };
                    let range = [middle - half, middle + half];
                    Change::ForceLimit { actuator, range }
                })
            }
            _ => return None,
        };
        Some(changes)
    }

    /// The joint whose position a channel measures.
    fn measured(&self, effect: &str, channel: &str) -> Option<String> {
        let mut signals = self.of_spec.signal_effects.iter();
        let own = signals.find(|own| own.effect == effect);
        let measures = own.and_then(|own| own.measures.as_deref());
        // Within the loop of a servo the geometry tells.
        let letter = |c: char| if c.is_alphanumeric() { c } else { '_' };
        let stem: String = effect.chars().map(letter).chain(['_']).collect();
        let mut terms = self.of_spec.inputs.iter();
        let term = terms.find(|term| term.in_geometry && term.adds.contains(&stem));
        let turned = term.map(|term| term.quantity.as_str());
        self.joint(measures.or(turned).unwrap_or(channel))
    }

    /// A comment on an effect that the format cannot express.
    fn remark(&mut self, effect: &str, kind: &str) {
        let sizes: Vec<(&str, &Found)> = self.sizes(effect).collect();
        let written = sizes.iter().map(|(own, found)| {
            let value = found.value.map_or_else(|| "unknown".to_owned(), number);
            let value = with_unit(&value, &found.unit);
            if sizes.len() == 1 {
                value
            } else {
                format!("{own} {value}")
            }
        });
        let written: Vec<String> = written.collect();
        let written = if written.is_empty() {
            String::new()
        } else {
            format!(" = {}", written.join(", "))
        };
        let factor = match (kind, sizes.as_slice()) {
            ("sensor_scale", [(_, found)]) => found.value.zip(Some(found.without.unwrap_or(1.0))),
            _ => None,
        };
        let factor = factor.map(|(scale, without)| 1.0 + scale - without);
        let remedy = factor.map_or_else(
            || remedy(kind, self.format).to_owned(),
            |factor| format!("multiply its readings by {}", number(factor.recip())),
        );
        let format = self.format.word();
        self.remarks
            .push(format!("not in {format}: {effect}{written}: {remedy}"));
    }
}

/// The bodies that count as one with a body.
fn companions<'d>(dictionary: &'d Dictionary, name: &str) -> Vec<&'d str> {
    let bodies = || dictionary.bodies.iter();
    let own = bodies().find(|own| own.name == name);
    let own = own.map_or("", |own| own.body.as_str());
    let alike = bodies().filter(|other| other.body == own);
    alike.map(|other| other.name.as_str()).collect()
}

/// Changes, if there are any.
fn some(changes: Option<Vec<Change>>) -> Option<Vec<Change>> {
    changes.filter(|all| !all.is_empty())
}

/// The value of a size in SI.
fn in_si(found: &Found) -> Option<f64> {
    let scale = units::parse(&found.unit).map_or(1.0, |unit| unit.scale);
    found.value.map(|value| value * scale)
}

/// `upper_arm.com.x` as element and attribute; names of elements may contain dots.
fn element_of(name: &str) -> Option<(&str, &str)> {
    let (element, attribute) = name.rsplit_once('.')?;
    match element.rsplit_once('.') {
        Some((outer, "com" | "gravity")) => Some((outer, &name[outer.len() + 1..])),
        _ => Some((element, attribute)),
    }
}

/// What to do about an effect that a format cannot express.
fn remedy(kind: &str, format: Format) -> &'static str {
    match kind {
        "sensor_bias" => "subtract it where the channel is read",
        "sensor_delay" => "shift the times of the channel",
        "sensor_filter" => "undo the low-pass filter where the channel is read",
        "actuator_dead_zone" => "add it to the command, with its sign, before it is sent",
        "stribeck_friction" if format == Format::Mjcf => {
            "its constant part is written as frictionloss"
        }
        "stribeck_friction" => "its constant part is written as friction",
        _ if format == Format::Urdf => {
            "set it where the robot is simulated, or leave it as the uncertainty of the model"
        }
        _ => "apply it through `qfrc_applied`, or leave it as the uncertainty of the model",
    }
}

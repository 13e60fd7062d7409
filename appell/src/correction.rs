//! A robot file corrected by a hypothesis of a gap report.

use std::fmt::Write as _;
use std::path::Path;

use appell_gap::diagnose::Refitted;
use appell_report::text::{number, with_unit};
use appell_robots::{
    ActuatorName, Amount, Change, Corrected, Dictionary, JointNumber, Letters, Options,
};

use crate::gap_report::{Found, GapReport, Hypothesis};
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
/// No change.
const STAYS: Amount = Amount::Add(0.0);

/// A robot file with the changes of a hypothesis.
pub struct Correction {
    /// The text of the file.
    pub text: String,
    /// What was changed, and what the format cannot express, a line each.
    pub summary: String,
}

/// The robot file `path` with a hypothesis of a gap report, numbered from 1; by default the most probable one. All but
/// the numbers that change stays as it is.
pub fn correct(
    path: &Path,
    text: &str,
    report: &GapReport,
    hypothesis: Option<usize>,
) -> Result<Correction, Error> {
    let hypothesis = report.hypothesis(hypothesis)?;
    let mut wanted = Wanted::of(path, text)?;
    for refitted in &hypothesis.changes().parameters {
        wanted.refitted(refitted);
    }
    for effect in &hypothesis.effects {
        wanted.effect(effect, &hypothesis.of(effect));
    }
    let Wanted {
        changes, remarks, ..
    } = wanted;
    let Corrected { text, edits } = robot::corrected(path, text, &changes, &remarks)?;
    let mut summary = String::new();
    for line in edits {
        let _ = writeln!(summary, "  changed   {line}");
    }
    for line in remarks {
        let _ = writeln!(summary, "  {line}");
    }
    for rival in report.rivals(hypothesis) {
        let _ = writeln!(
            summary,
            "  tied with {rival}: these recordings cannot distinguish them"
        );
    }
    Ok(Correction { text, summary })
}

/// A size of an effect: the part of its name after the effect, its value, its unit.
type Sizes<'h> = Vec<(&'h str, &'h Found)>;

impl Hypothesis {
    /// The sizes of an effect.
    fn of(&self, effect: &str) -> Sizes<'_> {
        let sizes = self.parameters.iter().filter_map(|found| {
            let own = found.name.strip_prefix(effect)?.strip_prefix('.')?;
            Some((own, found))
        });
        sizes.collect()
    }
}

/// Changes of a robot file, and comments on what it cannot express.
struct Wanted {
    /// The nominal robot.
    dictionary: Dictionary,
    changes: Vec<Change>,
    remarks: Vec<String>,
}

impl Wanted {
    fn of(path: &Path, text: &str) -> Result<Self, Error> {
        let options = Options {
            letters: Letters::Matching(vec!["*.com".to_owned()]),
            actuators: true,
            ..Options::default()
        };
        let dictionary = robot::read_text(path, text, None, &options)?.dictionary;
        Ok(Self {
            dictionary,
            changes: Vec::new(),
            remarks: Vec::new(),
        })
    }

    /// The centre of mass of a body with all that is fixed to it, in its frame.
    fn centre(&self, body: &str) -> [f64; 3] {
        ["com.x", "com.y", "com.z"].map(|axis| {
            let mut entries = self.dictionary.entries.iter();
            let own = entries.find(|entry| entry.element == body && entry.attribute == axis);
            own.map_or(0.0, |entry| entry.value)
        })
    }

    /// A nominal number of an actuator.
    fn stated(&self, actuator: &str, number: fn(&ActuatorName) -> f64) -> f64 {
        let mut actuators = self.dictionary.actuators.iter();
        let own = actuators.find(|own| own.name == actuator);
        own.map_or(0.0, number)
    }

    /// A number of the file that was fitted beside the effects.
    fn refitted(&mut self, one: &Refitted) {
        let Some((element, attribute)) = element_of(&one.name) else {
            return;
        };
        let (element, to) = (element.to_owned(), Amount::To(one.value));
        let change = match attribute {
            "mass" => Change::Mass {
                body: element,
                amount: to,
            },
            "inertia" => Change::Inertia {
                body: element,
                factor: one.value,
            },
            "com.x" => Change::Centre {
                body: element,
                amounts: [to, STAYS, STAYS],
            },
            "com.y" => Change::Centre {
                body: element,
                amounts: [STAYS, to, STAYS],
            },
            "com.z" => Change::Centre {
                body: element,
                amounts: [STAYS, STAYS, to],
            },
            "kp" => Change::Kp {
                actuator: element,
                amount: to,
            },
            "kv" => Change::Kv {
                actuator: element,
                amount: to,
            },
            "gear" => Change::Gear {
                actuator: element,
                amount: to,
            },
            "forcerange" => Change::ForceLimit {
                actuator: element,
                limit: one.value,
            },
            _ => {
                let known = JOINT_NUMBERS.iter().find(|(word, _)| *word == attribute);
                let Some((_, attribute)) = known else {
                    let value = number(one.value);
                    self.remarks
                        .push(format!("not written: {} = {value}", one.name));
                    return;
                };
                Change::Joint {
                    joint: element,
                    attribute: *attribute,
                    amount: to,
                }
            }
        };
        self.changes.push(change);
    }

    /// An effect, with its sizes.
    fn effect(&mut self, effect: &str, sizes: &Sizes<'_>) {
        let (kind, site) = effect.split_once('@').unwrap_or((effect, ""));
        let value = |name: &str| {
            let mut own = sizes.iter().filter(|(own, _)| *own == name);
            own.next().and_then(|(_, found)| found.value)
        };
        let name = site.to_owned();
        let add = |attribute: JointNumber, size: &str| {
            let amount = Amount::Add(value(size)?);
            Some(vec![Change::Joint {
                joint: name.clone(),
                attribute,
                amount,
            }])
        };
        let at_drives = |attribute: JointNumber, size: &str| {
            let all = sizes.iter().filter_map(|(own, found)| {
                let joint = own.strip_suffix(size)?.strip_suffix('_')?.to_owned();
                Some(Change::Joint {
                    joint,
                    attribute,
                    amount: Amount::Add(found.value?),
                })
            });
            Some(all.collect())
        };
        let actuator = name.clone();
        let changes: Option<Vec<Change>> = match (kind, site) {
            // Its number is among those that were fitted.
            ("parameter_error", _) => Some(Vec::new()),
            ("coulomb_friction", "drives") => at_drives(JointNumber::Frictionloss, "force"),
            ("viscous_friction", "drives") => at_drives(JointNumber::Damping, "coefficient"),
            ("added_inertia", "drives") => at_drives(JointNumber::Armature, "inertia"),
            ("coulomb_friction", _) => add(JointNumber::Frictionloss, "force"),
            ("viscous_friction", _) => add(JointNumber::Damping, "coefficient"),
            ("added_inertia", _) => {
                add(JointNumber::Armature, "inertia").or_else(|| add(JointNumber::Armature, "mass"))
            }
            ("spring", _) => value("stiffness").map(|stiffness| {
                vec![Change::Spring {
                    joint: name.clone(),
                    stiffness,
                    relaxed_at: 0.0,
                }]
            }),
            ("backlash", _) => value("half_gap").map(|half| {
                vec![Change::Play {
                    joint: name.clone(),
                    gap: 2.0 * half,
                }]
            }),
            ("payload", _) => value("mass").map(|mass| {
                let centre = self.centre(&name);
                let away = ["x", "y", "z"].map(|axis| value(axis).unwrap_or(0.0));
                let at = std::array::from_fn(|axis| centre[axis] + away[axis]);
                vec![Change::Payload {
                    body: name.clone(),
                    mass,
                    at,
                }]
            }),
            ("actuator_gain", _) => value("gain").map(|gain| {
                vec![Change::Gain {
                    actuator,
                    factor: 1.0 + gain,
                }]
            }),
            ("actuator_bias", _) => value("bias").map(|bias| {
                vec![Change::Bias {
                    actuator,
                    add: bias,
                }]
            }),
            // Beside a lag or a delay that the file has.
            ("actuator_lag", _) => value("time_constant").map(|more| {
                let seconds = self.stated(&actuator, |own| own.lag) + more;
                vec![Change::Lag { actuator, seconds }]
            }),
            ("actuator_delay", _) => value("delay").map(|more| {
                let seconds = self.stated(&actuator, |own| own.delay) + more;
                vec![Change::Delay { actuator, seconds }]
            }),
            ("actuator_saturation" | "saturation", _) => {
                value("limit").map(|limit| vec![Change::ForceLimit { actuator, limit }])
            }
            // The nearest expression of friction that depends on the rate or the direction.
            ("stribeck_friction", _) => {
                self.remark(
                    effect,
                    sizes,
                    "its constant part is written as frictionloss",
                );
                add(JointNumber::Frictionloss, "sliding")
            }
            _ => None,
        };
        match changes {
            Some(changes) => self.changes.extend(changes),
            None => self.remark(effect, sizes, remedy(kind)),
        }
    }

    /// A comment on an effect that the format cannot express.
    fn remark(&mut self, effect: &str, sizes: &Sizes<'_>, remedy: &str) {
        let sizes = sizes.iter().map(|(own, found)| {
            let value = found.value.map_or_else(|| "unknown".to_owned(), number);
            let value = with_unit(&value, &found.unit);
            if sizes.len() == 1 {
                value
            } else {
                format!("{own} {value}")
            }
        });
        let sizes: Vec<String> = sizes.collect();
        let sizes = if sizes.is_empty() {
            String::new()
        } else {
            format!(" = {}", sizes.join(", "))
        };
        self.remarks
            .push(format!("not in MJCF: {effect}{sizes}: {remedy}"));
    }
}

/// `upper_arm.com.x` as element and attribute; names of elements may contain dots.
fn element_of(name: &str) -> Option<(&str, &str)> {
    let (element, attribute) = name.rsplit_once('.')?;
    match element.rsplit_once('.') {
        Some((body, "com")) => Some((body, &name[body.len() + 1..])),
        _ => Some((element, attribute)),
    }
}

/// What to do about an effect that MJCF cannot express.
fn remedy(kind: &str) -> &'static str {
    match kind {
        "sensor_bias" => "subtract it where the channel is read",
        "sensor_scale" => "divide where the channel is read",
        "sensor_delay" => "shift the times of the channel",
        "sensor_filter" => "undo the low-pass filter where the channel is read",
        "actuator_dead_zone" => "add it to the command, with its sign, before it is sent",
        "directional_friction" => "apply it through `qfrc_applied`",
        _ => "apply it through `qfrc_applied`, or leave it as the uncertainty of the model",
    }
}

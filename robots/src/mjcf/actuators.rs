//! Actuators: their laws, and the inertia and damping that they add to joints and tendons.

use std::collections::BTreeMap;

use appell_spec::{Code, did_you_mean};
use roxmltree::Attribute;

use crate::model::{Drive, LeftOut, On, Tendon};
use crate::rotation::is_zero;
use crate::xml::{Element, Findings, children, elements, exactly, numbers, tag};

use super::Reader;
use super::schema::{self, ACTUATORS};

/// Attributes of all kinds of actuators that drive a joint or a tendon, and those of each kind.
const COMMON: &str = "armature class cranklength cranksite ctrllimited ctrlrange damping delay forcelimited forcerange \
                      gear group interp joint jointinparent lengthrange name nsample refsite site slidersite tendon user";
const OWN: &[(&str, &str)] = &[
    (
        "general",
        "actdim actearly actlimited actrange biasprm biastype body dynprm dyntype ffrange gainprm gaintype \
         inheritrange input velrange",
    ),
    ("motor", ""),
    ("position", "dampratio inheritrange kp kv timeconst"),
    ("velocity", "kv"),
    ("damper", "kv"),
    ("cylinder", "area bias diameter timeconst"),
    (
        "dcmotor",
        "cogging controller inductance input lugre motorconst nominal resistance saturation thermal",
    ),
];
/// What makes a `dcmotor` another one than a gain and a back-EMF, and the words with which it does not.
const NO_MERE_MOTOR: &[&str] = &[
    "cogging",
    "controller",
    "inductance",
    "input",
    "lugre",
    "thermal",
];
/// Kinds that follow no law of the form gain × command + bias.
const OTHER_LAW: &str = "its law has no counterpart, and it exerts no force";
/// Other transmissions, and drives of joints without an axis.
const OTHER_WAY: &str = "it drives no hinge, slide or fixed tendon, and exerts no force";
const COMPENSATION: &str =
    "its gravity compensation is no force of actuators, and not bounded together with them";
const SHARED: &str = "the sum of the forces of several actuators on the tendon is not bounded";

/// Attributes that are read together with actuators.
const READ: &[&str] = &[
    "joint/actuatorfrcrange",
    "joint/actuatorfrclimited",
    "fixed/actuatorfrcrange",
    "fixed/actuatorfrclimited",
    "tendon/actuatorfrcrange",
    "tendon/actuatorfrclimited",
    "flag/actuation",
    "option/actuatorgroupdisable",
];

/// The law of an actuator as its element and the defaults of its class build it up.
#[derive(Debug, Clone)]
struct Built {
    gain_type: String,
    gain: [f64; 3],
    bias_type: String,
    bias: [f64; 3],
    filter_type: String,
    time: f64,
    /// Whether commands are bounded whatever `ctrllimited` says.
    bounded: bool,
    /// The motor of `dcmotor`.
    motor: Motor,
    /// An element whose law is of another kind.
    other: bool,
}

/// A direct-current motor.
#[derive(Debug, Clone, Copy, Default)]
struct Motor {
    resistance: f64,
    /// Constants of torque and of back-EMF.
    constants: [f64; 3],
    /// Voltage, stall torque and speed without load.
    nominal: [f64; 3],
    /// Bounds of torque and of current.
    saturation: [f64; 3],
}

impl Motor {
    /// Its constant and its resistance.
    fn constants(&self) -> (f64, f64) {
        let [torque, back, _] = self.constants;
        let [voltage, stall, speed] = self.nominal;
        let constant = match (torque > 0.0, back > 0.0) {
            (true, true) => (torque * back).sqrt(),
            (false, false) => voltage / speed,
            _ => torque.max(back),
        };
        if self.resistance > 0.0 {
            (constant, self.resistance)
        } else {
            (constant, constant * voltage / stall)
        }
    }

    /// The largest torque, if it is bounded.
    fn bound(&self) -> Option<f64> {
        let [torque, current, _] = self.saturation;
        let bound = if torque > 0.0 {
            torque
        } else {
            current * self.constants().0
        };
        (bound > 0.0).then_some(bound)
    }
}

impl Built {
    fn new() -> Self {
        Self {
            gain_type: "fixed".to_owned(),
            gain: [1.0, 0.0, 0.0],
            bias_type: "none".to_owned(),
            bias: [0.0; 3],
            filter_type: "none".to_owned(),
            time: 1.0,
            bounded: false,
            motor: Motor::default(),
            other: false,
        }
    }

    /// Sets the types of gain, bias and filter.
    fn types(&mut self, gain: &str, bias: &str, filter: Option<&str>) {
        gain.clone_into(&mut self.gain_type);
        bias.clone_into(&mut self.bias_type);
        if let Some(filter) = filter {
            filter.clone_into(&mut self.filter_type);
        }
    }

    /// Applies an element, as the functions `mjs_setTo…` of `MuJoCo` do.
    fn apply(&mut self, element: Element<'_>, findings: &Findings) {
        let number = |key: &str| {
            let given = element.attribute_node(key)?;
            exactly::<1>(findings, &given, &format!("`{key}`")).map(|[number]| number)
        };
        let some = |key: &str, into: &mut [f64; 3]| {
            let given = element.attribute_node(key);
            let read = given.and_then(|given| numbers(findings, &given));
            for (own, read) in into.iter_mut().zip(read.into_iter().flatten()) {
                *own = read;
            }
        };
        self.other = false;
        match element.tag_name().name() {
            "general" => {
                some("gainprm", &mut self.gain);
                some("biasprm", &mut self.bias);
                let mut filter = [self.time, 0.0, 0.0];
                some("dynprm", &mut filter);
                self.time = filter[0];
                for (key, own) in [
                    ("gaintype", &mut self.gain_type),
                    ("biastype", &mut self.bias_type),
                    ("dyntype", &mut self.filter_type),
                ] {
                    if let Some(word) = element.attribute(key) {
                        word.clone_into(own);
                    }
                }
            }
            "motor" => {
                self.gain[0] = 1.0;
                self.types("fixed", "none", Some("none"));
            }
            "position" => {
                self.gain[0] = number("kp").unwrap_or(self.gain[0]);
                self.bias[..2].copy_from_slice(&[0.0, -self.gain[0]]);
                // A positive factor of the rate is a damping ratio.
                let kv = number("kv").map(|kv| -kv);
                self.bias[2] = number("dampratio").or(kv).unwrap_or(self.bias[2]);
                match number("timeconst") {
                    Some(0.0) => "none".clone_into(&mut self.filter_type),
                    Some(time) => {
                        self.time = time;
                        "filterexact".clone_into(&mut self.filter_type);
                    }
                    None => {}
                }
                self.types("fixed", "affine", None);
            }
            "velocity" => {
                self.gain[0] = number("kv").unwrap_or(self.gain[0]);
                self.bias = [0.0, 0.0, -self.gain[0]];
                self.types("fixed", "affine", Some("none"));
            }
            "damper" => {
                self.gain = [0.0, 0.0, -number("kv").unwrap_or_default()];
                self.bounded = true;
                self.types("affine", "none", Some("none"));
            }
            "cylinder" => {
                self.time = number("timeconst").unwrap_or(self.time);
                some("bias", &mut self.bias);
                self.gain[0] = number("area").unwrap_or(self.gain[0]);
                if let Some(diameter) = number("diameter") {
                    self.gain[0] = std::f64::consts::FRAC_PI_4 * diameter * diameter;
                }
                self.types("fixed", "affine", Some("filter"));
            }
            "dcmotor" => {
                self.motor.resistance = number("resistance").unwrap_or(self.motor.resistance);
                some("motorconst", &mut self.motor.constants);
                some("nominal", &mut self.motor.nominal);
                some("saturation", &mut self.motor.saturation);
                let acts = |key: &&str| {
                    let given = element.attribute(*key).unwrap_or_default();
                    let mut words = given.split_ascii_whitespace();
                    words.any(|word| word != "voltage" && word.parse() != Ok(0.0))
                };
                self.other = NO_MERE_MOTOR.iter().any(acts);
                self.types("dcmotor", "none", Some("none"));
            }
            _ => self.other = true,
        }
    }

    /// Gain and bias with the terms that act; `None` for another law.
    fn law(&self) -> Option<([f64; 3], [f64; 3])> {
        let gain = match self.gain_type.as_str() {
            "dcmotor" if !self.other => {
                let (constant, resistance) = self.motor.constants();
                let gain = constant / resistance;
                let law = ([gain, 0.0, 0.0], [0.0, 0.0, -gain * constant]);
                return (gain.is_finite() && gain > 0.0).then_some(law);
            }
            "fixed" => [self.gain[0], 0.0, 0.0],
            "affine" => self.gain,
            _ => return None,
        };
        let bias = match self.bias_type.as_str() {
            "none" => [0.0; 3],
            "affine" => self.bias,
            _ => return None,
        };
        let filtered = ["none", "filter", "filterexact"].contains(&self.filter_type.as_str());
        (filtered && !self.other).then_some((gain, bias))
    }

    fn lag(&self) -> f64 {
        match self.filter_type.as_str() {
            "none" => 0.0,
            _ => self.time,
        }
    }
}

impl<'x> Reader<'x, '_> {
    /// Bounds, where an attribute gives them and another one, or the order of the two, says that they hold.
    pub(super) fn bounds(
        &self,
        attribute: &dyn Fn(&str) -> Option<Attribute<'x, 'x>>,
        range: &str,
        limited: &str,
    ) -> Option<[f64; 2]> {
        if !self.actuators {
            return None;
        }
        let given = attribute(range)?;
        let [from, to] = exactly::<2>(self.findings, &given, "a range, from to,")?;
        let holds = match attribute(limited).map(|given| given.value()) {
            Some("true") => true,
            Some("false") => false,
            _ => self.compiler.autolimits && from < to,
        };
        holds.then_some([from, to])
    }

    /// Adds the inertia and the damping of drives to joints and tendons, and reads the actuators or lists them.
    pub(super) fn drives(&mut self, tendons: &mut [Tendon]) -> Option<Vec<Drive>> {
        let by_name: BTreeMap<String, usize> = (tendons.iter().enumerate())
            .map(|(index, one)| (one.name.clone(), index))
            .collect();
        let mut drives = Vec::new();
        for element in children(self.root, "actuator").flat_map(elements) {
            let class = self.class(element, "class");
            let attribute = |key: &str| {
                let own = element.attribute_node(key);
                own.or_else(|| self.defaults.of_any(ACTUATORS, class, key))
            };
            let gear = attribute("gear").and_then(|given| numbers(self.findings, &given));
            let gear = gear.and_then(|all| all.first().copied()).unwrap_or(1.0);
            let armature = attribute("armature")
                .and_then(|given| exactly::<1>(self.findings, &given, "`armature`"));
            let armature = armature.map_or(0.0, |[one]| one * gear * gear);
            let damping = self
                .polynomial(attribute("damping"))
                .map(|one| one * gear * gear);
            // Of several transmissions, the last one holds.
            let ways = [
                "joint",
                "jointinparent",
                "tendon",
                "cranksite",
                "site",
                "body",
            ];
            let given = ways.iter().rev();
            let way = given.copied().find(|key| element.attribute(*key).is_some());
            let target = way.and_then(|key| element.attribute(key));
            let link = target.filter(|_| matches!(way, Some("joint" | "jointinparent")));
            let link = link.and_then(|name| self.joint_links.get(name).copied());
            let tendon = target.filter(|_| way == Some("tendon"));
            let tendon = tendon.and_then(|name| by_name.get(name).copied());
            let (on, inertia, resistance) = if let Some(link) = link
                && let Some(joint) = &mut self.links[link].joint
            {
                let on = On::Joint(joint.name.clone());
                (Some(on), &mut joint.armature, &mut joint.damping)
            } else if let Some(tendon) = tendon {
                let tendon = &mut tendons[tendon];
                let on = On::Tendon(tendon.name.clone());
                (Some(on), &mut tendon.armature, &mut tendon.damping)
            } else {
                if armature != 0.0 || !is_zero(damping) {
                    self.findings.warning(
                        Code::NotAllowedHere,
                        tag(element),
                        "inertia and damping of this drive are left out",
                        "they are read where it drives a hinge, a slide or a fixed tendon",
                    );
                }
                self.leave_out_drive(element, OTHER_WAY);
                continue;
            };
            *inertia += armature;
            for (own, more) in resistance.iter_mut().zip(damping) {
                *own += more;
            }
            match on.filter(|_| self.actuators) {
                Some(on) => drives.extend(self.drive(element, class, on, gear)),
                None => self.leave_out_of("actuator", element),
            }
        }
        if !self.actuators {
            return None;
        }
        // What these say is read, except of spatial tendons.
        self.left_out
            .retain(|one| !READ.contains(&one.what.as_str()));
        for tendon in tendons {
            let on = On::Tendon(tendon.name.clone());
            let count = drives.iter().filter(|drive| drive.on == on).count();
            if count > 1 && tendon.drive_range.take().is_some() {
                self.left_out.push(LeftOut {
                    what: "fixed/actuatorfrcrange".to_owned(),
                    name: Some(tendon.name.clone()),
                    effect: Some(SHARED),
                    place: tendon.place.clone(),
                });
            }
        }
        self.leave_out_compensation();
        Some(drives)
    }

    /// Lists gravity compensation that counts as a force of actuators.
    fn leave_out_compensation(&mut self) {
        let all = |tag: &'static str| {
            self.root
                .descendants()
                .filter(move |one| one.has_tag_name(tag))
        };
        if !all("body").any(|body| body.attribute("gravcomp").is_some()) {
            return;
        }
        let given =
            all("joint").filter(|joint| joint.attribute("actuatorgravcomp") == Some("true"));
        let given: Vec<LeftOut> = given
            .map(|joint| LeftOut {
                what: "joint/actuatorgravcomp".to_owned(),
                name: joint.attribute("name").map(str::to_owned),
                effect: Some(COMPENSATION),
                place: tag(joint),
            })
            .collect();
        self.left_out.extend(given);
    }

    /// Lists an actuator, with its effect where actuators are read.
    fn leave_out_drive(&mut self, element: Element<'x>, effect: &'static str) {
        self.leave_out_of("actuator", element);
        if let Some(last) = self.left_out.last_mut().filter(|_| self.actuators) {
            last.effect = Some(effect);
        }
    }

    /// The law of an actuator; one of another form is listed as left out.
    fn drive(
        &mut self,
        element: Element<'x>,
        class: Option<&'x str>,
        on: On,
        gear: f64,
    ) -> Option<Drive> {
        let kind = element.tag_name().name();
        self.check_attributes(element);
        if self.switched_off(element, class) {
            self.leave_out_of("actuator", element);
            if let Some(last) = self.left_out.last_mut() {
                last.effect = None;
            }
            return None;
        }
        let mut built = Built::new();
        for one in self.defaults.chain(ACTUATORS, class) {
            built.apply(one, self.findings);
        }
        built.apply(element, self.findings);
        let Some((gain, bias)) = built.law() else {
            self.leave_out_drive(element, OTHER_LAW);
            return None;
        };
        let name = self.drive_name(element, &on);
        let attribute = |key: &str| {
            let own = element.attribute_node(key);
            own.or_else(|| self.defaults.of_any(ACTUATORS, class, key))
        };
        let number = |key: &str| {
            let given = attribute(key)?;
            exactly::<1>(self.findings, &given, &format!("`{key}`")).map(|[number]| number)
        };
        Some(Drive {
            name,
            kind: kind.to_owned(),
            gear,
            gain,
            bias,
            ctrl_range: self.commands(&attribute, &built, &on),
            act_range: self
                .bounds(&attribute, "actrange", "actlimited")
                .filter(|_| built.filter_type != "none"),
            force_range: match built.motor.bound() {
                Some(bound) => Some([-bound, bound]),
                None => self.bounds(&attribute, "forcerange", "forcelimited"),
            },
            lag: built.lag(),
            delay: number("delay").unwrap_or_default(),
            place: tag(element),
            on,
        })
    }

    /// The name of an actuator, or one made from that of its joint or tendon.
    fn drive_name(&mut self, element: Element<'x>, on: &On) -> String {
        if let Some(name) = element.attribute("name") {
            self.refuse_twice("actuators", name, tag(element));
            return name.to_owned();
        }
        let kind = element.tag_name().name();
        let (On::Joint(driven) | On::Tendon(driven)) = on;
        let mut name = format!("{kind}_{driven}");
        let mut count = 1;
        while !self.names.insert(("actuators", name.clone())) {
            count += 1;
            name = format!("{kind}_{driven}_{count}");
        }
        name
    }

    /// Bounds of the command: those of its own, or those of its joint.
    fn commands(
        &self,
        attribute: &dyn Fn(&str) -> Option<Attribute<'x, 'x>>,
        built: &Built,
        on: &On,
    ) -> Option<[f64; 2]> {
        if schema::disabled(self.root, "clampctrl") {
            return None;
        }
        let share = attribute("inheritrange")
            .and_then(|given| exactly::<1>(self.findings, &given, "`inheritrange`"));
        if let (Some([share]), On::Joint(joint)) = (share.filter(|[share]| *share > 0.0), on) {
            let [from, to] = self.joint(joint)?.range?;
            let (middle, half) = (f64::midpoint(from, to), share * (to - from) / 2.0);
            return Some([middle - half, middle + half]);
        }
        if built.bounded {
            let given = attribute("ctrlrange")?;
            return exactly(self.findings, &given, "a range, from to,");
        }
        self.bounds(attribute, "ctrlrange", "ctrllimited")
    }

    /// Whether actuators, or those of its group, are switched off in `option`.
    fn switched_off(&self, element: Element<'x>, class: Option<&'x str>) -> bool {
        let own = element.attribute("group");
        let of_class = self.defaults.of_any(ACTUATORS, class, "group");
        let group = own.or(of_class.map(|given| given.value())).unwrap_or("0");
        let off = children(self.root, "option")
            .filter_map(|option| option.attribute("actuatorgroupdisable"));
        schema::disabled(self.root, "actuation")
            || off
                .last()
                .is_some_and(|groups| groups.split_ascii_whitespace().any(|one| one == group))
    }

    /// Refuses attributes that the kind does not have.
    fn check_attributes(&self, element: Element<'x>) {
        let kind = element.tag_name().name();
        let Some((_, own)) = OWN.iter().find(|(name, _)| *name == kind) else {
            return;
        };
        let known = || {
            let all = [COMMON, own].into_iter();
            all.flat_map(str::split_ascii_whitespace)
        };
        for attribute in element.attributes() {
            let key = attribute.name();
            if !known().any(|one| one == key) {
                self.findings.error(
                    Code::UnknownKey,
                    attribute.range(),
                    format!("`{kind}` has no attribute `{}`", appell_spec::shown(key)),
                    did_you_mean(key, known(), || {
                        "MuJoCo 4.0 has none of that name: remove it, or say it otherwise"
                            .to_owned()
                    }),
                );
            }
        }
    }
}

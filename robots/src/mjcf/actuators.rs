//! Actuators: their laws, and the inertia and damping that they add to joints and tendons.

use std::collections::BTreeMap;

use appell_spec::Code;

use crate::model::{Drive, LeftOut, On, Tendon};
use crate::rotation::is_zero;
use crate::xml::{Element, children, elements, tag};

use super::Reader;
use super::defaults::Given;
use super::law::Law;
use super::schema::{self, ACTUATORS, has};

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
/// Kinds that follow no law of the form gain × command + bias.
const OTHER_LAW: &str = "its law has no counterpart, and it exerts no force";
/// Other transmissions, and drives of joints without an axis.
const OTHER_WAY: &str = "it drives no hinge, slide or fixed tendon, and exerts no force";
const COMPENSATION: &str =
    "its gravity compensation is no force of actuators, and not bounded together with them";
const SHARED: &str = "the sum of the forces of several actuators on the tendon is not bounded";

/// Attributes that are read together with actuators.
const READ: &str = "joint/actuatorfrcrange joint/actuatorfrclimited fixed/actuatorfrcrange fixed/actuatorfrclimited \
                    tendon/actuatorfrcrange tendon/actuatorfrclimited flag/actuation option/actuatorgroupdisable";

impl<'x> Reader<'x, '_> {
    /// Bounds, where an attribute gives them and another one, or the order of the two, says that they hold.
    pub(super) fn bounds(
        &self,
        given: &Given<'_, 'x>,
        range: &str,
        limited: &str,
    ) -> Option<[f64; 2]> {
        if !self.actuators {
            return None;
        }
        let [from, to] = given.exactly(range, "a range, from to,")?;
        let holds = match given.word(limited) {
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
            let given = self.given(element, ACTUATORS, class);
            let gear = given.numbers("gear");
            let gear = gear.and_then(|all| all.first().copied()).unwrap_or(1.0);
            let armature = given
                .number("armature")
                .map_or(0.0, |one| one * gear * gear);
            let damping = given.polynomial("damping").map(|one| one * gear * gear);
            // Of several transmissions, the last one holds.
            let ways = "body site cranksite tendon jointinparent joint";
            let mut ways = ways.split_ascii_whitespace();
            let way = ways.find(|key| element.attribute(*key).is_some());
            let target = way.and_then(|key| element.attribute(key));
            let link = target.filter(|_| matches!(way, Some("joint" | "jointinparent")));
            let link = link.and_then(|name| self.joint_links.get(name).copied());
            let tendon = target.filter(|_| way == Some("tendon"));
            let tendon = tendon.and_then(|name| by_name.get(name).copied());
            let (on, range, inertia, resistance) = if let Some(link) = link
                && let Some(joint) = &mut self.links[link].joint
            {
                let on = On::Joint(joint.name.clone());
                (on, joint.range, &mut joint.armature, &mut joint.damping)
            } else if let Some(tendon) = tendon {
                let tendon = &mut tendons[tendon];
                let on = On::Tendon(tendon.name.clone());
                (on, tendon.range, &mut tendon.armature, &mut tendon.damping)
            } else {
                if armature != 0.0 || !is_zero(damping) {
                    let message = "inertia and damping of this drive are left out";
                    let help = "they are read where it drives a hinge, a slide or a fixed tendon";
                    self.findings
                        .warning(Code::NotAllowedHere, tag(element), message, help);
                }
                self.leave_out_drive(element, OTHER_WAY);
                continue;
            };
            *inertia += armature;
            for (own, more) in resistance.iter_mut().zip(damping) {
                *own += more;
            }
            if self.actuators {
                drives.extend(self.drive(element, class, on, gear, range));
            } else {
                self.leave_out_of("actuator", element);
            }
        }
        if !self.actuators {
            return None;
        }
        // What these say is read, except of spatial tendons.
        self.left_out.retain(|one| !has(READ, &one.what));
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
        range: Option<[f64; 2]>,
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
        let [_, law] = Law::of(element, class, &self.defaults, self.findings);
        let Some((gain, bias)) = law.affine() else {
            self.leave_out_drive(element, OTHER_LAW);
            return None;
        };
        let name = self.drive_name(element, &on);
        let given = self.given(element, ACTUATORS, class);
        Some(Drive {
            name,
            kind: kind.to_owned(),
            gear,
            gain,
            bias,
            ctrl_range: self.commands(&given, &law, range),
            act_range: self
                .bounds(&given, "actrange", "actlimited")
                .filter(|_| law.filter_type != "none"),
            force_range: match law.motor.bound() {
                Some(bound) => Some([-bound, bound]),
                None => self.bounds(&given, "forcerange", "forcelimited"),
            },
            lag: law.lag(),
            delay: given.number("delay").unwrap_or_default(),
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

    /// Bounds of the command: those of its own, or those of its joint or tendon.
    fn commands(
        &self,
        given: &Given<'_, 'x>,
        law: &Law,
        length_range: Option<[f64; 2]>,
    ) -> Option<[f64; 2]> {
        if schema::disabled(self.root, "clampctrl") {
            return None;
        }
        let share = given.number("inheritrange");
        if let Some(share) = share.filter(|share| *share > 0.0) {
            let [from, to] = length_range?;
            let (middle, half) = (f64::midpoint(from, to), share * (to - from) / 2.0);
            return Some([middle - half, middle + half]);
        }
        if law.bounded {
            return given.exactly("ctrlrange", "a range, from to,");
        }
        self.bounds(given, "ctrlrange", "ctrllimited")
    }

    /// Whether actuators, or those of its group, are switched off in `option`.
    fn switched_off(&self, element: Element<'x>, class: Option<&'x str>) -> bool {
        let given = self.given(element, ACTUATORS, class);
        let group = given.word("group").unwrap_or("0");
        let off = children(self.root, "option")
            .filter_map(|option| option.attribute("actuatorgroupdisable"));
        schema::disabled(self.root, "actuation")
            || off.last().is_some_and(|groups| has(groups, group))
    }

    /// Refuses attributes that the kind does not have.
    fn check_attributes(&self, element: Element<'x>) {
        let kind = element.tag_name().name();
        let Some((_, own)) = OWN.iter().find(|(name, _)| *name == kind) else {
            return;
        };
        let all = [COMMON, own];
        for attribute in element.attributes() {
            if !all.iter().any(|words| has(words, attribute.name())) {
                let known = all.into_iter().flat_map(str::split_ascii_whitespace);
                schema::unknown_attribute(kind, &attribute, known, self.findings);
            }
        }
    }
}

//! Numbers of joints, springs, and what encoders read.

use appell_spec::Code;

use crate::model::{Joint, Motion};
use crate::xml::{Element, children, no_such, tag};

use super::bytes::{number, numbers, same};
use super::change::{Amount, Number, Refused, refused};
use super::sheet::Sheet;

/// The name of joints in classes.
const JOINT: &str = "joint";

impl<'x> Sheet<'x, '_> {
    /// A joint and its element.
    pub(super) fn joint(&self, name: &str) -> Result<(Joint, Element<'x>), Refused> {
        let joints = || {
            self.robot
                .links
                .iter()
                .filter_map(|link| link.joint.as_ref())
        };
        let found = joints().find(|joint| joint.name == name);
        let found = found.and_then(|joint| Some((joint.clone(), self.at(&joint.place)?)));
        let (joint, element) = found.ok_or_else(|| {
            let known = joints().map(|joint| joint.name.as_str());
            let help = "name a joint of the file";
            no_such("joint", name, tag(self.root), known, help)
        })?;
        if element.has_tag_name("freejoint") {
            let message = format!("joint `{name}` is a `freejoint`, which has no numbers");
            let help = "write it as `<joint type=\"free\"/>`";
            return Err(refused(Code::NotAllowedHere, tag(element), message, help));
        }
        Ok((joint, element))
    }

    /// A joint with an axis and its element.
    pub(super) fn joint_with_axis(&self, name: &str) -> Result<(Joint, Element<'x>), Refused> {
        let (joint, element) = self.joint(name)?;
        if joint.motion.has_axis() {
            return Ok((joint, element));
        }
        let message = format!("joint `{name}` is no hinge and no slide");
        let help = "only these have one position";
        Err(refused(Code::NotAllowedHere, tag(element), message, help))
    }

    /// A position of a joint, in the unit of the file.
    pub(super) fn in_file_unit(&self, joint: &Joint, position: f64) -> f64 {
        if joint.motion == Motion::Turning && self.compiler.angles.degrees {
            position.to_degrees()
        } else {
            position
        }
    }

    /// A position of a joint in SI, from the unit of the file.
    fn in_si(&self, joint: &Joint, position: f64) -> f64 {
        match joint.motion {
            Motion::Turning => self.compiler.angles.radians(position),
            _ => position,
        }
    }

    pub(super) fn joint_number(
        &mut self,
        name: &str,
        attribute: Number,
        amount: Amount,
    ) -> Result<(), Refused> {
        let key = match attribute {
            Number::Damping => "damping",
            Number::Frictionloss => "frictionloss",
            Number::Armature => "armature",
            Number::Springref => "springref",
            Number::Ref => "ref",
            _ => "stiffness",
        };
        if matches!(attribute, Number::Springref | Number::Ref) {
            let (joint, element) = self.joint_with_axis(name)?;
            let all = self.numbers(element, JOINT, key)?;
            let before = first(all.as_deref());
            let after = amount.of(self.in_si(&joint, before));
            if same(after, self.in_si(&joint, before)) {
                return Ok(());
            }
            return self.set(element, key, number(self.in_file_unit(&joint, after)));
        }
        let (joint, element) = self.joint(name)?;
        if matches!(attribute, Number::Damping | Number::Stiffness) {
            self.write_out_springdamper(&joint, element)?;
        }
        let mut all = self.numbers(element, JOINT, key)?.unwrap_or_default();
        let before = first(Some(&all));
        let carried = match attribute {
            Number::Damping | Number::Armature => self.carried(name, key)?,
            _ => 0.0,
        };
        let whole = self.at_least_zero(name, key, amount.of(before + carried));
        if same(whole, before + carried) {
            return Ok(());
        }
        let after = (whole - carried).max(0.0);
        if whole < carried {
            self.scale_carried(name, key, whole / carried)?;
        }
        if same(after, before) {
            return Ok(());
        }
        self.reshaped |= attribute == Number::Armature;
        all.resize(all.len().max(1), 0.0);
        all[0] = after;
        self.set(element, key, numbers(&all))
    }

    /// Zero for a negative number, with a sentence.
    pub(super) fn at_least_zero(&mut self, name: &str, key: &str, wanted: f64) -> f64 {
        if wanted < 0.0 {
            let words = format!("{name}: {key} would be {}, and is 0", number(wanted));
            self.said.push(words);
        }
        wanted.max(0.0)
    }

    /// Writes out the numbers that are computed from the inertias of the file, where these change.
    pub(super) fn write_settled(&mut self) -> Result<(), Refused> {
        if !self.reshaped {
            return Ok(());
        }
        let joints = (self.robot.links.iter()).filter_map(|link| link.joint.as_ref());
        let settled = joints.filter(|joint| joint.settles.is_some());
        for joint in settled.cloned().collect::<Vec<Joint>>() {
            if let Some(element) = self.at(&joint.place) {
                self.write_out_springdamper(&joint, element)?;
            }
        }
        self.write_damping_ratios()
    }

    /// Replaces `springdamper` of a joint by the stiffness and the damping that are computed from it.
    fn write_out_springdamper(
        &mut self,
        joint: &Joint,
        element: Element<'x>,
    ) -> Result<(), Refused> {
        let Some(given) = self.numbers(element, JOINT, "springdamper")? else {
            return Ok(());
        };
        if given.iter().any(|one| *one <= 0.0) {
            return Ok(());
        }
        self.remove(element, "springdamper")?;
        if self.inherited(element, JOINT, "springdamper").is_some() {
            self.set(element, "springdamper", "0 0")?;
        }
        self.set(element, "stiffness", numbers(&joint.stiffness[..1]))?;
        self.set(element, "damping", numbers(&joint.damping[..1]))
    }

    pub(super) fn spring(
        &mut self,
        name: &str,
        stiffness: f64,
        relaxed_at: f64,
    ) -> Result<(), Refused> {
        if stiffness == 0.0 {
            return Ok(());
        }
        let (joint, element) = self.joint_with_axis(name)?;
        self.write_out_springdamper(&joint, element)?;
        let own = self
            .numbers(element, JOINT, "stiffness")?
            .unwrap_or_default();
        let place = self.numbers(element, JOINT, "springref")?;
        let place = self.in_si(&joint, first(place.as_deref()));
        if own.iter().skip(1).any(|factor| *factor != 0.0) && !same(place, relaxed_at) {
            let message = format!("the spring of joint `{name}` is no linear one");
            let help = "add the other spring as a tendon of this joint";
            return Err(refused(Code::NotAllowedHere, tag(element), message, help));
        }
        let before = first(Some(&own));
        let sum = before + stiffness;
        if sum < 0.0 {
            let message = format!("the stiffness of joint `{name}` would be {}", number(sum));
            let help = "MJCF has springs with a positive stiffness only";
            return Err(refused(Code::NotAllowedHere, tag(element), message, help));
        }
        let mut all = own;
        all.resize(all.len().max(1), 0.0);
        all[0] = sum;
        self.set(element, "stiffness", numbers(&all))?;
        if sum > 0.0 {
            let relaxed = (before * place + stiffness * relaxed_at) / sum;
            if !same(relaxed, place) {
                let relaxed = self.in_file_unit(&joint, relaxed);
                self.set(element, "springref", number(relaxed))?;
            }
        }
        Ok(())
    }

    pub(super) fn reading(&mut self, name: &str, bias: f64) -> Result<(), Refused> {
        if bias == 0.0 {
            return Ok(());
        }
        let (joint, element) = self.joint_with_axis(name)?;
        let shift = self.in_file_unit(&joint, bias);
        let moved = |all: Option<Vec<f64>>| -> Vec<f64> {
            let all = all.unwrap_or_else(|| vec![0.0]);
            all.into_iter().map(|one| one + shift).collect()
        };
        let zero = self.numbers(element, JOINT, "ref")?;
        self.set(element, "ref", numbers(&moved(zero)))?;
        // Bounds of commands are bounds of readings, and stay.
        self.write_inherited_ranges(name)?;
        if let Some(range) = self.numbers(element, JOINT, "range")?
            && range.iter().any(|end| *end != 0.0)
        {
            self.set(element, "range", numbers(&moved(Some(range))))?;
        }
        let relaxed = self.numbers(element, JOINT, "springref")?;
        let pulls = self.numbers(element, JOINT, "stiffness")?;
        let pulls = pulls.is_some_and(|all| all.iter().any(|factor| *factor != 0.0));
        if relaxed.is_some() || pulls || joint.settles.is_some() {
            self.set(element, "springref", numbers(&moved(relaxed)))?;
        }
        self.move_tendons(element, bias)
    }

    /// Moves the lengths of fixed tendons along that are given for a joint with another zero.
    fn move_tendons(&mut self, joint: Element<'x>, bias: f64) -> Result<(), Refused> {
        let Some(name) = joint.attribute("name") else {
            return Ok(());
        };
        let tendons = children(self.root, "tendon");
        let tendons: Vec<Element<'x>> = tendons.flat_map(|all| children(all, "fixed")).collect();
        for tendon in tendons {
            let terms = children(tendon, JOINT);
            let mut rate = 0.0;
            for term in terms.filter(|term| term.attribute("joint") == Some(name)) {
                let factor = term.attribute("coef").map_or(Ok(1.0), str::parse);
                rate += factor.unwrap_or(1.0);
            }
            for key in ["range", "springlength"] {
                let Some(all) = self.numbers(tendon, "tendon", key)? else {
                    continue;
                };
                // −1 is the length at which all springs of the joints are relaxed.
                let by_joints = all.first().is_some_and(|one| same(*one, -1.0));
                let counts = all.iter().any(|end| *end != 0.0) && !by_joints;
                if rate != 0.0 && (counts || key == "springlength" && !by_joints) {
                    let moved: Vec<f64> = all.iter().map(|one| one + rate * bias).collect();
                    self.set(tendon, key, numbers(&moved))?;
                }
            }
        }
        Ok(())
    }
}

/// The first of several numbers; zero where there is none.
fn first(all: Option<&[f64]>) -> f64 {
    all.and_then(|all| all.first().copied()).unwrap_or_default()
}

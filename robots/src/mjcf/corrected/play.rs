//! Backlash: a second joint behind that of the drive.

use crate::xml::tag;

use super::bytes::{escaped, number, numbers};
use super::sheet::{Sheet, read};
use super::{Refused, refused};
use appell_spec::Code;

/// Attributes of a joint that its second one shares.
const SHARED: [&str; 4] = ["class", "type", "pos", "axis"];
/// Attributes that are zero at the second joint, where its class has another value.
const ZERO: [(&str, &str); 9] = [
    ("armature", "0"),
    ("damping", "0"),
    ("frictionloss", "0"),
    ("stiffness", "0"),
    ("springref", "0"),
    ("springdamper", "0 0"),
    ("ref", "0"),
    ("margin", "0"),
    ("actuatorfrcrange", "0 0"),
];
/// Time constant of the flanks, in s.
const FLANK: f64 = 0.002;

impl Sheet<'_, '_> {
    pub(super) fn play(&mut self, name: &str, gap: f64) -> Result<(), Refused> {
        let (joint, element) = self.joint_with_axis(name)?;
        let gap = self.at_least_zero(name, "backlash", gap);
        if gap == 0.0 {
            return Ok(());
        }
        let half = self.in_file_unit(&joint, 0.5 * gap);
        let new = self.free_name("joint", &format!("{name}_play"));
        let mut text = format!("<joint name=\"{new}\"");
        let mut write = |key: &str, value: &str| {
            let value = escaped(value);
            text.extend([" ", key, "=\"", value.as_str(), "\""]);
        };
        for key in SHARED {
            if let Some(value) = element.attribute(key) {
                write(key, value);
            }
        }
        if !self.compiler.autolimits || self.inherited(element, "joint", "limited").is_some() {
            write("limited", "true");
        }
        write("range", &numbers(&[-half, half]));
        let flank = FLANK.max(2.0 * self.timestep()?);
        write("solreflimit", &format!("{} 1", number(flank)));
        for (key, zero) in ZERO {
            let inherited = self.inherited(element, "joint", key);
            let inherited = inherited.map(|given| read(&given, element, key));
            if inherited
                .transpose()?
                .is_some_and(|all| all.iter().any(|one| *one != 0.0))
            {
                write(key, zero);
            }
        }
        text.push_str("/>");
        if self
            .numbers(element, "joint", "armature")?
            .is_none_or(|all| all == [0.0])
        {
            let message = format!("the drive of joint `{name}` has no inertia");
            let help = "backlash needs an `armature` of the joint";
            return Err(refused(Code::NotAllowedHere, tag(element), message, help));
        }
        self.said.push(format!(
            "joint {new}: new after {name}, range {}",
            numbers(&[-half, half])
        ));
        self.insert_after(element, &text)
    }
}

//! Joints that become rigid on request.

use std::collections::BTreeMap;
use std::str::FromStr;

use appell_spec::did_you_mean;

use crate::model::{Motion, Robot};

/// A joint that becomes rigid.
#[derive(Debug, Clone, PartialEq)]
pub struct Lock {
    /// Its name in the file.
    pub joint: String,
    /// The constant coordinate, in rad or m; `None` as drawn in the file.
    pub value: Option<f64>,
}

impl FromStr for Lock {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let split = text.rsplit_once('=');
        let (joint, value) = split.map_or((text, None), |(joint, value)| (joint, Some(value)));
        let value = value.map(|value| {
            let number = value.trim().parse::<f64>().ok();
            let number = number.filter(|number| number.is_finite());
            let shown = appell_spec::shown(value);
            number.ok_or_else(|| format!("`{shown}` is not a number; write rad or m"))
        });
        let joint = joint.trim();
        if joint.is_empty() {
            return Err("write the name of a joint, or JOINT=VALUE".to_owned());
        }
        Ok(Self {
            joint: joint.to_owned(),
            value: value.transpose()?,
        })
    }
}

/// Makes joints rigid: their links are fixed to the parents. The error is a sentence.
pub(crate) fn lock(robot: &mut Robot, locks: &[Lock]) -> Result<(), String> {
    let mut values: BTreeMap<String, f64> = BTreeMap::new();
    for one in locks {
        let named = |joint: &str| joint == one.joint;
        let found = (robot.links.iter_mut())
            .find(|link| link.joint.as_ref().is_some_and(|joint| named(&joint.name)));
        let Some(link) = found else {
            let joints = robot.links.iter().filter_map(|link| link.joint.as_ref());
            let known = joints.map(|joint| joint.name.as_str());
            let name = appell_spec::shown(&one.joint);
            let help = did_you_mean(&one.joint, known, || "name a joint that moves".to_owned());
            return Err(if values.contains_key(&one.joint) {
                format!("`{name}` is locked twice")
            } else {
                format!("there is no joint `{name}`; {help}")
            });
        };
        let Some(joint) = link.joint.clone() else {
            continue;
        };
        if !joint.motion.has_axis() && one.value.is_some() {
            let name = appell_spec::shown(&one.joint);
            return Err(format!(
                "joint `{name}` has several coordinates; lock it without a value, as it is drawn"
            ));
        }
        let value = one.value.unwrap_or(joint.zero);
        link.pose = link.moved(value - joint.zero);
        link.joint = None;
        if matches!(joint.motion, Motion::Turning | Motion::Sliding) {
            values.insert(joint.name, value);
        }
    }
    robot.driven.retain(|joint| !values.contains_key(joint));
    let tendons = robot.tendons.iter_mut().map(|tendon| &mut tendon.length);
    let couplings = robot.couplings.iter_mut();
    let couplings =
        couplings.flat_map(|one| [&mut one.follows].into_iter().chain(one.other.as_mut()));
    for sum in tendons.chain(couplings) {
        sum.fix(&values);
    }
    Ok(())
}

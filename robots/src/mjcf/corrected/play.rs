//! Backlash: a second joint behind that of the drive.

use crate::assembly::Configuration;
use crate::kinematics::Freedom;
use crate::mass;
use crate::xml::Element;

use super::bytes::{escaped, number, numbers};
use super::change::Refused;
use super::sheet::{Sheet, read};

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
/// Time constant of the flanks, in s; `MuJoCo` has none below two steps.
const FLANK: f64 = 0.002;
/// Inertia of a drive whose own is not known, relative to that of all that it moves.
const LIGHT: f64 = 0.02;

impl<'x> Sheet<'x, '_> {
    pub(super) fn play(&mut self, name: &str, gap: f64) -> Result<(), Refused> {
        self.joint_with_axis(name)?;
        let gap = self.at_least_zero(name, "backlash", gap);
        let known = self.plays.iter_mut().find(|(joint, _)| joint == name);
        match known {
            Some((_, own)) => *own += gap,
            None if gap > 0.0 => self.plays.push((name.to_owned(), gap)),
            None => {}
        }
        Ok(())
    }

    /// Writes the second joints.
    pub(super) fn write_plays(&mut self) -> Result<(), Refused> {
        for (name, gap) in self.plays.clone() {
            self.write_play(&name, gap)?;
        }
        Ok(())
    }

    fn write_play(&mut self, name: &str, gap: f64) -> Result<(), Refused> {
        let (joint, element) = self.joint_with_axis(name)?;
        self.give_inertia(name, element)?;
        let half = self.in_file_unit(&joint, 0.5 * gap);
        let range = numbers(&[-half, half]);
        let new = self.free_name("joint", &format!("{name}_play"));
        let mut attributes = vec![("name", new.clone())];
        let shared = SHARED
            .iter()
            .filter_map(|key| Some((*key, element.attribute(*key)?)));
        attributes.extend(shared.map(|(key, value)| (key, value.to_owned())));
        let limited = self.inherited(element, "joint", "limited");
        if !self.compiler.autolimits || limited.is_some_and(|word| word != "auto") {
            attributes.push(("limited", "true".to_owned()));
        }
        attributes.push(("range", range.clone()));
        let flank = FLANK.max(2.0 * self.timestep()?);
        attributes.push(("solreflimit", format!("{} 1", number(flank))));
        for (key, zero) in ZERO {
            let inherited = self.inherited(element, "joint", key);
            let inherited = inherited.map(|given| read(&given, element, key));
            let inherited = inherited.transpose()?.unwrap_or_default();
            if inherited.iter().any(|one| *one != 0.0) {
                attributes.push((key, zero.to_owned()));
            }
        }
        let attributes = attributes.into_iter();
        let attributes = attributes.map(|(key, value)| format!(" {key}=\"{}\"", escaped(&value)));
        let attributes: String = attributes.collect();
        let words = format!("joint {new}: new after {name}, range {range}");
        self.said.push(words);
        self.insert_after(element, &format!("<joint{attributes}/>"))
    }

    /// Gives the drive of a joint a small inertia where it has none: between drive and load no body has any.
    fn give_inertia(&mut self, name: &str, element: Element<'x>) -> Result<(), Refused> {
        let number_of = |key: &str| -> Result<f64, Refused> {
            Ok(self.first(element, "joint", key)?.unwrap_or_default())
        };
        if number_of("armature")? + self.carried(name, "armature")? > 0.0 {
            return Ok(());
        }
        let links = &self.robot.links;
        let at = Freedom::all(links).into_iter().position(|freedom| {
            let joint = links[freedom.link].joint.as_ref();
            joint.is_some_and(|joint| joint.name == name)
        });
        let poses = Configuration::new(links, |_| 0.0).poses(links);
        let moved = at.map(|at| mass::matrix(links, &self.robot.tendons, &poses).entries[at][at]);
        // The steps of the simulation follow a drive that settles no faster than in one of them.
        let damping = self.feedback(name)? + self.carried(name, "damping")?;
        let followed = self.timestep()? * (damping + number_of("damping")?);
        let light = followed.max(LIGHT * moved.unwrap_or_default());
        let words = format!(
            "joint {name}: the drive has no inertia in the file; backlash needs one, armature {} is small",
            number(light)
        );
        self.said.push(words);
        self.reshaped = true;
        self.set(element, "armature", number(light))
    }
}

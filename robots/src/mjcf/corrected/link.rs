//! Changes of a URDF file: inertias of links, damping and friction of joints, payloads.

use crate::inertia::{Inertia, within_triangle};
use crate::rotation::Vector;
use crate::xml::{Element, child};

use super::body::Group;
use super::bytes::{number, numbers, same};
use super::change::{Amount, Number, Refused};
use super::sheet::Sheet;

/// Attributes of `<dynamics>`.
const DYNAMICS: [&str; 2] = ["damping", "friction"];
/// Entries of an inertia, in the order in which they are computed.
const ENTRIES: [&str; 6] = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
const ORIGIN: &str = "origin";

impl<'x> Sheet<'x, '_> {
    /// A number of an element; zero where it is missing.
    fn number_in(&self, element: Option<Element<'x>>, key: &str) -> Result<f64, Refused> {
        let first = element.map(|element| self.first(element, "", key));
        Ok(first.transpose()?.flatten().unwrap_or_default())
    }

    /// Changes the damping or the dry friction of a joint.
    pub(super) fn dynamics(
        &mut self,
        name: &str,
        attribute: Number,
        amount: Amount,
    ) -> Result<(), Refused> {
        let (_, joint) = self.joint_with_axis(name)?;
        let known = self.dynamics.iter().position(|(own, _)| *own == joint);
        let index = if let Some(index) = known {
            index
        } else {
            let own = child(joint, "dynamics");
            let [damping, friction] = DYNAMICS.map(|key| self.number_in(own, key));
            self.dynamics.push((joint, [damping?, friction?]));
            self.dynamics.len() - 1
        };
        let place = usize::from(attribute == Number::Frictionloss);
        let before = self.dynamics[index].1[place];
        let after = self.at_least_zero(name, DYNAMICS[place], amount.of(before));
        self.dynamics[index].1[place] = after;
        Ok(())
    }

    /// Writes the damping and the friction of joints.
    pub(super) fn write_dynamics(&mut self) -> Result<(), Refused> {
        for (joint, after) in std::mem::take(&mut self.dynamics) {
            let own = child(joint, "dynamics");
            let mut new = String::new();
            for (key, after) in DYNAMICS.into_iter().zip(after) {
                if same(self.number_in(own, key)?, after) {
                    continue;
                }
                match own {
                    Some(own) => self.set(own, key, number(after))?,
                    None => new = format!("{new} {key}=\"{}\"", number(after)),
                }
            }
            if !new.is_empty() {
                let name = joint.attribute("name").unwrap_or_default();
                self.said
                    .push(format!("joint {name}: dynamics{}", new.replace('"', "")));
                self.insert_into(joint, &format!("<dynamics{new}/>"), false)?;
            }
        }
        Ok(())
    }

    /// A point mass as a link of its own, by a fixed joint.
    pub(super) fn payload_link(
        &mut self,
        name: &str,
        link: Element<'x>,
        mass: f64,
        at: Vector,
    ) -> Result<(), Refused> {
        let payload = self.free_name("link", "payload");
        let joint = self.free_name("joint", &format!("{payload}_joint"));
        let (mass, place) = (number(mass), numbers(&at));
        self.said.push(format!(
            "link {payload}: new on {name} at {place}, mass {mass}"
        ));
        let inertial = inertial(&mass, &[0.0; 3], &[0.0; 6]);
        self.insert_after(link, &format!("<link name=\"{payload}\">{inertial}</link>"))?;
        let name = super::bytes::escaped(name);
        let ends = format!("<parent link=\"{name}\"/><child link=\"{payload}\"/>");
        let origin = format!("<origin xyz=\"{place}\" rpy=\"0 0 0\"/>");
        self.insert_after(
            link,
            &format!("<joint name=\"{joint}\" type=\"fixed\">{ends}{origin}</joint>"),
        )
    }

    /// Changes numbers of `<inertial>`, in its own axes.
    pub(super) fn write_link_numbers(
        &mut self,
        inertial: Element<'x>,
        group: &Group,
    ) -> Result<(), Refused> {
        let (before, after) = (group.before, group.after);
        if !same(before.mass, after.mass) {
            self.set_in(inertial, "mass", &[("value", number(after.mass))])?;
        }
        if numbers(&before.centre) != numbers(&after.centre) {
            self.set_in(inertial, ORIGIN, &[("xyz", numbers(&after.centre))])?;
        }
        let inertia = child(inertial, "inertia").filter(|_| !same(group.factor, 1.0));
        for key in ENTRIES {
            let entry = self.number_in(inertia, key)?;
            if let Some(inertia) = inertia.filter(|_| entry != 0.0) {
                self.set(inertia, key, number(entry * group.factor))?;
            }
        }
        Ok(())
    }

    /// Writes all numbers of the inertia of a link, in its axes.
    pub(super) fn write_link(&mut self, link: usize, own: Inertia) -> Result<(), Refused> {
        let element = self.body(link)?;
        let tensor = within_triangle(own.tensor);
        let (mass, place) = (number(own.mass), numbers(&own.centre));
        let Some(inside) = child(element, "inertial") else {
            let name = &self.robot.links[link].name;
            self.said.push(format!(
                "link {name}: inertial written out, mass {mass} at {place}"
            ));
            let text = inertial(&mass, &own.centre, &tensor);
            return self.insert_into(element, &text, true);
        };
        self.set_in(inside, "mass", &[("value", mass)])?;
        let origin = [("xyz", place), ("rpy", "0 0 0".to_owned())];
        self.set_in(inside, ORIGIN, &origin)?;
        let entries: Vec<(&'static str, String)> =
            ENTRIES.into_iter().zip(tensor.map(number)).collect();
        self.set_in(inside, "inertia", &entries)
    }

    /// Sets attributes of a child of `<inertial>`, which is inserted if there is none.
    fn set_in(
        &mut self,
        inertial: Element<'x>,
        name: &'static str,
        values: &[(&'static str, String)],
    ) -> Result<(), Refused> {
        if let Some(own) = child(inertial, name) {
            for (key, value) in values {
                self.set(own, key, value.clone())?;
            }
            return Ok(());
        }
        let values = values
            .iter()
            .map(|(key, value)| format!(" {key}=\"{value}\""));
        let text = format!("<{name}{}/>", values.collect::<String>());
        self.insert_into(inertial, &text, true)
    }
}

/// `<inertial>` of a link.
fn inertial(mass: &str, centre: &Vector, tensor: &[f64; 6]) -> String {
    let entries = ENTRIES.into_iter().zip(tensor);
    let entries = entries.map(|(key, entry)| format!(" {key}=\"{}\"", number(*entry)));
    format!(
        "<inertial><origin xyz=\"{}\" rpy=\"0 0 0\"/><mass value=\"{mass}\"/><inertia{}/></inertial>",
        numbers(centre),
        entries.collect::<String>()
    )
}

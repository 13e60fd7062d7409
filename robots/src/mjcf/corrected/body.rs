//! Masses, centres of mass, inertias and payloads of bodies.

use appell_spec::Code;

use crate::format::Format;
use crate::inertia::{Inertia, within_triangle};
use crate::model::Robot;
use crate::options::Options;
use crate::rotation::{Pose, Vector};
use crate::xml::{Element, Findings, children, no_such, tag};

use super::super::compiler::InertiaFrom;
use super::bytes::{number, numbers, same};
use super::change::{Amount, Refused, refused};
use super::sheet::Sheet;

/// Orientations of an inertia.
const ORIENTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Attributes of `<compiler>` and `<inertial>`.
const TOTAL: &str = "settotalmass";
const FROM_GEOMS: &str = "inertiafromgeom";
const DIAGONAL: &str = "diaginertia";
const FULL: &str = "fullinertia";

/// Bodies that are fixed to each other: one mass, one centre, one inertia.
pub(super) struct Group {
    /// The link that has the joint.
    pub(super) head: usize,
    /// Before the changes and after them, in the frame of the head.
    pub(super) before: Inertia,
    pub(super) after: Inertia,
    /// The factor of the moments of inertia, while nothing else changes them.
    pub(super) factor: f64,
    /// Whether more than the factor changes the moments of inertia.
    pub(super) reshaped: bool,
}

impl<'x> Sheet<'x, '_> {
    /// The link of a body.
    fn link(&self, name: &str) -> Result<usize, Refused> {
        let links = || (self.robot.links.iter().enumerate()).filter(|(_, link)| link.written);
        let found = links().find(|(_, link)| link.name == name);
        found.map(|(index, _)| index).ok_or_else(|| {
            let known = links().map(|(_, link)| link.name.as_str());
            let help = "name a body of the file";
            no_such("body", name, tag(self.root), known, help)
        })
    }

    /// The link with a joint to which a link is fixed, and its pose in that one.
    fn head(&self, link: usize) -> Option<(usize, Pose)> {
        let (mut at, mut pose) = (link, Pose::IDENTITY);
        while self.robot.links[at].joint.is_none() {
            pose = self.robot.links[at].pose.then(pose);
            at = self.robot.links[at].parent?;
        }
        Some((at, pose))
    }

    /// The element of a link.
    pub(super) fn body(&self, link: usize) -> Result<Element<'x>, Refused> {
        let link = &self.robot.links[link];
        self.at(&link.place).ok_or_else(|| {
            let message = format!("body `{}` has no element", link.name);
            let help = "name a body of the file";
            refused(Code::UnknownReference, tag(self.root), message, help)
        })
    }

    /// The group of a body, and the pose of the body in its frame.
    fn group(&mut self, name: &str) -> Result<(usize, Pose), Refused> {
        let link = self.link(name)?;
        let Some((head, pose)) = self.head(link) else {
            let message = format!("body `{name}` does not move");
            let help = "its mass changes nothing: name a body with a joint";
            let place = tag(self.body(link)?);
            return Err(refused(Code::NotAllowedHere, place, message, help));
        };
        let known = self.groups.iter().position(|group| group.head == head);
        let index = known.unwrap_or_else(|| {
            let whole = self.members(head).into_iter();
            let whole = whole.fold(Inertia::NONE, |sum, (member, pose)| {
                sum.with(&self.robot.links[member].inertia.placed(pose))
            });
            self.groups.push(Group {
                head,
                before: whole,
                after: whole,
                factor: 1.0,
                reshaped: false,
            });
            self.groups.len() - 1
        });
        Ok((index, pose))
    }

    /// The links of a group with their poses, the head first.
    fn members(&self, head: usize) -> Vec<(usize, Pose)> {
        let links = head..self.robot.links.len();
        let of_it = links.filter_map(|link| {
            let (own, pose) = self.head(link)?;
            (own == head).then_some((link, pose))
        });
        of_it.collect()
    }

    pub(super) fn mass(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let (index, _) = self.group(name)?;
        let before = self.groups[index].after.mass;
        self.groups[index].after.mass = self.at_least_zero(name, "mass", amount.of(before));
        Ok(())
    }

    pub(super) fn centre(&mut self, name: &str, amounts: [Amount; 3]) -> Result<(), Refused> {
        let (index, pose) = self.group(name)?;
        let group = &mut self.groups[index];
        let before = pose.inverse().of(group.after.centre);
        let after = [0, 1, 2].map(|k| amounts[k].of(before[k]));
        if numbers(&after) != numbers(&before) {
            group.after.centre = pose.of(after);
        }
        Ok(())
    }

    pub(super) fn inertia_times(&mut self, name: &str, factor: f64) -> Result<(), Refused> {
        let (index, _) = self.group(name)?;
        let factor = self.at_least_zero(name, "factor of its inertia", factor);
        let group = &mut self.groups[index];
        group.factor *= factor;
        group.after.tensor = group.after.tensor.map(|entry| entry * factor);
        Ok(())
    }

    pub(super) fn payload(&mut self, name: &str, mass: f64, at: Vector) -> Result<(), Refused> {
        if mass == 0.0 {
            return Ok(());
        }
        let (index, pose) = self.group(name)?;
        self.reshaped = true;
        if mass < 0.0 || self.compiler.adjusts() {
            // A body of its own has no negative mass, and its mass and inertia would be raised to their bounds.
            let point = Inertia {
                mass,
                centre: pose.of(at),
                tensor: [0.0; 6],
            };
            let group = &mut self.groups[index];
            group.after = group.after.with(&point);
            group.reshaped = true;
            return Ok(());
        }
        let element = self.body(self.link(name)?)?;
        if self.format == Format::Urdf {
            return self.payload_link(name, element, mass, at);
        }
        let payload = self.free_name("body", "payload");
        self.use_inertials()?;
        let (own, place) = (number(mass / self.scale()?), numbers(&at));
        self.said.push(format!(
            "body {payload}: new in {name} at {place}, mass {}",
            number(mass)
        ));
        let inertial = format!("<inertial pos=\"0 0 0\" mass=\"{own}\" diaginertia=\"0 0 0\"/>");
        let text = format!("<body name=\"{payload}\" pos=\"{place}\">{inertial}</body>");
        self.add_to_total(mass)?;
        self.insert_into(element, &text, false)
    }

    /// A name for a new element, which no other one of its kind has.
    pub(super) fn free_name(&mut self, kind: &str, wanted: &str) -> String {
        let taken = |name: &str| {
            let same =
                |one: &Element<'_>| one.has_tag_name(kind) && one.attribute("name") == Some(name);
            self.named.contains(name) || self.root.descendants().any(|one| same(&one))
        };
        let numbered = (2..).map(|count| format!("{wanted}_{count}"));
        let mut all = [wanted.to_owned()].into_iter().chain(numbered);
        let free = all.find(|name| !taken(name));
        let free = free.unwrap_or_else(|| wanted.to_owned());
        self.named.insert(free.clone());
        free
    }

    /// Masses over those that are written, where `settotalmass` scales them.
    fn scale(&self) -> Result<f64, Refused> {
        if self.compiler.total_mass.is_none() {
            return Ok(1.0);
        }
        // The same file without `settotalmass`, with all places as they are.
        let mut text = self.root.document().input_text().to_owned();
        for compiler in children(self.root, "compiler") {
            if let Some(total) = compiler.attribute_node(TOTAL) {
                let place = total.range();
                text.replace_range(place.clone(), &" ".repeat(place.len()));
            }
        }
        let document = crate::xml::parse(&text)?;
        let options = Options {
            floating: true,
            ..Options::default()
        };
        let findings = Findings::default();
        let written = super::super::read(document.root_element(), &findings, self.whole, &options);
        let sum = |robot: &Robot| -> f64 { robot.links.iter().map(|link| link.inertia.mass).sum() };
        Ok(sum(&self.robot) / sum(&written))
    }

    /// Adds a mass to the one to which all masses are scaled.
    fn add_to_total(&mut self, mass: f64) -> Result<(), Refused> {
        let with = children(self.root, "compiler").filter(|one| one.has_attribute(TOTAL));
        let Some(compiler) = with.last().filter(|_| self.compiler.total_mass.is_some()) else {
            return Ok(());
        };
        let total = self.numbers(compiler, "", TOTAL)?.unwrap_or_default();
        let total: f64 = total.iter().sum();
        self.set(compiler, TOTAL, number(total + mass))
    }

    /// Lets `<inertial>` count where all inertias come from geoms.
    fn use_inertials(&mut self) -> Result<(), Refused> {
        if self.compiler.inertia_from != InertiaFrom::Geoms {
            return Ok(());
        }
        let mut all = self.root.descendants();
        if let Some(inertial) = all.find(|one| one.has_tag_name("inertial")) {
            let message =
                "`inertial` is not read, as inertias are those of geoms by `inertiafromgeom`";
            let help = "remove every `<inertial>`, or write `inertiafromgeom=\"auto\"`";
            return Err(refused(Code::NotAllowedHere, tag(inertial), message, help));
        }
        let with = children(self.root, "compiler").filter(|one| one.has_attribute(FROM_GEOMS));
        match with.last() {
            Some(compiler) => self.set(compiler, FROM_GEOMS, "auto"),
            None => Ok(()),
        }
    }

    /// Writes masses and inertias of all groups that were changed.
    pub(super) fn write_groups(&mut self) -> Result<(), Refused> {
        for group in std::mem::take(&mut self.groups) {
            if group.before == group.after {
                continue;
            }
            self.reshaped = true;
            self.tell_whole(&group);
            self.use_inertials()?;
            self.write_group(&group)?;
            self.add_to_total(group.after.mass - group.before.mass)?;
        }
        Ok(())
    }

    /// Tells the mass of bodies that are fixed to each other, since only that of all of them is known.
    fn tell_whole(&mut self, group: &Group) {
        let [before, after] = [group.before.mass, group.after.mass].map(number);
        let others = self.others(group);
        if others.is_empty() || before == after {
            return;
        }
        let links = &self.robot.links;
        let others = others.iter().map(|(link, _)| links[*link].name.as_str());
        self.said.push(format!(
            "{} together with {}, fixed to it: mass {after} (was {before})",
            links[group.head].name,
            others.collect::<Vec<_>>().join(", ")
        ));
    }

    fn write_group(&mut self, group: &Group) -> Result<(), Refused> {
        let is_urdf = self.format == Format::Urdf;
        let mut all = children(self.body(group.head)?, "inertial");
        // Of several in an MJCF, the last one holds.
        let inertial = if is_urdf { all.next() } else { all.last() };
        let from_geoms = self.compiler.inertia_from == InertiaFrom::Geoms;
        let by_numbers = !from_geoms && !group.reshaped && !self.compiler.adjusts();
        if let Some(inertial) = inertial.filter(|_| by_numbers)
            && self.others(group).is_empty()
        {
            return if is_urdf {
                self.write_link_numbers(inertial, group)
            } else {
                self.write_numbers(inertial, group)
            };
        }
        for (link, own) in self.shares(group)? {
            if is_urdf {
                self.write_link(link, own)?;
            } else {
                self.write_whole(link, own)?;
            }
        }
        Ok(())
    }

    /// Links with mass that are fixed to the head of a group, with their poses.
    fn others(&self, group: &Group) -> Vec<(usize, Pose)> {
        let mut members = self.members(group.head);
        members.retain(|(link, _)| {
            *link != group.head && !self.robot.links[*link].inertia.is_nothing()
        });
        members
    }

    /// The links of a group whose inertia changes, each with the new one in its frame.
    fn shares(&self, group: &Group) -> Result<Vec<(usize, Inertia)>, Refused> {
        let others = self.others(group);
        let own = others.iter().fold(group.after, |own, (link, pose)| {
            own.with(&negative(self.robot.links[*link].inertia.placed(*pose)))
        });
        if is_possible(&own) {
            return Ok(vec![(group.head, own)]);
        }
        if !is_possible(&group.after) {
            let name = &self.robot.links[group.head].name;
            let why = group.after.impossible();
            let why = why.unwrap_or_else(|| "its mass is not positive".to_owned());
            let message = format!("no body can have the inertia of `{name}`: {why}");
            let help = "the changes of this body are larger than it is";
            let body = self.body(group.head)?;
            return Err(refused(Code::NotPhysical, tag(body), message, help));
        }
        // The fixed bodies alone are heavier than the new mass: the body has all of it.
        let emptied = others.into_iter().map(|(link, _)| (link, Inertia::NONE));
        Ok(emptied.chain([(group.head, group.after)]).collect())
    }

    /// Changes numbers of `<inertial>`, in its own axes.
    fn write_numbers(&mut self, inertial: Element<'x>, group: &Group) -> Result<(), Refused> {
        let (before, after) = (group.before, group.after);
        if !same(before.mass, after.mass) {
            self.set(inertial, "mass", number(after.mass / self.scale()?))?;
        }
        if numbers(&before.centre) != numbers(&after.centre) {
            self.set(inertial, "pos", numbers(&after.centre))?;
        }
        if same(group.factor, 1.0) {
            return Ok(());
        }
        for key in [DIAGONAL, FULL] {
            let Some(all) = self.numbers(inertial, "", key)? else {
                continue;
            };
            let mut tensor = [0.0; 6];
            for (entry, given) in tensor.iter_mut().zip(&all) {
                *entry = given * group.factor;
            }
            let tensor = within_triangle(tensor);
            let count = all.len().min(tensor.len());
            self.set(inertial, key, numbers(&tensor[..count]))?;
        }
        Ok(())
    }

    /// Writes all numbers of `<inertial>`, in the axes of the body.
    fn write_whole(&mut self, link: usize, own: Inertia) -> Result<(), Refused> {
        let body = self.body(link)?;
        let scale = self.scale()?;
        let [xx, yy, zz, products @ ..] = within_triangle(own.tensor.map(|entry| entry / scale));
        let (key, other, moments) = if products.iter().all(|entry| *entry == 0.0) {
            (DIAGONAL, FULL, numbers(&[xx, yy, zz]))
        } else {
            let [xy, xz, yz] = products;
            (FULL, DIAGONAL, numbers(&[xx, yy, zz, xy, xz, yz]))
        };
        let (mass, place) = (number(own.mass / scale), numbers(&own.centre));
        if let Some(inertial) = children(body, "inertial").last() {
            for key in ORIENTATIONS {
                self.remove(inertial, key)?;
            }
            self.remove(inertial, other)?;
            self.set(inertial, "pos", place)?;
            self.set(inertial, "mass", mass)?;
            return self.set(inertial, key, moments);
        }
        let name = &self.robot.links[link].name;
        self.said.push(format!(
            "body {name}: inertial written out, mass {mass} at {place}, {key} {moments}"
        ));
        let text = format!("<inertial pos=\"{place}\" mass=\"{mass}\" {key}=\"{moments}\"/>");
        self.insert_into(body, &text, true)
    }
}

/// Whether a body can have an inertia.
fn is_possible(inertia: &Inertia) -> bool {
    inertia.mass > 0.0 && inertia.impossible().is_none()
}

/// What, added to a body, takes another one away from it.
fn negative(inertia: Inertia) -> Inertia {
    Inertia {
        mass: -inertia.mass,
        tensor: inertia.tensor.map(|entry| -entry),
        ..inertia
    }
}

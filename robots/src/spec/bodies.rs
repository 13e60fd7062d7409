//! Frames, points, bodies and weights.

use std::collections::BTreeSet;

use crate::letters::{Kind, Number, quantity};
use crate::model::Motion;
use crate::patterns;
use crate::rotation::{Vector, dot, is_zero, right_angles};
use crate::table::{Item, list, quoted};
use crate::tree::Part;

use super::{Writer, minus, operand, plus};

/// Names of the axes of a frame.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// A frame that is turned from its parent, by axes and angles.
fn turned(parent: &str, turns: &[(String, String)]) -> Item {
    let turn = |(axis, by): &(String, String)| {
        Item::default()
            .text("about_axis", axis)
            .expression("by", by)
    };
    let item = Item::default().text("parent", parent);
    match turns {
        [(axis, by)] => item.text("about_axis", axis).expression("by", by),
        several => {
            let tables: Vec<String> = several.iter().map(|one| turn(one).table()).collect();
            item.raw("turns", &format!("[{}]", tables.join(", ")))
        }
    }
}

/// The components of a force against the weight of a mass.
fn against(gravity: Vector, letters: &[String; 3], mass: &str) -> Vec<String> {
    let components = gravity.into_iter().zip(letters);
    let force = components.map(|(component, letter)| match mass.strip_prefix('-') {
        _ if component == 0.0 => "0".to_owned(),
        Some(mass) if component > 0.0 => format!("{mass}*{letter}"),
        None if component > 0.0 => format!("-{mass}*{letter}"),
        _ => format!("{mass}*{letter}"),
    });
    force.collect()
}

/// The components of a position, in m.
pub(super) fn lengths(position: Vector) -> Vec<String> {
    position.iter().map(|one| quantity(*one, "m")).collect()
}

impl Writer<'_> {
    /// A number that belongs to a link or a joint, as an expression.
    fn number(&mut self, number: Number<'_>) -> String {
        self.numbers.write(number, &mut self.quantities)
    }

    /// The displacement of a joint from its zero in the file's drawing, as an expression.
    fn displacement(&mut self, index: usize, unit: &'static str) -> String {
        let body = self.at(index);
        let q = self.called.coordinates[index].clone();
        let joint = &body.joint;
        if !(self.numbers.patterns).choose(&joint.name, "ref", joint.zero) {
            return plus(&q, &quantity(body.offset, unit));
        }
        let zero = self.number(Number {
            value: joint.zero,
            unit,
            letter: &format!("ref_{q}"),
            of: &joint.name,
            attribute: "ref",
            about: &format!("value of joint {} as drawn in its file", joint.name),
            ..Number::default()
        });
        plus(&minus(&q, &zero), &quantity(body.offset + joint.zero, unit))
    }

    /// Components of a vector, in m.
    fn components(
        &mut self,
        value: Vector,
        letters: &str,
        of: &str,
        about: &str,
        kind: Kind,
    ) -> Vec<String> {
        let components = value.into_iter().zip(AXES).map(|(value, axis)| {
            let about = format!("{about}, {axis}");
            self.numbers.write(
                Number {
                    value,
                    unit: "m",
                    letter: &letters.replace('#', axis),
                    of,
                    about: &about,
                    kind,
                    ..Number::default()
                },
                &mut self.quantities,
            )
        });
        components.collect()
    }

    /// The weight. Returns the expressions of the magnitudes of the components of gravity.
    pub(super) fn gravity(&mut self, gravity: Vector) -> [String; 3] {
        let count = gravity.iter().filter(|one| **one != 0.0).count();
        let mut written = [const { String::new() }; 3];
        for (index, component) in gravity.into_iter().enumerate() {
            let axis = AXES[index];
            if component == 0.0 {
                "0".clone_into(&mut written[index]);
                continue;
            }
            let (letter, load) = if count == 1 {
                ("g".to_owned(), "weight".to_owned())
            } else {
                (format!("g_{axis}"), format!("weight_{axis}"))
            };
            let acceleration = self.number(Number {
                value: component.abs(),
                unit: "m/s^2",
                letter: &letter,
                of: patterns::OPTION,
                attribute: if count == 1 {
                    "gravity"
                } else {
                    ["gravity.x", "gravity.y", "gravity.z"][index]
                },
                about: "gravitational acceleration",
                ..Number::default()
            });
            let down = if component < 0.0 {
                format!("-{axis}")
            } else {
                axis.to_owned()
            };
            let item = Item::default()
                .text("kind", "gravity")
                .text("down", &down)
                .expression("acceleration", &acceleration);
            self.loads.add(&load, &item);
            written[index] = acceleration;
        }
        written
    }

    /// The frame of a body. One that does not rotate relative to its parent has the frame of the parent.
    pub(super) fn frame(&mut self, index: usize) {
        let body = self.at(index);
        let called = self.called.links[body.link].clone();
        let parent = self.frame_of(body.parent);
        if !body.joint.motion.has_axis() {
            self.quaternion_frame(index, &called, &parent);
            return;
        }
        let turning = body.joint.motion == Motion::Turning;
        if body.turns.is_empty() && !turning {
            self.called.frames.push(parent);
            return;
        }
        let mut turns = self.constant_turns(index, &parent);
        if turning {
            let sign = if body.axis.backwards { "-" } else { "" };
            let by = self.displacement(index, "rad");
            turns.push((format!("{sign}{}", AXES[body.axis.index]), by));
        }
        let item = turned(&parent, &turns);
        let axis = AXES[body.axis.index];
        let along = format!("{axis} points along the axis of the joint, other than in the file");
        let item = item.text_if(!body.keeps_axes, "about", &along);
        self.frames.add(&called, &item);
        self.called.frames.push(called);
    }

    /// The frame of a body with a ball joint or a free joint. If it is mounted at an angle, its parent is a frame fixed
    /// at that angle.
    fn quaternion_frame(&mut self, index: usize, called: &str, parent: &str) {
        let turns = self.constant_turns(index, parent);
        let mut parent = parent.to_owned();
        if !turns.is_empty() {
            let mount = self.places.new_one(&format!("mount_{called}"));
            self.frames.add(&mount, &turned(&parent, &turns));
            parent = mount;
        }
        let quaternion = self.called.several[index].iter().rev().take(4).rev();
        let quaternion: Vec<String> = quaternion.map(|name| quoted(name)).collect();
        let item = Item::default()
            .text("parent", &parent)
            .raw("quaternion", &format!("[{}]", quaternion.join(", ")));
        self.frames.add(called, &item);
        self.called.frames.push(called.to_owned());
    }

    /// The constant turns of a body's frame, each an axis and an angle.
    fn constant_turns(&mut self, index: usize, parent: &str) -> Vec<(String, String)> {
        let body = self.at(index);
        let link = self.links[body.link].name.clone();
        let called = self.called.links[body.link].clone();
        let mut turns: Vec<(String, String)> = Vec::new();
        for (count, turn) in body.turns.iter().enumerate() {
            let (value, axis) =
                if turn.angle < 0.0 && turn.angle > -3.0 && right_angles(turn.angle).is_some() {
                    (-turn.angle, format!("-{}", AXES[turn.axis]))
                } else {
                    (turn.angle, AXES[turn.axis].to_owned())
                };
            // Right angles are not parameters.
            let by = if right_angles(value).is_some() {
                quantity(value, "rad")
            } else {
                self.number(Number {
                    value,
                    unit: "rad",
                    letter: &format!("angle_{called}_{}", count + 1),
                    of: &link,
                    about: &format!("angle between the frames of {called} and {parent}"),
                    ..Number::default()
                })
            };
            turns.push((axis, by));
        }
        turns
    }

    /// The point of a body: the origin of its link, or a point of the axis.
    pub(super) fn point(&mut self, index: usize) {
        let body = self.at(index);
        let link = self.links[body.link].name.clone();
        let called = self.called.links[body.link].clone();
        if body.joint.motion == Motion::Free {
            let item = Item::point("O", "ground", &self.called.several[index][..3]);
            self.points.add(&called, &item);
            self.called.points.push(called);
            return;
        }
        let origin = body.joint.motion == Motion::Sliding || is_zero(body.joint.anchor);
        let name = if origin {
            called.clone()
        } else {
            self.places.new_one(&format!("axis_{called}"))
        };
        let (parent_frame, mut from) = (self.frame_of(body.parent), self.point_of(body.parent));
        let (letters, about) = (format!("#_{called}"), format!("place of {name}"));
        let mut at = self.components(body.position, &letters, &link, &about, Kind::Other);
        let mut frame = parent_frame;
        if body.joint.motion == Motion::Sliding {
            let own = self.called.frames[index].clone();
            if own != frame && !is_zero(body.position) {
                let guide = self.places.new_one(&format!("guide_{called}"));
                self.points.add(&guide, &Item::point(&from, &frame, &at));
                from = guide;
                at = vec!["0".to_owned(); 3];
            }
            frame = own;
            let way = self.displacement(index, "m");
            let component = &mut at[body.axis.index];
            *component = match (component.as_str(), body.axis.backwards) {
                ("0", false) => way,
                ("0", true) => format!("-{}", operand(&way)),
                (constant, false) => format!("{constant} + {way}"),
                (constant, true) => format!("{constant} - ({way})"),
            };
        }
        let item = Item::point(&from, &frame, &at);
        let item = item.text_if(!origin, "about", "on the axis of the joint");
        self.points.add(&name, &item);
        self.called.points.push(name);
    }

    /// The body, unless it has neither mass nor inertia, with its centre of mass.
    pub(super) fn body(&mut self, index: usize) {
        let body = self.at(index);
        let inertia = body.inertia;
        if inertia.is_nothing() {
            return;
        }
        let link = self.links[body.link].name.clone();
        let called = self.called.links[body.link].clone();
        let frame = self.called.frames[index].clone();
        let at = if self.centre_is_selected(index) {
            self.centre_in_link(index)
        } else {
            let letters = format!("c#_{called}");
            let about = format!("centre of mass of {called}");
            self.components(inertia.centre, &letters, &link, &about, Kind::Inertial)
        };
        let centre = if at.iter().all(|one| one == "0") {
            self.called.points[index].clone()
        } else {
            let centre = self.places.new_one(&format!("G_{called}"));
            let from = self.called.points[index].clone();
            self.points.add(&centre, &Item::point(&from, &frame, &at));
            centre
        };
        let mut inertial = |value: f64, unit: &'static str, letter: String, about: &str| {
            self.numbers.write(
                Number {
                    value,
                    unit,
                    letter: &letter,
                    of: &link,
                    about: &format!("{about} of {called}"),
                    kind: Kind::Inertial,
                    attribute: if unit == "kg" { "mass" } else { "" },
                    never_negative: unit == "kg",
                },
                &mut self.quantities,
            )
        };
        let mass = inertial(inertia.mass, "kg", format!("m_{called}"), "mass");
        let entries = ["xx", "yy", "zz", "xy", "xz", "yz"]
            .into_iter()
            .zip(inertia.tensor);
        let entries = entries.map(|(entry, value)| {
            let about = format!("inertia about the centre of mass, {entry},");
            inertial(value, "kg*m^2", format!("I{entry}_{called}"), &about)
        });
        let entries: Vec<String> = entries.collect();
        let entries = self.scaled(index, entries);
        let item = if entries.iter().all(|entry| entry == "0") {
            Item::default()
                .text("centre", &centre)
                .expression("mass", &mass)
        } else {
            let tensor = Item::default().text("in", &frame);
            let tensor = if entries[3..].iter().all(|entry| entry == "0") {
                tensor.raw("diagonal", &list(&entries[..3]))
            } else {
                tensor
                    .raw("moments", &list(&entries[..3]))
                    .raw("products", &list(&entries[3..]))
            };
            Item::default()
                .text("frame", &frame)
                .text("centre", &centre)
                .expression("mass", &mass)
                .raw("inertia", &tensor.table())
        };
        let merged = body
            .parts
            .iter()
            .filter(|part| self.links[part.link].written && part.link != body.link);
        let merged: Vec<&str> = merged
            .map(|part| self.called.links[part.link].as_str())
            .collect();
        let about = super::sentence(&format!("with {}", merged.join(", ")));
        let item = item.text_if(!merged.is_empty(), "about", &about);
        self.bodies.add(&called, &item);
    }

    /// Origins of links that are fixed to the ground.
    pub(super) fn links_on_the_ground(&mut self) {
        for part in &self.tree.ground {
            if !is_zero(part.position) {
                let item = Item::point("O", "ground", &lengths(part.position));
                let item = item.text("about", "fixed to the ground");
                self.points.add(&self.called.links[part.link], &item);
            }
        }
    }

    /// Origins of links that are fixed to others, all or those at the ends of chains.
    pub(super) fn links_on_bodies(&mut self, all: bool) {
        let ends: BTreeSet<usize> = self.ends_of_chains().map(|part| part.link).collect();
        for (index, body) in self.tree.bodies.iter().enumerate() {
            for part in &body.parts {
                let name = &self.called.links[part.link];
                let written = self.links[part.link].written && *name != self.called.points[index];
                if !written || !(all || ends.contains(&part.link)) {
                    continue;
                }
                let (from, frame) = (&self.called.points[index], &self.called.frames[index]);
                let item = Item::point(from, frame, &lengths(part.position));
                self.points.add(name, &item);
            }
        }
    }

    /// Forces that compensate a fraction of the weight of links.
    pub(super) fn carried(&mut self, gravity: Vector, letters: &[String; 3]) {
        if is_zero(gravity) {
            return;
        }
        for (index, body) in self.tree.bodies.iter().enumerate() {
            for part in &body.parts {
                let link = &self.links[part.link];
                if link.carried == 0.0 || link.inertia.mass == 0.0 {
                    continue;
                }
                let called = &self.called.links[part.link];
                let point = self.places.new_one(&format!("carried_{called}"));
                let (from, frame) = (&self.called.points[index], &self.called.frames[index]);
                let item = Item::point(from, frame, &lengths(part.centre));
                self.points.add(&point, &item);
                let mass = quantity(link.carried * link.inertia.mass, "kg");
                let force = against(gravity, letters, &mass);
                self.lift(&point, &point, &force, "gravity compensation");
            }
        }
        for (rotor, point, mass) in std::mem::take(&mut self.weightless) {
            let force = against(gravity, letters, &mass);
            let name = format!("weightless_{rotor}");
            self.lift(&name, &point, &force, "the drive has no weight");
        }
    }

    /// A force on a point.
    fn lift(&mut self, name: &str, point: &str, force: &[String], about: &str) {
        let item = Item::default()
            .text("kind", "force")
            .text("on", point)
            .text("in", "ground")
            .expressions("vector", force)
            .text("about", about);
        self.loads.add(name, &item);
    }

    /// Of each body without child bodies, the farthest link without child links.
    fn ends_of_chains(&self) -> impl Iterator<Item = &'_ Part> {
        let mut is_parent = vec![false; self.links.len()];
        for parent in self.links.iter().filter_map(|link| link.parent) {
            is_parent[parent] = true;
        }
        let mut carries = vec![false; self.tree.bodies.len()];
        for parent in self.tree.bodies.iter().filter_map(|body| body.parent) {
            carries[parent] = true;
        }
        let last = (self.tree.bodies.iter().zip(carries)).filter(|(_, carries)| !carries);
        last.filter_map(move |(body, _)| {
            let distance = |part: &&Part| dot(part.position, part.position);
            let ends = body.parts.iter().filter(|part| !is_parent[part.link]);
            ends.max_by(|a, b| distance(a).total_cmp(&distance(b)))
        })
    }

    /// Positions of the ends of the chains.
    pub(super) fn ends(&mut self) {
        let ends: Vec<String> = self
            .ends_of_chains()
            .map(|part| self.called.links[part.link].clone())
            .collect();
        for called in ends {
            for axis in AXES {
                let name = self.quantities.new_one(&format!("{axis}_of_{called}"));
                let item = Item::default()
                    .text("value", &format!("position({called}, {axis})"))
                    .text("unit", "m");
                self.outputs.add(&name, &item);
            }
        }
    }
}

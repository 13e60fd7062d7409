//! From links to bodies: links that are fixed together form one body, whose frame has an axis along that of its joint.

use std::collections::BTreeMap;

use appell_spec::Code;

use crate::inertia::{Inertia, without_rounding};
use crate::model::{Joint, Link, Motion};
use crate::rotation::{Axis, Pose, Rotation, Turn, Vector, scaled};
use crate::xml::Findings;

/// Bodies in the order of the tree, and the links that are fixed to the ground.
#[derive(Debug)]
pub(crate) struct Tree {
    pub(crate) bodies: Vec<Body>,
    /// Links that are fixed to the ground.
    pub(crate) ground: Vec<Part>,
    /// By link: the body that it belongs to, unless that is the ground.
    pub(crate) body_of: Vec<Option<usize>>,
    /// Bodies by the names of joints with an axis.
    pub(crate) by_joint: BTreeMap<String, usize>,
}

/// A link that belongs to a body.
#[derive(Debug)]
pub(crate) struct Part {
    /// Its index among the links.
    pub(crate) link: usize,
    /// Its origin from the body's point, in the body's frame.
    pub(crate) position: Vector,
    /// Its centre of mass likewise.
    pub(crate) centre: Vector,
}

/// A joint with all links that it moves as one rigid body.
#[derive(Debug)]
pub(crate) struct Body {
    pub(crate) parent: Option<usize>,
    pub(crate) joint: Joint,
    /// The link that the joint moves.
    pub(crate) link: usize,
    /// Constant turns from the parent's frame before that of the joint.
    pub(crate) turns: Vec<Turn>,
    /// From the axes of the body's frame to those of the link that the joint moves.
    pub(crate) own: Rotation,
    /// Axis of the joint in the body's frame.
    pub(crate) axis: Axis,
    /// Offset added to the coordinate: the joint position at which the coordinate is zero.
    pub(crate) offset: f64,
    /// The body's point from that of the parent, in the parent's frame, before a joint slides.
    pub(crate) position: Vector,
    /// In the body's frame, from the body's point.
    pub(crate) inertia: Inertia,
    pub(crate) parts: Vec<Part>,
    /// Whether the frame has the axes of the link in the file.
    pub(crate) keeps_axes: bool,
    /// Where it is in the frame of its parent in the file.
    pub(crate) start: Pose,
}

/// The body of a link, and the pose of the link in it.
#[derive(Clone, Copy)]
struct Seat {
    body: Option<usize>,
    pose: Pose,
}

/// Merges links that are fixed together.
pub(crate) fn merged(links: &[Link], findings: &Findings) -> Tree {
    let mut tree = Tree {
        bodies: Vec::new(),
        ground: Vec::new(),
        body_of: Vec::new(),
        by_joint: BTreeMap::new(),
    };
    let mut seats: Vec<Seat> = Vec::new();
    for (index, link) in links.iter().enumerate() {
        let on = link.parent.map_or(
            Seat {
                body: None,
                pose: Pose::IDENTITY,
            },
            |parent| seats[parent],
        );
        let pose = on.pose.then(link.pose);
        let seat = match &link.joint {
            None => Seat {
                body: on.body,
                pose,
            },
            Some(joint) => {
                if joint.motion == Motion::Free && on.body.is_some() {
                    let message =
                        format!("`{}` floats, but stands on a link that moves", link.name);
                    let help = "only what stands on the ground can float";
                    findings.error(Code::NotAllowedHere, link.place.clone(), message, help);
                }
                tree.moved_by(joint, index, on.body, pose)
            }
        };
        seats.push(seat);
        let inertia = link.inertia.placed(seat.pose);
        if !inertia.is_finite() || !pose.position.iter().all(|one| one.is_finite()) {
            let message = format!(
                "place or inertia of `{}` are too large for a number",
                link.name
            );
            let help = "give lengths in m, masses in kg";
            findings.error(Code::NotFinite, link.place.clone(), message, help);
        }
        let part = Part {
            link: index,
            position: without_rounding(seat.pose.position),
            centre: inertia.centre,
        };
        match seat.body {
            None => tree.ground.push(part),
            Some(body) => {
                let body = &mut tree.bodies[body];
                body.inertia = body.inertia.with(&inertia);
                body.parts.push(part);
            }
        }
    }
    tree.body_of = seats.into_iter().map(|seat| seat.body).collect();
    for (index, body) in tree.bodies.iter().enumerate() {
        if body.joint.motion.has_axis() {
            tree.by_joint
                .entry(body.joint.name.clone())
                .or_insert(index);
        }
    }
    tree
}

impl Tree {
    /// A new body, moved by a joint at a pose in the frame of its parent.
    fn moved_by(&mut self, joint: &Joint, link: usize, parent: Option<usize>, pose: Pose) -> Seat {
        let (axis, own) = if joint.motion.has_axis() {
            Axis::nearest(joint.axis)
        } else {
            let any = Axis {
                index: 0,
                backwards: false,
            };
            (any, Rotation::IDENTITY)
        };
        let rotation = pose.rotation.then(own);
        let (last, anchor) = match joint.motion {
            Motion::Turning => (Some(axis.index), joint.anchor),
            Motion::Ball => (None, joint.anchor),
            Motion::Sliding | Motion::Free => (None, [0.0; 3]),
        };
        let mut turns = match joint.motion {
            Motion::Free => Vec::new(),
            _ => rotation.turns(last),
        };
        let mut offset = -joint.zero;
        if let (Some(last), Some(turn)) = (last, turns.last())
            && turn.axis == last
        {
            offset += axis.sign() * turn.angle;
            turns.pop();
        }
        let within = Pose {
            rotation: own.inverse(),
            position: own.inverse().of(scaled(anchor, -1.0)),
        };
        self.bodies.push(Body {
            parent,
            joint: joint.clone(),
            link,
            turns,
            own,
            axis,
            offset,
            position: without_rounding(pose.of(anchor)),
            inertia: Inertia::NONE,
            parts: Vec::new(),
            keeps_axes: own == Rotation::IDENTITY,
            start: pose,
        });
        Seat {
            body: Some(self.bodies.len() - 1),
            pose: within,
        }
    }
}

//! A robot as described by its file: a tree of links, each with at most one joint.

use std::collections::{BTreeMap, BTreeSet};

use crate::inertia::Inertia;
use crate::rotation::{Pose, Vector};
use crate::xml::Span;

/// The robot of a file.
#[derive(Debug)]
pub(crate) struct Robot {
    pub(crate) name: String,
    pub(crate) gravity: Vector,
    /// Parents come before their children.
    pub(crate) links: Vec<Link>,
    pub(crate) couplings: Vec<Coupling>,
    pub(crate) tendons: Vec<Tendon>,
    pub(crate) connections: Vec<Connection>,
    /// Actuated joints.
    pub(crate) driven: BTreeSet<String>,
    /// Actuators that are inputs; `None` where the joints themselves have inputs.
    pub(crate) drives: Option<Vec<Drive>>,
    pub(crate) left_out: Vec<LeftOut>,
}

/// A link, or an intermediate massless link of one with several joints.
#[derive(Debug)]
pub(crate) struct Link {
    pub(crate) name: String,
    /// `None` is the ground.
    pub(crate) parent: Option<usize>,
    /// Pose of its frame in that of the parent at joint position zero.
    pub(crate) pose: Pose,
    /// `None` if fixed to the parent.
    pub(crate) joint: Option<Joint>,
    pub(crate) inertia: Inertia,
    /// The fraction of its weight that is compensated.
    pub(crate) carried: f64,
    /// Whether the file defines this link; intermediate links are not in the file.
    pub(crate) written: bool,
    pub(crate) place: Span,
}

impl Link {
    /// A link without inertia that does not move on its parent.
    pub(crate) fn fixed(name: String, parent: Option<usize>, pose: Pose, place: Span) -> Self {
        Self {
            name,
            parent,
            pose,
            joint: None,
            inertia: Inertia::NONE,
            carried: 0.0,
            written: true,
            place,
        }
    }

    /// Appends it to `links` with joints in series, with an intermediate link for each but the last. The result is its
    /// index.
    pub(crate) fn moved_by(mut self, mut joints: Vec<Joint>, links: &mut Vec<Self>) -> usize {
        self.joint = joints.pop();
        for (index, joint) in joints.into_iter().enumerate() {
            let name = format!("{}_{}", self.name, index + 1);
            links.push(Self {
                joint: Some(joint),
                written: false,
                ..Self::fixed(name, self.parent, self.pose, self.place.clone())
            });
            (self.parent, self.pose) = (Some(links.len() - 1), Pose::IDENTITY);
        }
        links.push(self);
        links.len() - 1
    }
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Motion {
    /// It turns about its axis.
    Turning,
    /// It slides along its axis.
    Sliding,
    /// It rotates about a point (spherical).
    Ball,
    /// It has six degrees of freedom.
    Free,
}

impl Motion {
    /// Whether the joint has one coordinate, along or about an axis.
    pub(crate) fn has_axis(self) -> bool {
        matches!(self, Self::Turning | Self::Sliding)
    }

    /// Number of degrees of freedom.
    pub(crate) fn freedoms(self) -> usize {
        match self {
            Self::Turning | Self::Sliding => 1,
            Self::Ball => 3,
            Self::Free => 6,
        }
    }
}

/// Factors of a quantity, its square and its cube. Damping has the signs of odd functions: a v + b v |v| + c v³.
pub(crate) type Polynomial = [f64; 3];

/// A joint.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) motion: Motion,
    /// A unit vector in the link's frame.
    pub(crate) axis: Vector,
    /// A point of the axis in the link's frame.
    pub(crate) anchor: Vector,
    /// The coordinate at which the link is as drawn.
    pub(crate) zero: f64,
    pub(crate) range: Option<[f64; 2]>,
    /// Damping, with the rate.
    pub(crate) damping: Polynomial,
    /// Inertia of parts that move with this joint only (rotor).
    pub(crate) armature: f64,
    /// Dry friction.
    pub(crate) friction: f64,
    pub(crate) stiffness: Polynomial,
    /// The coordinate at which the spring is relaxed.
    pub(crate) relaxed: f64,
    /// Time constant and damping ratio from which its stiffness and damping are computed.
    pub(crate) settles: Option<[f64; 2]>,
    /// Bounds of the sum of all forces of actuators on it.
    pub(crate) drive_range: Option<[f64; 2]>,
    pub(crate) place: Span,
}

impl Joint {
    /// The initial coordinate: as drawn, if that is in its range.
    pub(crate) fn start(&self) -> f64 {
        match self.range {
            Some([from, to]) if !(from..=to).contains(&self.zero) => f64::midpoint(from, to),
            _ => self.zero,
        }
    }

    /// A joint without an axis, springs, damping and friction.
    pub(crate) fn without_axis(name: String, motion: Motion, anchor: Vector) -> Self {
        Self {
            anchor,
            ..Self::along(name, motion, [1.0, 0.0, 0.0])
        }
    }

    /// A joint about or along an axis through the origin, without springs, damping and friction.
    pub(crate) fn along(name: String, motion: Motion, axis: Vector) -> Self {
        Self {
            name,
            motion,
            axis,
            anchor: [0.0; 3],
            zero: 0.0,
            range: None,
            damping: [0.0; 3],
            armature: 0.0,
            friction: 0.0,
            stiffness: [0.0; 3],
            relaxed: 0.0,
            settles: None,
            drive_range: None,
            place: 0..0,
        }
    }
}

/// A sum of coordinates of joints with an axis, each with its factor, and a constant.
#[derive(Debug, Clone, Default)]
pub(crate) struct Sum {
    pub(crate) terms: Vec<(String, f64)>,
    pub(crate) constant: f64,
}

impl Sum {
    /// The coordinate of a joint.
    pub(crate) fn of(joint: &str) -> Self {
        Self {
            terms: vec![(joint.to_owned(), 1.0)],
            constant: 0.0,
        }
    }

    /// Gives coordinates their values.
    pub(crate) fn fix(&mut self, values: &BTreeMap<String, f64>) {
        for (name, factor) in &self.terms {
            self.constant += values.get(name).map_or(0.0, |value| factor * value);
        }
        self.terms.retain(|(name, _)| !values.contains_key(name));
    }

    /// Its value for given coordinates.
    pub(crate) fn at(&self, value: impl Fn(&str) -> f64) -> f64 {
        let terms = self.terms.iter();
        self.constant
            + terms
                .map(|(name, factor)| factor * value(name))
                .sum::<f64>()
    }
}

/// A constraint between coordinates: the deviation of the dependent sum from its value as drawn is a polynomial of the
/// deviation of the other sum.
#[derive(Debug)]
pub(crate) struct Coupling {
    pub(crate) name: String,
    pub(crate) follows: Sum,
    pub(crate) other: Option<Sum>,
    /// Values of the two at which `coefficients` are taken.
    pub(crate) zeros: [f64; 2],
    /// The polynomial, from its constant on.
    pub(crate) coefficients: Vec<f64>,
    pub(crate) place: Span,
}

/// A length that is a sum of coordinates, with its spring, damping and friction.
#[derive(Debug)]
pub(crate) struct Tendon {
    pub(crate) name: String,
    pub(crate) length: Sum,
    pub(crate) damping: Polynomial,
    pub(crate) stiffness: Polynomial,
    /// Lengths between which its spring is relaxed.
    pub(crate) relaxed: [f64; 2],
    pub(crate) friction: f64,
    pub(crate) armature: f64,
    /// Its shortest and longest length, which bound nothing but commands.
    pub(crate) range: Option<[f64; 2]>,
    /// Bounds of the sum of all forces of actuators on it.
    pub(crate) drive_range: Option<[f64; 2]>,
    pub(crate) place: Span,
}

/// An actuator: a force along a length, which is `gear` times a coordinate or a sum of coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) name: String,
    /// Its element, such as `position`.
    pub(crate) kind: String,
    /// Its transmission: a joint with an axis or a fixed tendon.
    pub(crate) on: On,
    pub(crate) gear: f64,
    /// The force is `gain` times the command plus `bias`; each is a constant, a factor of the length and one of its rate.
    pub(crate) gain: [f64; 3],
    pub(crate) bias: [f64; 3],
    /// Bounds of the command, of its filtered value, and of the force before the gear.
    pub(crate) ctrl_range: Option<[f64; 2]>,
    pub(crate) act_range: Option<[f64; 2]>,
    pub(crate) force_range: Option<[f64; 2]>,
    /// Time constant of the filter, and delay of the command, in s.
    pub(crate) lag: f64,
    pub(crate) delay: f64,
    pub(crate) place: Span,
}

/// The transmission of an actuator, by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum On {
    Joint(String),
    Tendon(String),
}

/// The law of an actuator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Law {
    /// kp (command − length) − kv rate + bias
    Position,
    /// kv (command − rate) + bias
    Velocity,
    /// gain · command, plus a spring and a damper
    Force,
    /// Any other: the gain depends on length and rate.
    Modulated,
}

/// Whether a number is another one, as computed from the same numbers of a file.
pub(crate) fn is(a: f64, b: f64) -> bool {
    a.total_cmp(&b).is_eq() || a - b == 0.0
}

impl Drive {
    /// Its numbers that can be parameters.
    pub(crate) fn attributes(&self) -> &'static [&'static str] {
        match self.law() {
            Law::Position => &[
                "kp",
                "kv",
                "gear",
                "bias",
                "forcerange",
                "timeconst",
                "delay",
            ],
            Law::Force => &["gear", "gain", "bias", "forcerange", "timeconst", "delay"],
            Law::Velocity | Law::Modulated => {
                &["kv", "gear", "bias", "forcerange", "timeconst", "delay"]
            }
        }
    }

    pub(crate) fn law(&self) -> Law {
        match (self.gain, self.bias) {
            ([kp, 0.0, 0.0], [_, back, _]) if kp != 0.0 && is(back, -kp) => Law::Position,
            ([kv, 0.0, 0.0], [_, 0.0, back]) if kv != 0.0 && is(back, -kv) => Law::Velocity,
            ([_, 0.0, 0.0], _) => Law::Force,
            _ => Law::Modulated,
        }
    }
}

/// A connection of two links that closes a loop of the tree.
#[derive(Debug)]
pub(crate) struct Connection {
    pub(crate) name: String,
    /// The links, and a point of each, in its frame; `None` is the ground.
    pub(crate) ends: [(Option<usize>, Vector); 2],
    /// The pose of the first in the second.
    pub(crate) second: Pose,
    /// Whether the relative orientation is fixed as well.
    pub(crate) rigid: bool,
    pub(crate) place: Span,
}

impl Connection {
    /// The points that must coincide, relative to the first end in its frame.
    pub(crate) fn points(&self) -> Vec<Vector> {
        let mut points = vec![[0.0; 3]];
        if self.rigid {
            points.extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        }
        points
    }
}

/// A part of the file without a counterpart in a spec.
#[derive(Debug)]
pub(crate) struct LeftOut {
    /// Its element, such as `actuator/motor`.
    pub(crate) what: String,
    pub(crate) name: Option<String>,
    /// How the motion differs without it, if it does.
    pub(crate) effect: Option<&'static str>,
    pub(crate) place: Span,
}

//! Poses of links, and their partial velocities.

use crate::model::{Link, Motion};
use crate::rotation::{Pose, Rotation, Vector, add, cross, minus, scaled};

/// A degree of freedom: its link, and the index of the coordinate of its joint or, after those of the position, of
/// the axis of rotation of the link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Freedom {
    pub(crate) link: usize,
    pub(crate) component: usize,
}

impl Freedom {
    /// Those of all joints.
    pub(crate) fn all(links: &[Link]) -> Vec<Self> {
        let joints = (links.iter().enumerate())
            .filter_map(|(link, own)| Some((link, own.joint.as_ref()?.motion)));
        let each = |(link, motion): (usize, Motion)| {
            (0..motion.freedoms()).map(move |component| Self { link, component })
        };
        joints.flat_map(each).collect()
    }

    /// Partial rate of a sum of coordinates, given by joints with their factors.
    pub(crate) fn rate(self, links: &[Link], terms: &[(String, f64)]) -> f64 {
        let joint = links[self.link].joint.as_ref();
        let own = |(name, _): &&(String, f64)| joint.is_some_and(|joint| joint.name == *name);
        terms.iter().filter(own).map(|(_, factor)| factor).sum()
    }

    /// Partial velocity of the link and its descendants.
    pub(crate) fn twist(self, links: &[Link], poses: &[Pose]) -> Twist {
        let pose = poses[self.link];
        let Some(joint) = &links[self.link].joint else {
            return Twist::default();
        };
        let about = |axis: Vector, anchor: Vector| Twist {
            turn: axis,
            shift: cross(pose.of(anchor), axis),
        };
        let along = |axis: Vector| Twist {
            turn: [0.0; 3],
            shift: axis,
        };
        match joint.motion {
            Motion::Turning => about(pose.rotation.of(joint.axis), joint.anchor),
            Motion::Sliding => along(pose.rotation.of(joint.axis)),
            Motion::Free if self.component < 3 => along(Rotation::IDENTITY.0[self.component]),
            Motion::Free => about(pose.rotation.0.map(|row| row[self.component - 3]), [0.0; 3]),
            Motion::Ball => about(pose.rotation.0.map(|row| row[self.component]), joint.anchor),
        }
    }
}

/// The velocity of a rigid body: its angular velocity, and that of its point at the origin of the ground.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Twist {
    pub(crate) turn: Vector,
    pub(crate) shift: Vector,
}

impl Twist {
    /// Velocity of the body's point at a place.
    pub(crate) fn at(self, place: Vector) -> Vector {
        add(self.shift, cross(self.turn, place))
    }
}

impl Link {
    /// Its pose in its parent for a displacement of a joint with an axis from the drawn configuration.
    pub(crate) fn moved(&self, way: f64) -> Pose {
        let Some(joint) = &self.joint else {
            return self.pose;
        };
        self.pose.then(match joint.motion {
            Motion::Turning => {
                let rotation = Rotation::about_vector(joint.axis, way);
                let position = minus(joint.anchor, rotation.of(joint.anchor));
                Pose { rotation, position }
            }
            Motion::Sliding => Pose {
                rotation: Rotation::IDENTITY,
                position: scaled(joint.axis, way),
            },
            Motion::Ball | Motion::Free => Pose::IDENTITY,
        })
    }
}

/// A displacement of each freedom to a generic configuration, where no links are aligned by chance.
pub(crate) fn anywhere(index: usize) -> f64 {
    0.1 + 0.05 * ((7 * index) % 5) as f64
}

//! Frames: composed rotations, and angular velocities without differentiating matrices.

use appell_spec::mechanism::{FrameId, List};

use super::algebra::Algebra;
use super::expressions::Setting;
use super::finding::{Item, Outcome};
use super::kinematics::Effort;
use super::quaternion::Attitude;
use super::right_angles::sin_cos;
use super::rotation::{Rotation, Turn};
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph};

/// A vector and the frame of its components.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameVector {
    /// Frame of the components.
    pub frame: FrameId,
    /// Components.
    pub v: Vec3,
}

impl FrameVector {
    /// A vector by its components in a frame.
    pub fn new(frame: FrameId, v: Vec3) -> Self {
        Self { frame, v }
    }

    /// A unit vector along an axis of a frame.
    pub fn unit(frame: FrameId, axis: usize) -> Self {
        Self::new(frame, vector::IDENTITY[axis])
    }
}

#[derive(Debug, Clone)]
struct Frame {
    parent: Option<FrameId>,
    /// From the parent to the frame.
    rotations: Vec<Rotation>,
    /// Angular velocity from the ground, in this frame.
    w: Vec3,
}

/// The frames of a mechanism.
#[derive(Debug, Clone)]
pub struct Frames {
    frames: List<FrameId, Frame>,
}

impl Frames {
    /// Frames with their angular velocities: `ω_child = Rᵀ ω_parent + axis · dα/dt` for each turn.
    pub fn new(algebra: &mut Algebra, setting: Setting<'_>, effort: Effort<'_>) -> Outcome<Self> {
        let mut frames: List<FrameId, Frame> = List::default();
        for (id, frame) in setting.mechanism.frames.entries() {
            let mut w = frame.parent.map_or(vector::ZERO, |parent| frames[parent].w);
            let mut rotations = Vec::with_capacity(frame.turns.len());
            for turn in &frame.turns {
                let graph = &mut algebra.graph;
                let mut angle = setting.lower_in(graph, Item::Frame(id), &turn.angle)?;
                if turn.negative {
                    angle = algebra.graph.neg(angle);
                }
                let [sin, cos] = sin_cos(algebra, angle);
                rotations.push(Rotation::Turn(Turn {
                    axis: turn.axis.index(),
                    angle,
                    rate: setting.rate(algebra, angle),
                    sin,
                    cos,
                }));
            }
            rotations.extend(frame.quaternion.map(|quaternion| {
                let [e, e_dot] = [&setting.symbols.coordinates[..], setting.rates]
                    .map(|all| quaternion.map(|id| all[id.index()]));
                Rotation::Attitude(Attitude::new(algebra, e, e_dot))
            }));
            for rotation in &rotations {
                let graph = &mut algebra.graph;
                w = rotation.in_child(graph, w);
                w = graph.add3(w, rotation.rate());
            }
            let w = match effort {
                Effort::Recursive => algebra.shared3(&format!("w_{}", frame.name), w),
                Effort::Plain | Effort::Shortest(_) => algebra.shortest3(w),
            };
            algebra.check_size()?;
            frames.push(Frame {
                parent: frame.parent,
                rotations,
                w,
            });
        }
        Ok(Self { frames })
    }

    /// Angular velocity of a frame from the ground, in its own components.
    pub fn angular_velocity(&self, frame: FrameId) -> FrameVector {
        FrameVector::new(frame, self.frames[frame].w)
    }

    /// All angular velocities and rates of turns.
    pub(super) fn rates(&mut self) -> impl Iterator<Item = &mut Expr> {
        self.frames.iter_mut().flat_map(|frame| {
            let rates = frame.rotations.iter_mut().flat_map(Rotation::rates);
            frame.w.iter_mut().chain(rates)
        })
    }

    /// Angular velocity of a frame in the components of a related one: the latter's angular velocity plus the
    /// rates of the turns between.
    pub fn angular_velocity_in(&self, graph: &mut Graph, frame: FrameId, to: FrameId) -> Vec3 {
        let path = self.ancestors(frame);
        let Some(last) = path.iter().position(|&f| f == to) else {
            return self.express(graph, self.angular_velocity(frame), to);
        };
        let mut v = vector::ZERO;
        for &frame in &path[..last] {
            for rotation in self.frames[frame].rotations.iter().rev() {
                v = graph.add3(v, rotation.rate());
                v = rotation.in_parent(graph, v);
            }
        }
        graph.add3(v, self.frames[to].w)
    }

    /// A vector expressed in another frame.
    pub fn express(&self, graph: &mut Graph, vector: FrameVector, to: FrameId) -> Vec3 {
        let (up, down) = without_shared_end(self.ancestors(vector.frame), self.ancestors(to));
        let mut v = vector.v;
        for frame in up {
            for rotation in self.frames[frame].rotations.iter().rev() {
                v = rotation.in_parent(graph, v);
            }
        }
        for frame in down.into_iter().rev() {
            for rotation in &self.frames[frame].rotations {
                v = rotation.in_child(graph, v);
            }
        }
        v
    }

    /// The frame and its ancestors up to the ground.
    pub fn ancestors(&self, frame: FrameId) -> Vec<FrameId> {
        std::iter::successors(Some(frame), |&f| self.frames[f].parent).collect()
    }

    /// The number of frames on the path from one frame to another, excluding the first.
    pub fn distance(&self, from: FrameId, to: FrameId) -> usize {
        let (up, down) = without_shared_end(self.ancestors(from), self.ancestors(to));
        up.len() + down.len()
    }

    /// The turns from the parent of a frame to it.
    pub(super) fn rotations(&self, frame: FrameId) -> &[Rotation] {
        &self.frames[frame].rotations
    }

    /// All frames.
    pub fn ids(&self) -> impl Iterator<Item = FrameId> + use<> {
        self.frames.ids()
    }
}

/// Two paths to a root, each without the part that they share.
pub(super) fn without_shared_end<T: PartialEq>(mut a: Vec<T>, mut b: Vec<T>) -> (Vec<T>, Vec<T>) {
    let both = a.iter().rev().zip(b.iter().rev());
    let shared = both.take_while(|(a, b)| a == b).count();
    a.truncate(a.len() - shared);
    b.truncate(b.len() - shared);
    (a, b)
}

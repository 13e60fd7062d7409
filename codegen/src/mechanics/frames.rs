//! Frames: rotations by chains and angular velocities without differentiating matrices.

use appell_spec::mechanism::{FrameId, List, Mechanism};

use super::algebra::Algebra;
use super::expressions::Lowering;
use super::finding::{Item, Outcome, division_by_zero};
use super::quaternion::Attitude;
use super::right_angles::sin_cos;
use super::time::TimeDerivative;
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

/// One rotation about a coordinate axis.
#[derive(Debug, Clone, Copy)]
struct Turn {
    axis: usize,
    /// Rate of the angle.
    rate: Expr,
    sin: Expr,
    cos: Expr,
}

#[derive(Debug, Clone)]
struct Frame {
    parent: Option<FrameId>,
    turns: Vec<Turn>,
    /// In the place of the turns.
    attitude: Option<Attitude>,
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
    pub fn new(
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        lowering: &Lowering<'_>,
        time: &TimeDerivative<'_>,
    ) -> Outcome<Self> {
        let mut frames: List<FrameId, Frame> = List::default();
        for (id, frame) in mechanism.frames.entries() {
            let mut w = frame.parent.map_or(vector::ZERO, |parent| frames[parent].w);
            let mut turns = Vec::with_capacity(frame.turns.len());
            for turn in &frame.turns {
                let mut angle = lowering
                    .lower(&mut algebra.graph, &turn.angle)
                    .map_err(|_| vec![division_by_zero(Item::Frame(id))])?;
                if turn.negative {
                    angle = algebra.graph.neg(angle);
                }
                let axis = turn.axis.index();
                let [sin, cos] = sin_cos(algebra, angle);
                let elementary = Turn {
                    axis,
                    rate: time.of(algebra, angle),
                    sin,
                    cos,
                };
                w = elementary.into_child(&mut algebra.graph, w);
                w[axis] = algebra.graph.add(w[axis], elementary.rate);
                turns.push(elementary);
            }
            let attitude = frame.quaternion.map(|quaternion| {
                let [e, e_dot] = [&lowering.symbols.coordinates[..], lowering.rates]
                    .map(|all| quaternion.map(|id| all[id.index()]));
                let attitude = Attitude::new(algebra, e, e_dot);
                w = attitude.in_child(&mut algebra.graph, w);
                w = algebra.graph.add3(w, attitude.w);
                attitude
            });
            let w = algebra.shortest3(w);
            frames.push(Frame {
                parent: frame.parent,
                turns,
                attitude,
                w,
            });
        }
        Ok(Self { frames })
    }

    /// Angular velocity of a frame from the ground, in its own components.
    pub fn angular_velocity(&self, frame: FrameId) -> FrameVector {
        FrameVector {
            frame,
            v: self.frames[frame].w,
        }
    }

    /// All angular velocities and rates of turns.
    pub(super) fn rates(&mut self) -> impl Iterator<Item = &mut Expr> {
        self.frames.iter_mut().flat_map(|frame| {
            let turns = frame.turns.iter_mut().map(|turn| &mut turn.rate);
            let attitudes = frame
                .attitude
                .iter_mut()
                .flat_map(|attitude| &mut attitude.w);
            frame.w.iter_mut().chain(turns).chain(attitudes)
        })
    }

    /// Angular velocity of a frame in the components of one that it is turned against: that of the
    /// other and the rates of the turns between.
    pub fn angular_velocity_in(&self, graph: &mut Graph, frame: FrameId, to: FrameId) -> Vec3 {
        let path = self.ancestors(frame);
        let Some(last) = path.iter().position(|&f| f == to) else {
            return self.express(graph, self.angular_velocity(frame), to);
        };
        let mut v = vector::ZERO;
        for &frame in &path[..last] {
            for turn in self.frames[frame].turns.iter().rev() {
                v[turn.axis] = graph.add(v[turn.axis], turn.rate);
                v = turn.into_parent(graph, v);
            }
            if let Some(attitude) = &self.frames[frame].attitude {
                v = graph.add3(v, attitude.w);
                v = attitude.in_parent(graph, v);
            }
        }
        graph.add3(v, self.frames[to].w)
    }

    /// The same vector in the components of another frame.
    pub fn express(&self, graph: &mut Graph, vector: FrameVector, to: FrameId) -> Vec3 {
        let (up, down) = (self.ancestors(vector.frame), self.ancestors(to));
        let shared = up
            .iter()
            .rev()
            .zip(down.iter().rev())
            .take_while(|(a, b)| a == b)
            .count();
        let mut v = vector.v;
        for &frame in &up[..up.len() - shared] {
            for turn in self.frames[frame].turns.iter().rev() {
                v = turn.into_parent(graph, v);
            }
            if let Some(attitude) = &self.frames[frame].attitude {
                v = attitude.in_parent(graph, v);
            }
        }
        for &frame in down[..down.len() - shared].iter().rev() {
            for turn in &self.frames[frame].turns {
                v = turn.into_child(graph, v);
            }
            if let Some(attitude) = &self.frames[frame].attitude {
                v = attitude.in_child(graph, v);
            }
        }
        v
    }

    /// The frame and its ancestors up to the ground.
    pub fn ancestors(&self, frame: FrameId) -> Vec<FrameId> {
        std::iter::successors(Some(frame), |&f| self.frames[f].parent).collect()
    }

    /// How many frames lie on the way from one to the other, the last one counted.
    pub fn distance(&self, from: FrameId, to: FrameId) -> usize {
        let (up, down) = (self.ancestors(from), self.ancestors(to));
        let both = up.iter().rev().zip(down.iter().rev());
        let shared = both.take_while(|(a, b)| a == b).count();
        up.len() + down.len() - 2 * shared
    }

    /// All frames.
    pub fn ids(&self) -> impl Iterator<Item = FrameId> + use<> {
        self.frames.ids()
    }
}

impl Turn {
    /// R v: from the turned frame into the one before the turn.
    fn into_parent(self, graph: &mut Graph, v: Vec3) -> Vec3 {
        self.rotate(graph, v, self.sin)
    }

    /// Rᵀ v: into the turned frame.
    fn into_child(self, graph: &mut Graph, v: Vec3) -> Vec3 {
        let sin = graph.neg(self.sin);
        self.rotate(graph, v, sin)
    }

    /// Rotation about one axis; the next two axes in cyclic order take part.
    fn rotate(self, graph: &mut Graph, v: Vec3, sin: Expr) -> Vec3 {
        let (i, j) = ((self.axis + 1) % 3, (self.axis + 2) % 3);
        let mut rotated = v;
        let (ci, sj) = (graph.mul(self.cos, v[i]), graph.mul(sin, v[j]));
        rotated[i] = graph.sub(ci, sj);
        let (si, cj) = (graph.mul(sin, v[i]), graph.mul(self.cos, v[j]));
        rotated[j] = graph.add(si, cj);
        rotated
    }
}

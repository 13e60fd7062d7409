//! Velocities of points and bodies for given generalised velocities.

use appell_spec::mechanism::{BodyId, FrameId, GROUND, List, Mechanism, ORIGIN, PointId};

use super::algebra::Algebra;
use super::expressions::Lowering;
use super::finding::{Item, Outcome, division_by_zero};
use super::frames::{FrameVector, Frames};
use super::symbols::Symbols;
use super::time::TimeDerivative;
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph, Substitution};

/// Largest distance, in frames, at which other frames are tried for the components of a vector.
const FARTHEST: usize = 3;

/// Positions and velocities of a mechanism.
#[derive(Debug, Clone)]
pub struct Kinematics {
    /// Frames and their angular velocities.
    pub frames: Frames,
    /// Position of each point relative to its reference point.
    offsets: List<PointId, FrameVector>,
    /// Velocity of each point from the ground.
    velocities: List<PointId, FrameVector>,
}

/// How far velocities are simplified.
#[derive(Debug, Clone, Copy)]
pub enum Effort<'a> {
    /// Not at all: for velocities used only once.
    Plain,
    /// Named components, computed recursively from frame and preceding point: for long chains.
    Recursive,
    /// Shortest form in the frame where that is shortest: for the equations. The centre of a rolling body may
    /// be expressed by its contact.
    Shortest(&'a [RollingContact]),
}

/// A point of rolling contact with the ground: the material point of the body is at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RollingContact {
    /// The rolling body.
    pub body: BodyId,
    /// The contact point.
    pub point: PointId,
}

/// An auxiliary motion outside the coordinates: the points placed from the origin via `root` are translated
/// with a velocity.
///
/// If geometry already embeds a constraint, this is the motion in which its reaction does work.
#[derive(Debug, Clone, Copy)]
pub struct Carried {
    /// The point adjacent to the origin whose subtree moves.
    pub root: PointId,
    /// Velocity.
    pub v: FrameVector,
}

impl Kinematics {
    /// Velocities for the generalised velocities `rates`, with auxiliary motions added.
    pub fn new(
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        symbols: &Symbols,
        rates: &[Expr],
        carried: &[Carried],
        effort: Effort<'_>,
    ) -> Outcome<Self> {
        let lowering = Lowering { symbols, rates };
        let time = TimeDerivative { symbols, rates };
        let frames = Frames::new(algebra, mechanism, &lowering, &time, effort)?;
        let mut offsets = List::default();
        for (id, point) in mechanism.points.entries() {
            let v = lowering
                .lower_all(&mut algebra.graph, &point.at)
                .map_err(|_| vec![division_by_zero(Item::Point(id))])?;
            let frame = point.frame;
            offsets.push(FrameVector { frame, v });
        }
        let mut kinematics = Self {
            frames,
            offsets,
            velocities: List::default(),
        };
        for (id, point) in mechanism.points.entries() {
            let velocity = match point.from {
                None => FrameVector {
                    frame: GROUND,
                    v: vector::ZERO,
                },
                Some(from) => {
                    let velocity = kinematics.relative_to(algebra, &time, id, from, carried);
                    match effort {
                        Effort::Plain => velocity,
                        Effort::Recursive => FrameVector {
                            v: algebra.shared3(&format!("v_{}", point.name), velocity.v),
                            ..velocity
                        },
                        Effort::Shortest(contacts) => {
                            kinematics.shortest(algebra, mechanism, id, velocity, contacts)
                        }
                    }
                }
            };
            kinematics.velocities.push(velocity);
        }
        Ok(kinematics)
    }

    /// `v_P = v_from + (dr/dt in the frame) + ω × r`, plus auxiliary motions.
    fn relative_to(
        &self,
        algebra: &mut Algebra,
        time: &TimeDerivative<'_>,
        point: PointId,
        from: PointId,
        carried: &[Carried],
    ) -> FrameVector {
        let FrameVector { frame, v: at } = self.offsets[point];
        let frames = &self.frames;
        let mut v = frames.express(&mut algebra.graph, self.velocities[from], frame);
        for motion in carried.iter().filter(|c| c.root == point) {
            let carried = frames.express(&mut algebra.graph, motion.v, frame);
            v = algebra.graph.add3(v, carried);
        }
        let relative = time.of3(algebra, at);
        let turning = algebra.graph.cross(frames.angular_velocity(frame).v, at);
        v = algebra.graph.add3(v, relative);
        v = algebra.graph.add3(v, turning);
        FrameVector { frame, v }
    }

    /// The velocity of a point in its shortest form. The centre of a rolling body rotates about the contact,
    /// `v_C = ω × r_PC`, which avoids differentiating the shape of the body.
    fn shortest(
        &self,
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        point: PointId,
        differentiated: FrameVector,
        contacts: &[RollingContact],
    ) -> FrameVector {
        let mut best = self.shortest_form(algebra, differentiated);
        for contact in contacts {
            let body = &mechanism.bodies[contact.body];
            let Some(frame) = body.frame.filter(|_| body.centre == point) else {
                continue;
            };
            let graph = &mut algebra.graph;
            let arm = self.between(graph, mechanism, contact.point, point, frame);
            let v = graph.cross(self.frames.angular_velocity(frame).v, arm);
            let turning = self.shortest_form(algebra, FrameVector { frame, v });
            if algebra.graph.operations(&turning.v) < algebra.graph.operations(&best.v) {
                best = turning;
            }
        }
        best
    }

    fn shortest_form(&self, algebra: &mut Algebra, vector: FrameVector) -> FrameVector {
        let v = algebra.shortest3(vector.v);
        self.frames.simplest(algebra, FrameVector { v, ..vector })
    }

    /// Replaces subexpressions of all velocities.
    pub fn replace(&mut self, graph: &mut Graph, replacement: &mut Substitution) -> Outcome<()> {
        let components = self
            .velocities
            .iter_mut()
            .flat_map(|velocity| &mut velocity.v);
        for component in components.chain(self.frames.rates()) {
            *component = replacement
                .apply(graph, *component)
                .ok_or_else(|| vec![division_by_zero(Item::Mechanism)])?;
        }
        Ok(())
    }

    /// Velocity of a point.
    pub fn velocity(&self, point: PointId) -> FrameVector {
        self.velocities[point]
    }

    /// Position of a point relative to its reference point.
    pub fn offset(&self, point: PointId) -> FrameVector {
        self.offsets[point]
    }

    /// Velocity of the material point of a body currently at `point`: `v_C + ω × r_CP`.
    pub fn material_velocity(
        &self,
        graph: &mut Graph,
        mechanism: &Mechanism,
        body: BodyId,
        point: PointId,
        frame: FrameId,
    ) -> Vec3 {
        let body = &mechanism.bodies[body];
        let centre = self
            .frames
            .express(graph, self.velocities[body.centre], frame);
        let Some(body_frame) = body.frame else {
            return centre;
        };
        let w = self
            .frames
            .express(graph, self.frames.angular_velocity(body_frame), frame);
        let arm = self.between(graph, mechanism, body.centre, point, frame);
        let turning = graph.cross(w, arm);
        graph.add3(centre, turning)
    }

    /// Position of `to` from `from`.
    pub fn between(
        &self,
        graph: &mut Graph,
        mechanism: &Mechanism,
        from: PointId,
        to: PointId,
        frame: FrameId,
    ) -> Vec3 {
        let chain = |point| -> Vec<PointId> {
            std::iter::successors(Some(point), |&p: &PointId| mechanism.points[p].from).collect()
        };
        let (a, b) = (chain(from), chain(to));
        // Omitting the common part of both paths keeps the vector short.
        let shared = a
            .iter()
            .rev()
            .zip(b.iter().rev())
            .take_while(|(p, q)| p == q)
            .count();
        let mut v = vector::ZERO;
        for &point in &b[..b.len() - shared] {
            let step = self.frames.express(graph, self.offsets[point], frame);
            v = graph.add3(v, step);
        }
        for &point in &a[..a.len() - shared] {
            let step = self.frames.express(graph, self.offsets[point], frame);
            v = graph.sub3(v, step);
        }
        v
    }

    /// Position of a point from the origin, in the ground.
    pub fn position(&self, graph: &mut Graph, mechanism: &Mechanism, point: PointId) -> Vec3 {
        self.between(graph, mechanism, ORIGIN, point, GROUND)
    }
}

impl Frames {
    /// A vector expressed in the nearby frame where its components have the fewest operations: each turn on the
    /// path to a distant frame makes the components longer.
    pub fn simplest(&self, algebra: &mut Algebra, vector: FrameVector) -> FrameVector {
        let mut best = vector;
        let mut cost = algebra.graph.operations(&best.v);
        for frame in self.ids() {
            if cost == 0 || frame == best.frame || self.distance(vector.frame, frame) > FARTHEST {
                continue;
            }
            let v = self.express(&mut algebra.graph, vector, frame);
            let v = algebra.shortest3(v);
            let operations = algebra.graph.operations(&v);
            if operations < cost {
                (best, cost) = (FrameVector { frame, v }, operations);
            }
        }
        best
    }
}

/// The point adjacent to the origin on the path to `point`.
pub fn root_of(mechanism: &Mechanism, point: PointId) -> PointId {
    let mut root = point;
    while let Some(from) = mechanism.points[root].from
        && from != ORIGIN
    {
        root = from;
    }
    root
}

//! Velocities of points and bodies for given generalised velocities.

use appell_spec::mechanism::{BodyId, FrameId, GROUND, List, Mechanism, ORIGIN, PointId};

use super::algebra::Algebra;
use super::expressions::Setting;
use super::finding::{Item, Outcome, defined};
use super::frames::{FrameVector, Frames, without_shared_end};
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Graph, Substitution};

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
    /// Reference point of each point; `None` for the origin.
    references: List<PointId, Option<PointId>>,
    /// Centre of mass and frame of each body; a point mass has no frame.
    bodies: List<BodyId, (PointId, Option<FrameId>)>,
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
    /// Velocities in a setting, with auxiliary motions added.
    pub fn new(
        algebra: &mut Algebra,
        setting: Setting<'_>,
        carried: &[Carried],
        effort: Effort<'_>,
    ) -> Outcome<Self> {
        let mechanism = setting.mechanism;
        let frames = Frames::new(algebra, setting, effort)?;
        let mut offsets = List::default();
        for (id, point) in mechanism.points.entries() {
            let v = setting.lower_all_in(&mut algebra.graph, Item::Point(id), &point.at)?;
            offsets.push(FrameVector::new(point.frame, v));
        }
        let bodies = mechanism.bodies.iter();
        let mut kinematics = Self {
            frames,
            offsets,
            velocities: List::default(),
            references: mechanism.points.iter().map(|point| point.from).collect(),
            bodies: bodies.map(|body| (body.centre, body.frame)).collect(),
        };
        for (id, point) in mechanism.points.entries() {
            let velocity = match point.from {
                None => FrameVector::new(GROUND, vector::ZERO),
                Some(from) => {
                    let velocity = kinematics.relative_to(algebra, setting, id, from, carried);
                    match effort {
                        Effort::Plain => velocity,
                        Effort::Recursive => FrameVector {
                            v: algebra.shared3(&format!("v_{}", point.name), velocity.v),
                            ..velocity
                        },
                        Effort::Shortest(contacts) => {
                            kinematics.shortest(algebra, id, velocity, contacts)
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
        setting: Setting<'_>,
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
        let relative = setting.rate3(algebra, at);
        let turning = algebra.graph.cross(frames.angular_velocity(frame).v, at);
        v = algebra.graph.add3(v, relative);
        v = algebra.graph.add3(v, turning);
        FrameVector::new(frame, v)
    }

    /// The velocity of a point in its shortest form. The centre of a rolling body rotates about the contact,
    /// `v_C = ω × r_PC`, which avoids differentiating the shape of the body.
    fn shortest(
        &self,
        algebra: &mut Algebra,
        point: PointId,
        differentiated: FrameVector,
        contacts: &[RollingContact],
    ) -> FrameVector {
        let mut best = self.shortest_form(algebra, differentiated);
        for contact in contacts {
            let (centre, frame) = self.bodies[contact.body];
            let Some(frame) = frame.filter(|_| centre == point) else {
                continue;
            };
            let graph = &mut algebra.graph;
            let arm = self.between(graph, contact.point, point, frame);
            let v = graph.cross(self.frames.angular_velocity(frame).v, arm);
            let turning = self.shortest_form(algebra, FrameVector::new(frame, v));
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
            *component = defined(replacement.apply(graph, *component), Item::Mechanism)?;
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

    /// Velocity of a point in the components of a frame.
    pub fn velocity_in(&self, graph: &mut Graph, point: PointId, frame: FrameId) -> Vec3 {
        self.frames.express(graph, self.velocities[point], frame)
    }

    /// Angular velocity of a body in the components of a frame; zero for a point mass.
    pub fn turning_in(&self, graph: &mut Graph, body: BodyId, frame: FrameId) -> Vec3 {
        let (_, Some(own)) = self.bodies[body] else {
            return vector::ZERO;
        };
        let w = self.frames.angular_velocity(own);
        self.frames.express(graph, w, frame)
    }

    /// Velocity of the material point of a body currently at `point`, `v_C + ω × r_CP`, or of the point itself if
    /// there is no body.
    pub fn material_velocity(
        &self,
        graph: &mut Graph,
        body: Option<BodyId>,
        point: PointId,
        frame: FrameId,
    ) -> Vec3 {
        let Some(body) = body else {
            return self.velocity_in(graph, point, frame);
        };
        let (centre, own) = self.bodies[body];
        let v = self.velocity_in(graph, centre, frame);
        if own.is_none() {
            return v;
        }
        let w = self.turning_in(graph, body, frame);
        let arm = self.between(graph, centre, point, frame);
        let turning = graph.cross(w, arm);
        graph.add3(v, turning)
    }

    /// Position of `to` from `from`.
    pub fn between(&self, graph: &mut Graph, from: PointId, to: PointId, frame: FrameId) -> Vec3 {
        let chain = |point| -> Vec<PointId> {
            std::iter::successors(Some(point), |&p: &PointId| self.references[p]).collect()
        };
        // Omitting the common part of both paths keeps the vector short.
        let (a, b) = without_shared_end(chain(from), chain(to));
        let mut v = vector::ZERO;
        for point in b {
            let step = self.frames.express(graph, self.offsets[point], frame);
            v = graph.add3(v, step);
        }
        for point in a {
            let step = self.frames.express(graph, self.offsets[point], frame);
            v = graph.sub3(v, step);
        }
        v
    }

    /// Position of a point from the origin, in the ground.
    pub fn position(&self, graph: &mut Graph, point: PointId) -> Vec3 {
        self.between(graph, ORIGIN, point, GROUND)
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

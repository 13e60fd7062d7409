//! Kinematics of a mechanism in the ground frame: all vectors in components of the inertial frame, all velocities as
//! derivatives of positions.

use appell_spec::expr::{Expr as Spec, Motion as Quantity, Response};
use appell_spec::mechanism::{
    Axis, BodyId, Components, ConstraintId, ConstraintKind, FrameId, List, PointId,
};

use super::loads::acting;
use crate::mechanics::algebra::{Algebra, replacing};
use crate::mechanics::expressions::Setting;
use crate::mechanics::finding::{Item, Outcome};
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph, Substitution};

/// Positions and velocities for given generalised velocities.
pub(super) struct Inertial<'a> {
    /// The generalised velocities are symbols, or functions of the pseudo-velocities.
    pub(super) setting: Setting<'a>,
    /// Rotation matrices from each frame to the ground frame.
    rotations: List<FrameId, Mat3>,
    positions: List<PointId, Vec3>,
    velocities: List<PointId, Vec3>,
    /// Angular velocities of the frames.
    turning: List<FrameId, Vec3>,
    /// Symbols of the forces that loads define, with their values.
    forces: Vec<(Expr, Expr)>,
}

/// A scalar constraint on velocities.
pub(super) struct Row {
    /// Index of the constraint.
    pub(super) constraint: ConstraintId,
    /// Vanishes if the constraint is satisfied.
    pub(super) value: Expr,
    /// Direction of its reaction: the unit force in the ground frame, or the multiplier as first component if the
    /// constraint has no point.
    pub(super) direction: Vec3,
}

impl<'a> Inertial<'a> {
    pub(super) fn new(
        algebra: &mut Algebra,
        setting: Setting<'a>,
        reactions: &[(Expr, Expr)],
    ) -> Outcome<Self> {
        let (mechanism, symbols) = (setting.mechanism, setting.symbols);
        let mut inertial = Self {
            setting,
            rotations: List::default(),
            positions: List::default(),
            velocities: List::default(),
            turning: List::default(),
            forces: reactions.to_vec(),
        };
        for frame in &mechanism.frames {
            let mut rotation = match frame.parent {
                Some(parent) => inertial.rotations[parent],
                None => vector::IDENTITY,
            };
            for turn in &frame.turns {
                let mut angle = inertial.lower(algebra, &turn.angle)?;
                if turn.negative {
                    angle = algebra.graph.neg(angle);
                }
                let turn = elementary(&mut algebra.graph, turn.axis, angle);
                rotation = algebra.graph.mat_mat(&rotation, &turn);
            }
            if let Some(quaternion) = frame.quaternion {
                let e = quaternion.map(|id| symbols.coordinates[id.index()]);
                let own = products(&mut algebra.graph, e);
                rotation = algebra.graph.mat_mat(&rotation, &own);
            }
            let turning = inertial.angular_velocity(algebra, &rotation);
            inertial.rotations.push(rotation);
            inertial.turning.push(turning);
        }
        for point in &mechanism.points {
            let mut position = inertial.in_ground(algebra, point.frame, &point.at)?;
            if let Some(from) = point.from {
                position = algebra.graph.add3(inertial.positions[from], position);
            }
            let velocity = setting.rate3(algebra, position);
            inertial.positions.push(position);
            inertial.velocities.push(velocity);
        }
        for load in mechanism.loads_after_what_they_name() {
            let own = symbols.responses.iter();
            for &(response, symbol) in own {
                if let Response::Force(of, along) = response
                    && of == load
                {
                    let force = acting(algebra, &inertial, &mechanism.loads[load].kind)?;
                    let value = match along {
                        Some((axis, frame)) => {
                            inertial.along(&mut algebra.graph, force, axis, frame)
                        }
                        None => force[0],
                    };
                    inertial.forces.push((symbol, value));
                }
            }
        }
        algebra.check_size()?;
        Ok(inertial)
    }

    /// Lowers an expression and substitutes kinematic quantities that it names; frames and points name none.
    pub(super) fn lower(&self, algebra: &mut Algebra, expr: &Spec) -> Outcome<Expr> {
        let Setting {
            mechanism, symbols, ..
        } = self.setting;
        let graph = &mut algebra.graph;
        let value = self.setting.lower_in(graph, Item::Mechanism, expr)?;
        let is_whole = self.velocities.len() == mechanism.points.len();
        let plain = symbols.motions.is_empty() && self.forces.is_empty();
        if plain || !is_whole {
            return Ok(value);
        }
        let mut values = self.forces.clone();
        for &(motion, symbol) in &symbols.motions {
            let value = match motion {
                Quantity::Position(p, axis, frame) => {
                    self.along(graph, self.positions[p], axis, frame)
                }
                Quantity::Velocity(p, axis, frame) => {
                    self.along(graph, self.velocities[p], axis, frame)
                }
                Quantity::Speed(p) => {
                    let v = self.velocities[p];
                    let square = graph.dot(v, v);
                    graph.sqrt(square)
                }
                Quantity::AngularVelocity(of, axis, frame) => {
                    self.along(graph, self.turning[of], axis, frame)
                }
            };
            values.push((symbol, value));
        }
        let mut told = Substitution::of_parts(graph, &values);
        Ok(algebra.apply(&mut told, &[value])?[0])
    }

    /// A component of a vector given in the ground frame.
    fn along(&self, graph: &mut Graph, v: Vec3, axis: Axis, frame: FrameId) -> Expr {
        let rotation = &self.rotations[frame];
        let column = [0, 1, 2].map(|row| rotation[row][axis.index()]);
        graph.dot(column, v)
    }

    /// A velocity in terms of the generalised velocities: pseudo-velocities are replaced by their definitions.
    pub(super) fn velocity_along(&self, algebra: &mut Algebra, velocity: &Spec) -> Outcome<Expr> {
        let velocity = self.lower(algebra, velocity)?;
        let (speeds, defined) = (&self.setting.symbols.speeds, self.definitions(algebra)?);
        let mut definitions = replacing(&algebra.graph, speeds, &defined);
        Ok(algebra.apply(&mut definitions, &[velocity])?[0])
    }

    fn lower3(&self, algebra: &mut Algebra, v: &Components) -> Outcome<Vec3> {
        let mut lowered = [Graph::ZERO; 3];
        for (target, component) in lowered.iter_mut().zip(v) {
            *target = self.lower(algebra, component)?;
        }
        Ok(lowered)
    }

    /// Transforms a vector from a frame to the ground frame.
    pub(super) fn in_ground(
        &self,
        algebra: &mut Algebra,
        frame: FrameId,
        v: &Components,
    ) -> Outcome<Vec3> {
        let v = self.lower3(algebra, v)?;
        Ok(algebra.graph.mat_vec(&self.rotations[frame], v))
    }

    /// ω from Ṙ Rᵀ, which is the matrix of ω ×.
    fn angular_velocity(&self, algebra: &mut Algebra, rotation: &Mat3) -> Vec3 {
        let rate = rotation.map(|row| self.setting.rate3(algebra, row));
        let mut spin = |i: usize, j: usize| algebra.graph.dot(rate[i], rotation[j]);
        [spin(2, 1), spin(0, 2), spin(1, 0)]
    }

    /// Position of a point.
    pub(super) fn position(&self, point: PointId) -> Vec3 {
        self.positions[point]
    }

    /// Velocity of a point, or of the material point of a body there: `v_C + ω × r`.
    pub(super) fn velocity(&self, graph: &mut Graph, body: Option<BodyId>, point: PointId) -> Vec3 {
        let Some(body) = body else {
            return self.velocities[point];
        };
        let centre = self.setting.mechanism.bodies[body].centre;
        let arm = graph.sub3(self.positions[point], self.positions[centre]);
        let turning = graph.cross(self.turning(body), arm);
        graph.add3(self.velocities[centre], turning)
    }

    /// Angular velocity of a body; zero for a point mass.
    pub(super) fn turning(&self, body: BodyId) -> Vec3 {
        let frame = self.setting.mechanism.bodies[body].frame;
        frame.map_or(vector::ZERO, |frame| self.turning[frame])
    }

    /// Mass of a body.
    pub(super) fn mass(&self, algebra: &mut Algebra, body: BodyId) -> Outcome<Expr> {
        self.lower(algebra, &self.setting.mechanism.bodies[body].mass)
    }

    /// `I w` of a body, R I Rᵀ w.
    pub(super) fn momentum(&self, algebra: &mut Algebra, body: BodyId, w: Vec3) -> Outcome<Vec3> {
        let Some(inertia) = &self.setting.mechanism.bodies[body].inertia else {
            return Ok(vector::ZERO);
        };
        let mut tensor = vector::IDENTITY;
        for (row, written) in tensor.iter_mut().zip(&inertia.matrix) {
            *row = self.lower3(algebra, written)?;
        }
        let rotation = &self.rotations[inertia.frame];
        let w = algebra.graph.transposed_mat_vec(rotation, w);
        let momentum = algebra.graph.mat_vec(&tensor, w);
        Ok(algebra.graph.mat_vec(rotation, momentum))
    }

    /// The definitions of the pseudo-velocities.
    pub(super) fn definitions(&self, algebra: &mut Algebra) -> Outcome<Vec<Expr>> {
        let speeds = self.setting.mechanism.pseudo_velocities.iter();
        let definitions = speeds.map(|w| self.lower(algebra, &w.definition));
        let definitions = definitions.collect::<Outcome<_>>()?;
        algebra.check_size()?;
        Ok(definitions)
    }

    /// The constraints in the order of the spec.
    pub(super) fn rows(&self, algebra: &mut Algebra) -> Outcome<Vec<Row>> {
        let mut rows = Vec::new();
        for (constraint, item) in self.setting.mechanism.constraints.entries() {
            let mut row = |value, direction| {
                rows.push(Row {
                    constraint,
                    value,
                    direction,
                });
            };
            match &item.kind {
                ConstraintKind::Rolling {
                    body, contact, on, ..
                } => {
                    let mut v = self.velocity(&mut algebra.graph, Some(*body), *contact);
                    if on.is_some() {
                        let carried = self.velocity(&mut algebra.graph, *on, *contact);
                        v = algebra.graph.sub3(v, carried);
                    }
                    for (value, axis) in v.into_iter().zip(vector::IDENTITY) {
                        row(value, axis);
                    }
                }
                ConstraintKind::Velocity { zero, equals, .. } => {
                    let (left, right) = (self.lower(algebra, zero)?, self.lower(algebra, equals)?);
                    row(algebra.graph.sub(left, right), vector::IDENTITY[0]);
                }
                ConstraintKind::FixedVelocity {
                    point,
                    body,
                    frame,
                    direction,
                    equals,
                    ..
                } => {
                    let along = self.in_ground(algebra, *frame, direction)?;
                    let v = self.velocity(&mut algebra.graph, *body, *point);
                    let left = algebra.graph.dot(along, v);
                    let right = self.lower(algebra, equals)?;
                    row(algebra.graph.sub(left, right), along);
                }
                ConstraintKind::Position { zero, .. } => {
                    let position = self.lower(algebra, zero)?;
                    row(self.setting.rate(algebra, position), vector::IDENTITY[0]);
                }
            }
        }
        algebra.check_size()?;
        Ok(rows)
    }
}

/// The columns e i ē, e j ē, e k ē: the images of the axes under a unit quaternion.
fn products(graph: &mut Graph, e: [Expr; 4]) -> Mat3 {
    let conjugate = [e[0], graph.neg(e[1]), graph.neg(e[2]), graph.neg(e[3])];
    let columns = vector::IDENTITY.map(|[x, y, z]| {
        let turned = product(graph, e, [Graph::ZERO, x, y, z]);
        let [_, x, y, z] = product(graph, turned, conjugate);
        [x, y, z]
    });
    [0, 1, 2].map(|row| columns.map(|column| column[row]))
}

/// Hamilton's product.
fn product(graph: &mut Graph, [a, u @ ..]: [Expr; 4], [b, v @ ..]: [Expr; 4]) -> [Expr; 4] {
    let (both, inner) = (graph.mul(a, b), graph.dot(u, v));
    let (av, bu, across) = (graph.scale3(a, v), graph.scale3(b, u), graph.cross(u, v));
    let sum = graph.add3(av, bu);
    let [x, y, z] = graph.add3(sum, across);
    [graph.sub(both, inner), x, y, z]
}

/// The rotation matrix of a turn about an axis.
fn elementary(graph: &mut Graph, axis: Axis, angle: Expr) -> Mat3 {
    let (sin, cos) = (graph.sin(angle), graph.cos(angle));
    let minus = graph.neg(sin);
    let (zero, one) = (Graph::ZERO, Graph::ONE);
    match axis {
        Axis::X => [[one, zero, zero], [zero, cos, minus], [zero, sin, cos]],
        Axis::Y => [[cos, zero, sin], [zero, one, zero], [minus, zero, cos]],
        Axis::Z => [[cos, minus, zero], [sin, cos, zero], [zero, zero, one]],
    }
}

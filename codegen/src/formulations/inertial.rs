//! Kinematics of a mechanism in the ground frame: all vectors in components of the inertial frame, all velocities as
//! derivatives of positions.

use appell_spec::expr::{Expr as Spec, Motion as Quantity, Response};
use appell_spec::mechanism::{
    Axis, BodyId, Components, ConstraintId, ConstraintKind, FrameId, List, Mechanism, PointId,
};

use super::loads::acting;
use crate::mechanics::algebra::Algebra;
use crate::mechanics::expressions::{DivisionByZero, Lowering};
use crate::mechanics::finding::{Item, Outcome, division_by_zero};
use crate::mechanics::symbols::Symbols;
use crate::mechanics::time::TimeDerivative;
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph, Substitution};

/// A lowered expression of a spec.
pub(super) type Lowered<T> = Result<T, DivisionByZero>;

/// Runs a step that may divide by zero and may create many expressions.
pub(super) fn room<T>(
    algebra: &mut Algebra,
    step: impl FnOnce(&mut Algebra) -> Lowered<T>,
) -> Outcome<T> {
    let result = step(algebra).map_err(|DivisionByZero| vec![division_by_zero(Item::Mechanism)])?;
    algebra.check_size()?;
    Ok(result)
}

/// Positions and velocities for given generalised velocities.
pub(super) struct Inertial<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) symbols: &'a Symbols,
    /// Generalised velocities: symbols, or functions of the pseudo-velocities.
    pub(super) rates: &'a [Expr],
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
        mechanism: &'a Mechanism,
        symbols: &'a Symbols,
        rates: &'a [Expr],
        reactions: &[(Expr, Expr)],
    ) -> Lowered<Self> {
        let mut inertial = Self {
            mechanism,
            symbols,
            rates,
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
            let velocity = inertial.time().of3(algebra, position);
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
        Ok(inertial)
    }

    /// Derivatives along the motion, with constant pseudo-velocities.
    pub(super) fn time(&self) -> TimeDerivative<'a> {
        TimeDerivative {
            symbols: self.symbols,
            rates: self.rates,
        }
    }

    pub(super) fn lower(&self, algebra: &mut Algebra, expr: &Spec) -> Lowered<Expr> {
        let (symbols, rates) = (self.symbols, self.rates);
        let value = Lowering { symbols, rates }.lower(&mut algebra.graph, expr)?;
        self.told(algebra, value)
    }

    /// Substitutes kinematic quantities named in the spec; frames and points contain none.
    fn told(&self, algebra: &mut Algebra, value: Expr) -> Lowered<Expr> {
        let is_whole = self.velocities.len() == self.mechanism.points.len();
        let plain = self.symbols.motions.is_empty() && self.forces.is_empty();
        if plain || !is_whole {
            return Ok(value);
        }
        let graph = &mut algebra.graph;
        let mut values = self.forces.clone();
        for &(motion, symbol) in &self.symbols.motions {
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
        told.apply(graph, value).ok_or(DivisionByZero)
    }

    /// A component of a vector given in the ground frame.
    fn along(&self, graph: &mut Graph, v: Vec3, axis: Axis, frame: FrameId) -> Expr {
        let rotation = &self.rotations[frame];
        let column = [0, 1, 2].map(|row| rotation[row][axis.index()]);
        graph.dot(column, v)
    }

    /// A velocity in terms of the generalised velocities: pseudo-velocities are replaced by their definitions.
    pub(super) fn velocity_along(&self, algebra: &mut Algebra, velocity: &Spec) -> Lowered<Expr> {
        let velocity = self.lower(algebra, velocity)?;
        let mut defined = Vec::new();
        for (speed, &symbol) in (self.mechanism.pseudo_velocities.iter()).zip(&self.symbols.speeds)
        {
            defined.push((symbol, self.lower(algebra, &speed.definition)?));
        }
        let mut definitions = Substitution::of_parts(&algebra.graph, &defined);
        let velocity = definitions.apply(&mut algebra.graph, velocity);
        velocity.ok_or(DivisionByZero)
    }

    fn lower3(&self, algebra: &mut Algebra, v: &Components) -> Lowered<Vec3> {
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
    ) -> Lowered<Vec3> {
        let v = self.lower3(algebra, v)?;
        Ok(algebra.graph.mat_vec(&self.rotations[frame], v))
    }

    /// ω from Ṙ Rᵀ, which is the matrix of ω ×.
    fn angular_velocity(&self, algebra: &mut Algebra, rotation: &Mat3) -> Vec3 {
        let rate = rotation.map(|row| self.time().of3(algebra, row));
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
        let centre = self.mechanism.bodies[body].centre;
        let arm = graph.sub3(self.positions[point], self.positions[centre]);
        let turning = graph.cross(self.turning(body), arm);
        graph.add3(self.velocities[centre], turning)
    }

    /// Angular velocity of a body; zero for a point mass.
    pub(super) fn turning(&self, body: BodyId) -> Vec3 {
        let frame = self.mechanism.bodies[body].frame;
        frame.map_or(vector::ZERO, |frame| self.turning[frame])
    }

    /// Mass of a body.
    pub(super) fn mass(&self, algebra: &mut Algebra, body: BodyId) -> Lowered<Expr> {
        self.lower(algebra, &self.mechanism.bodies[body].mass)
    }

    /// `I w` of a body, R I Rᵀ w.
    pub(super) fn momentum(&self, algebra: &mut Algebra, body: BodyId, w: Vec3) -> Lowered<Vec3> {
        let Some(inertia) = &self.mechanism.bodies[body].inertia else {
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
    pub(super) fn definitions(&self, algebra: &mut Algebra) -> Lowered<Vec<Expr>> {
        let speeds = self.mechanism.pseudo_velocities.iter();
        speeds.map(|w| self.lower(algebra, &w.definition)).collect()
    }

    /// The constraints in the order of the spec.
    pub(super) fn rows(&self, algebra: &mut Algebra) -> Lowered<Vec<Row>> {
        let mut rows = Vec::new();
        for (constraint, item) in self.mechanism.constraints.entries() {
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
                    row(self.time().of(algebra, position), vector::IDENTITY[0]);
                }
            }
        }
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

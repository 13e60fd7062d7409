//! Rolling contacts without an explicit solution: their rows in the frame where they are shortest.
//!
//! The motion of the body is needed as well, so the rows share its partial velocities. Since the velocity of
//! the contact point vanishes, so does the transport term of its derivative: the rates of the rows are the
//! components of `v̇_C + d/dt (ω × r)`.

use appell_spec::mechanism::{BodyId, ConstraintKind, FrameId, GROUND, PointId};

use super::algebra::{Algebra, named3};
use super::constraints::Constraints;
use super::elimination::{Elimination, TurnedRow};
use super::expressions::Setting;
use super::finding::{Item, Outcome, defined};
use super::frames::FrameVector;
use super::gibbs_appell::{BodyMotion, frame_rate};
use super::kinematics::Kinematics;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Substitution};

/// The three rows of a contact.
pub struct ContactRows {
    /// Their positions in the open system.
    pub places: Vec<usize>,
    /// The rows in the chosen frame.
    pub rows: Vec<TurnedRow>,
    /// Their rates at zero accelerations, negated.
    change: Vec3,
}

/// The data that determine the rows of a contact.
struct Contact<'a> {
    /// With q̇ in terms of the pseudo-velocities and the unknowns of the open system.
    setting: Setting<'a>,
    elimination: &'a Elimination,
    /// The pseudo-velocities, then the unknowns of the open system.
    directions: &'a [Expr],
    kinematics: &'a Kinematics,
    motion: &'a BodyMotion,
    body: BodyId,
    frame: FrameId,
    point: PointId,
}

impl ContactRows {
    /// The rows of all contacts none of whose rows has an explicit solution.
    pub fn all(
        algebra: &mut Algebra,
        free: Setting<'_>,
        constraints: &Constraints,
        elimination: &Elimination,
        kinematics: &Kinematics,
        bodies: &[BodyMotion],
    ) -> Outcome<Vec<Self>> {
        let mut all = Vec::new();
        if elimination.open.by_division {
            return Ok(all);
        }
        let (mechanism, rates) = (free.mechanism, &elimination.rates);
        let directions = [free.symbols.speeds.as_slice(), &elimination.open.unknowns].concat();
        for (index, constraint) in mechanism.constraints.entries() {
            let ConstraintKind::Rolling {
                body,
                contact,
                on: None,
                ..
            } = constraint.kind
            else {
                continue;
            };
            let rows = elimination.open.rows.iter();
            let places: Vec<usize> = rows
                .enumerate()
                .filter(|(_, row)| {
                    row.is_some_and(|row| {
                        let row = &constraints.rows[row];
                        row.constraint == index && row.along.frame == GROUND
                    })
                })
                .map(|(place, _)| place)
                .collect();
            let (3, Some(frame)) = (places.len(), mechanism.bodies[body].frame) else {
                continue;
            };
            let contact = Contact {
                setting: Setting { rates, ..free },
                elimination,
                directions: &directions,
                kinematics,
                motion: &bodies[body.index()],
                body,
                frame,
                point: contact,
            };
            all.push(contact.rows(algebra, places)?);
        }
        Ok(all)
    }

    /// Negated rate of the row at a position of the open system.
    pub fn change_of(&self, place: usize) -> Option<Expr> {
        let axis = self.places.iter().position(|&p| p == place)?;
        Some(self.change[axis])
    }
}

impl Contact<'_> {
    fn rows(&self, algebra: &mut Algebra, mut places: Vec<usize>) -> Outcome<ContactRows> {
        // In the order of the axes of the ground.
        places.sort_unstable_by_key(|&place| self.elimination.open.rows[place]);
        let nearby = [
            self.setting.mechanism.points[self.point].frame,
            self.motion.centre.velocity.frame,
        ];
        let mut best: Option<(usize, FrameId, Vec<Vec3>)> = None;
        for frame in nearby {
            let partial = self.partial(algebra, frame);
            let cost = algebra.graph.operations(partial.as_flattened());
            if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                best = Some((cost, frame, partial));
            }
        }
        let (frame, partial) =
            best.map_or((GROUND, Vec::new()), |(_, frame, partial)| (frame, partial));
        let drift = self.drift(algebra, frame)?;
        let speeds = &self.setting.symbols.speeds;
        let rows = (0..3).map(|axis| {
            let (frames, unit) = (&self.kinematics.frames, FrameVector::unit(frame, axis));
            let factors = frames.express(&mut algebra.graph, unit, GROUND);
            let mut parts = vec![algebra.graph.neg(drift[axis])];
            for (&speed, direction) in speeds.iter().zip(&partial) {
                let part = algebra.graph.mul(direction[axis], speed);
                parts.push(algebra.graph.neg(part));
            }
            TurnedRow {
                coefficients: partial[speeds.len()..]
                    .iter()
                    .map(|direction| direction[axis])
                    .collect(),
                right: algebra.graph.sum(&parts),
                factors: factors.to_vec(),
            }
        });
        let rows = rows.collect();
        Ok(ContactRows {
            rows,
            change: self.change(algebra, frame),
            places,
        })
    }

    /// Partial velocities of the contact.
    fn partial(&self, algebra: &mut Algebra, frame: FrameId) -> Vec<Vec3> {
        let w = self.angular_velocity(algebra, frame);
        let arm = self.arm(algebra, frame);
        let centre = &self.motion.centre;
        let directions = self.directions.iter().zip(&centre.partial);
        directions
            .map(|(&direction, &v)| {
                let v = FrameVector::new(centre.velocity.frame, v);
                let v = self.kinematics.frames.express(&mut algebra.graph, v, frame);
                let w = w.map(|component| algebra.derivative(component, direction));
                let w = algebra.shortest3(w);
                let turning = algebra.graph.cross(w, arm);
                algebra.graph.add3(v, turning)
            })
            .collect()
    }

    /// Velocity of the contact at zero speeds.
    fn drift(&self, algebra: &mut Algebra, frame: FrameId) -> Outcome<Vec3> {
        let (frames, v) = (&self.kinematics.frames, self.motion.centre.velocity);
        let v = frames.express(&mut algebra.graph, v, frame);
        let w = self.angular_velocity(algebra, frame);
        let arm = self.arm(algebra, frame);
        let turning = algebra.graph.cross(w, arm);
        let v = algebra.graph.add3(v, turning);
        let mut at_rest = Substitution::by_zero(&algebra.graph, self.directions);
        let rest = at_rest.apply_all(&mut algebra.graph, &v);
        let rest = defined(rest, Item::Body(self.body))?;
        Ok(algebra.shortest3([rest[0], rest[1], rest[2]]))
    }

    /// `-(v̇_C + d/dt (ω × r))` at zero accelerations.
    fn change(&self, algebra: &mut Algebra, frame: FrameId) -> Vec3 {
        let centre = &self.motion.centre;
        let a = FrameVector::new(centre.velocity.frame, centre.bias);
        let a = self.kinematics.frames.express(&mut algebra.graph, a, frame);
        let w = self.angular_velocity(algebra, frame);
        let arm = self.arm(algebra, frame);
        let mechanism = self.setting.mechanism;
        let (body, point) = (&self.motion.name, &mechanism.points[self.point].name);
        let w_dot = self.setting.rate3(algebra, w);
        let w_dot = algebra.shortest3(w_dot);
        let w_dot = named3(algebra, &format!("w_dot_{body}"), w_dot);
        let arm_dot = self.setting.rate3(algebra, arm);
        let arm_dot = named3(algebra, &format!("arm_dot_{point}"), arm_dot);
        let frame_rate = frame_rate(algebra, mechanism, self.kinematics, frame);
        let graph = &mut algebra.graph;
        let turning = graph.cross(w, arm);
        let parts = [
            graph.cross(w_dot, arm),
            graph.cross(w, arm_dot),
            graph.cross(frame_rate, turning),
        ];
        let sum = parts.into_iter().fold(a, |sum, part| graph.add3(sum, part));
        graph.neg3(sum)
    }

    fn angular_velocity(&self, algebra: &mut Algebra, frame: FrameId) -> Vec3 {
        let frames = &self.kinematics.frames;
        let w = frames.angular_velocity_in(&mut algebra.graph, self.frame, frame);
        named3(algebra, &format!("w_{}", self.motion.name), w)
    }

    /// From the centre to the contact.
    fn arm(&self, algebra: &mut Algebra, frame: FrameId) -> Vec3 {
        let mechanism = self.setting.mechanism;
        let centre = mechanism.bodies[self.body].centre;
        let (graph, point) = (&mut algebra.graph, &mechanism.points[self.point].name);
        let arm = self.kinematics.between(graph, centre, self.point, frame);
        named3(algebra, &format!("arm_{point}"), arm)
    }
}

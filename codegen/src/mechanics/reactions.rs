//! Constraint forces by auxiliary pseudo-velocities.
//!
//! Every constraint row has a speed that violates only this row. In the motion along it the constraint does
//! work, so Appell's equation for it gives the reaction.

use super::algebra::Algebra;
use super::constraints::Constraints;
use super::elimination::Violation;
use super::expressions::Setting;
use super::finding::Outcome;
use super::gibbs_appell::{ActualMotion, BodyMotion, partial_velocities};
use super::kinematics::{Carried, Effort, Kinematics};
use super::loads::{applied_loads, generalized_forces, settle};
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph, Substitution};

/// Reaction at every place of [`Constraints::reactions`], in the ground. `in_loads` are the reactions on which
/// loads depend; loads with other reactions are omitted.
pub fn reactions(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    constraints: &Constraints,
    violation: &Violation,
    bodies: &[BodyMotion],
    accelerations: &[Expr],
    in_loads: &[(Expr, Expr)],
) -> Outcome<Vec<Vec3>> {
    let motions = constraints.auxiliary.motions.iter();
    let carried: Vec<Carried> = motions
        .zip(&violation.carried_rates)
        .flat_map(|(motion, &rate)| motion.at(&mut algebra.graph, rate))
        .collect();
    let mechanism = setting.mechanism;
    let violated = Setting {
        rates: &violation.coordinate_rates,
        ..setting
    };
    let kinematics = Kinematics::new(algebra, violated, &carried, Effort::Plain)?;
    let mut loads = applied_loads(algebra, violated, &kinematics)?;
    settle(&mut loads, &mut algebra.graph, mechanism, in_loads)?;
    let applied = generalized_forces(algebra, &loads, &violation.rates);
    // Violations are virtual: a damper resists the actual motion only.
    let mut allowed = Substitution::by_zero(&algebra.graph, &violation.rates);
    let applied = algebra.apply(&mut allowed, &applied)?;

    // Inertial forces and moments, shared by all reactions.
    let mut inertial = Vec::with_capacity(bodies.len());
    for body in bodies {
        let motion = ActualMotion::new(algebra, body, accelerations);
        let force = algebra.graph.scale3(body.mass, motion.a);
        inertial.push((force, motion.momentum_rate));
    }

    let mut totals = vec![vector::ZERO; constraints.reactions.len()];
    for ((row, &rate), applied) in constraints.rows.iter().zip(&violation.rates).zip(applied) {
        let Some(place) = constraints.reported(row) else {
            continue;
        };
        let mut parts = vec![algebra.graph.neg(applied)];
        let moving = mechanism.bodies.entries().zip(bodies);
        for (((id, body), motion), (force, moment)) in moving.zip(&inertial) {
            let frame = motion.centre.velocity.frame;
            let v = kinematics.velocity_in(&mut algebra.graph, body.centre, frame);
            let partial = partial_velocities(algebra, v, &[rate])[0];
            parts.push(algebra.graph.dot(*force, partial));
            if let Some(rotation) = &motion.rotation {
                let frame = rotation.velocity.frame;
                let w = kinematics.turning_in(&mut algebra.graph, id, frame);
                let partial = partial_velocities(algebra, w, &[rate])[0];
                parts.push(algebra.graph.dot(*moment, partial));
            }
        }
        let magnitude = algebra.graph.sum(&parts);
        let magnitude = algebra.shortest(magnitude);
        let contribution = algebra.graph.scale3(magnitude, row.reaction.direction);
        let total = &mut totals[place];
        *total = algebra.graph.add3(*total, contribution);
    }
    Ok(totals)
}

/// Constraint rows with given generalised velocities: zero up to rounding.
pub fn residual(graph: &mut Graph, constraints: &Constraints, rates: &[Expr]) -> Vec<Expr> {
    constraints
        .rows
        .iter()
        .filter(|row| !row.is_embedded())
        .map(|row| {
            let mut parts = vec![row.rest];
            for (&coefficient, &rate) in row.coefficients.iter().zip(rates) {
                parts.push(graph.mul(coefficient, rate));
            }
            graph.sum(&parts)
        })
        .collect()
}

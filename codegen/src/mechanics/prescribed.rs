//! The power of prescribed motions: rheonomic constraints and frames, and drives.
//!
//! A velocity is `v = Σ (∂v/∂ω) ω + v₀`. The first part is an admissible motion, in which inertial forces and
//! loads balance (d'Alembert). So the prescribed motion requires the power `Σ (m a·v₀ + ḣ·Ω₀) − Σ F·v₀` over
//! all bodies and loads. It is zero if nothing is prescribed.

use super::Derivation;
use super::algebra::Algebra;
use super::finding::{Item, Outcome, defined};
use super::gibbs_appell::ActualMotion;
use super::loads::AppliedLoad;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, Substitution};

impl Derivation {
    /// The power of prescribed motions, with these pseudo-accelerations.
    pub fn prescribed_power(&mut self, accelerations: &[Expr]) -> Outcome<Expr> {
        let (algebra, speeds) = (&mut self.algebra, &self.symbols.speeds);
        let mut standing = Substitution::by_zero(&algebra.graph, speeds);
        let mut parts = Vec::new();
        for body in &self.bodies {
            let v_0 = prescribed3(algebra, &mut standing, body.centre.velocity.v)?;
            let w_0 = match &body.rotation {
                Some(rotation) => prescribed3(algebra, &mut standing, rotation.velocity.v)?,
                None => None,
            };
            if v_0.is_none() && w_0.is_none() {
                continue;
            }
            let motion = ActualMotion::new(algebra, body, accelerations);
            if let Some(v_0) = v_0 {
                let force = algebra.graph.scale3(body.mass, motion.a);
                parts.push(algebra.graph.dot(force, v_0));
            }
            if let Some(w_0) = w_0 {
                parts.push(algebra.graph.dot(motion.momentum_rate, w_0));
            }
        }
        for (force, velocity) in self.loads.iter().flat_map(AppliedLoad::work) {
            if let Some(v_0) = prescribed(algebra, &mut standing, velocity)? {
                let supplied = algebra.graph.mul(force, v_0);
                parts.push(algebra.graph.neg(supplied));
            }
        }
        let graph = &mut algebra.graph;
        let mut sum = graph.sum(&parts);
        for (speed, drive) in self.given.drives(graph, accelerations) {
            let supplied = graph.mul(drive, speeds[speed]);
            sum = graph.add(sum, supplied);
        }
        Ok(sum)
    }
}

/// The velocity at zero pseudo-velocities; `None` if it vanishes.
fn prescribed(
    algebra: &mut Algebra,
    standing: &mut Substitution,
    velocity: Expr,
) -> Outcome<Option<Expr>> {
    let v_0 = defined(
        standing.apply(&mut algebra.graph, velocity),
        Item::Mechanism,
    )?;
    let is_zero = algebra.test.is_zero(&algebra.graph, v_0);
    Ok((!is_zero).then_some(v_0))
}

fn prescribed3(
    algebra: &mut Algebra,
    standing: &mut Substitution,
    velocity: Vec3,
) -> Outcome<Option<Vec3>> {
    let mut v_0 = [Graph::ZERO; 3];
    let mut moves = false;
    for (own, component) in v_0.iter_mut().zip(velocity) {
        if let Some(part) = prescribed(algebra, standing, component)? {
            (*own, moves) = (part, true);
        }
    }
    Ok(moves.then_some(v_0))
}

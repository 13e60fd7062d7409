//! Kane's equations: `Σ (F - m a)·v_i + (T - I α - ω × I ω)·ω_i = 0` for every pseudo-velocity.

use appell_spec::mechanism::BodyId;

use super::inertial::Inertial;
use super::loads::{Which, efforts, generalized_force};
use crate::mechanics::algebra::Algebra;
use crate::mechanics::finding::Outcome;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph};

/// Kane's equations in the notation of Appell's.
pub(super) struct Kane {
    /// M, row by row.
    pub(super) mass_matrix: Vec<Vec<Expr>>,
    /// b.
    pub(super) bias: Vec<Expr>,
    /// Π.
    pub(super) forces: Vec<Expr>,
    /// Pseudo-accelerations.
    pub(super) accelerations: Vec<Expr>,
    /// Sum of all reactions by Newton's law for the whole mechanism, at given pseudo-accelerations.
    pub(super) total_reaction: Vec3,
}

/// Partial velocities of a body.
struct Partial {
    mass: Expr,
    /// ∂v/∂ω of the centre of mass.
    v: Vec<Vec3>,
    /// ∂ω/∂ω of the body.
    w: Vec<Vec3>,
    /// I ∂ω/∂ω.
    momentum: Vec<Vec3>,
    /// m a and I α + ω × I ω without pseudo-accelerations.
    inertial: [Vec3; 2],
}

/// Kane's equations for velocities in terms of the pseudo-velocities; `actual` are the pseudo-accelerations of
/// Newton's law, `given` the prescribed ones, which replace an equation.
pub(super) fn kane(
    algebra: &mut Algebra,
    inertial: &Inertial<'_>,
    actual: &[Expr],
    given: &[(usize, Expr)],
) -> Outcome<Kane> {
    let speeds = &inertial.setting.symbols.speeds;
    let mut bodies = Vec::with_capacity(inertial.setting.mechanism.bodies.len());
    for body in inertial.setting.mechanism.bodies.ids() {
        bodies.push(partial(algebra, inertial, body)?);
        algebra.check_size()?;
    }
    let loads = efforts(algebra, inertial, Which::All)?;
    let graph = &mut algebra.graph;
    let mut mass_matrix = vec![vec![Graph::ZERO; speeds.len()]; speeds.len()];
    let mut bias = Vec::with_capacity(speeds.len());
    for i in 0..speeds.len() {
        for j in 0..speeds.len() {
            let mut parts = Vec::new();
            for body in &bodies {
                let product = graph.dot(body.v[i], body.v[j]);
                parts.push(graph.mul(body.mass, product));
                parts.push(graph.dot(body.w[i], body.momentum[j]));
            }
            mass_matrix[i][j] = graph.sum(&parts);
        }
        let mut parts = Vec::new();
        for body in &bodies {
            let [force, moment] = body.inertial;
            parts.push(graph.dot(body.v[i], force));
            parts.push(graph.dot(body.w[i], moment));
        }
        bias.push(graph.sum(&parts));
    }
    let mut forces = Vec::with_capacity(speeds.len());
    for &speed in speeds {
        forces.push(generalized_force(algebra, &loads, speed));
        algebra.check_size()?;
    }
    let graph = &mut algebra.graph;
    for &(speed, rate) in given {
        give(graph, &mut mass_matrix, &mut bias, speed, rate);
        forces[speed] = rate;
    }
    let right = forces.iter().zip(&bias).map(|(&f, &b)| graph.sub(f, b));
    let right = right.collect();
    let accelerations = graph.solve_numerically(mass_matrix.concat(), right);

    let mut total_reaction = [Graph::ZERO; 3];
    for load in loads.iter().filter(|load| load.external) {
        total_reaction = graph.sub3(total_reaction, load.force);
    }
    for body in &bodies {
        total_reaction = graph.add3(total_reaction, body.inertial[0]);
        for (&v, &acceleration) in body.v.iter().zip(actual) {
            let mass = graph.mul(body.mass, acceleration);
            let force = graph.scale3(mass, v);
            total_reaction = graph.add3(total_reaction, force);
        }
    }
    Ok(Kane {
        mass_matrix,
        bias,
        forces,
        accelerations,
        total_reaction,
    })
}

/// Prescribes the rate of a speed and moves its terms in the other equations to the bias.
fn give(
    graph: &mut Graph,
    mass_matrix: &mut [Vec<Expr>],
    bias: &mut [Expr],
    speed: usize,
    rate: Expr,
) {
    for (row, (entries, bias)) in mass_matrix.iter_mut().zip(bias).enumerate() {
        if row == speed {
            entries.fill(Graph::ZERO);
            entries[speed] = Graph::ONE;
            *bias = Graph::ZERO;
        } else {
            let known = graph.mul(entries[speed], rate);
            *bias = graph.add(*bias, known);
            entries[speed] = Graph::ZERO;
        }
    }
}

fn partial(algebra: &mut Algebra, inertial: &Inertial<'_>, body: BodyId) -> Outcome<Partial> {
    let centre = inertial.setting.mechanism.bodies[body].centre;
    let v = inertial.velocity(&mut algebra.graph, None, centre);
    let w = inertial.turning(body);
    let mass = inertial.mass(algebra, body)?;
    let mut along = |v: Vec3| -> Vec<Vec3> {
        let speeds = inertial.setting.symbols.speeds.iter();
        speeds
            .map(|&speed| v.map(|c| algebra.derivative(c, speed)))
            .collect()
    };
    let (partial_v, partial_w) = (along(v), along(w));
    let momenta = partial_w.iter();
    let momenta: Outcome<Vec<Vec3>> = momenta
        .map(|&w| inertial.momentum(algebra, body, w))
        .collect();
    let [a, alpha] = [v, w].map(|velocity| inertial.setting.rate3(algebra, velocity));
    let growth = inertial.momentum(algebra, body, alpha)?;
    let momentum = inertial.momentum(algebra, body, w)?;
    let gyroscopic = algebra.graph.cross(w, momentum);
    Ok(Partial {
        mass,
        v: partial_v,
        w: partial_w,
        momentum: momenta?,
        inertial: [
            algebra.graph.scale3(mass, a),
            algebra.graph.add3(growth, gyroscopic),
        ],
    })
}

//! Shapes that represent bodies, from mass, inertia and contacts.

use appell_spec::mechanism::{BodyId, ConstraintKind, Mechanism, PointId};

use super::placement::Inertia;
use super::scene::Scene;
use super::space::{Matrix, Vector, add, dot, length, scaled, unit};

/// Two moments of inertia closer than this are equal.
const EQUAL: f64 = 1e-9;

/// The shape of a body, in the ground.
pub(super) enum Solid {
    /// A rolling body with an axis: the circle about `hub` through the end of `radius`.
    Wheel {
        hub: Vector,
        axis: Vector,
        radius: Vector,
    },
    /// A rolling body with a spherical inertia.
    Ball { centre: Vector, radius: f64 },
    /// Any other: the homogeneous ellipsoid of its mass and inertia, by its square `Σ aᵢ² eᵢ eᵢᵀ`
    /// with the semi-axes.
    Ellipsoid { centre: Vector, square: Matrix },
}

/// The shapes of the bodies that have one.
pub(super) fn solids(
    mechanism: &Mechanism,
    scene: &Scene,
) -> impl Iterator<Item = (BodyId, Solid)> {
    let bodies = mechanism.bodies.ids();
    bodies.filter_map(|id| Some((id, solid(mechanism, scene, id)?)))
}

fn solid(mechanism: &Mechanism, scene: &Scene, id: BodyId) -> Option<Solid> {
    let (mass, inertia) = &scene.bodies[id];
    let centre = scene.points[mechanism.bodies[id].centre]?;
    let inertia = inertia.as_ref()?;
    let arm = contact(mechanism, id)
        .and_then(|point| scene.points[point])
        .map(|contact| add(contact, -1.0, centre));
    match (arm, axis_of_symmetry(inertia)) {
        (Some(arm), Symmetry::Axis(axis)) => {
            let along = dot(arm, axis);
            let (hub, radius) = (add(centre, along, axis), add(arm, -along, axis));
            (length(radius) > 0.0).then_some(Solid::Wheel { hub, axis, radius })
        }
        (Some(arm), Symmetry::Every) => Some(Solid::Ball {
            centre,
            radius: length(arm),
        }),
        // In a plane only one moment of inertia matters, which does not determine a shape.
        _ if scene.flat_across.is_some() => None,
        _ => Some(Solid::Ellipsoid {
            centre,
            square: ellipsoid(*mass, inertia),
        }),
    }
}

/// The square of a ball.
pub(super) fn ball(radius: f64) -> Matrix {
    [0, 1, 2].map(|i| scaled(radius * radius, unit(i)))
}

/// The rolling contact of a body: a constrained point that does not move with it.
fn contact(mechanism: &Mechanism, id: BodyId) -> Option<PointId> {
    let held = mechanism.constraints.iter().filter_map(|c| match c.kind {
        ConstraintKind::Rolling { body, contact, .. } => Some((body, contact)),
        ConstraintKind::FixedVelocity {
            body: Some(body),
            point,
            ..
        } => Some((body, point)),
        ConstraintKind::FixedVelocity { body: None, .. }
        | ConstraintKind::Velocity { .. }
        | ConstraintKind::Position { .. } => None,
    });
    let frame = mechanism.bodies[id].frame;
    let rolls = |&(body, point): &(BodyId, PointId)| {
        body == id && Some(mechanism.points[point].frame) != frame
    };
    held.filter(rolls).map(|(_, point)| point).next()
}

/// Symmetry axes of a body, by its inertia.
enum Symmetry {
    None,
    Axis(Vector),
    Every,
}

fn axis_of_symmetry(inertia: &Inertia) -> Symmetry {
    let m = &inertia.matrix;
    let size = m[0][0].abs().max(m[1][1].abs()).max(m[2][2].abs());
    let equal = |a: f64, b: f64| (a - b).abs() <= EQUAL * size;
    let diagonal = [(0, 1), (1, 2), (2, 0)]
        .iter()
        .all(|&(i, j)| equal(m[i][j], 0.0));
    let pairs = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| diagonal && equal(m[i][i], m[j][j]));
    match pairs {
        [true, true, _] => Symmetry::Every,
        [true, ..] => Symmetry::Axis(inertia.axes[0]),
        [_, true, _] => Symmetry::Axis(inertia.axes[1]),
        [.., true] => Symmetry::Axis(inertia.axes[2]),
        _ => Symmetry::None,
    }
}

/// The square of an ellipsoid: `m/5` times it is `∫ r rᵀ dm`, which is half of the trace of the
/// inertia without the inertia.
fn ellipsoid(mass: f64, inertia: &Inertia) -> Matrix {
    let (m, axes) = (&inertia.matrix, &inertia.axes);
    let half_trace = (m[0][0] + m[1][1] + m[2][2]) / 2.0;
    let mut square = [[0.0; 3]; 3];
    for (i, row) in m.iter().enumerate() {
        for (j, &moment) in row.iter().enumerate() {
            let spread = if i == j { half_trace - moment } else { -moment };
            for (k, to) in square.iter_mut().enumerate() {
                *to = add(*to, 5.0 * spread / mass * axes[i][k], axes[j]);
            }
        }
    }
    square
}

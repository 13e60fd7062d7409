//! Shapes of bodies, from mass, inertia and contacts, and strokes in space: links, axes, wheels, the ground.

use std::f64::consts::TAU;

use appell_spec::mechanism::{Body, BodyId, Mechanism, PointId};

use super::link::{self, Link, LinkKind};
use super::scene::{Inertia, Scene};
use super::space::{Matrix, Vector, add, between, cross, dot, length, scaled, spans, unit};
use super::view::View;

/// Corners of a round line.
const CORNERS: u32 = 72;
/// Two directions closer than this are equal.
const EQUAL: f64 = 1e-9;

/// A line through points in space.
pub(super) struct Stroke {
    /// Its style.
    pub(super) class: &'static str,
    pub(super) corners: Vec<Vector>,
    /// Its tooltip.
    pub(super) about: String,
}

/// Links from each point to its reference point, and springs and dampers.
pub(super) fn links(mechanism: &Mechanism, scene: &Scene) -> Vec<Stroke> {
    let stroke = |Link { kind, ends, about }: Link| {
        let [a, b] = ends.map(|end| scene.points[end]);
        Some(Stroke {
            class: match kind {
                LinkKind::Way => "way",
                LinkKind::Rod => "link",
                LinkKind::Spring | LinkKind::Damper => "spring dashed",
            },
            corners: vec![a?, b?],
            about,
        })
    };
    link::links(mechanism).filter_map(stroke).collect()
}

/// Bodies: a rolling one as the circle through its contact, any other as the homogeneous ellipsoid
/// of its mass and inertia.
pub(super) fn bodies(mechanism: &Mechanism, scene: &Scene, view: &View) -> Vec<Stroke> {
    let shape = |(id, solid): (BodyId, Solid)| {
        let (class, outline) = match solid {
            Solid::Wheel { hub, axis, radius } => ("wheel", Some(circle(hub, axis, radius))),
            Solid::Ball { centre, radius } => ("wheel", outline(centre, &ball(radius), view)),
            Solid::Ellipsoid { centre, square } => ("body", outline(centre, &square, view)),
        };
        let corners = outline.filter(|corners| corners.iter().flatten().all(|c| c.is_finite()))?;
        let body = &mechanism.bodies[id];
        Some(Stroke {
            class,
            corners,
            about: format!("{} {}", body.name, body.about),
        })
    };
    solids(mechanism, scene).filter_map(shape).collect()
}

/// The circle about an axis through the end of a radius.
fn circle(hub: Vector, axis: Vector, radius: Vector) -> Vec<Vector> {
    let other = cross(axis, radius);
    round(|cos, sin| add(add(hub, cos, radius), sin, other))
}

/// Projection of an ellipsoid with this square: an ellipse, by the Cholesky factor of the projected
/// square.
fn outline(centre: Vector, square: &Matrix, view: &View) -> Option<Vec<Vector>> {
    let width = between(view.right, square, view.right).sqrt();
    let shear = between(view.right, square, view.up) / width;
    let rest = between(view.up, square, view.up) - shear * shear;
    let height = rest.max(0.0).sqrt();
    let place = |cos, sin| view.beside(centre, width * cos, shear * cos + height * sin);
    (width > 0.0).then(|| round(place))
}

fn round(place: impl Fn(f64, f64) -> Vector) -> Vec<Vector> {
    let corner = |k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(CORNERS)).sin_cos();
        place(cos, sin)
    };
    (0..=CORNERS).map(corner).collect()
}

/// Axes at a point, with the names of all frames of the same orientation.
pub(super) struct Axes {
    /// Their origin.
    pub(super) at: Vector,
    pub(super) directions: Matrix,
    /// Names of the frames.
    pub(super) names: String,
}

/// The axes of every frame that has a [point](link::seat). Frames of the same orientation at one
/// point are drawn once.
pub(super) fn axes(mechanism: &Mechanism, scene: &Scene) -> Vec<Axes> {
    let mut drawn: Vec<Axes> = Vec::new();
    for (id, frame) in mechanism.frames.entries() {
        let mut bodies = mechanism.bodies.iter();
        let own = bodies.find(|body| body.frame == Some(id));
        let place = link::seat(mechanism, id).filter(|_| own.is_none_or(Body::has_place));
        let at = place.and_then(|point| scene.points[point]);
        let (Some(at), Some(directions)) = (at, scene.frames[id]) else {
            continue;
        };
        let alike = |other: &&mut Axes| {
            let mut turned = directions.iter().zip(other.directions);
            length(add(other.at, -1.0, at)) == 0.0
                && turned.all(|(a, b)| length(add(*a, -1.0, b)) < EQUAL)
        };
        match drawn.iter_mut().find(alike) {
            Some(other) => {
                other.names.extend([" = ", &frame.name]);
            }
            None => drawn.push(Axes {
                at,
                directions,
                names: frame.name.clone(),
            }),
        }
    }
    drawn
}

/// Squares of the ground below the drawing; a line if seen from the side.
pub(super) fn ground(view: &View, places: &[Vector], step: f64) -> Vec<Stroke> {
    let spans = view.floor.map(|direction| {
        let along = places.iter().map(|place| [dot(*place, direction) / step]);
        let [[low, high]] = spans(along.chain([[0.0]]));
        [low.floor() - 1.0, high.ceil() + 1.0]
    });
    let mut lines = Vec::new();
    for (k, [low, high]) in spans.into_iter().enumerate() {
        let [a, b] = [view.floor[k], view.floor[1 - k]];
        let mut at = low;
        while at <= high {
            let start = scaled(at * step, a);
            lines.push(Stroke {
                class: "grid",
                corners: spans[1 - k].map(|end| add(start, end * step, b)).to_vec(),
                about: String::new(),
            });
            at += 1.0;
        }
    }
    lines
}

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
    let held = mechanism.constraints.iter().filter_map(link::held);
    let frame = mechanism.bodies[id].frame;
    let rolls = |&(body, point): &(Option<BodyId>, PointId)| {
        body == Some(id) && Some(mechanism.points[point].frame) != frame
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

//! Strokes in space: links, axes, wheels, shapes of bodies, the ground.

use std::f64::consts::TAU;

use appell_spec::mechanism::{Body, BodyId, Mechanism};

use super::link::{self, Link, LinkKind};
use super::scene::Scene;
use super::solids::{Solid, ball, solids};
use super::space::{Matrix, Vector, add, between, cross, dot, length, scaled, spans};
use super::view::View;

/// Corners of a round line.
const CORNERS: u32 = 72;
/// Two directions closer than this are equal.
const EQUAL: f64 = 1e-9;

/// A line through points in space.
pub(super) struct Stroke {
    /// Its style.
    pub(super) class: &'static str,
    /// Its corners.
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
    /// Their directions.
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

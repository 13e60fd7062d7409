//! Strokes in space: links, axes, wheels, hints of bodies, the ground.

use std::f64::consts::TAU;

use appell_spec::mechanism::{
    Body, BodyId, Connection, ConstraintKind, GROUND, LoadKind, Mechanism, ORIGIN, PointId,
};

use super::scene::{Inertia, Scene};
use super::space::{Matrix, Vector, add, between, cross, dot, length, scaled, unit};
use super::view::View;

/// Corners of a round line.
const CORNERS: u32 = 72;
/// Two directions or two moments of inertia closer than this are equal.
const EQUAL: f64 = 1e-9;

/// A line through places in space.
pub(super) struct Stroke {
    /// How it looks.
    pub(super) class: &'static str,
    /// Its corners.
    pub(super) corners: Vec<Vector>,
    /// Shown where the pointer rests on it.
    pub(super) about: String,
}

/// Links from each point to the point that it is placed from, and springs and dampers.
pub(super) fn links(mechanism: &Mechanism, scene: &Scene) -> Vec<Stroke> {
    let line = |class, [a, b]: [PointId; 2], about| {
        let corners = vec![scene.points[a]?, scene.points[b]?];
        Some(Stroke {
            class,
            corners,
            about,
        })
    };
    let placed = mechanism.points.iter().enumerate().filter_map(|(id, p)| {
        let from = p.from?;
        // What leads from the origin by coordinates is no part of the mechanism.
        let class = if from == ORIGIN && p.frame == GROUND {
            "way"
        } else {
            "link"
        };
        let about = format!("{} from {}", p.name, mechanism.points[from].name);
        line(class, [from, id], about)
    });
    let connections = mechanism.loads.iter().filter_map(|load| {
        let Some(&Connection::Points(a, b)) = load.kind.between() else {
            return None;
        };
        let word = match load.kind {
            LoadKind::Spring { .. } => "spring",
            _ => "damper",
        };
        line("spring dashed", [a, b], format!("{word} {}", load.name))
    });
    placed.chain(connections).collect()
}

/// Bodies: one that rolls as the circle through its contact, any other as the homogeneous ellipsoid
/// that has its mass and inertia.
pub(super) fn bodies(mechanism: &Mechanism, scene: &Scene, view: &View) -> Vec<Stroke> {
    let shape = |(id, body): (BodyId, &Body)| {
        let (mass, inertia) = &scene.bodies[id];
        let (centre, inertia) = (scene.points[body.centre]?, inertia.as_ref()?);
        let arm = contact(mechanism, id)
            .and_then(|point| scene.points[point])
            .map(|contact| add(contact, -1.0, centre));
        let outline = match (arm, axis_of_symmetry(inertia)) {
            (Some(arm), Symmetry::Axis(axis)) => circle(centre, axis, arm),
            (Some(arm), Symmetry::Every) => {
                let square = dot(arm, arm);
                let spread = [0, 1, 2].map(|i| scaled(square, unit(i)));
                outline(centre, &spread, view)
            }
            // In a plane one moment of inertia matters, and it does not tell a shape.
            _ if view.flat => None,
            _ => outline(centre, &ellipsoid(*mass, inertia), view),
        };
        let corners = outline.filter(|corners| corners.iter().flatten().all(|c| c.is_finite()))?;
        Some(Stroke {
            class: if arm.is_some() { "wheel" } else { "body" },
            corners,
            about: format!("{} {}", body.name, body.about),
        })
    };
    let bodies = mechanism.bodies.iter().enumerate();
    bodies.filter_map(shape).collect()
}

/// The point at which a body rolls: one that does not move with it, and at which it is held.
fn contact(mechanism: &Mechanism, id: BodyId) -> Option<PointId> {
    let held = mechanism.constraints.iter().filter_map(|c| match c.kind {
        ConstraintKind::Rolling { body, contact, .. } => Some((body, contact)),
        ConstraintKind::FixedVelocity {
            body: Some(body),
            point,
            ..
        } => Some((body, point)),
        _ => None,
    });
    let frame = mechanism.bodies[id].frame;
    let rolls = |&(body, point): &(BodyId, PointId)| {
        body == id && Some(mechanism.points[point].frame) != frame
    };
    held.filter(rolls).map(|(_, point)| point).next()
}

/// About which axes a body is symmetric, as far as its inertia tells.
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
        _ => match pairs.iter().position(|&equal| equal) {
            Some(axis) => Symmetry::Axis(inertia.axes[axis]),
            None => Symmetry::None,
        },
    }
}

/// The circle about an axis through the end of an arm.
fn circle(centre: Vector, axis: Vector, arm: Vector) -> Option<Vec<Vector>> {
    let along = dot(arm, axis);
    let (hub, radius) = (add(centre, along, axis), add(arm, -along, axis));
    let other = cross(axis, radius);
    (length(radius) > 0.0).then(|| round(|cos, sin| add(add(hub, cos, radius), sin, other)))
}

/// The square of an ellipsoid, `Σ aᵢ² eᵢ eᵢᵀ` with its semi-axes: `m/5` times it is `∫ r rᵀ dm`, which
/// is half of the trace of the inertia without the inertia.
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

/// What is seen of an ellipsoid with this square: an ellipse, by the Cholesky factor of the square
/// that is seen.
fn outline(centre: Vector, square: &Matrix, view: &View) -> Option<Vec<Vector>> {
    let width = between(view.right, square, view.right).sqrt();
    let shear = between(view.right, square, view.up) / width;
    let height = (between(view.up, square, view.up) - shear * shear)
        .max(0.0)
        .sqrt();
    (width > 0.0)
        .then(|| round(|cos, sin| view.beside(centre, width * cos, shear * cos + height * sin)))
}

fn round(place: impl Fn(f64, f64) -> Vector) -> Vec<Vector> {
    let corner = |k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(CORNERS)).sin_cos();
        place(cos, sin)
    };
    (0..=CORNERS).map(corner).collect()
}

/// Axes at a place, with the names of all frames that are turned alike.
pub(super) struct Axes {
    /// Where they are drawn.
    pub(super) at: Vector,
    /// Their directions.
    pub(super) directions: Matrix,
    /// Names of the frames.
    pub(super) names: String,
}

/// The axes of every frame that has a place: the centre of its body, or the point from which it
/// places another. Frames that are turned alike at one place are drawn once.
pub(super) fn axes(mechanism: &Mechanism, scene: &Scene) -> Vec<Axes> {
    let mut drawn: Vec<Axes> = Vec::new();
    for (id, frame) in mechanism.frames.iter().enumerate() {
        let of_body = mechanism.bodies.iter().find(|body| body.frame == Some(id));
        let placing = mechanism.points.iter().find(|point| point.frame == id);
        let place = match id {
            GROUND => Some(ORIGIN),
            _ => of_body
                .map(|body| body.centre)
                .or(placing.and_then(|point| point.from)),
        };
        let at = place.and_then(|point| scene.points[point]);
        let (Some(at), Some(directions)) = (at, scene.frames[id]) else {
            continue;
        };
        let alike = |other: &&mut Axes| {
            let turned = directions.iter().zip(other.directions);
            length(add(other.at, -1.0, at)) == 0.0
                && turned
                    .into_iter()
                    .all(|(a, b)| length(add(*a, -1.0, b)) < EQUAL)
        };
        match drawn.iter_mut().find(alike) {
            Some(other) => {
                other.names.push_str(" = ");
                other.names.push_str(&frame.name);
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

/// Squares of the ground below all that is drawn; seen from the side, a line.
pub(super) fn ground(view: &View, places: &[Vector], step: f64) -> Vec<Stroke> {
    let spans = view.floor.map(|direction| {
        let along = || places.iter().map(|place| dot(*place, direction) / step);
        let low = along().fold(0.0, f64::min).floor() - 1.0;
        let high = along().fold(0.0, f64::max).ceil() + 1.0;
        [low, high]
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

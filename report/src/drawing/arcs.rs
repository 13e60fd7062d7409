//! Angles between a frame and its parent, as arcs about the axis of a turn.

use std::f64::consts::TAU;

use appell_spec::expr::{ExprKind, Quantity};
use appell_spec::mechanism::{FrameId, Mechanism, PointId, Turn};

use super::link;
use super::scene::Scene;
use super::space::{Matrix, Vector, add, cross, dot, length, scaled};

/// Radius of an arc without a link, and the largest one, relative to the drawing.
const RADIUS: f64 = 0.13;
/// Radius relative to the link that has turned.
const ALONG_LINK: f64 = 0.8;
/// Angles below are not visible.
const SMALLEST: f64 = 0.02;
/// Lengths below, relative to the drawing, have no direction.
const NO_LENGTH: f64 = 1e-9;
/// Parts of an arc.
const PARTS: u32 = 32;
/// Length of the drawn reference direction of an angle, in radii.
const BEYOND: f64 = 1.3;

/// A marked angle.
pub(super) struct Arc {
    /// From the direction in the parent to that in the frame.
    pub(super) corners: Vec<Vector>,
    /// The reference direction of the angle.
    pub(super) from: [Vector; 2],
    /// Name and value in degrees.
    pub(super) name: String,
}

/// The angles of all turns that are drawn somewhere and are not zero.
pub(super) fn arcs(mechanism: &Mechanism, scene: &Scene, extent: f64) -> Vec<Arc> {
    let mut arcs = Vec::new();
    for (id, frame) in mechanism.frames.entries() {
        let Some(mut axes) = frame.parent.and_then(|parent| scene.frames[parent]) else {
            continue;
        };
        for (turn, &value) in frame.turns.iter().zip(&scene.turns[id]) {
            let angle = if turn.negative { -value } else { value };
            let about = axes[turn.axis.index()];
            if let Some(arm) = arm(mechanism, scene, id, &axes, turn, angle, extent) {
                arcs.extend(arc(arm, about, angle, named(mechanism, turn, value)));
            }
            axes = axes.map(|axis| turned(axis, about, angle));
        }
    }
    arcs
}

/// Centre of an arc and its initial radius: along the link that the frame rotates, else across the rotation axis
/// at the point where the frame is drawn.
fn arm(
    mechanism: &Mechanism,
    scene: &Scene,
    frame: FrameId,
    axes: &Matrix,
    turn: &Turn,
    angle: f64,
    extent: f64,
) -> Option<[Vector; 2]> {
    let about = axes[turn.axis.index()];
    let placed = mechanism
        .points
        .entries()
        .filter(|(_, point)| point.frame == frame);
    let link = placed.filter_map(|(id, point)| {
        let place = |point: PointId| scene.points[point];
        let (from, to) = (place(point.from?)?, place(id)?);
        let link = add(to, -1.0, from);
        let across = add(link, -dot(link, about), about);
        (length(across) > NO_LENGTH * extent).then_some([from, across])
    });
    let largest = RADIUS * extent;
    let sized = |[centre, along]: [Vector; 2]| {
        let radius = (ALONG_LINK * length(along)).min(largest);
        [centre, scaled(radius / length(along), along)]
    };
    let only = mechanism.frames[frame].turns.len() == 1;
    // The link is rotated already.
    let link = link.map(|[centre, along]| [centre, turned(along, about, -angle)]);
    let beside = || {
        let seat = link::seat(mechanism, frame)?;
        let next = axes[(turn.axis.index() + 1) % 3];
        Some([scene.points[seat]?, scaled(largest, next)])
    };
    let mut link = link.filter(|_| only).map(sized);
    link.next().or_else(beside)
}

fn arc([centre, begin]: [Vector; 2], about: Vector, angle: f64, name: String) -> Option<Arc> {
    // Whole turns are not visible.
    let angle = angle % TAU;
    if angle.is_nan() || angle.abs() < SMALLEST {
        return None;
    }
    let at = |part: f64| add(centre, 1.0, turned(begin, about, part * angle));
    let corners = (0..=PARTS).map(|k| at(f64::from(k) / f64::from(PARTS)));
    Some(Arc {
        corners: corners.collect(),
        from: [centre, add(centre, BEYOND, begin)],
        name,
    })
}

/// The value of an angle in degrees, with the name of its coordinate.
fn named(mechanism: &Mechanism, turn: &Turn, value: f64) -> String {
    let coordinate = |kind: &ExprKind| match kind {
        ExprKind::Quantity(Quantity::Coordinate(id)) => Some(*id),
        _ => None,
    };
    let (coordinate, value) = match &turn.angle.kind {
        ExprKind::Negate(inner) => (coordinate(&inner.kind), -value),
        kind => (coordinate(kind), value),
    };
    let degrees = (value.to_degrees() * 10.0).round() / 10.0;
    match coordinate {
        Some(id) => format!("{} = {degrees}°", mechanism.coordinates[id].label.name),
        None => format!("{degrees}°"),
    }
}

/// A vector turned about a unit vector (Rodrigues' formula).
fn turned(vector: Vector, about: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    let along = scaled((1.0 - cos) * dot(about, vector), about);
    add(add(along, cos, vector), sin, cross(about, vector))
}

//! Right angles that a file writes with few digits.

use crate::model::Robot;
use crate::rotation::{Rotation, Vector, unit};

/// Largest deviation from a right angle, in rad, that is corrected on request.
pub const SNAP: f64 = 1e-4;

/// Makes nearly right angles right, if requested; returns how many orientations and axes have such angles.
pub(crate) fn snap(robot: &mut Robot, really: bool) -> usize {
    let mut count = 0;
    for link in &mut robot.links {
        if let Some(rotation) = right_rotation(link.pose.rotation) {
            count += 1;
            if really {
                link.pose.rotation = rotation;
            }
        }
        if let Some(joint) = &mut link.joint
            && let Some(axis) = right_axis(joint.axis)
        {
            count += 1;
            if really {
                joint.axis = axis;
            }
        }
    }
    count
}

/// Whether a number is zero only nearly.
fn is_small(x: f64) -> bool {
    x != 0.0 && x.abs() < SNAP
}

/// The rotation with its nearly right angles made right, if it has any.
fn right_rotation(rotation: Rotation) -> Option<Rotation> {
    let right =
        |angle: f64| (angle / std::f64::consts::FRAC_PI_2).round() * std::f64::consts::FRAC_PI_2;
    let turns = rotation.turns(None);
    let nearly = turns
        .iter()
        .any(|turn| is_small(turn.angle - right(turn.angle)));
    let turned = turns.iter().map(|turn| {
        let away = turn.angle - right(turn.angle);
        let angle = if away.abs() < SNAP {
            right(turn.angle)
        } else {
            turn.angle
        };
        Rotation::about(turn.axis, angle)
    });
    nearly.then(|| turned.fold(Rotation::IDENTITY, Rotation::then))
}

/// The direction without components that are nearly zero, if it has any.
fn right_axis(axis: Vector) -> Option<Vector> {
    let nearly = axis.iter().any(|component| is_small(*component));
    let cut = axis.map(|component| {
        if component.abs() < SNAP {
            0.0
        } else {
            component
        }
    });
    if nearly { unit(cut) } else { None }
}

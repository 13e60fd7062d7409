//! Right angles that a file writes with few digits.

use crate::model::Robot;
use crate::rotation::{Rotation, Vector, unit};

/// What angles may lack of a right one, in rad, to be taken for it on request.
pub const SNAP: f64 = 1e-4;

/// Makes nearly right angles right, if asked to; returns how many orientations and axes have such angles.
pub(crate) fn snap(robot: &mut Robot, really: bool) -> usize {
    let mut count = 0;
    for link in &mut robot.links {
        let rotation = rotation(link.pose.rotation);
        if rotation != link.pose.rotation {
            count += 1;
            if really {
                link.pose.rotation = rotation;
            }
        }
        if let Some(joint) = &mut link.joint {
            let axis = axis(joint.axis);
            if axis != joint.axis {
                count += 1;
                if really {
                    joint.axis = axis;
                }
            }
        }
    }
    count
}

/// The rotation with nearly right angles made right.
fn rotation(rotation: Rotation) -> Rotation {
    let right = |angle: f64| {
        let right = (angle / std::f64::consts::FRAC_PI_2).round() * std::f64::consts::FRAC_PI_2;
        if (angle - right).abs() < SNAP {
            right
        } else {
            angle
        }
    };
    let turns = rotation.turns(None);
    if turns.iter().all(|turn| right(turn.angle) == turn.angle) {
        return rotation;
    }
    let turns = turns
        .iter()
        .map(|turn| Rotation::about(turn.axis, right(turn.angle)));
    turns.fold(Rotation::IDENTITY, Rotation::then)
}

/// The direction without components that are nearly zero.
fn axis(axis: Vector) -> Vector {
    let cut = axis.map(|component| {
        if component.abs() < SNAP {
            0.0
        } else {
            component
        }
    });
    if cut == axis {
        axis
    } else {
        unit(cut).unwrap_or(axis)
    }
}

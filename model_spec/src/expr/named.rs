//! Kinematic quantities and forces by name, such as `velocity(P, x)` and `force(spring)`.

use crate::axis::Axis;
use crate::ids::{ConstraintId, FrameId, LoadId, PointId, SpeedId};

/// Position or velocity of a point, or angular velocity of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Motion {
    /// Position of a point from the origin, along an axis of a frame.
    Position(PointId, Axis, FrameId),
    /// Velocity of a point, along an axis of a frame.
    Velocity(PointId, Axis, FrameId),
    /// Magnitude of the velocity of a point.
    Speed(PointId),
    /// Angular velocity of the first frame, along an axis of the second.
    AngularVelocity(FrameId, Axis, FrameId),
}

/// An acceleration relative to the ground, or a force. A force without an axis is the scalar by which it
/// is defined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Response {
    /// Acceleration of a point, along an axis of a frame.
    Acceleration(PointId, Axis, FrameId),
    /// Angular acceleration of the first frame, along an axis of the second.
    AngularAcceleration(FrameId, Axis, FrameId),
    /// Reaction of a constraint at its point.
    Reaction(ConstraintId, Option<(Axis, FrameId)>),
    /// Reaction of a contact along the normal of its surface.
    NormalForce(ConstraintId),
    /// Force or torque of a load.
    Force(LoadId, Option<(Axis, FrameId)>),
    /// Generalised force that the actuator supplies along a pseudo-velocity with prescribed rate.
    DriveForce(SpeedId),
}

words! {
    /// The kinds of kinematic quantities and forces, as they are called in a spec, with their syntax.
    Word, &'static str;
    /// `position(P, x)`, `position(P, x, frame)`
    Position "position" "position(P, x)"
    /// `velocity(P, x)`, `velocity(P, x, frame)`
    Velocity "velocity" "velocity(P, x)"
    /// `speed(P)`
    Speed "speed" "speed(P)"
    /// `angular_velocity(frame, z)`, `angular_velocity(frame, z, other)`
    AngularVelocity "angular_velocity" "angular_velocity(wheel, z)"
    /// `acceleration(P, x)`, `acceleration(P, x, frame)`
    Acceleration "acceleration" "acceleration(P, x)"
    /// `angular_acceleration(frame, z)`, `angular_acceleration(frame, z, other)`
    AngularAcceleration "angular_acceleration" "angular_acceleration(wheel, z)"
    /// `reaction(constraint, x)`, `reaction(constraint, x, frame)`, `reaction(constraint)`
    Reaction "reaction" "reaction(rolling, x)"
    /// `normal_force(contact)`
    NormalForce "normal_force" "normal_force(rolling)"
    /// `force(load, x)`, `force(load, x, frame)`, `force(load)`
    Force "force" "force(push, x)"
    /// `drive_force(omega)`
    DriveForce "drive_force" "drive_force(omega)"
}

impl Word {
    /// Its syntax.
    pub fn example(self) -> &'static str {
        Self::ALL[self as usize].2
    }
}

//! The subject of an equation, which determines the lines of the spec that it depends on.

use appell_spec::mechanism::{BodyId, ConstraintId, CoordinateId, FrameId, LoadId, PointId};

/// The subject of an equation, in addition to its letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// Acceleration energy of a body.
    Body(BodyId),
    /// Velocity or acceleration of a point.
    Point(PointId),
    /// Angular velocity of a frame.
    Frame(FrameId),
    /// A row of a constraint.
    Constraint(ConstraintId),
    /// The rate of a coordinate, which constraints determine.
    Rate(CoordinateId),
    /// Virtual power of a load.
    Load(LoadId),
    /// The inertia of all bodies that move with both pseudo-velocities.
    Inertia(usize, usize),
    /// The generalised force of a pseudo-velocity.
    Force(usize),
    /// The equation of motion of a pseudo-velocity.
    Motion(usize),
    /// All bodies, as in the kinetic energy.
    Bodies,
    /// All loads, as in the potential energy.
    Loads,
}

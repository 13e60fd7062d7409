//! Changes of a file, and why one cannot be made.

use appell_spec::{Code, Diagnostic};

use crate::format::Format;
use crate::rotation::Vector;
use crate::xml::Span;

/// A change of a number, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// The new value.
    To(f64),
    /// A summand.
    Add(f64),
    /// A factor.
    Times(f64),
}

impl Amount {
    /// The changed value of a number.
    pub fn of(self, value: f64) -> f64 {
        match self {
            Self::To(new) => new,
            Self::Add(summand) => value + summand,
            Self::Times(factor) => value * factor,
        }
    }
}

/// A number of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointNumber {
    /// Damping: the factor of the rate, together with that of its actuators.
    Damping,
    /// Dry friction.
    Frictionloss,
    /// Reflected inertia of the drive, together with that of its actuators.
    Armature,
    /// Stiffness of the spring: the factor of its elongation.
    Stiffness,
    /// Where the spring is relaxed.
    Springref,
    /// The position in the pose of the file. Neither the range nor the spring moves along, as they do with
    /// [`Change::Reading`].
    Ref,
}

/// A change of a file; names are those of the file, numbers are in SI.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// A number of a joint.
    Joint {
        /// The joint.
        joint: String,
        /// Its number.
        attribute: JointNumber,
        /// The change.
        amount: Amount,
    },
    /// The mass of a body, together with all bodies that are fixed to it. Its centre of mass and its inertia about that
    /// stay.
    Mass {
        /// The body.
        body: String,
        /// The change.
        amount: Amount,
    },
    /// The centre of mass of a body, together with all bodies that are fixed to it, in its frame. The inertia about it
    /// stays.
    Centre {
        /// The body.
        body: String,
        /// The change of each component.
        amounts: [Amount; 3],
    },
    /// The inertia of a body about its centre of mass, together with all bodies that are fixed to it.
    Inertia {
        /// The body.
        body: String,
        /// The factor of all moments of inertia.
        factor: f64,
    },
    /// A point mass that is fixed to a body.
    Payload {
        /// The body.
        body: String,
        /// Its mass.
        mass: f64,
        /// Its position in the frame of the body.
        at: Vector,
    },
    /// The gain of a position servo, and the equal one of its feedback.
    Kp {
        /// The actuator.
        actuator: String,
        /// The change.
        amount: Amount,
    },
    /// The gain of the rate of a servo.
    Kv {
        /// The actuator.
        actuator: String,
        /// The change.
        amount: Amount,
    },
    /// The transmission ratio of an actuator.
    Gear {
        /// The actuator.
        actuator: String,
        /// The change.
        amount: Amount,
    },
    /// A factor of all the force of an actuator: the `gear` of a motor, gains and bounds of any other one.
    Gain {
        /// The actuator.
        actuator: String,
        /// The factor.
        factor: f64,
    },
    /// A summand of the force of an actuator, before its gear.
    Bias {
        /// The actuator.
        actuator: String,
        /// The summand.
        add: f64,
    },
    /// The time constant of a first-order lag of the command of an actuator, which replaces one that it has.
    Lag {
        /// The actuator.
        actuator: String,
        /// The time constant, in s.
        seconds: f64,
    },
    /// The delay of the command of an actuator, which replaces one that it has.
    Delay {
        /// The actuator.
        actuator: String,
        /// The delay, in s.
        seconds: f64,
    },
    /// The bounds of the force of an actuator, before its gear: the same in both directions, or those of the file times a
    /// factor.
    ForceRange {
        /// The actuator.
        actuator: String,
        /// The change of the upper bound.
        amount: Amount,
    },
    /// Bounds of the force of an actuator, before its gear, in addition to those that it has.
    ForceLimit {
        /// The actuator.
        actuator: String,
        /// Least and largest force.
        range: [f64; 2],
    },
    /// A spring in addition to that of a joint.
    Spring {
        /// The joint.
        joint: String,
        /// Its stiffness.
        stiffness: f64,
        /// Where it is relaxed.
        relaxed_at: f64,
    },
    /// The acceleration of gravity, x, y and z.
    Gravity(Vector),
    /// Backlash behind the drive of a joint: a second joint after it, in the same body and along the same axis. The
    /// drive, its armature and its friction, and the encoder stay at the first one.
    Play {
        /// The joint.
        joint: String,
        /// The whole way from one flank to the other.
        gap: f64,
    },
    /// An encoder that reads the position of a joint with a bias: the range and the spring move along, and the robot
    /// stays where it is.
    Reading {
        /// The joint.
        joint: String,
        /// The reading less the position.
        bias: f64,
    },
}

impl Change {
    /// Whether files of a format can express it. A URDF has no actuators, no springs and no gravity.
    pub fn is_expressed_by(&self, format: Format) -> bool {
        let of_bodies = || {
            matches!(
                self,
                Self::Mass { .. }
                    | Self::Centre { .. }
                    | Self::Inertia { .. }
                    | Self::Payload { .. }
            )
        };
        let of_dynamics = || {
            let Self::Joint { attribute, .. } = self else {
                return false;
            };
            matches!(attribute, JointNumber::Damping | JointNumber::Frictionloss)
        };
        format == Format::Mjcf || of_bodies() || of_dynamics()
    }
}

/// Why a change cannot be made.
pub(super) type Refused = Box<Diagnostic>;

#[allow(
    clippy::unnecessary_box_returns,
    reason = "all refusals are boxed, as errors of results"
)]
pub(super) fn refused(
    code: Code,
    at: Span,
    message: impl Into<String>,
    help: impl Into<String>,
) -> Refused {
    let error = Diagnostic::error(code, message).at(at, "");
    Box::new(error.help(help))
}

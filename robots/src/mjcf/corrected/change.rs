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

/// A number of an element of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Number {
    /// Damping of a joint: the factor of the rate, together with that of its actuators.
    Damping,
    /// Dry friction of a joint.
    Frictionloss,
    /// Reflected inertia of the drive of a joint, together with that of its actuators.
    Armature,
    /// Stiffness of the spring of a joint: the factor of its elongation.
    Stiffness,
    /// Where the spring of a joint is relaxed.
    Springref,
    /// The position of a joint in the pose of the file. Neither the range nor the spring moves along, as they do with
    /// [`Number::Reading`].
    Ref,
    /// What the encoder of a joint reads, less its position, 0 in the file: the range and the spring move along, and the
    /// robot stays where it is.
    Reading,
    /// Backlash behind the drive of a joint, the whole way from one flank to the other, 0 in the file: a second joint after
    /// it, in the same body and along the same axis. The drive, its armature and its friction, and the encoder stay at
    /// the first one.
    Play,
    /// The mass of a body, together with all bodies that are fixed to it. Its centre of mass and its inertia about that
    /// stay.
    Mass,
    /// The inertia of a body about its centre of mass, together with all bodies that are fixed to it: a factor of all
    /// moments of inertia, 1 in the file.
    Inertia,
    /// The gain of a position servo, and the equal one of its feedback.
    Kp,
    /// The gain of the rate of a servo.
    Kv,
    /// The transmission ratio of an actuator.
    Gear,
    /// A factor of all the force of an actuator, 1 in the file: the `gear` of a motor, gains and bounds of any other one.
    Gain,
    /// A summand of the force of an actuator before its gear, 0 in the file.
    Bias,
    /// The time constant of a first-order lag of the command of an actuator, in s.
    Lag,
    /// The delay of the command of an actuator, in s.
    Delay,
    /// The upper bound of the force of an actuator, before its gear: the lower one is of the same size, or both are those of
    /// the file times a factor.
    ForceRange,
}

/// A change of a file; names are those of the file, numbers are in SI.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// A number of a joint, a body or an actuator.
    Number {
        /// The element.
        of: String,
        /// Its number.
        number: Number,
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
    /// A point mass that is fixed to a body.
    Payload {
        /// The body.
        body: String,
        /// Its mass.
        mass: f64,
        /// Its position in the frame of the body.
        at: Vector,
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
}

impl Change {
    /// The change of a number of an element.
    pub fn number(of: impl Into<String>, number: Number, amount: Amount) -> Self {
        let of = of.into();
        Self::Number { of, number, amount }
    }

    /// Whether files of a format can express it. A URDF has no actuators, no springs and no gravity.
    pub fn is_expressed_by(&self, format: Format) -> bool {
        use Number::{Damping, Frictionloss, Inertia, Mass};
        let of_urdf = match self {
            Self::Number { number, .. } => {
                matches!(number, Mass | Inertia | Damping | Frictionloss)
            }
            Self::Centre { .. } | Self::Payload { .. } => true,
            Self::ForceLimit { .. } | Self::Spring { .. } | Self::Gravity(_) => false,
        };
        of_urdf || format == Format::Mjcf
    }
}

/// Why a change cannot be made.
pub(super) type Refused = Diagnostic;

pub(super) fn refused(
    code: Code,
    at: Span,
    message: impl Into<String>,
    help: impl Into<String>,
) -> Refused {
    Diagnostic::error(code, message).at(at, "").help(help)
}

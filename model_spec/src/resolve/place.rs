//! Contexts of expressions, and the quantities that may occur there.

use crate::expr::{Motion, Quantity, Response, Word};
use crate::mechanism::Interpolation;

/// A context of expressions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// The context as named in messages: `the angle of a frame`.
    pub(super) what: &'static str,
    /// Which quantities may occur, besides parameters and `pi`.
    allows: u16,
    /// How smooth a signal must be here.
    pub(super) smooth: Smooth,
    /// Whether the expression must be linear in the rates.
    pub(super) linear: bool,
}

/// How smooth a signal must be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Smooth {
    /// Not at all.
    Any,
    /// It is differentiated once.
    Once,
    /// It is differentiated twice.
    Twice,
}

const COORDINATES: u16 = 1;
const RATES: u16 = 2;
const SPEEDS: u16 = 4;
const INPUTS: u16 = 8;
const TIME: u16 = 16;
const MOTIONS: u16 = 32;
const ACCELERATIONS: u16 = 64;
const FORCES: u16 = 128;
const POSITIONS: u16 = 256;

impl Place {
    const fn new(what: &'static str, allows: u16, smooth: Smooth) -> Self {
        Self {
            what,
            allows,
            smooth,
            linear: false,
        }
    }

    const fn linear(what: &'static str) -> Self {
        Self {
            linear: true,
            ..Self::new(what, COORDINATES | RATES | TIME, Smooth::Once)
        }
    }

    /// A property of a body or of the surroundings.
    pub(super) const fn constant(what: &'static str) -> Self {
        Self::new(what, 0, Smooth::Any)
    }

    /// A position or an angle.
    pub(super) const fn geometry(what: &'static str) -> Self {
        Self::new(what, COORDINATES | TIME, Smooth::Twice)
    }

    /// A position constraint.
    pub(super) const fn closure(what: &'static str) -> Self {
        Self::new(what, COORDINATES | TIME | POSITIONS, Smooth::Twice)
    }

    /// A prescribed velocity.
    pub(super) const fn prescribed(what: &'static str) -> Self {
        Self::new(what, COORDINATES | TIME, Smooth::Once)
    }

    /// A property of a surface.
    pub(super) const fn surface(what: &'static str) -> Self {
        Self::new(what, COORDINATES | TIME, Smooth::Any)
    }

    /// A property that may be scheduled in time.
    pub(super) const fn scheduled(what: &'static str) -> Self {
        Self::new(what, TIME, Smooth::Any)
    }

    /// A force.
    pub(super) const fn force(what: &'static str) -> Self {
        let all = COORDINATES | RATES | SPEEDS | INPUTS | TIME | POSITIONS | MOTIONS | FORCES;
        Self::new(what, all, Smooth::Any)
    }

    /// A feedback law.
    pub(super) const fn law(what: &'static str) -> Self {
        Self::new(what, COORDINATES | SPEEDS | TIME, Smooth::Any)
    }

    /// A value computed from others along a motion.
    pub(super) const fn motion(what: &'static str) -> Self {
        Self::new(what, COORDINATES | RATES | SPEEDS, Smooth::Any)
    }

    /// The right-hand side of an equation of motion.
    pub(super) const fn equation(what: &'static str) -> Self {
        Self::new(what, COORDINATES | SPEEDS | INPUTS | TIME, Smooth::Any)
    }

    /// A quantity of interest.
    pub(super) const OUTPUT: Self = Self::new("an output", u16::MAX, Smooth::Any);
    /// A named expression.
    pub(super) const DEFINITION: Self = Self::new("a definition", u16::MAX, Smooth::Any);
    /// Definition of a pseudo-velocity.
    pub(super) const SPEED: Self = Self {
        allows: COORDINATES | RATES | TIME | POSITIONS | MOTIONS,
        ..Self::linear("a pseudo-velocity")
    };
    /// Velocity along which a force acts.
    pub(super) const ALONG: Self = Self {
        allows: COORDINATES | RATES | SPEEDS | TIME | POSITIONS | MOTIONS,
        ..Self::linear("the velocity along which a force acts")
    };
    /// Left side of a velocity constraint.
    pub(super) const RATE_ROW: Self = Self {
        allows: COORDINATES | RATES | TIME | POSITIONS | MOTIONS,
        ..Self::linear("a velocity constraint")
    };

    pub(super) fn allows(&self, quantity: Quantity) -> bool {
        let asked = match quantity {
            Quantity::Parameter(_) | Quantity::Pi => 0,
            Quantity::Coordinate(_) => COORDINATES,
            Quantity::Rate(_) => RATES,
            Quantity::PseudoVelocity(_) => SPEEDS,
            Quantity::Input(_) => INPUTS,
            Quantity::Signal(_) | Quantity::Time => TIME,
            Quantity::Motion(Motion::Position(..)) => POSITIONS,
            Quantity::Motion(_) => MOTIONS,
            Quantity::Response(
                Response::Acceleration(..)
                | Response::AngularAcceleration(..)
                | Response::DriveForce(_),
            ) => ACCELERATIONS,
            Quantity::Response(_) => FORCES,
        };
        self.allows & asked == asked
    }

    /// Whether a kind of kinematic quantity or force may occur.
    pub(super) fn allows_word(&self, word: Word) -> bool {
        let asked = match word {
            Word::Position => POSITIONS,
            Word::Velocity | Word::Speed | Word::AngularVelocity => MOTIONS,
            Word::Acceleration | Word::AngularAcceleration | Word::DriveForce => ACCELERATIONS,
            Word::Reaction | Word::NormalForce | Word::Force => FORCES,
        };
        self.allows & asked == asked
    }

    /// Whether it may depend on the configuration.
    pub(super) fn allows_coordinates(&self) -> bool {
        self.allows & COORDINATES != 0
    }

    /// Whether it is a force of the mechanism.
    pub(super) fn is_force(&self) -> bool {
        self.allows & FORCES != 0 && self.allows & ACCELERATIONS == 0
    }

    /// The quantities that may occur here, as listed in messages.
    pub(super) fn allowed_words(&self) -> String {
        let mut words = vec!["parameters"];
        for (flag, word) in [
            (COORDINATES, "coordinates"),
            (RATES, "rates"),
            (SPEEDS, "pseudo-velocities"),
            (INPUTS, "inputs"),
            (TIME, "signals and time"),
            (POSITIONS, "positions of points"),
            (MOTIONS, "velocities of points and frames"),
            (FORCES, "forces of loads and constraints"),
            (ACCELERATIONS, "accelerations"),
        ] {
            if self.allows & flag != 0 {
                words.push(word);
            }
        }
        words.join(", ")
    }
}

impl Smooth {
    /// Whether a function as smooth as this interpolation is allowed: a jump counts as `hold`, a
    /// kink as `linear`.
    pub(super) fn admits(self, interpolation: Interpolation) -> bool {
        match self {
            Self::Any => true,
            Self::Once => interpolation != Interpolation::Hold,
            Self::Twice => interpolation == Interpolation::Cubic,
        }
    }

    /// The required interpolation.
    pub(super) const fn remedy(self) -> &'static str {
        match self {
            Self::Any => "hold",
            Self::Once => "linear",
            Self::Twice => "cubic",
        }
    }
}

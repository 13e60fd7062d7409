//! Properties that are left out of a robot on request.

use std::str::FromStr;

use appell_spec::did_you_mean;

use crate::model::Robot;

/// A property of robots that a spec may omit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Without {
    /// Damping in proportion to rates.
    Damping,
    /// Inertia of drives (armature).
    Armature,
    /// Springs of joints and tendons.
    Springs,
    /// Dry friction.
    Friction,
    /// Ranges of coordinates.
    Limits,
    /// Couplings of joints and loop closures: all joints are then independent.
    Couplings,
    /// Forces that compensate the weight of links (`gravcomp`).
    Compensation,
    /// Unused points at the origins of links.
    Points,
}

impl Without {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Damping,
        Self::Armature,
        Self::Springs,
        Self::Friction,
        Self::Limits,
        Self::Couplings,
        Self::Compensation,
        Self::Points,
    ];

    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Damping => "damping",
            Self::Armature => "armature",
            Self::Springs => "springs",
            Self::Friction => "friction",
            Self::Limits => "limits",
            Self::Couplings => "couplings",
            Self::Compensation => "compensation",
            Self::Points => "points",
        }
    }

    pub(crate) fn apply(self, robot: &mut Robot) {
        if self == Self::Couplings {
            robot.couplings.clear();
            robot.connections.clear();
        }
        for tendon in &mut robot.tendons {
            match self {
                Self::Damping => tendon.damping = [0.0; 3],
                Self::Armature => tendon.armature = 0.0,
                Self::Springs => tendon.stiffness = [0.0; 3],
                Self::Friction => tendon.friction = 0.0,
                _ => {}
            }
        }
        for link in &mut robot.links {
            if self == Self::Compensation {
                link.carried = 0.0;
            }
            if let Some(joint) = &mut link.joint {
                match self {
                    Self::Damping => joint.damping = [0.0; 3],
                    Self::Armature => joint.armature = 0.0,
                    Self::Springs => joint.stiffness = [0.0; 3],
                    Self::Friction => joint.friction = 0.0,
                    Self::Limits => joint.range = None,
                    Self::Couplings | Self::Compensation | Self::Points => {}
                }
            }
        }
    }
}

impl FromStr for Without {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|one| one.word() == word);
        found.ok_or_else(|| {
            let words = Self::ALL.map(Self::word);
            let help = did_you_mean(word, words, || format!("it can be {}", words.join(", ")));
            let word = appell_spec::shown(word);
            format!("there is nothing called `{word}` to leave out; {help}")
        })
    }
}

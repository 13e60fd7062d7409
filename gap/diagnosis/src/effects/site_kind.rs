//! Kinds of sites at which effects act, and the placeholders that each defines.

/// Kinds of sites.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SiteKind {
    /// A coordinate whose rate appears in a pseudo-velocity.
    Coordinate,
    /// Such a coordinate that is a length.
    Slider,
    /// Such a coordinate that is an angle.
    Hinge,
    /// A slider whose rate is a pseudo-velocity, driven by an input.
    DrivenSlider,
    /// Such a hinge.
    DrivenHinge,
    /// A body.
    Body,
    /// A body with a frame.
    RigidBody,
    /// A body that rolls.
    Wheel,
    /// A rolling contact that does not creep yet.
    Contact,
    /// The weight.
    Gravity,
    /// A parameter.
    Parameter,
    /// An input.
    Input,
    /// A measured channel.
    Channel,
    /// A measured coordinate that reversed at an end of its range.
    Reached,
    /// Two coordinates.
    Pair,
    /// A load that depends on the motion like a feedback controller.
    Load,
    /// Such a load with the name of its input, the actuator of a robot.
    Servo,
    /// A coordinate that the actuator of a robot drives: a load with the name of its input.
    Joint,
    /// A channel that measures such a coordinate.
    Encoder,
}

/// Keyword, kind and description.
const WORDS: [(&str, SiteKind, &str); 19] = [
    (
        "coordinate",
        SiteKind::Coordinate,
        "length or angle that is not prescribed",
    ),
    ("slider", SiteKind::Slider, "length that is not prescribed"),
    ("hinge", SiteKind::Hinge, "angle that is not prescribed"),
    (
        "driven_slider",
        SiteKind::DrivenSlider,
        "driven length whose rate is a pseudo-velocity",
    ),
    (
        "driven_hinge",
        SiteKind::DrivenHinge,
        "driven angle whose rate is a pseudo-velocity",
    ),
    ("body", SiteKind::Body, "body"),
    ("rigid_body", SiteKind::RigidBody, "body with a frame"),
    ("wheel", SiteKind::Wheel, "body that rolls"),
    ("contact", SiteKind::Contact, "rolling contact"),
    ("gravity", SiteKind::Gravity, "weight"),
    (
        "parameter",
        SiteKind::Parameter,
        "parameter with a tolerance",
    ),
    ("input", SiteKind::Input, "input that was used"),
    ("channel", SiteKind::Channel, "measured column"),
    (
        "reached",
        SiteKind::Reached,
        "measured coordinate that reversed at an end of its range",
    ),
    (
        "pair",
        SiteKind::Pair,
        "pair of coordinates, of neighbours only where there are many",
    ),
    (
        "load",
        SiteKind::Load,
        "load that depends on the motion like a feedback controller",
    ),
    (
        "servo",
        SiteKind::Servo,
        "such a load with the name of its input, the actuator of a robot",
    ),
    (
        "joint",
        SiteKind::Joint,
        "coordinate driven by the actuator of a robot: a load with the name of its input",
    ),
    (
        "encoder",
        SiteKind::Encoder,
        "measured column of such a coordinate",
    ),
];

impl SiteKind {
    pub(super) fn of(word: &str) -> Option<Self> {
        let found = WORDS.iter().find(|(own, ..)| *own == word);
        found.map(|(_, kind, _)| *kind)
    }

    #[cfg(test)]
    pub(super) fn all() -> impl Iterator<Item = Self> {
        WORDS.into_iter().map(|(_, kind, _)| kind)
    }

    pub(super) fn kinds() -> String {
        WORDS.map(|(word, ..)| word).join(", ")
    }

    /// Its keyword.
    pub fn word(self) -> &'static str {
        self.row().map_or("", |(word, ..)| word)
    }

    /// Description of such a site.
    pub fn about(self) -> &'static str {
        self.row().map_or("", |(.., about)| about)
    }

    /// Whether an effect there may add a coordinate.
    pub(super) const fn bears_coordinate(self) -> bool {
        matches!(self, Self::DrivenSlider | Self::DrivenHinge)
    }

    fn row(self) -> Option<&'static (&'static str, Self, &'static str)> {
        WORDS.iter().find(|(_, kind, _)| *kind == self)
    }

    /// Lists of placeholders at such a site, in addition to `effect` and `site`.
    pub(super) fn words(self) -> &'static [&'static [&'static str]] {
        match self {
            Self::Coordinate | Self::Slider | Self::Hinge | Self::Joint => &[OF_COORDINATE, ACROSS],
            Self::DrivenSlider | Self::DrivenHinge => {
                &[OF_COORDINATE, ACROSS, OF_DRIVEN, LATER_DRIVEN]
            }
            Self::Reached => &[OF_COORDINATE, ACROSS, OF_REACHED],
            Self::Pair => &[OF_PAIR],
            Self::Body => &[OF_BODY, LATER_BODY],
            Self::RigidBody => &[OF_BODY, OF_RIGID, LATER_BODY],
            Self::Wheel => &[OF_BODY, OF_WHEEL, LATER_BODY],
            Self::Gravity => &[&["gravity"], ACROSS],
            Self::Input => &[&["unit", "largest", "narrow"]],
            Self::Load | Self::Servo => &[&["expression", "unit", "largest", "narrow"]],
            Self::Encoder => &[&["coordinate", "unit"]],
            Self::Contact | Self::Parameter | Self::Channel => &[],
        }
    }
}

const OF_COORDINATE: &[&str] = &["unit", "force", "typical_rate", "narrow_rate"];
const ACROSS: &[&str] = &["across_1", "across_2", "across_x", "across_y", "across_z"];
const OF_DRIVEN: &[&str] = &["pseudo_velocity"];
const OF_BODY: &[&str] = &[
    "centre",
    "frame",
    "speed",
    "velocity_x",
    "velocity_y",
    "velocity_z",
];
const OF_REACHED: &[&str] = &["upper", "lower", "range"];
const OF_RIGID: &[&str] = &["away_x", "away_y", "away_z", "reach"];
const OF_PAIR: &[&str] = &[
    "first",
    "second",
    "first_unit",
    "second_unit",
    "first_force",
    "second_force",
    "ratio",
];
const OF_WHEEL: &[&str] = &[
    "contact",
    "roll",
    "narrow_rate",
    "axle_rate",
    "spin",
    "normal_x",
    "normal_y",
    "normal_z",
];
/// Placeholders whose texts depend on the equations of the mechanism.
pub(super) const LATER_DRIVEN: &[&str] = &["drive", "inertia"];
/// A placeholder whose text depends on the other effects of the body.
pub(super) const LATER_BODY: &[&str] = &["last_centre"];

//! The sections and their keys.

use super::joints::JOINTS;
use super::keys::{ABOUT, AXES, IN, TURNS, UNIT, UNIT_CHECKED, key};
use super::kinds::{CONSTRAINTS, LOADS};
use super::{Form, Key, Need, Presence, Section, Sense, Shape, Target, Word};
use crate::mechanism::Interpolation;

const fn interpolation(text: &'static str, interpolation: Interpolation) -> Word {
    let sense = Sense::Interpolation(interpolation);
    Word { text, sense }
}

/// The words for the interpolation of a signal.
pub static INTERPOLATIONS: &[Word] = &[
    interpolation("hold", Interpolation::Hold),
    interpolation("linear", Interpolation::Linear),
    interpolation("cubic", Interpolation::Cubic),
];

/// Every section, in the customary order of a spec.
pub static SECTIONS: &[Section] = &[
    Section {
        name: "mechanism",
        about: "Name and origin of the mechanism.",
        presence: Presence::Required,
        shape: Shape::Table(&[
            key(
                "name",
                Form::Name,
                Need::Always,
                "Name of the mechanism, a valid identifier.",
            ),
            key("title", Form::Text, Need::Always, "One-line title."),
            key(
                "source",
                Form::Text,
                Need::Optional,
                "Source of the model: paper and equations.",
            ),
            key(
                "longest_step",
                Form::Number,
                Need::Optional,
                "Longest step, in s, of the filters that follow recordings; 0.02 by default.",
            ),
        ]),
    },
    Section {
        name: "parameters",
        about: "Constants of the mechanism.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key(
                    "value",
                    Form::Number,
                    Need::Always,
                    "Value in the parameter's unit.",
                ),
                UNIT,
                ABOUT,
                key(
                    "at_least",
                    Form::Number,
                    Need::Optional,
                    "Smallest admissible value.",
                ),
                key(
                    "at_most",
                    Form::Number,
                    Need::Optional,
                    "Largest admissible value.",
                ),
                key(
                    "std",
                    Form::Number,
                    Need::Optional,
                    "Standard deviation to which the value is known: the tolerance of recordings that state none.",
                ),
            ],
            None,
        ),
    },
    Section {
        name: "coordinates",
        about: "Generalised coordinates.",
        presence: Presence::Unless("joints"),
        shape: Shape::Items(
            &[
                UNIT,
                ABOUT,
                key(
                    "range",
                    Form::Range,
                    Need::Optional,
                    "Range in which the model is valid.",
                ),
                key(
                    "initial",
                    Form::Number,
                    Need::Optional,
                    "Initial value; 0 by default.",
                ),
            ],
            None,
        ),
    },
    Section {
        name: "inputs",
        about: "Quantities that a controller or a recording supplies.",
        presence: Presence::Optional,
        shape: Shape::Items(&[UNIT, ABOUT], None),
    },
    Section {
        name: "signals",
        about: "Known functions of time, given as data.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key(
                    "t",
                    Form::Numbers,
                    Need::Always,
                    "Times in seconds, strictly increasing.",
                ),
                key(
                    "value",
                    Form::Numbers,
                    Need::Always,
                    "One value for each time.",
                ),
                UNIT,
                key(
                    "interpolation",
                    Form::Word(INTERPOLATIONS),
                    Need::Optional,
                    "Interpolation between samples; `linear` by default.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "definitions",
        about: "Named expressions, for use in others.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key("value", Form::Expression, Need::Always, "Value."),
                UNIT_CHECKED,
                ABOUT,
            ],
            Some("value"),
        ),
    },
    Section {
        name: "frames",
        about: "Frames, each rotated from its parent.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key(
                    "parent",
                    Form::Reference(Target::Frame),
                    Need::Always,
                    "Frame from which this one is rotated.",
                ),
                key(
                    "about_axis",
                    Form::Word(AXES),
                    Need::Way(0),
                    "Axis of the rotation.",
                ),
                key(
                    "by",
                    Form::Expression,
                    Need::Way(0),
                    "Angle of the rotation, right-handed about the axis.",
                ),
                key(
                    "turns",
                    Form::Tables(TURNS),
                    Need::Way(1),
                    "Several rotations, starting from the parent.",
                ),
                key(
                    "quaternion",
                    Form::Quaternion,
                    Need::Way(2),
                    "Orientation without a singularity: scalar part and vector part of a unit quaternion.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "points",
        about: "Points, each placed from another.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key(
                    "from",
                    Form::Reference(Target::Point),
                    Need::Always,
                    "Point from which this one is placed.",
                ),
                IN,
                key(
                    "at",
                    Form::Components,
                    Need::Always,
                    "Position from that point.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "joints",
        about: "Joints: each stands for a frame, a point, their coordinates and pseudo-velocities.",
        presence: Presence::Optional,
        shape: Shape::Kinds(JOINTS),
    },
    Section {
        name: "bodies",
        about: "Rigid bodies and point masses.",
        presence: Presence::Required,
        shape: Shape::Items(
            &[
                key(
                    "frame",
                    Form::Reference(Target::Frame),
                    Need::Optional,
                    "Frame fixed in the body; a point mass has none.",
                ),
                key(
                    "centre",
                    Form::Reference(Target::Point),
                    Need::Always,
                    "Centre of mass.",
                ),
                key("mass", Form::Expression, Need::Always, "Mass."),
                key(
                    "inertia",
                    Form::Inertia(INERTIA),
                    Need::Optional,
                    "Inertia about the centre of mass; of a body that moves in a plane the moment about its normal.",
                ),
                key(
                    "taken_away",
                    Form::Flag,
                    Need::Optional,
                    "Whether mass and inertia are subtracted: a hole, or a part already included in another body.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "constraints",
        about: "Constraints on velocities and positions.",
        presence: Presence::Optional,
        shape: Shape::Kinds(CONSTRAINTS),
    },
    Section {
        name: "pseudo_velocities",
        about: "The pseudo-velocities of Appell's equations.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key(
                    "value",
                    Form::Expression,
                    Need::Always,
                    "Definition, linear in the rates `dot(q)`.",
                ),
                UNIT_CHECKED,
                ABOUT,
                key(
                    "rate",
                    Form::Expression,
                    Need::Optional,
                    "Its rate, where a drive gives it: an expression in inputs, `t`, signals and states.",
                ),
                key(
                    "initial",
                    Form::Number,
                    Need::Optional,
                    "Initial value; 0 by default.",
                ),
            ],
            Some("value"),
        ),
    },
    Section {
        name: "loads",
        about: "Applied forces and torques.",
        presence: Presence::Optional,
        shape: Shape::Kinds(LOADS),
    },
    Section {
        name: "outputs",
        about: "Named quantities of interest.",
        presence: Presence::Optional,
        shape: Shape::Items(
            &[
                key("value", Form::Expression, Need::Always, "Value."),
                UNIT_CHECKED,
                ABOUT,
            ],
            Some("value"),
        ),
    },
    Section {
        name: "initial",
        about: "Initial values of coordinates and pseudo-velocities, each in its unit.",
        presence: Presence::Optional,
        shape: Shape::States,
    },
];

static INERTIA: &[Key] = &[
    IN,
    key(
        "diagonal",
        Form::Components,
        Need::Way(0),
        "Principal moments; the axes of the frame are principal axes.",
    ),
    key(
        "matrix",
        Form::Matrix,
        Need::Way(1),
        "The inertia tensor, row by row.",
    ),
    key(
        "moments",
        Form::Components,
        Need::Way(2),
        "`[I_xx, I_yy, I_zz]`.",
    ),
    key(
        "products",
        Form::Components,
        Need::Way(2),
        "`[I_xy, I_xz, I_yz]` with `I_xy = -∫ x y dm`.",
    ),
];

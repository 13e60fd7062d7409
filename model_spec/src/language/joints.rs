//! The kinds of joints and their keys.

use super::keys::{ABOUT, AXES, TURNS as TURN, key};
use super::{Form, ItemKind, JointWord, Key, Kind, Need, Target};

const PARENT: Key = key(
    "parent",
    Form::Reference(Target::Frame),
    Need::Optional,
    "Frame that carries the joint; the ground by default.",
);
const FROM: Key = key(
    "from",
    Form::Reference(Target::Point),
    Need::Optional,
    "Point from which the joint is placed; the point with the name of `parent` by default, `O` on the ground.",
);
const AT: Key = key(
    "at",
    Form::Components,
    Need::Optional,
    "Place of the joint from that point, in `parent`; there by default.",
);
const TURNS: Key = key(
    "turns",
    Form::Tables(TURN),
    Need::Optional,
    "Rotations from `parent` to the joint, before its own motion.",
);
const AXIS: Key = key(
    "axis",
    Form::Direction,
    Need::Always,
    "Axis of the joint: a word, or a direction of any length.",
);
const RANGE: Key = key(
    "range",
    Form::Range,
    Need::Optional,
    "Range of the coordinate, in which the model is valid.",
);
const INITIAL: Key = key(
    "initial",
    Form::Number,
    Need::Optional,
    "Initial value of the coordinate; 0 by default.",
);
const COORDINATE: Key = key(
    "coordinate",
    Form::NewName,
    Need::Optional,
    "Name of the coordinate; `q_NAME` by default.",
);
const OMEGA: Key = key(
    "speed",
    Form::NewName,
    Need::Optional,
    "Name of the pseudo-velocity; `omega_NAME` by default.",
);

const DEPENDENT: Key = key(
    "dependent",
    Form::Flag,
    Need::Optional,
    "Whether the joint makes no pseudo-velocities: its rates follow from constraints and from those written elsewhere.",
);

const fn coordinates(count: usize, about: &'static str) -> Key {
    key("coordinates", Form::NewNames(count), Need::Optional, about)
}

const fn speeds(count: usize, about: &'static str) -> Key {
    key("speeds", Form::NewNames(count), Need::Optional, about)
}

const fn initial(count: usize) -> Key {
    key(
        "initial",
        Form::Values(count),
        Need::Optional,
        "Initial values of the coordinates; 0 by default.",
    )
}

pub(super) static JOINTS: &[Kind] = &[
    Kind {
        word: "revolute",
        is: ItemKind::Joint(JointWord::Revolute),
        about: "A turn about an axis.",
        keys: &[
            PARENT,
            FROM,
            AT,
            TURNS,
            AXIS,
            COORDINATE,
            OMEGA,
            DEPENDENT,
            key(
                "offset",
                Form::Expression,
                Need::Optional,
                "Angle where the coordinate is 0; 0 by default.",
            ),
            RANGE,
            INITIAL,
            ABOUT,
        ],
    },
    Kind {
        word: "prismatic",
        is: ItemKind::Joint(JointWord::Prismatic),
        about: "A displacement along an axis.",
        keys: &[
            PARENT,
            FROM,
            AT,
            TURNS,
            AXIS,
            COORDINATE,
            key(
                "speed",
                Form::NewName,
                Need::Optional,
                "Name of the pseudo-velocity; `v_NAME` by default.",
            ),
            DEPENDENT,
            key(
                "offset",
                Form::Expression,
                Need::Optional,
                "Displacement where the coordinate is 0; 0 by default.",
            ),
            RANGE,
            INITIAL,
            ABOUT,
        ],
    },
    Kind {
        word: "cylindrical",
        is: ItemKind::Joint(JointWord::Cylindrical),
        about: "A turn about an axis and a displacement along it.",
        keys: &[
            PARENT,
            FROM,
            AT,
            TURNS,
            AXIS,
            coordinates(
                2,
                "Names of angle and displacement; `q_NAME` and `s_NAME` by default.",
            ),
            speeds(
                2,
                "Names of their rates; `omega_NAME` and `v_NAME` by default.",
            ),
            DEPENDENT,
            initial(2),
            ABOUT,
        ],
    },
    Kind {
        word: "screw",
        is: ItemKind::Joint(JointWord::Screw),
        about: "A turn about an axis that moves along it.",
        keys: &[
            PARENT,
            FROM,
            AT,
            TURNS,
            AXIS,
            key(
                "pitch",
                Form::Expression,
                Need::Always,
                "Displacement along the axis in one revolution.",
            ),
            COORDINATE,
            OMEGA,
            DEPENDENT,
            RANGE,
            INITIAL,
            ABOUT,
        ],
    },
    Kind {
        word: "universal",
        is: ItemKind::Joint(JointWord::Universal),
        about: "A turn about an axis, then one about a second axis, which the first turn carries along.",
        keys: &[
            PARENT,
            FROM,
            AT,
            TURNS,
            AXIS,
            key(
                "second_axis",
                Form::Direction,
                Need::Always,
                "Axis of the second turn, in the frame after the first.",
            ),
            coordinates(
                2,
                "Names of the angles; `q1_NAME` and `q2_NAME` by default.",
            ),
            speeds(
                2,
                "Names of their rates; `omega1_NAME` and `omega2_NAME` by default.",
            ),
            DEPENDENT,
            initial(2),
            ABOUT,
        ],
    },
    Kind {
        word: "planar",
        is: ItemKind::Joint(JointWord::Planar),
        about: "Displacements in the plane across an axis, and a turn about it.",
        keys: &[
            PARENT,
            FROM,
            AT,
            TURNS,
            key(
                "axis",
                Form::Word(AXES),
                Need::Always,
                "Axis across the plane.",
            ),
            coordinates(
                3,
                "Names of two displacements and the angle; for the axis z `x_NAME`, `y_NAME`, `q_NAME` by default.",
            ),
            speeds(
                3,
                "Names of their rates; for the axis z `v_x_NAME`, `v_y_NAME`, `omega_NAME` by default.",
            ),
            DEPENDENT,
            initial(3),
            ABOUT,
        ],
    },
    Kind {
        word: "ball",
        is: ItemKind::Joint(JointWord::Ball),
        about: "Turns about every axis, as a unit quaternion.",
        keys: &[
            PARENT,
            FROM,
            AT,
            coordinates(
                4,
                "Names of the components of the quaternion, the scalar part first; `e0_NAME` to `e3_NAME` by default.",
            ),
            speeds(
                3,
                "Names of the components of the angular velocity relative to `parent`, in the frame of the joint; `omega_x_NAME`, `omega_y_NAME`, `omega_z_NAME` by default.",
            ),
            DEPENDENT,
            initial(4),
            ABOUT,
        ],
    },
    Kind {
        word: "free",
        is: ItemKind::Joint(JointWord::Free),
        about: "Displacements along the axes of `parent`, and turns about every axis.",
        keys: &[
            PARENT,
            FROM,
            AT,
            coordinates(
                7,
                "Names of the displacements and of the components of the quaternion; `x_NAME`, `y_NAME`, `z_NAME`, `e0_NAME` to `e3_NAME` by default.",
            ),
            speeds(
                6,
                "Names of the rates of the displacements and of the components of the angular velocity, as of `ball`; `v_x_NAME` to `v_z_NAME`, `omega_x_NAME` to `omega_z_NAME` by default.",
            ),
            DEPENDENT,
            initial(7),
            ABOUT,
        ],
    },
    Kind {
        word: "fixed",
        is: ItemKind::Joint(JointWord::Fixed),
        about: "No motion: a frame and a point that `parent` carries.",
        keys: &[PARENT, FROM, AT, TURNS, ABOUT],
    },
];

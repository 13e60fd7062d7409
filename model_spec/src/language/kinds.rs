//! The kinds of constraints and loads, and their keys.

use super::keys::{ABOUT, AXES, IN, key};
use super::{ConstraintWord, Form, ItemKind, Kind, LoadWord, Need, Target};

pub(super) static CONSTRAINTS: &[Kind] = &[
    Kind {
        word: "rolling",
        is: ItemKind::Constraint(ConstraintWord::Rolling),
        about: "The material point of a body at the contact moves as the surface does: on the ground it is at rest.",
        keys: &[
            key(
                "body",
                Form::Reference(Target::Body),
                Need::Always,
                "Rolling body.",
            ),
            key(
                "contact",
                Form::Reference(Target::Point),
                Need::Always,
                "Contact point.",
            ),
            key(
                "on",
                Form::Reference(Target::Body),
                Need::Optional,
                "Body that carries the surface, such as a turntable; the ground by default.",
            ),
            key(
                "normal",
                Form::Word(AXES),
                Need::Optional,
                "Axis of `in` that points from the surface into the body; upwards by default.",
            ),
            key(
                "in",
                Form::Reference(Target::Frame),
                Need::Optional,
                "Frame of the normal; the ground by default.",
            ),
            key(
                "friction",
                Form::Expression,
                Need::Optional,
                "Coefficient of friction, with which the friction demand is compared.",
            ),
            key(
                "longitudinal_creep",
                Form::Expression,
                Need::Optional,
                "Longitudinal creep coefficient: sliding velocity over travelling velocity, per tangential force over normal force.",
            ),
            key(
                "lateral_creep",
                Form::Expression,
                Need::Optional,
                "Lateral creep coefficient.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "velocity",
        is: ItemKind::Constraint(ConstraintWord::Velocity),
        about: "A combination of rates has a prescribed value.",
        keys: &[
            key(
                "zero",
                Form::Expression,
                Need::Always,
                "Combination, linear in the rates `dot(q)`.",
            ),
            key(
                "equals",
                Form::Expression,
                Need::Optional,
                "Prescribed value; 0 by default.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "fixed_velocity",
        is: ItemKind::Constraint(ConstraintWord::FixedVelocity),
        about: "A point has a prescribed velocity along a direction.",
        keys: &[
            key(
                "point",
                Form::Reference(Target::Point),
                Need::Always,
                "The point.",
            ),
            key(
                "body",
                Form::Reference(Target::Body),
                Need::Optional,
                "Body whose material point at that place is meant.",
            ),
            key(
                "direction",
                Form::Components,
                Need::Always,
                "Direction; its length scales the velocity.",
            ),
            IN,
            key(
                "equals",
                Form::Expression,
                Need::Optional,
                "Prescribed velocity; 0 by default.",
            ),
            key(
                "one_sided",
                Form::Flag,
                Need::Optional,
                "Whether the reaction can only push along the direction, as a contact does.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "position",
        is: ItemKind::Constraint(ConstraintWord::Position),
        about: "An equation between coordinates.",
        keys: &[
            key(
                "zero",
                Form::Expression,
                Need::Always,
                "Combination of coordinates that stays zero.",
            ),
            key(
                "dependent",
                Form::Reference(Target::Coordinate),
                Need::Optional,
                "Coordinate to be solved for; chosen automatically by default.",
            ),
            key(
                "one_sided",
                Form::Flag,
                Need::Optional,
                "Whether the reaction can only push, towards positive `zero`, as a contact does.",
            ),
            ABOUT,
        ],
    },
];

pub(super) static LOADS: &[Kind] = &[
    Kind {
        word: "gravity",
        is: ItemKind::Load(LoadWord::Gravity),
        about: "Weight of every body.",
        keys: &[
            key(
                "down",
                Form::Word(AXES),
                Need::Always,
                "Direction of gravity, an axis of the ground.",
            ),
            key(
                "acceleration",
                Form::Expression,
                Need::Always,
                "Gravitational acceleration.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "force",
        is: ItemKind::Load(LoadWord::Force),
        about: "A force on a point.",
        keys: &[
            key(
                "on",
                Form::Reference(Target::Point),
                Need::Always,
                "Point of application.",
            ),
            key(
                "body",
                Form::Reference(Target::Body),
                Need::Optional,
                "Body whose material point at that place is meant.",
            ),
            key(
                "reaction_on",
                Form::Reference(Target::Point),
                Need::Optional,
                "Point on which the opposite force acts.",
            ),
            IN,
            key(
                "vector",
                Form::Components,
                Need::Always,
                "Components of the force.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "torque",
        is: ItemKind::Load(LoadWord::Torque),
        about: "A torque on a body.",
        keys: &[
            key("on", Form::Reference(Target::Body), Need::Always, "Body."),
            key(
                "reaction_on",
                Form::Reference(Target::Body),
                Need::Optional,
                "Body on which the opposite torque acts.",
            ),
            IN,
            key(
                "vector",
                Form::Components,
                Need::Always,
                "Components of the torque.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "spring",
        is: ItemKind::Load(LoadWord::Spring),
        about: "A linear spring.",
        keys: &[
            key(
                "between",
                Form::Two(Target::Point),
                Need::Way(0),
                "The two points it connects.",
            ),
            key(
                "coordinate",
                Form::Reference(Target::Coordinate),
                Need::Way(1),
                "Coordinate on which it acts.",
            ),
            key("stiffness", Form::Expression, Need::Always, "Stiffness."),
            key(
                "relaxed",
                Form::Expression,
                Need::Optional,
                "Unstretched length, or coordinate at rest; 0 by default.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "damper",
        is: ItemKind::Load(LoadWord::Damper),
        about: "A linear damper.",
        keys: &[
            key(
                "between",
                Form::Two(Target::Point),
                Need::Way(0),
                "The two points it connects.",
            ),
            key(
                "coordinate",
                Form::Reference(Target::Coordinate),
                Need::Way(1),
                "Coordinate on which it acts.",
            ),
            key(
                "damping",
                Form::Expression,
                Need::Always,
                "Damping coefficient.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "torsional_spring",
        is: ItemKind::Load(LoadWord::TorsionalSpring),
        about: "A torsional spring between two frames that turn relative to each other about one axis, and a damper in parallel.",
        keys: &[
            key(
                "between",
                Form::Two(Target::Frame),
                Need::Always,
                "The two frames; the angle is the sum of the turns from the first to the second.",
            ),
            key(
                "stiffness",
                Form::Expression,
                Need::Always,
                "Torque per angle.",
            ),
            key(
                "relaxed",
                Form::Expression,
                Need::Optional,
                "Angle without torque; 0 by default.",
            ),
            key(
                "damping",
                Form::Expression,
                Need::Optional,
                "Torque per angular velocity; none by default.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "generalized",
        is: ItemKind::Load(LoadWord::Generalized),
        about: "A generalised force: its power is `force * dot(coordinate)`, or `force * velocity`.",
        keys: &[
            key(
                "coordinate",
                Form::Reference(Target::Coordinate),
                Need::Way(0),
                "Coordinate along which it acts.",
            ),
            key(
                "velocity",
                Form::Expression,
                Need::Way(1),
                "Velocity along which it acts: a pseudo-velocity, or a combination linear in pseudo-velocities and rates.",
            ),
            key(
                "force",
                Form::Expression,
                Need::Always,
                "Generalised force.",
            ),
            ABOUT,
        ],
    },
];

//! The vocabulary: every section, kind and key of the language.
//!
//! The parser, the editor schema and the tests of the manual all read this one table.

/// A section of a spec.
#[derive(Debug)]
pub struct Section {
    /// Name in brackets.
    pub name: &'static str,
    /// One sentence for people.
    pub about: &'static str,
    /// What it holds.
    pub shape: Shape,
    /// Whether a spec must have it.
    pub required: bool,
}

/// What a section holds.
#[derive(Debug)]
pub enum Shape {
    /// One table of keys.
    Table(&'static [Key]),
    /// Named items with the same keys. The last part names the key that an item holds when it is
    /// written without a table, if that is allowed.
    Items(&'static [Key], Option<&'static str>),
    /// Named items of several kinds.
    Kinds(&'static [Kind]),
    /// Numbers by the name of a state.
    States,
}

/// A kind of item, chosen by the key `kind`.
#[derive(Debug)]
pub struct Kind {
    /// The word after `kind =`.
    pub word: &'static str,
    /// One sentence for people.
    pub about: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// A key.
#[derive(Debug)]
pub struct Key {
    /// As written.
    pub name: &'static str,
    /// Form of its value.
    pub form: Form,
    /// Whether it must be there.
    pub need: Need,
    /// One sentence for people.
    pub about: &'static str,
}

/// Whether a key must be there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Always.
    Always,
    /// Never.
    Optional,
    /// Exactly one of the numbered ways must be chosen, with all its keys.
    Way(u8),
}

/// Form of a value.
#[derive(Debug)]
pub enum Form {
    /// A sentence.
    Text,
    /// A name that is defined here.
    Name,
    /// The name of a frame, point, body or coordinate.
    Reference(Target),
    /// A unit.
    Unit,
    /// A number in the item's unit.
    Number,
    /// A list of numbers.
    Numbers,
    /// Lower and upper end, in the item's unit.
    Range,
    /// An expression: a string, or a plain number.
    Expression,
    /// Three expressions.
    Components,
    /// Three rows of three expressions.
    Matrix,
    /// Names of two points.
    TwoPoints,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A table.
    Table(&'static [Key]),
    /// A list of tables.
    Tables(&'static [Key]),
}

/// What a reference leads to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A frame, `ground` included.
    Frame,
    /// A point, `O` included.
    Point,
    /// A body.
    Body,
    /// A coordinate.
    Coordinate,
}

impl Target {
    /// The word for people.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Point => "point",
            Self::Body => "body",
            Self::Coordinate => "coordinate",
        }
    }

    /// The section that defines it.
    pub const fn section(self) -> &'static str {
        match self {
            Self::Frame => "frames",
            Self::Point => "points",
            Self::Body => "bodies",
            Self::Coordinate => "coordinates",
        }
    }
}

const fn key(name: &'static str, form: Form, need: Need, about: &'static str) -> Key {
    Key {
        name,
        form,
        need,
        about,
    }
}

const ABOUT: Key = key(
    "about",
    Form::Text,
    Need::Optional,
    "One sentence for people.",
);
const UNIT: Key = key(
    "unit",
    Form::Unit,
    Need::Always,
    "Unit in which people read and write the quantity; `1` for a pure number.",
);
const UNIT_CHECKED: Key = key(
    "unit",
    Form::Unit,
    Need::Optional,
    "Unit in which people read the quantity; it must fit the value. SI when left out.",
);
const IN: Key = key(
    "in",
    Form::Reference(Target::Frame),
    Need::Always,
    "Frame in which the components are written.",
);

/// The words for a coordinate axis.
pub const AXES: &[&str] = &["x", "y", "z", "-x", "-y", "-z"];

/// Every section, in the order of a well-told spec.
pub static SECTIONS: &[Section] = &[
    Section {
        name: "mechanism",
        about: "Name and origin of the mechanism.",
        required: true,
        shape: Shape::Table(&[
            key(
                "name",
                Form::Name,
                Need::Always,
                "Name of the mechanism, a valid identifier.",
            ),
            key("title", Form::Text, Need::Always, "One line for people."),
            key(
                "source",
                Form::Text,
                Need::Optional,
                "Where the model comes from: paper and equations.",
            ),
        ]),
    },
    Section {
        name: "parameters",
        about: "Constants of the mechanism.",
        required: false,
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
            ],
            None,
        ),
    },
    Section {
        name: "coordinates",
        about: "Generalised coordinates.",
        required: true,
        shape: Shape::Items(
            &[
                UNIT,
                ABOUT,
                key(
                    "range",
                    Form::Range,
                    Need::Optional,
                    "Range in which the equations hold.",
                ),
                key(
                    "initial",
                    Form::Number,
                    Need::Optional,
                    "Initial value; 0 when left out.",
                ),
            ],
            None,
        ),
    },
    Section {
        name: "inputs",
        about: "Quantities that a controller or a recording supplies.",
        required: false,
        shape: Shape::Items(&[UNIT, ABOUT], None),
    },
    Section {
        name: "signals",
        about: "Known functions of time, given as data.",
        required: false,
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
                    Form::Word(&["hold", "linear", "cubic"]),
                    Need::Optional,
                    "Course between two samples; `linear` when left out.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "frames",
        about: "Frames, each turned from its parent.",
        required: false,
        shape: Shape::Items(
            &[
                key(
                    "parent",
                    Form::Reference(Target::Frame),
                    Need::Always,
                    "Frame from which this one is turned.",
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
                    Form::Tables(&[
                        key(
                            "about_axis",
                            Form::Word(AXES),
                            Need::Always,
                            "Axis of the rotation.",
                        ),
                        key(
                            "by",
                            Form::Expression,
                            Need::Always,
                            "Angle of the rotation.",
                        ),
                    ]),
                    Need::Way(1),
                    "Several rotations, first the one next to the parent.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "points",
        about: "Points, each placed from another.",
        required: false,
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
        name: "bodies",
        about: "Rigid bodies and point masses.",
        required: true,
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
                    Form::Table(INERTIA),
                    Need::Optional,
                    "Inertia about the centre of mass.",
                ),
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "constraints",
        about: "Constraints on velocities.",
        required: false,
        shape: Shape::Kinds(CONSTRAINTS),
    },
    Section {
        name: "pseudo_velocities",
        about: "The speeds of Appell's equations.",
        required: false,
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
                    "initial",
                    Form::Number,
                    Need::Optional,
                    "Initial value; 0 when left out.",
                ),
            ],
            Some("value"),
        ),
    },
    Section {
        name: "loads",
        about: "Applied forces and torques.",
        required: false,
        shape: Shape::Kinds(LOADS),
    },
    Section {
        name: "outputs",
        about: "Named quantities of interest.",
        required: false,
        shape: Shape::Items(
            &[
                key("value", Form::Expression, Need::Always, "Value."),
                UNIT_CHECKED,
                ABOUT,
            ],
            None,
        ),
    },
    Section {
        name: "initial",
        about: "Initial values of coordinates and pseudo-velocities, each in its unit.",
        required: false,
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
        "The tensor, row by row.",
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

static CONSTRAINTS: &[Kind] = &[
    Kind {
        word: "rolling",
        about: "The material point of a body at the contact is at rest.",
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
            ABOUT,
        ],
    },
    Kind {
        word: "velocity",
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
                "Prescribed value; 0 when left out.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "fixed_velocity",
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
                "Body whose material point is meant.",
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
                "Prescribed velocity; 0 when left out.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "position",
        about: "Reserved: an equation between coordinates.",
        keys: &[
            key(
                "zero",
                Form::Expression,
                Need::Always,
                "Combination of coordinates that stays zero.",
            ),
            ABOUT,
        ],
    },
];

static LOADS: &[Kind] = &[
    Kind {
        word: "gravity",
        about: "Weight of every body.",
        keys: &[
            key(
                "down",
                Form::Word(AXES),
                Need::Always,
                "Direction of the weight, an axis of the ground.",
            ),
            key(
                "acceleration",
                Form::Expression,
                Need::Always,
                "Acceleration of free fall.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "force",
        about: "A force on a point.",
        keys: &[
            key(
                "on",
                Form::Reference(Target::Point),
                Need::Always,
                "Point of attack.",
            ),
            key(
                "body",
                Form::Reference(Target::Body),
                Need::Optional,
                "Body whose material point is meant.",
            ),
            key(
                "reaction_on",
                Form::Reference(Target::Point),
                Need::Optional,
                "Point that feels the opposite force.",
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
        about: "A torque on a body.",
        keys: &[
            key("on", Form::Reference(Target::Body), Need::Always, "Body."),
            key(
                "reaction_on",
                Form::Reference(Target::Body),
                Need::Optional,
                "Body that feels the opposite torque.",
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
        about: "A linear spring.",
        keys: &[
            key(
                "between",
                Form::TwoPoints,
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
                "Length or coordinate at which it is relaxed; 0 when left out.",
            ),
            ABOUT,
        ],
    },
    Kind {
        word: "damper",
        about: "A linear damper.",
        keys: &[
            key(
                "between",
                Form::TwoPoints,
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
        word: "generalized",
        about: "A generalised force: its power is `force * dot(coordinate)`.",
        keys: &[
            key(
                "coordinate",
                Form::Reference(Target::Coordinate),
                Need::Always,
                "Coordinate.",
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

//! The one table of all codes.

/// Which stage finds it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading and checking the spec, in this crate.
    Spec,
    /// Deriving the equations of motion.
    Derivation,
}

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub struct CodeInfo {
    /// The code.
    pub code: Code,
    /// As written in messages.
    pub text: &'static str,
    /// Which stage finds it.
    pub stage: Stage,
    /// The rule, in a few words.
    pub title: &'static str,
    /// Why the rule exists and how to follow it.
    pub explanation: &'static str,
}

macro_rules! codes {
    ($($variant:ident $stage:ident $text:literal $title:literal $explanation:literal)*) => {
        /// The rules that a spec can break.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $(#[doc = $title] $variant,)*
        }

        /// Every code, in the order of [`Code`].
        pub static CODES: &[CodeInfo] = &[
            $(CodeInfo {
                code: Code::$variant,
                text: $text,
                stage: Stage::$stage,
                title: $title,
                explanation: $explanation,
            },)*
        ];
    };
}

impl Code {
    /// The row of the table.
    pub fn info(self) -> &'static CodeInfo {
        &CODES[self as usize]
    }

    /// As written in messages: `unit-mismatch`.
    pub fn text(self) -> &'static str {
        self.info().text
    }

    /// The code written so.
    pub fn from_text(text: &str) -> Option<Self> {
        CODES.iter().find(|c| c.text == text).map(|c| c.code)
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.text())
    }
}

codes! {
    TomlSyntax Spec "toml-syntax"
        "The file is not TOML"
        "A spec is a TOML file. Names that the broken part may define are not looked up, so that one slip gives one message."
    LimitExceeded Spec "limit-exceeded"
        "Something is larger than any sensible spec needs"
        "Sizes of files, names, numbers, tables and expressions are bounded, so that a hostile spec cannot exhaust the machine."
    ForbiddenCharacter Spec "forbidden-character"
        "A character that cannot be seen, or that reorders the text"
        "Control characters and marks of bidirectional text can make a spec read differently from what it means."
    UnknownSection Spec "unknown-section"
        "No such section"
        "The top level of a spec holds only the sections of this reference."
    UnknownKey Spec "unknown-key"
        "No such key here"
        "Each section and each kind takes only its own keys."
    MissingSection Spec "missing-section"
        "A required section is missing"
        "A mechanism needs `[mechanism]`, `[coordinates]` and `[bodies]`."
    MissingKey Spec "missing-key"
        "A required key is missing"
        "The definition is incomplete without the key."
    ConflictingKeys Spec "conflicting-keys"
        "Two keys say the same thing"
        "Some things can be said in more than one way; use one of them."
    WrongType Spec "wrong-type"
        "A value has the wrong form"
        "The key takes another form of value, such as a string in place of a number, or three components in place of two."
    UnknownWord Spec "unknown-word"
        "Not one of the words that the key takes"
        "The key takes one of a few words."
    InvalidName Spec "invalid-name"
        "Not a valid name"
        "A name starts with a letter, goes on with letters, digits and `_`, and has at most 64 characters."
    ReservedName Spec "reserved-name"
        "The language uses this name itself"
        "`t`, `pi`, `dot`, `if` and the functions keep their meaning everywhere; `ground` and `O` are given."
    DuplicateName Spec "duplicate-name"
        "A name is defined twice"
        "Parameters, coordinates, pseudo-velocities, inputs, signals and outputs share one set of names, because expressions do not say which they mean. A signal `s` also takes the names of its derivatives, `s_dot` and `s_ddot`, which are columns of results."
    UnknownName Spec "unknown-name"
        "An expression uses a name that nothing defines"
        "Expressions know parameters, coordinates, pseudo-velocities, inputs, signals, `t` and `pi`."
    UnknownReference Spec "unknown-reference"
        "No frame, point, body or coordinate of this name"
        "The key refers to an item of another section by its name."
    UnknownFunction Spec "unknown-function"
        "No such function"
        "The functions are listed in this reference."
    WrongArity Spec "wrong-arity"
        "A function with the wrong number of arguments"
        "Each function takes a fixed number of arguments."
    ExpressionSyntax Spec "expression-syntax"
        "The text is not an expression"
        "Expressions are written with numbers, names, `+ - * / ^`, parentheses and functions."
    DivisionByZero Spec "division-by-zero"
        "A division by the number zero"
        "The divisor is zero whatever the state of the mechanism."
    NotAllowedHere Spec "not-allowed-here"
        "A quantity that this place cannot depend on"
        "Positions depend on coordinates, not on velocities or inputs; a mass is constant; and so on."
    NotLinear Spec "not-linear"
        "Not linear in the generalised velocities"
        "Pseudo-velocities and velocity constraints are sums of terms, each with exactly one `dot(q)`, multiplied by what does not depend on velocities."
    UnknownUnit Spec "unknown-unit"
        "No such unit"
        "The units are listed in this reference."
    UnitSyntax Spec "unit-syntax"
        "The text is not a unit"
        "A unit is a product of powers of unit symbols, such as `kg*m^2/s`; a pure number has the unit `1`."
    UnitMismatch Spec "unit-mismatch"
        "Two units that cannot be brought together"
        "Sums, comparisons and every place of a spec need matching units. A literal `0` fits any unit."
    ExponentNotConstant Spec "exponent-not-constant"
        "The exponent of a quantity with a unit must be a number"
        "The unit of `a^n` is known only when `n` is a number in the text, such as `2` or `1/2`."
    NotFinite Spec "not-finite"
        "A number is not finite"
        "`inf` and `nan` have no place in a spec, nor have numbers too large for the machine."
    ValueOutsideLimits Spec "value-outside-limits"
        "A value is outside its own limits"
        "A parameter lies between `at_least` and `at_most`; an initial value lies inside the range of its coordinate."
    EmptyRange Spec "empty-range"
        "A range that holds nothing"
        "The lower end lies below the upper end."
    SignalTable Spec "signal-table"
        "The table of a signal is not a function of time"
        "Times increase strictly, and there is one value for each time."
    SignalTooRough Spec "signal-too-rough"
        "A signal that jumps or kinks where a smooth one is needed"
        "An imposed position is differentiated twice, an imposed velocity once. `cubic` serves both, `linear` only velocities."
    MotionMayJump Spec "motion-may-jump"
        "A function that jumps or kinks where a smooth one is needed"
        "Positions are differentiated twice, imposed velocities once, and the equations leave out what happens at a jump. `sign` and `if` may jump, `abs`, `min` and `max` kink."
    ReferenceCycle Spec "reference-cycle"
        "Items that are defined by one another in a circle"
        "Every frame leads back to `ground` through its parents, every point to `O`."
    BodyWithoutFrame Spec "body-without-frame"
        "A body that needs a frame has none"
        "A body without a frame is a point mass: it has no inertia, cannot roll and feels no torque."
    SelfReaction Spec "self-reaction"
        "Something is connected to itself"
        "A reaction acts on another point or body; a spring connects two different points."
    NotPhysical Spec "not-physical"
        "No body can have this mass, inertia or friction"
        "A mass is not negative, nor is a coefficient of friction. No principal moment of inertia is negative or larger than the sum of the other two; that is a warning, because a planar model may state only the moment it needs."
    UnusedName Spec "unused-name"
        "Nothing uses this name"
        "A parameter, coordinate, input or signal that appears in no expression changes nothing."
    MissingPseudoVelocities Derivation "missing-pseudo-velocities"
        "The number of pseudo-velocities does not fit"
        "There are as many pseudo-velocities as coordinates minus independent constraints."
    SingularPseudoVelocities Derivation "singular-pseudo-velocities"
        "The pseudo-velocities do not determine the generalised velocities"
        "Together with the constraints, the definitions of the pseudo-velocities must be solvable for every `dot(q)`."
    DependentConstraints Derivation "dependent-constraints"
        "Constraints contradict each other"
        "Two constraints prescribe different values for the same velocity."
    RedundantConstraint Derivation "redundant-constraint"
        "A constraint that follows from the others"
        "The constraint adds nothing: it is left out with a warning, and the motion is the same. It is an error where the constraint follows from the others in some configurations only."
    UndeterminedReaction Derivation "undetermined-reaction"
        "Reactions whose shares cannot be told"
        "The mechanism is statically indeterminate: several constraints prevent one motion, so their forces outnumber the laws of motion, as with two wheels on one axle that both resist a sideways slip. How stiff they are would decide, which rigid bodies do not tell. The motion is the same; the reactions that depend on the shares are not reported, and their contacts are not judged."
    InertiaNotInvariant Derivation "inertia-not-invariant"
        "The inertia changes with the rotation of the body"
        "Inertia may be written in a frame other than the body's own only where the rotation between the two does not change it, as for a wheel in the frame of its axle."
    SingularMassMatrix Derivation "singular-mass-matrix"
        "A motion without inertia"
        "Every pseudo-velocity must move some mass; otherwise its acceleration is not determined."
    VanishingLength Derivation "vanishing-length"
        "A spring or damper that can lose its direction"
        "A connection between two points pulls along the line between them, which has no direction where the points meet. It is an error where they always do, a warning where they do at the initial state or inside the declared ranges."
    IntegrableConstraint Derivation "integrable-constraint"
        "A constraint between velocities that fixes positions"
        "By Frobenius' theorem the velocities that the constraints allow never leave a surface of positions: the constraint is the rate of a relation between coordinates. The motion is right as long as the initial state satisfies that relation; a coordinate fewer, or a constraint of kind `position`, satisfies it always. A note, because a coordinate too many can be convenient."
    ContactGeometry Derivation "contact-geometry"
        "A rolling contact that its own geometry contradicts"
        "The contact point moves over the ground and stays on it, while the material point of the body passes through it with velocity zero. So the velocity across the ground vanishes by geometry, the contact is neither the centre of the body nor fixed in it, and gravity presses the body onto the ground."
    ContactNotJudged Derivation "contact-not-judged"
        "A contact whose forces cannot be told"
        "Normal force and friction demand need the normal of the surface and a reaction that belongs to this contact alone. On a plane across the weight the normal is known; another surface has a frame, named with `in` and `normal`."
    CreepNotJudged Derivation "creep-not-judged"
        "A contact that creeps under forces that cannot be told"
        "Creep follows the force of the contact. It needs the normal of the surface, a reaction that belongs to this contact alone, and pseudo-velocities that formulas solve."
    NoEffect Derivation "no-effect"
        "Something that is used but changes nothing"
        "A coordinate that moves no body and appears in no load and no output often is the angle that a frame forgot. A parameter can drop out of all equations, a body can be unable to move; both are notes."
    NoWork Derivation "no-work"
        "An input or a load that does no work"
        "Its power is zero in every motion that the constraints allow, so it does not enter the equations of motion. It acts across the motion, between points that keep their distance, or on a point at rest. A load without inputs is only noted where constraints have reactions, which it changes."
    EnergySource Derivation "energy-source"
        "A passive element that feeds energy"
        "With the values of the spec, friction drives the motion it should resist, a spring pushes away from its relaxed length, or a weight falls upwards: mostly a wrong sign."
    UnbalancedReaction Derivation "unbalanced-reaction"
        "A force and its reaction on different lines"
        "Two opposite forces on parallel lines make a couple, which changes the angular momentum of the mechanism from within. A force between two points acts along the line between them."
    TooLarge Derivation "too-large"
        "The equations are too large"
        "The derivation stops before its expressions fill the memory. Frames that turn against the ground instead of against each other often shorten them."
}

//! The one table of all codes.

/// The stage that reports it.
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
    /// The stage that reports it.
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
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.text())
    }
}

codes! {
    TomlSyntax Spec "toml-syntax"
        "The file is not TOML"
        "A spec is a TOML file. Names that the unreadable part may define are not checked, so that one slip gives one message."
    LimitExceeded Spec "limit-exceeded"
        "A size limit is exceeded"
        "Sizes of files, names, numbers, tables and expressions are bounded, so that a malicious spec cannot exhaust memory or time."
    ForbiddenCharacter Spec "forbidden-character"
        "An invisible character, or one that reorders the text"
        "Control characters and bidirectional marks can make a spec look different from what it says."
    UnknownSection Spec "unknown-section"
        "Unknown section"
        "A spec may contain only the sections of this manual."
    UnknownKey Spec "unknown-key"
        "Unknown key"
        "Each section and each kind has its own keys."
    MissingSection Spec "missing-section"
        "A required section is missing"
        "A mechanism needs `[mechanism]`, `[bodies]` and either `[coordinates]` or `[joints]`, which make coordinates."
    MissingKey Spec "missing-key"
        "A required key is missing"
        "The definition is incomplete without the key."
    ConflictingKeys Spec "conflicting-keys"
        "Two keys exclude each other"
        "Some things can be given in several ways; use one of them."
    WrongType Spec "wrong-type"
        "A value has the wrong form"
        "The key expects another type of value, for example a number instead of a string, or three components instead of two."
    UnknownWord Spec "unknown-word"
        "Unknown word"
        "The key accepts one of a few words."
    InvalidName Spec "invalid-name"
        "Not a valid name"
        "A name is a letter followed by letters, digits and `_`, at most 64 characters in all."
    ReservedName Spec "reserved-name"
        "A reserved name"
        "`t`, `pi`, `dot`, `if` and the function names are reserved everywhere; `ground` and `O` are predefined."
    DuplicateName Spec "duplicate-name"
        "A name is defined twice"
        "Parameters, coordinates, pseudo-velocities, inputs, signals and outputs share one namespace, because expressions refer to them by name alone. A signal `s` also reserves the names of its derivatives, `s_dot` and `s_ddot`, which are columns of results. A joint defines a frame and a point of its name, and its coordinates and pseudo-velocities."
    UnknownName Spec "unknown-name"
        "An expression uses an undefined name"
        "Expressions may use parameters, coordinates, pseudo-velocities, inputs, signals, `t` and `pi`."
    UnknownReference Spec "unknown-reference"
        "Undefined frame, point, body, coordinate, constraint or load"
        "The key or expression refers to an item of another section by its name."
    UnknownFunction Spec "unknown-function"
        "Unknown function"
        "The functions are listed under [Expressions](#expressions)."
    WrongArity Spec "wrong-arity"
        "A function with the wrong number of arguments"
        "Each function takes a fixed number of arguments."
    ExpressionSyntax Spec "expression-syntax"
        "Invalid expression"
        "Expressions consist of numbers, names, `+ - * / ^`, parentheses and functions."
    DivisionByZero Spec "division-by-zero"
        "Division by zero"
        "The divisor is zero in every state of the mechanism."
    NotAllowedHere Spec "not-allowed-here"
        "A quantity that is not allowed here"
        "Positions depend on coordinates, not on velocities or inputs; a mass is constant; see [Expressions](#expressions)."
    NotLinear Spec "not-linear"
        "Not linear in the generalised velocities"
        "Pseudo-velocities and velocity constraints are sums of terms, each with exactly one `dot(q)` and a factor that does not depend on velocities."
    UnknownUnit Spec "unknown-unit"
        "Unknown unit"
        "The units are listed under [Units](#units)."
    UnitSyntax Spec "unit-syntax"
        "Invalid unit"
        "A unit is a product of powers of unit symbols, such as `kg*m^2/s`; a pure number has the unit `1`."
    UnitMismatch Spec "unit-mismatch"
        "Incompatible units"
        "The terms of a sum, both sides of a comparison and the value of every key must have matching dimensions. A literal `0` fits any unit."
    DoubtfulUnit Spec "doubtful-unit"
        "A number that suggests another unit"
        "An angle of more than a revolution is often in degrees: a parameter in `rad`, a turn, a number in it or in the argument of `sin`, a range, an initial value with one. An angular rate in `Hz` counts radians, not revolutions. These are notes."
    ExponentNotConstant Spec "exponent-not-constant"
        "The exponent of a quantity with a unit must be a number"
        "The unit of `a^n` is known only when `n` is a number in the text, such as `2` or `1/2`."
    NotFinite Spec "not-finite"
        "A number is not finite"
        "`inf`, `nan` and numbers beyond double precision are not allowed."
    ValueOutsideLimits Spec "value-outside-limits"
        "A value is outside its own limits"
        "A parameter lies between `at_least` and `at_most`, and its `std` is not negative; an initial value lies inside the range of its coordinate."
    EmptyRange Spec "empty-range"
        "An empty range"
        "The lower limit must be below the upper limit."
    SignalTable Spec "signal-table"
        "The table of a signal does not define a function of time"
        "Times increase strictly, and there is one value for each time."
    SignalTooRough Spec "signal-too-rough"
        "A signal that is not smooth enough"
        "A prescribed position is differentiated twice, a prescribed velocity once. `cubic` is smooth enough for both, `linear` only for velocities."
    MotionMayJump Spec "motion-may-jump"
        "A function that may not be smooth enough"
        "Positions are differentiated twice, prescribed velocities once, and the equations omit the impulse at a jump. `sign` and `if` may jump; `abs`, `min` and `max` have a kink."
    ReferenceCycle Spec "reference-cycle"
        "A circular definition"
        "The parents of every frame must lead to `ground`, those of every point to `O`. Loads may name the forces of other loads, but not in a circle."
    BodyWithoutFrame Spec "body-without-frame"
        "A body that needs a frame has none"
        "A body without a frame is a point mass: it has no moment of inertia, cannot roll, and no torque can act on it."
    SelfReaction Spec "self-reaction"
        "An item connected to itself"
        "A reaction acts on another point or body; a spring connects two different points."
    NoCommonAxis Spec "no-common-axis"
        "Two frames do not turn relative to each other about one axis"
        "A torsional spring acts on the angle between two frames: all turns from one to the other that depend on coordinates are about one axis, with constant turns before and after them at most."
    NotPhysical Spec "not-physical"
        "A physically impossible mass, inertia, friction or axis"
        "Masses and coefficients of friction are not negative. No moment of inertia is negative; none exceeds the sum of the other two, which is only a warning, because a planar model may state just the moment that it needs, and not asked of a body without mass, which has a share of an inertia, such as that of a rotor about its axle. The axis of a joint has a length."
    DoubtfulItem Spec "doubtful-item"
        "An item that is probably meant otherwise"
        "A force or a blade at the material point of one body and the centre of mass of another; weight along the ground on which a body rolls, or twice, as two loads of kind `gravity` or as one and a force; a wheel that is symmetric about another axis than its axle. These are notes."
    UnusedName Spec "unused-name"
        "An unused quantity"
        "A parameter, coordinate, input, signal or definition that appears in no expression has no effect."
    MissingPseudoVelocities Derivation "missing-pseudo-velocities"
        "A wrong number of pseudo-velocities"
        "The number of pseudo-velocities is that of the coordinates minus that of the independent constraint rows."
    SingularPseudoVelocities Derivation "singular-pseudo-velocities"
        "The pseudo-velocities do not determine the generalised velocities"
        "Together with the constraints, the definitions of the pseudo-velocities must be solvable for every `dot(q)`."
    DependentConstraints Derivation "dependent-constraints"
        "Contradictory constraints"
        "Constraints prescribe different values for the same velocity."
    RedundantConstraint Derivation "redundant-constraint"
        "A redundant constraint"
        "The constraint follows from the others: it is left out with a warning, and the motion is the same. If it follows from them in some configurations only, that is an error."
    UndeterminedReaction Derivation "undetermined-reaction"
        "Statically indeterminate reactions"
        "Several constraints prevent the same motion, so there are more reactions than equations for them, as with two wheels on one axle that both resist sideslip. Their distribution depends on stiffness, which a rigid-body model does not have. The motion is not affected; the reactions that depend on the distribution are not reported, their contacts are not checked, and loads and outputs cannot name them."
    InertiaNotInvariant Derivation "inertia-not-invariant"
        "An inertia that depends on the rotation of the body"
        "Inertia may be given in a frame other than the body's own only if the rotation between the two does not change the tensor, as for a wheel in the frame of its axle."
    SingularMassMatrix Derivation "singular-mass-matrix"
        "A motion without inertia"
        "Every pseudo-velocity must move some mass; otherwise its acceleration is undetermined."
    InitialState Derivation "initial-state"
        "An initial state that breaks a position constraint"
        "The dependent coordinates follow from the others: their initial values only choose between solutions. It is a warning if there is no solution near them, for example because a rod is too short, and a note if the motion starts elsewhere than stated."
    VanishingLength Derivation "vanishing-length"
        "A spring or damper that can lose its direction"
        "A spring or damper acts along the line between two points, which has no direction when the points coincide. It is an error if they always do, a warning if they do at the initial state or inside the declared ranges."
    IntegrableConstraint Derivation "integrable-constraint"
        "An integrable velocity constraint"
        "By Frobenius' theorem the constraint is holonomic: it is the time derivative of a relation between coordinates. The motion is right if the initial state satisfies that relation; with one coordinate fewer, or a constraint of kind `position`, it always does. This is a note, because a redundant coordinate can be convenient."
    ContactGeometry Derivation "contact-geometry"
        "A rolling contact that contradicts its geometry"
        "The contact point travels along the ground, while the material point of the body at the contact is at rest. So the velocity normal to the ground vanishes by geometry, the contact is neither the centre of the body nor fixed in it, and gravity presses the body onto the ground."
    ContactNotJudged Derivation "contact-not-judged"
        "A contact whose forces are undetermined"
        "Normal force and friction demand require the normal of the surface and a determinate reaction of this contact alone. On a horizontal plane the normal is known; for any other surface, give its frame and axis with `in` and `normal`. Without a normal there is no `normal_force` to name in loads and outputs."
    CreepNotJudged Derivation "creep-not-judged"
        "Creep under undetermined contact forces"
        "Creep depends on the contact force. It requires the normal of the surface, a determinate reaction of this contact alone, and generalised velocities with a closed form in the pseudo-velocities."
    NoEffect Derivation "no-effect"
        "A quantity or body without effect"
        "A coordinate that moves no body and appears in no load and no output is often an angle missing from a frame. A parameter that cancels from all equations and a body that cannot move are notes."
    NoWork Derivation "no-work"
        "An input or a load that does no work"
        "Its power is zero in every admissible motion, so it does not enter the equations of motion: it acts normal to the motion, between points at a constant distance, or on a point at rest. For a load without inputs this is only a note if there are reactions, which it changes."
    EnergySource Derivation "energy-source"
        "A passive element that adds energy"
        "With the values of the spec, friction drives the motion that it should resist, a spring pushes away from its rest length, or bodies fall upwards. Usually a sign is wrong."
    UnbalancedReaction Derivation "unbalanced-reaction"
        "A force and its reaction on parallel lines"
        "Two opposite forces on parallel lines form a couple, an internal action that changes the angular momentum of the mechanism. A force between two points should act along the line that joins them."
    TooLarge Derivation "too-large"
        "The equations are too large"
        "The derivation stops before its expressions exhaust memory. Frames rotated from the ground instead of from each other often shorten them."
}

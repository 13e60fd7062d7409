//! The vocabulary: every section, kind and key of the language.
//!
//! The parser, the editor schema and the tests of the manual all read this one table.

mod keys;
mod kinds;
mod sections;

use crate::mechanism::{Axis, Interpolation};

pub use keys::{AXES, INTERPOLATIONS};
pub use sections::SECTIONS;

/// A section of a spec.
#[derive(Debug)]
pub struct Section {
    /// Name in brackets.
    pub name: &'static str,
    /// One-sentence description.
    pub about: &'static str,
    /// The form of its contents.
    pub shape: Shape,
    /// Whether a spec must have it.
    pub presence: Presence,
}

/// Whether a spec must have a section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Presence {
    /// Always.
    Required,
    /// May be left out.
    Optional,
    /// Unless it has another section that introduces items of this one.
    Unless(&'static str),
}

/// The form of the contents of a section.
#[derive(Debug)]
pub enum Shape {
    /// One table of keys.
    Table(&'static [Key]),
    /// Named items with the same keys. The last part names the key to which a value belongs that is
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
    /// The kind of item.
    pub is: ItemKind,
    /// One-sentence description.
    pub about: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

/// The kind of an item, for matching in later stages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ItemKind {
    /// An item of `[constraints]`.
    Constraint(ConstraintWord),
    /// An item of `[loads]`.
    Load(LoadWord),
    /// An item of `[joints]`.
    Joint(JointWord),
}

/// The kinds of joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the table of kinds has a sentence for each")]
pub enum JointWord {
    Revolute,
    Prismatic,
    Cylindrical,
    Screw,
    Universal,
    Planar,
    Ball,
    Free,
    Fixed,
}

/// The kinds of constraints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the table of kinds has a sentence for each")]
pub enum ConstraintWord {
    Rolling,
    Velocity,
    FixedVelocity,
    Position,
}

/// The kinds of loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the table of kinds has a sentence for each")]
pub enum LoadWord {
    Gravity,
    Force,
    Torque,
    Spring,
    Damper,
    TorsionalSpring,
    Generalized,
}

/// One of the words that a key takes.
#[derive(Debug)]
pub struct Word {
    /// As written.
    pub text: &'static str,
    /// Its meaning.
    pub sense: Sense,
}

/// The meaning of a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// A coordinate axis.
    Axis {
        /// Which one.
        axis: Axis,
        /// Whether it points backwards.
        negative: bool,
    },
    /// The interpolation of a signal.
    Interpolation(Interpolation),
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
    /// One-sentence description.
    pub about: &'static str,
}

/// Whether a key must be there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Always.
    Always,
    /// May be omitted.
    Optional,
    /// Exactly one of the numbered alternatives must be chosen, with all its keys.
    Way(u8),
}

/// Form of a value.
#[derive(Debug)]
pub enum Form {
    /// A sentence.
    Text,
    /// A name that is defined here.
    Name,
    /// The name of a coordinate or pseudo-velocity that is introduced here.
    NewName,
    /// A list of such names with this length.
    NewNames(usize),
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
    /// A list of numbers with this length, each in the unit of its quantity.
    Values(usize),
    /// An expression: a string, or a plain number.
    Expression,
    /// Three expressions.
    Components,
    /// Three rows of three expressions.
    Matrix,
    /// Two different names.
    Two(Target),
    /// Names of four coordinates.
    Quaternion,
    /// One of the words for an axis, or three expressions.
    Direction,
    /// One of these words.
    Word(&'static [Word]),
    /// `true` or `false`.
    Flag,
    /// A table, or an expression.
    Inertia(&'static [Key]),
    /// A table.
    Table(&'static [Key]),
    /// A list of tables.
    Tables(&'static [Key]),
}

/// The target of a reference.
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
    /// A constraint.
    Constraint,
    /// A load.
    Load,
    /// A pseudo-velocity.
    PseudoVelocity,
}

impl Target {
    /// The word in messages.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Frame => "frame",
            Self::Point => "point",
            Self::Body => "body",
            Self::Coordinate => "coordinate",
            Self::Constraint => "constraint",
            Self::Load => "load",
            Self::PseudoVelocity => "pseudo-velocity",
        }
    }

    /// The section that defines it.
    pub const fn section(self) -> &'static str {
        match self {
            Self::Frame => "frames",
            Self::Point => "points",
            Self::Body => "bodies",
            Self::Coordinate => "coordinates",
            Self::Constraint => "constraints",
            Self::Load => "loads",
            Self::PseudoVelocity => "pseudo_velocities",
        }
    }
}

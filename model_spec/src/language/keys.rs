//! The form of the tables, and keys and words that several of them share.

use super::Form::{Expression, Reference, Text, Unit, Word as OneOf};
use super::Need::{Always, Optional};
use super::Target::Frame;
use super::{Key, Sense, Word};
use crate::mechanism::{Axis, Interpolation};

/// Keys, each a row `(name, form, need, sentence)` or the constant of a shared one.
macro_rules! keys {
    (@($name:literal, $form:expr, $need:expr, $about:expr)) => {
        $crate::language::Key { name: $name, form: $form, need: $need, about: $about }
    };
    (@$shared:ident) => { $shared };
    ($($row:tt)*) => { &[$(keys!(@$row)),*] };
}

/// Kinds of items, each a row: word, variant, sentence, keys.
macro_rules! kinds {
    ($item:ident, $words:ident; $($word:literal, $variant:ident, $about:literal, { $($row:tt)* })*) => {
        &[$(Kind {
            word: $word,
            is: ItemKind::$item($words::$variant),
            about: $about,
            keys: keys! { $($row)* },
        }),*]
    };
}

/// Constants of shared keys.
macro_rules! shared {
    ($($name:ident: $row:tt;)*) => {
        $(pub(super) const $name: $crate::language::Key = keys!(@$row);)*
    };
}

pub(super) use {keys, kinds, shared};

shared! {
    ABOUT: ("about", Text, Optional, "One-sentence description.");
    UNIT: ("unit", Unit, Always, "Unit of the quantity in the spec and in results; `1` for a pure number.");
    UNIT_CHECKED: ("unit", Unit, Optional, "Unit of the quantity in results, of the dimension of the value; SI by default.");
    IN: ("in", Reference(Frame), Always, "Frame in which the components are written.");
}

pub(super) static TURNS: &[Key] = keys! {
    ("about_axis", OneOf(AXES), Always, "Axis of the rotation.")
    ("by", Expression, Always, "Angle of the rotation.")
};

const fn axis(text: &'static str, axis: Axis, negative: bool) -> Word {
    let sense = Sense::Axis { axis, negative };
    Word { text, sense }
}

/// The words for a coordinate axis.
pub static AXES: &[Word] = &[
    axis("x", Axis::X, false),
    axis("y", Axis::Y, false),
    axis("z", Axis::Z, false),
    axis("-x", Axis::X, true),
    axis("-y", Axis::Y, true),
    axis("-z", Axis::Z, true),
];

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

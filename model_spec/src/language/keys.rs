//! Keys and words that several sections share.

use super::{Form, Key, Need, Sense, Target, Word};
use crate::mechanism::Axis;

pub(super) const fn key(name: &'static str, form: Form, need: Need, about: &'static str) -> Key {
    Key {
        name,
        form,
        need,
        about,
    }
}

pub(super) const ABOUT: Key = key(
    "about",
    Form::Text,
    Need::Optional,
    "One-sentence description.",
);
pub(super) const UNIT: Key = key(
    "unit",
    Form::Unit,
    Need::Always,
    "Unit of the quantity in the spec and in results; `1` for a pure number.",
);
pub(super) const UNIT_CHECKED: Key = key(
    "unit",
    Form::Unit,
    Need::Optional,
    "Unit of the quantity in results, of the dimension of the value; SI by default.",
);
pub(super) const IN: Key = key(
    "in",
    Form::Reference(Target::Frame),
    Need::Always,
    "Frame in which the components are written.",
);

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

pub(super) static TURNS: &[Key] = &[
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
];

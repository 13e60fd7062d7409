//! The sections and their keys.

use super::Form::{
    Components, Expression, Flag, Inertia, Matrix, Name, Number, Numbers, Quaternion, Range,
    Reference, Tables, Text, Word,
};
use super::Need::{Always, Optional, Way};
use super::Target::{Frame, Point};
use super::keys::{ABOUT, AXES, IN, INTERPOLATIONS, TURNS, UNIT, UNIT_CHECKED, keys};
use super::kinds::{CONSTRAINTS, JOINTS, LOADS};
use super::{Key, Presence, Section, Shape};

/// Sections, each a row: name, presence, sentence, shape.
macro_rules! sections {
    ($($name:literal, $presence:ident $(($other:literal))?, $about:literal, $shape:ident $(($($part:tt)*))?;)*) => {
        &[$(Section {
            name: $name,
            about: $about,
            shape: Shape::$shape $(($($part)*))?,
            presence: Presence::$presence $(($other))?,
        }),*]
    };
}

/// Every section, in the customary order of a spec.
pub static SECTIONS: &[Section] = sections! {
    "mechanism", Required, "Name and origin of the mechanism.", Table(keys! {
        ("name", Name, Always, "Name of the mechanism, a valid identifier.")
        ("title", Text, Always, "One-line title.")
        ("source", Text, Optional, "Source of the model: paper and equations.")
        ("longest_step", Number, Optional, "Longest step, in s, of the filters that follow recordings; 0.02 by default.")
    });
    "parameters", Optional, "Constants of the mechanism.", Items(keys! {
        ("value", Number, Always, "Value in the parameter's unit.")
        UNIT ABOUT
        ("at_least", Number, Optional, "Smallest admissible value.")
        ("at_most", Number, Optional, "Largest admissible value.")
        ("std", Number, Optional, "Standard deviation to which the value is known: the tolerance of recordings that state none.")
    }, None);
    "coordinates", Unless("joints"), "Generalised coordinates.", Items(keys! {
        UNIT ABOUT
        ("range", Range, Optional, "Range in which the model is valid.")
        ("initial", Number, Optional, "Initial value; 0 by default.")
    }, None);
    "inputs", Optional, "Quantities that a controller or a recording supplies.", Items(&[UNIT, ABOUT], None);
    "signals", Optional, "Known functions of time, given as data.", Items(keys! {
        ("t", Numbers, Always, "Times in seconds, strictly increasing.")
        ("value", Numbers, Always, "One value for each time.")
        UNIT
        ("interpolation", Word(INTERPOLATIONS), Optional, "Interpolation between samples; `linear` by default.")
        ABOUT
    }, None);
    "definitions", Optional, "Named expressions, for use in others.", Items(keys! {
        ("value", Expression, Always, "Value.")
        UNIT_CHECKED ABOUT
    }, Some("value"));
    "frames", Optional, "Frames, each rotated from its parent.", Items(keys! {
        ("parent", Reference(Frame), Always, "Frame from which this one is rotated.")
        ("about_axis", Word(AXES), Way(0), "Axis of the rotation.")
        ("by", Expression, Way(0), "Angle of the rotation, right-handed about the axis.")
        ("turns", Tables(TURNS), Way(1), "Several rotations, starting from the parent.")
        ("quaternion", Quaternion, Way(2), "Orientation without a singularity: scalar part and vector part of a unit quaternion.")
        ABOUT
    }, None);
    "points", Optional, "Points, each placed from another.", Items(keys! {
        ("from", Reference(Point), Always, "Point from which this one is placed.")
        IN
        ("at", Components, Always, "Position from that point.")
        ABOUT
    }, None);
    "joints", Optional, "Joints: each stands for a frame, a point, their coordinates and pseudo-velocities.", Kinds(JOINTS);
    "bodies", Required, "Rigid bodies and point masses.", Items(keys! {
        ("frame", Reference(Frame), Optional, "Frame fixed in the body; a point mass has none.")
        ("centre", Reference(Point), Always, "Centre of mass.")
        ("mass", Expression, Always, "Mass.")
        ("inertia", Inertia(INERTIA), Optional, "Inertia about the centre of mass; of a body that moves in a plane the moment about its normal.")
        ("taken_away", Flag, Optional, "Whether mass and inertia are subtracted: a hole, or a part already included in another body.")
        ABOUT
    }, None);
    "constraints", Optional, "Constraints on velocities and positions.", Kinds(CONSTRAINTS);
    "pseudo_velocities", Optional, "The pseudo-velocities of Appell's equations.", Items(keys! {
        ("value", Expression, Always, "Definition, linear in the rates `dot(q)`.")
        UNIT_CHECKED ABOUT
        ("rate", Expression, Optional, "Its rate, where a drive gives it: an expression in inputs, `t`, signals and states.")
        ("initial", Number, Optional, "Initial value; 0 by default.")
    }, Some("value"));
    "loads", Optional, "Applied forces and torques.", Kinds(LOADS);
    "outputs", Optional, "Named quantities of interest.", Items(keys! {
        ("value", Expression, Always, "Value.")
        UNIT_CHECKED ABOUT
    }, Some("value"));
    "initial", Optional, "Initial values of coordinates and pseudo-velocities, each in its unit.", States;
};

static INERTIA: &[Key] = keys! {
    IN
    ("diagonal", Components, Way(0), "Principal moments; the axes of the frame are principal axes.")
    ("matrix", Matrix, Way(1), "The inertia tensor, row by row.")
    ("moments", Components, Way(2), "`[I_xx, I_yy, I_zz]`.")
    ("products", Components, Way(2), "`[I_xy, I_xz, I_yz]` with `I_xy = -∫ x y dm`.")
};

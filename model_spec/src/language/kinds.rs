//! The kinds of constraints, loads and joints, and their keys.

use super::Form::{
    Components, Direction, Expression, Flag, NewName, NewNames, Number, Range, Reference, Tables,
    Two, Values, Word,
};
use super::Need::{Always, Optional, Way};
use super::Target::{Body, Coordinate, Frame, Point};
use super::keys::{ABOUT, AXES, IN, TURNS, keys, kinds, shared};
use super::{ConstraintWord, ItemKind, JointWord, Kind, LoadWord};

pub(super) static CONSTRAINTS: &[Kind] = kinds! { Constraint, ConstraintWord;
    "rolling", Rolling, "The material point of a body at the contact moves as the surface does: on the ground it is at rest.", {
        ("body", Reference(Body), Always, "Rolling body.")
        ("contact", Reference(Point), Always, "Contact point.")
        ("on", Reference(Body), Optional, "Body that carries the surface, such as a turntable; the ground by default.")
        ("normal", Word(AXES), Optional, "Axis of `in` that points from the surface into the body; upwards by default.")
        ("in", Reference(Frame), Optional, "Frame of the normal; the ground by default.")
        ("friction", Expression, Optional, "Coefficient of friction, with which the friction demand is compared.")
        ("longitudinal_creep", Expression, Optional, "Longitudinal creep coefficient: sliding velocity over travelling velocity, per tangential force over normal force.")
        ("lateral_creep", Expression, Optional, "Lateral creep coefficient.")
        ABOUT
    }
    "velocity", Velocity, "A combination of rates has a prescribed value.", {
        ("zero", Expression, Always, "Combination, linear in the rates `dot(q)`.")
        ("equals", Expression, Optional, "Prescribed value; 0 by default.")
        ABOUT
    }
    "fixed_velocity", FixedVelocity, "A point has a prescribed velocity along a direction.", {
        ("point", Reference(Point), Always, "The point.")
        ("body", Reference(Body), Optional, "Body whose material point at that place is meant.")
        ("direction", Components, Always, "Direction; its length scales the velocity.")
        IN
        ("equals", Expression, Optional, "Prescribed velocity; 0 by default.")
        ("one_sided", Flag, Optional, "Whether the reaction can only push along the direction, as a contact does.")
        ABOUT
    }
    "position", Position, "An equation between coordinates.", {
        ("zero", Expression, Always, "Combination of coordinates that stays zero.")
        ("dependent", Reference(Coordinate), Optional, "Coordinate to be solved for; chosen automatically by default.")
        ("one_sided", Flag, Optional, "Whether the reaction can only push, towards positive `zero`, as a contact does.")
        ABOUT
    }
};

pub(super) static LOADS: &[Kind] = kinds! { Load, LoadWord;
    "gravity", Gravity, "Weight of every body.", {
        ("down", Word(AXES), Always, "Direction of gravity, an axis of the ground.")
        ("acceleration", Expression, Always, "Gravitational acceleration.")
        ABOUT
    }
    "force", Force, "A force on a point.", {
        ("on", Reference(Point), Always, "Point of application.")
        ("body", Reference(Body), Optional, "Body whose material point at that place is meant.")
        ("reaction_on", Reference(Point), Optional, "Point on which the opposite force acts.")
        IN
        ("vector", Components, Always, "Components of the force.")
        ABOUT
    }
    "torque", Torque, "A torque on a body.", {
        ("on", Reference(Body), Always, "Body.")
        ("reaction_on", Reference(Body), Optional, "Body on which the opposite torque acts.")
        IN
        ("vector", Components, Always, "Components of the torque.")
        ABOUT
    }
    "spring", Spring, "A linear spring.", {
        ("between", Two(Point), Way(0), "The two points it connects.")
        ("coordinate", Reference(Coordinate), Way(1), "Coordinate on which it acts.")
        ("stiffness", Expression, Always, "Stiffness.")
        ("relaxed", Expression, Optional, "Unstretched length, or coordinate at rest; 0 by default.")
        ABOUT
    }
    "damper", Damper, "A linear damper.", {
        ("between", Two(Point), Way(0), "The two points it connects.")
        ("coordinate", Reference(Coordinate), Way(1), "Coordinate on which it acts.")
        ("damping", Expression, Always, "Damping coefficient.")
        ABOUT
    }
    "torsional_spring", TorsionalSpring, "A torsional spring between two frames that turn relative to each other about one axis, and a damper in parallel.", {
        ("between", Two(Frame), Always, "The two frames; the angle is the sum of the turns from the first to the second.")
        ("stiffness", Expression, Always, "Torque per angle.")
        ("relaxed", Expression, Optional, "Angle without torque; 0 by default.")
        ("damping", Expression, Optional, "Torque per angular velocity; none by default.")
        ABOUT
    }
    "generalized", Generalized, "A generalised force: its power is `force * dot(coordinate)`, or `force * velocity`.", {
        ("coordinate", Reference(Coordinate), Way(0), "Coordinate along which it acts.")
        ("velocity", Expression, Way(1), "Velocity along which it acts: a pseudo-velocity, or a combination linear in pseudo-velocities and rates.")
        ("force", Expression, Always, "Generalised force.")
        ABOUT
    }
};

shared! {
    PARENT: ("parent", Reference(Frame), Optional, "Frame that carries the joint; the ground by default.");
    FROM: ("from", Reference(Point), Optional, "Point from which the joint is placed; the point with the name of `parent` by default, `O` on the ground.");
    AT: ("at", Components, Optional, "Place of the joint from that point, in `parent`; there by default.");
    TURNED: ("turns", Tables(TURNS), Optional, "Rotations from `parent` to the joint, before its own motion.");
    AXIS: ("axis", Direction, Always, "Axis of the joint: a word, or a direction of any length.");
    RANGE: ("range", Range, Optional, "Range of the coordinate, in which the model is valid.");
    INITIAL: ("initial", Number, Optional, "Initial value of the coordinate; 0 by default.");
    COORDINATE: ("coordinate", NewName, Optional, "Name of the coordinate; `q_NAME` by default.");
    OMEGA: ("speed", NewName, Optional, "Name of the pseudo-velocity; `omega_NAME` by default.");
    DEPENDENT: ("dependent", Flag, Optional, "Whether the joint makes no pseudo-velocities: its rates follow from constraints and from those written elsewhere.");
}

const INITIAL_VALUES: &str = "Initial values of the coordinates; 0 by default.";

pub(super) static JOINTS: &[Kind] = kinds! { Joint, JointWord;
    "revolute", Revolute, "A turn about an axis.", {
        PARENT FROM AT TURNED AXIS COORDINATE OMEGA DEPENDENT
        ("offset", Expression, Optional, "Angle where the coordinate is 0; 0 by default.")
        RANGE INITIAL ABOUT
    }
    "prismatic", Prismatic, "A displacement along an axis.", {
        PARENT FROM AT TURNED AXIS COORDINATE
        ("speed", NewName, Optional, "Name of the pseudo-velocity; `v_NAME` by default.")
        DEPENDENT
        ("offset", Expression, Optional, "Displacement where the coordinate is 0; 0 by default.")
        RANGE INITIAL ABOUT
    }
    "cylindrical", Cylindrical, "A turn about an axis and a displacement along it.", {
        PARENT FROM AT TURNED AXIS
        ("coordinates", NewNames(2), Optional, "Names of angle and displacement; `q_NAME` and `s_NAME` by default.")
        ("speeds", NewNames(2), Optional, "Names of their rates; `omega_NAME` and `v_NAME` by default.")
        DEPENDENT
        ("initial", Values(2), Optional, INITIAL_VALUES)
        ABOUT
    }
    "screw", Screw, "A turn about an axis that moves along it.", {
        PARENT FROM AT TURNED AXIS
        ("pitch", Expression, Always, "Displacement along the axis in one revolution.")
        COORDINATE OMEGA DEPENDENT RANGE INITIAL ABOUT
    }
    "universal", Universal, "A turn about an axis, then one about a second axis, which the first turn carries along.", {
        PARENT FROM AT TURNED AXIS
        ("second_axis", Direction, Always, "Axis of the second turn, in the frame after the first.")
        ("coordinates", NewNames(2), Optional, "Names of the angles; `q1_NAME` and `q2_NAME` by default.")
        ("speeds", NewNames(2), Optional, "Names of their rates; `omega1_NAME` and `omega2_NAME` by default.")
        DEPENDENT
        ("initial", Values(2), Optional, INITIAL_VALUES)
        ABOUT
    }
    "planar", Planar, "Displacements in the plane across an axis, and a turn about it.", {
        PARENT FROM AT TURNED
        ("axis", Word(AXES), Always, "Axis across the plane.")
        ("coordinates", NewNames(3), Optional, "Names of two displacements and the angle; for the axis z `x_NAME`, `y_NAME`, `q_NAME` by default.")
        ("speeds", NewNames(3), Optional, "Names of their rates; for the axis z `v_x_NAME`, `v_y_NAME`, `omega_NAME` by default.")
        DEPENDENT
        ("initial", Values(3), Optional, INITIAL_VALUES)
        ABOUT
    }
    "ball", Ball, "Turns about every axis, as a unit quaternion.", {
        PARENT FROM AT
        ("coordinates", NewNames(4), Optional, "Names of the components of the quaternion, the scalar part first; `e0_NAME` to `e3_NAME` by default.")
        ("speeds", NewNames(3), Optional, "Names of the components of the angular velocity relative to `parent`, in the frame of the joint; `omega_x_NAME`, `omega_y_NAME`, `omega_z_NAME` by default.")
        DEPENDENT
        ("initial", Values(4), Optional, INITIAL_VALUES)
        ABOUT
    }
    "free", Free, "Displacements along the axes of `parent`, and turns about every axis.", {
        PARENT FROM AT
        ("coordinates", NewNames(7), Optional, "Names of the displacements and of the components of the quaternion; `x_NAME`, `y_NAME`, `z_NAME`, `e0_NAME` to `e3_NAME` by default.")
        ("speeds", NewNames(6), Optional, "Names of the rates of the displacements and of the components of the angular velocity, as of `ball`; `v_x_NAME` to `v_z_NAME`, `omega_x_NAME` to `omega_z_NAME` by default.")
        DEPENDENT
        ("initial", Values(7), Optional, INITIAL_VALUES)
        ABOUT
    }
    "fixed", Fixed, "No motion: a frame and a point that `parent` carries.", {
        PARENT FROM AT TURNED ABOUT
    }
};

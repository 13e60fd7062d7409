//! The representations of orientations in MJCF.

use appell_spec::Code;
use roxmltree::Attribute;

use crate::rotation::{Rotation, Vector, unit};
use crate::xml::{Findings, exactly};

/// How angles are written.
pub(crate) struct Angles {
    pub(super) degrees: bool,
    /// Axes of the three turns, and whether each is about the axes as they were at first.
    sequence: [(usize, bool); 3],
}

impl Default for Angles {
    fn default() -> Self {
        Self {
            degrees: true,
            sequence: [(0, false), (1, false), (2, false)],
        }
    }
}

impl Angles {
    /// An angle in radians.
    pub(super) fn radians(&self, angle: f64) -> f64 {
        if self.degrees {
            angle.to_radians()
        } else {
            angle
        }
    }

    /// Reads `eulerseq`: small letters are axes that turn along, capitals those that stay.
    pub(super) fn read_sequence(&mut self, given: &Attribute<'_, '_>, findings: &Findings) {
        let axes: Option<Vec<(usize, bool)>> = given
            .value()
            .chars()
            .map(|c| "xyzXYZ".find(c).map(|at| (at % 3, at >= 3)))
            .collect();
        match axes.and_then(|axes| <[_; 3]>::try_from(axes).ok()) {
            Some(sequence) => self.sequence = sequence,
            None => findings.error(
                Code::WrongType,
                given.range_value(),
                format!(
                    "`eulerseq` cannot be `{}`",
                    appell_spec::shown(given.value())
                ),
                "write three axes: x, y, z turn along, X, Y, Z stay; `xyz` is the default",
            ),
        }
    }

    pub(super) fn euler(&self, angles: Vector) -> Rotation {
        let mut rotation = Rotation::IDENTITY;
        for ((axis, stays), angle) in self.sequence.into_iter().zip(angles) {
            let turn = Rotation::about(axis, self.radians(angle));
            rotation = if stays {
                turn.then(rotation)
            } else {
                rotation.then(turn)
            };
        }
        rotation
    }

    /// The orientation among the attributes of an element.
    pub(super) fn orientation<'x>(
        &self,
        attribute: &dyn Fn(&str) -> Option<Attribute<'x, 'x>>,
        findings: &Findings,
    ) -> Option<Rotation> {
        let zero = |given: &Attribute<'_, '_>, what: &str| {
            let message = format!("{what} has length zero");
            let help = "write one with a direction, or leave the attribute out";
            findings.error(Code::VanishingLength, given.range_value(), message, help);
        };
        if let Some(given) = attribute("quat") {
            let quaternion = exactly(findings, &given, "a quaternion, w x y z,")?;
            let rotation = Rotation::quaternion(quaternion);
            if rotation.is_none() {
                zero(&given, "the quaternion");
            }
            return rotation;
        }
        if let Some(given) = attribute("axisangle") {
            let [x, y, z, angle] = exactly(findings, &given, "an axis with its angle, x y z a,")?;
            let axis = unit([x, y, z]);
            if axis.is_none() {
                zero(&given, "the axis");
            }
            return axis.map(|axis| Rotation::about_vector(axis, self.radians(angle)));
        }
        if let Some(given) = attribute("euler") {
            return exactly(findings, &given, "a set of Euler angles")
                .map(|angles| self.euler(angles));
        }
        if let Some(given) = attribute("xyaxes") {
            let [a, b, c, d, e, f] = exactly(findings, &given, "the axes x and y")?;
            let rotation = Rotation::from_axes([a, b, c], [d, e, f]);
            if rotation.is_none() {
                zero(&given, "one of the axes, or the part of y across x,");
            }
            return rotation;
        }
        let given = attribute("zaxis")?;
        let axis = unit(exactly(findings, &given, "the axis z")?);
        if axis.is_none() {
            zero(&given, "the axis");
        }
        axis.map(|axis| Rotation::between([0.0, 0.0, 1.0], axis))
    }
}

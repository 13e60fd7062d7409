//! The projection: normal to the plane of motion, else oblique from above.

use appell_spec::mechanism::Mechanism;

use super::space::{Vector, add, cross, dot, scaled, unit};

/// Rotation of the first horizontal axis into the picture, in degrees.
const AZIMUTH: f64 = 32.0;
/// Elevation of the view, in degrees.
const ELEVATION: f64 = 20.0;

/// A parallel projection.
pub(super) struct View {
    /// Direction in the ground that points to the right on paper.
    pub(super) right: Vector,
    /// Direction that points up on paper.
    pub(super) up: Vector,
    /// Two directions that span the plane of the ground.
    pub(super) floor: [Vector; 2],
    /// Upwards in the ground: against the weight, else along z.
    pub(super) vertical: Vector,
    /// Direction of the weight, if there is any.
    pub(super) down: Option<Vector>,
}

impl View {
    /// The view of a mechanism that moves in the plane normal to an axis of the ground, or in
    /// space.
    pub(super) fn of(mechanism: &Mechanism, flat_across: Option<usize>) -> Self {
        let down = mechanism.down().map(|down| down.map(f64::from));
        let vertical = down.map_or(unit(2), |down| scaled(-1.0, down));
        let upright = |axis: usize| vertical[axis] != 0.0;
        let first = unit(usize::from(upright(0)));
        if let Some(axis) = flat_across {
            let up = if upright(axis) {
                unit(if axis == 2 { 1 } else { 2 })
            } else {
                vertical
            };
            let across = unit(axis);
            let right = cross(across, up).map(f64::abs);
            let floor = if upright(axis) { up } else { across };
            return Self {
                right,
                up,
                floor: [right, floor],
                vertical,
                down,
            };
        }
        let second = cross(vertical, first);
        let [(sin_a, cos_a), (sin_e, cos_e)] =
            [AZIMUTH, ELEVATION].map(|angle| angle.to_radians().sin_cos());
        let right = add(scaled(cos_a, first), sin_a, second);
        let away = cross(vertical, right);
        Self {
            right,
            up: add(scaled(cos_e, vertical), sin_e, away),
            floor: [first, second],
            vertical,
            down,
        }
    }

    /// Projection of a point: to the right and up.
    pub(super) fn seen(&self, place: Vector) -> [f64; 2] {
        [dot(place, self.right), dot(place, self.up)]
    }

    /// The point in the projection plane at such an offset to the right and up from another.
    pub(super) fn beside(&self, place: Vector, right: f64, up: f64) -> Vector {
        add(add(place, right, self.right), up, self.up)
    }
}

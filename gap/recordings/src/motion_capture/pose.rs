//! Positions and axes of rigid bodies.

/// Three components.
pub type Vector = [f64; 3];

/// Axes that are turned by yaw about z, then by tilt about x, then by pitch about y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axes {
    /// Columns: the axes in the ground.
    columns: [Vector; 3],
}

impl Axes {
    /// By angles in rad, in this order.
    pub fn turned([yaw, tilt, pitch]: [f64; 3]) -> Self {
        let ((s1, c1), (s2, c2), (s3, c3)) = (yaw.sin_cos(), tilt.sin_cos(), pitch.sin_cos());
        let x = [c1, s1, 0.0];
        let y = [-s1 * c2, c1 * c2, s2];
        let z = [s1 * s2, -c1 * s2, c2];
        let mix = |a: Vector, b: Vector, [p, q]: [f64; 2]| [0, 1, 2].map(|i| p * a[i] + q * b[i]);
        Self {
            columns: [mix(x, z, [c3, -s3]), y, mix(x, z, [s3, c3])],
        }
    }

    /// A vector of these axes, in the ground.
    pub fn to_ground(&self, vector: Vector) -> Vector {
        [0, 1, 2].map(|i| (0..3).map(|k| self.columns[k][i] * vector[k]).sum())
    }

    /// A vector of the ground, in these axes.
    pub fn from_ground(&self, vector: Vector) -> Vector {
        [0, 1, 2].map(|k| (0..3).map(|i| self.columns[k][i] * vector[i]).sum())
    }

    /// The first axis in the ground.
    pub const fn forward(&self) -> Vector {
        self.columns[0]
    }
}

/// a + b
pub(super) fn sum(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// a − b
pub(super) fn difference(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// a · b
pub(super) fn product(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUNDING: f64 = 1e-15;

    #[test]
    fn axes_are_those_of_the_transformations_of_yaw_tilt_and_pitch() {
        let angles: [f64; 3] = [0.7, -0.3, 0.4];
        let about = |axis: usize, angle: f64, v: Vector| {
            let (s, c) = angle.sin_cos();
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut turned = v;
            turned[i] = c * v[i] - s * v[j];
            turned[j] = s * v[i] + c * v[j];
            turned
        };
        let axes = Axes::turned(angles);
        for v in [[1.0, 0.0, 0.0], [0.3, -2.0, 0.5]] {
            let turned = about(2, angles[0], about(0, angles[1], about(1, angles[2], v)));
            let off = difference(axes.to_ground(v), turned);
            assert!(product(off, off).sqrt() < 4.0 * ROUNDING, "{off:?}");
            let back = difference(axes.from_ground(axes.to_ground(v)), v);
            assert!(product(back, back).sqrt() < 4.0 * ROUNDING, "{back:?}");
        }
    }
}

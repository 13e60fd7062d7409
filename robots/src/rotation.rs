//! Rotations and poses. A rotation takes components in a turned frame to those in the frame from
//! which it is turned.

use crate::elimination::largest;

/// Three components.
pub(crate) type Vector = [f64; 3];

/// Tolerance of right angles in radians.
const RIGHT: f64 = 1e-12;

/// An axis of a frame: its index, and whether it is taken backwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Axis {
    pub(crate) index: usize,
    pub(crate) backwards: bool,
}

/// A rotation matrix, by rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rotation(pub(crate) [Vector; 3]);

/// A rotated and shifted frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) rotation: Rotation,
    pub(crate) position: Vector,
}

/// One turn about an axis of the frame that is turned so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub(crate) axis: usize,
    pub(crate) angle: f64,
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn is_zero(a: Vector) -> bool {
    a.iter().all(|component| *component == 0.0)
}

pub(crate) fn scaled(a: Vector, factor: f64) -> Vector {
    a.map(|component| component * factor)
}

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    add(a, scaled(b, -1.0))
}

/// The unit vector along `a`, unless it has no direction.
pub(crate) fn unit(a: Vector) -> Option<Vector> {
    let largest = largest(&a);
    if largest <= f64::MIN_POSITIVE {
        return None;
    }
    let a = scaled(a, 1.0 / largest);
    Some(scaled(a, 1.0 / dot(a, a).sqrt()).map(whole))
}

/// A number that is 0, 1 or −1 up to rounding is taken as that.
fn whole(x: f64) -> f64 {
    let nearest = x.round();
    // A zero has no sign.
    if (x - nearest).abs() <= RIGHT {
        nearest + 0.0
    } else {
        x
    }
}

/// Sine and cosine, exact for right angles.
fn sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    if whole(sin).fract() == 0.0 && whole(cos).fract() == 0.0 {
        (whole(sin), whole(cos))
    } else {
        (sin, cos)
    }
}

impl Rotation {
    pub(crate) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// A turn about one of the axes.
    pub(crate) fn about(axis: usize, angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut rows = Self::IDENTITY.0;
        rows[j][j] = cos;
        rows[j][k] = -sin;
        rows[k][j] = sin;
        rows[k][k] = cos;
        Self(rows)
    }

    /// A turn about a unit vector.
    pub(crate) fn about_vector(axis: Vector, angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        let mut rows = axis.map(|a| axis.map(|b| (1.0 - cos) * a * b));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            rows[i][i] += cos;
            rows[j][k] -= sin * axis[i];
            rows[k][j] += sin * axis[i];
        }
        Self(rows).cleaned()
    }

    /// The rotation of a quaternion w, x, y, z of any length but zero.
    pub(crate) fn quaternion(q: [f64; 4]) -> Option<Self> {
        let largest = largest(&q);
        if largest <= f64::MIN_POSITIVE {
            return None;
        }
        let q = q.map(|one| one / largest);
        let square: f64 = q.iter().map(|one| one * one).sum();
        let [w, x, y, z] = q;
        let s = 2.0 / square;
        let rows = [
            [
                1.0 - s * (y * y + z * z),
                s * (x * y - w * z),
                s * (x * z + w * y),
            ],
            [
                s * (x * y + w * z),
                1.0 - s * (x * x + z * z),
                s * (y * z - w * x),
            ],
            [
                s * (x * z - w * y),
                s * (y * z + w * x),
                1.0 - s * (x * x + y * y),
            ],
        ];
        Some(Self(rows).cleaned())
    }

    /// Its unit quaternion w, x, y, z, from the largest of the four (Shepperd, *Journal of Guidance and Control* 1,
    /// 1978).
    pub(crate) fn to_quaternion(self) -> [f64; 4] {
        let r = self.0;
        let trace = r[0][0] + r[1][1] + r[2][2];
        let squares = [trace, r[0][0], r[1][1], r[2][2]];
        let mut largest = 0;
        for k in 1..4 {
            if squares[k] > squares[largest] {
                largest = k;
            }
        }
        let skew = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
        let mut q = [1.0 + trace, skew[0], skew[1], skew[2]];
        if let Some(i) = largest.checked_sub(1) {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            q[0] = skew[i];
            q[1 + i] = 1.0 + r[i][i] - r[j][j] - r[k][k];
            q[1 + j] = r[i][j] + r[j][i];
            q[1 + k] = r[i][k] + r[k][i];
        }
        let length = q.iter().map(|one| one * one).sum::<f64>().sqrt();
        q.map(|one| whole(one / length))
    }

    /// Roll, pitch and yaw about the fixed axes x, y, z.
    pub(crate) fn roll_pitch_yaw([roll, pitch, yaw]: Vector) -> Self {
        Self::about(2, yaw)
            .then(Self::about(1, pitch))
            .then(Self::about(0, roll))
    }

    /// The frame with these directions as its first two axes; the second is made perpendicular.
    pub(crate) fn from_axes(x: Vector, y: Vector) -> Option<Self> {
        let x = unit(x)?;
        let y = unit(minus(y, scaled(x, dot(x, y))))?;
        let z = cross(x, y);
        Some(Self([0, 1, 2].map(|i| [x[i], y[i], z[i]])).cleaned())
    }

    /// The smallest rotation that takes one unit vector to another.
    pub(crate) fn between(from: Vector, to: Vector) -> Self {
        let axis = cross(from, to);
        let angle = dot(axis, axis).sqrt().atan2(dot(from, to));
        match unit(axis) {
            Some(axis) => Self::about_vector(axis, angle),
            None if angle < 1.0 => Self::IDENTITY,
            // Opposite: half a turn about anything perpendicular.
            None => {
                let other = usize::from(from[0].abs() >= 0.5);
                let mut helper = [0.0; 3];
                helper[other] = 1.0;
                let axis = unit(cross(from, helper)).unwrap_or([1.0, 0.0, 0.0]);
                Self::about_vector(axis, std::f64::consts::PI)
            }
        }
    }

    /// This rotation followed by another about the turned axes.
    pub(crate) fn then(self, next: Self) -> Self {
        let mut rows = [[0.0; 3]; 3];
        for (row, own) in rows.iter_mut().zip(self.0) {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry = (0..3).map(|k| own[k] * next.0[k][j]).sum();
            }
        }
        Self(rows).cleaned()
    }

    pub(crate) fn inverse(self) -> Self {
        Self([0, 1, 2].map(|i| [0, 1, 2].map(|j| self.0[j][i])))
    }

    /// Components in the frame from which this one is turned.
    pub(crate) fn of(self, a: Vector) -> Vector {
        self.0.map(|row| dot(row, a))
    }

    /// Rows that are right angles up to rounding are exact.
    fn cleaned(self) -> Self {
        let whole = self.0.map(|row| row.map(whole));
        let right = whole.iter().flatten().all(|entry| entry.fract() == 0.0);
        if right { Self(whole) } else { self }
    }

    pub(crate) fn is_identity(self) -> bool {
        self == Self::IDENTITY
    }

    /// The fewest turns that give this rotation. If `last` is given, a last turn about that axis costs little: it
    /// only shifts the angle of a joint.
    pub(crate) fn turns(self, last: Option<usize>) -> Vec<Turn> {
        let mut best: Option<(u32, Vec<Turn>)> = None;
        let lasts = last.map_or(vec![0, 1, 2], |k| vec![k]);
        for k in lasts {
            for j in (0..3).filter(|j| *j != k) {
                // From the last axis of the alphabet, as yaw, pitch and roll.
                for i in (0..3).rev().filter(|i| *i != j) {
                    for half in [false, true] {
                        let angles = self.angles([i, j, k], half);
                        let price = |(n, angle): (usize, f64)| match angle {
                            0.0 => 0,
                            _ if n == 2 && last.is_some() => 1 + u32::from(!is_right(angle)),
                            _ if is_right(angle) => 4,
                            _ => 40,
                        };
                        let cost = angles.into_iter().enumerate().map(price).sum();
                        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                            let turns = [i, j, k].into_iter().zip(angles);
                            let turns = turns.filter(|(_, angle)| *angle != 0.0);
                            let turns = turns.map(|(axis, angle)| Turn { axis, angle });
                            best = Some((cost, turns.collect()));
                        }
                    }
                }
            }
        }
        best.map(|(_, turns)| turns).unwrap_or_default()
    }

    /// Angles of three successive turns about given axes. Each is computed from the remaining rotation after the
    /// previous turns, so that the product is exact to rounding even close to gimbal lock.
    fn angles(self, [i, j, k]: [usize; 3], half: bool) -> Vector {
        let column = |rotation: Self, axis: usize| rotation.0.map(|row| row[axis]);
        // The first turn rotates the last axis into the plane normal to the second.
        let u = column(self, k);
        let other = 3 - i - j;
        let handed = if (i + 1) % 3 == j { 1.0 } else { -1.0 };
        // In the plane (j, other), turned by the angle about i: component along j becomes zero.
        let first = if u[j].abs() <= RIGHT && u[other].abs() <= RIGHT {
            0.0
        } else {
            handed * (-u[j]).atan2(u[other])
        };
        let first = clean(if half {
            wrapped(first + std::f64::consts::PI)
        } else {
            first
        });
        let rest = Self::about(i, -first).then(self);
        let u = column(rest, k);
        let next = 3 - j - k;
        let handed = if (j + 1) % 3 == k { 1.0 } else { -1.0 };
        let second = clean(handed * u[next].atan2(u[k]));
        let rest = Self::about(j, -second).then(rest);
        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
        let third = clean(rest.0[b][a].atan2(rest.0[a][a]));
        [first, second, third]
    }
}

/// An angle between −π and π.
fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::PI;
    if angle > PI { angle - 2.0 * PI } else { angle }
}

/// An angle as a multiple of a right angle, if it is one within the tolerance.
pub(crate) fn right_angles(angle: f64) -> Option<f64> {
    let count = (angle / std::f64::consts::FRAC_PI_2).round();
    ((angle - count * std::f64::consts::FRAC_PI_2).abs() <= RIGHT).then_some(count)
}

fn is_right(angle: f64) -> bool {
    right_angles(angle).is_some()
}

/// A multiple of π/2 exact to rounding; zero has no sign.
fn clean(angle: f64) -> f64 {
    right_angles(angle).map_or(angle, |count| match count {
        // −π and π are the same rotation.
        -2.0 => std::f64::consts::PI,
        _ => count * std::f64::consts::FRAC_PI_2 + 0.0,
    })
}

impl Pose {
    pub(crate) const IDENTITY: Self = Self {
        rotation: Rotation::IDENTITY,
        position: [0.0; 3],
    };

    /// The pose of a frame given in this one.
    pub(crate) fn then(self, next: Self) -> Self {
        Self {
            rotation: self.rotation.then(next.rotation),
            position: self.of(next.position),
        }
    }

    /// The pose of the outer frame in this one.
    pub(crate) fn inverse(self) -> Self {
        let rotation = self.rotation.inverse();
        Self {
            rotation,
            position: scaled(rotation.of(self.position), -1.0),
        }
    }

    /// A position given in this frame.
    pub(crate) fn of(self, position: Vector) -> Vector {
        add(self.position, self.rotation.of(position))
    }
}

impl Axis {
    /// The axis along a unit vector, or the nearest one with the rotation from it to the vector.
    pub(crate) fn nearest(direction: Vector) -> (Self, Rotation) {
        let longest = |index: &usize| direction[*index].abs();
        let index = (0..3)
            .max_by(|a, b| longest(a).total_cmp(&longest(b)))
            .unwrap_or(2);
        let backwards = direction[index] < 0.0;
        let axis = Self { index, backwards };
        (axis, Rotation::between(axis.vector(), direction))
    }

    pub(crate) fn vector(self) -> Vector {
        let mut vector = [0.0; 3];
        vector[self.index] = self.sign();
        vector
    }

    pub(crate) fn sign(self) -> f64 {
        if self.backwards { -1.0 } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers between −1 and 1, the same in every run.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn composed(turns: &[Turn]) -> Rotation {
        let turns = turns
            .iter()
            .map(|turn| Rotation::about(turn.axis, turn.angle));
        turns.fold(Rotation::IDENTITY, Rotation::then)
    }

    fn error(a: Rotation, b: Rotation) -> f64 {
        let pairs = a.0.iter().flatten().zip(b.0.iter().flatten());
        pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }

    #[test]
    fn turns_compose_to_the_rotation_also_near_gimbal_lock() {
        let mut numbers = Numbers(7);
        for round in 0..2000 {
            let scale = [3.0, 1e-3, 1e-7, 1e-11][round % 4];
            let mut angle = || (numbers.next() * 2.0).round() * 1.570_75 + scale * numbers.next();
            let rotation = Rotation::roll_pitch_yaw([angle(), angle(), angle()]);
            for last in [None, Some(0), Some(1), Some(2)] {
                let turns = rotation.turns(last);
                assert!(
                    error(composed(&turns), rotation) < 4e-12,
                    "{rotation:?} {turns:?}"
                );
                if scale > 1e-6 {
                    assert!(
                        error(composed(&turns), rotation) < 2e-15,
                        "{rotation:?} {turns:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn right_angles_are_exact_and_few() {
        let half = std::f64::consts::FRAC_PI_2;
        let rotation = Rotation::roll_pitch_yaw([half, 0.0, 0.0]);
        assert_eq!(
            rotation.0,
            [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
        );
        assert_eq!(
            rotation.turns(None),
            [Turn {
                axis: 0,
                angle: half
            }]
        );
        let quaternion = Rotation::quaternion([0.0, 0.0, 0.3, 0.3]);
        assert_eq!(
            quaternion.map(|r| r.0),
            Some([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
        );
    }

    #[test]
    fn one_vector_is_turned_to_another() {
        let mut numbers = Numbers(3);
        let mut pairs = vec![
            ([0.0, 0.0, 1.0], [0.6, 0.0, 0.8]),
            ([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ];
        for _ in 0..100 {
            let mut any = || unit([0, 1, 2].map(|_| numbers.next())).unwrap_or([1.0, 0.0, 0.0]);
            pairs.push((any(), any()));
        }
        for (from, to) in pairs {
            let rotation = Rotation::between(from, to);
            let missed = minus(rotation.of(from), to);
            assert!(
                missed.iter().all(|d| d.abs() < 1e-15),
                "{from:?} {to:?} {missed:?}"
            );
            assert!(error(rotation.then(rotation.inverse()), Rotation::IDENTITY) < 1e-15);
        }
    }
}

//! Mass, centre of mass and inertia: rotated, shifted, combined.

use crate::elimination::largest;
use crate::letters::plain;
use crate::rotation::{Pose, Rotation, Vector, add, cross, dot, minus, scaled};

/// A symmetric tensor: xx, yy, zz, xy, xz, yz.
pub(crate) type Tensor = [f64; 6];

/// Rounding error of vanishing entries, relative to the largest one.
const ROUNDING: f64 = 1e-15;
/// Rounding error of numbers of twelve digits, with a margin.
const TWELVE_DIGITS: f64 = 1e-11;
/// How far the largest moment may exceed the sum of the others by the rounding of a file.
const WRITTEN: f64 = 1e-4;

/// The inertia of a rigid body, in some frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inertia {
    pub(crate) mass: f64,
    pub(crate) centre: Vector,
    /// About the centre of mass, along the axes of the frame.
    pub(crate) tensor: Tensor,
}

/// Row and column of the entries of a [`Tensor`].
const PLACES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

fn rows([xx, yy, zz, xy, xz, yz]: Tensor) -> [Vector; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// Volume of tetrahedra, each by its size, and the inertia of them all with a mass of 1.
pub(crate) fn of_triangles(tetrahedra: &[[Vector; 4]]) -> Option<(f64, Inertia)> {
    let mut whole = Inertia::NONE;
    for &[a, b, c, d] in tetrahedra {
        let edges = [minus(b, a), minus(c, a), minus(d, a)];
        let volume = (dot(edges[0], cross(edges[1], edges[2])) / 6.0).abs();
        if volume == 0.0 {
            continue;
        }
        let centre = scaled(add(add(a, b), add(c, d)), 0.25);
        let arms = [a, b, c, d].map(|corner| minus(corner, centre));
        // A homogeneous tetrahedron has the second moments of its corners, each with a twentieth of the mass.
        let moments = arms.map(|arm| of_point(volume / 20.0, arm));
        let tensor = moments.into_iter().fold([0.0; 6], sum);
        whole = whole.with(&Inertia {
            mass: volume,
            centre,
            tensor,
        });
    }
    (whole.mass > 0.0).then(|| {
        let tensor = whole.tensor.map(|entry| entry / whole.mass);
        let one = Inertia {
            mass: 1.0,
            tensor,
            ..whole
        };
        (whole.mass, one)
    })
}

/// The tensor along the axes from which those of `tensor` are turned.
pub(crate) fn turned(rotation: Rotation, tensor: Tensor) -> Tensor {
    if rotation.is_identity() {
        return tensor;
    }
    let inner = rows(tensor);
    let entry = |(i, j): (usize, usize)| -> f64 {
        let left = [0, 1, 2].map(|k| dot(rotation.0[i], [0, 1, 2].map(|l| inner[l][k])));
        dot(left, rotation.0[j])
    };
    without_rounding(PLACES.map(entry))
}

/// Numbers of which those that vanish up to rounding, compared with the largest one, are zero.
pub(crate) fn without_rounding<const N: usize>(all: [f64; N]) -> [f64; N] {
    let bound = ROUNDING * largest(&all);
    all.map(|entry| if entry.abs() <= bound { 0.0 } else { entry })
}

/// The tensor of a mass at a distance from the point about which it is taken.
fn of_point(mass: f64, at: Vector) -> Tensor {
    let square = dot(at, at);
    PLACES.map(|(i, j)| mass * (if i == j { square } else { 0.0 } - at[i] * at[j]))
}

fn sum(a: Tensor, b: Tensor) -> Tensor {
    [0, 1, 2, 3, 4, 5].map(|i| a[i] + b[i])
}

impl Inertia {
    pub(crate) const NONE: Self = Self {
        mass: 0.0,
        centre: [0.0; 3],
        tensor: [0.0; 6],
    };

    /// Whether there is neither mass nor moment.
    pub(crate) fn is_nothing(&self) -> bool {
        self.mass == 0.0 && self.tensor.iter().all(|entry| *entry == 0.0)
    }

    /// Rows of its tensor.
    pub(crate) fn rows(&self) -> [Vector; 3] {
        rows(self.tensor)
    }

    /// Whether all entries are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let numbers = [self.mass]
            .into_iter()
            .chain(self.centre)
            .chain(self.tensor);
        numbers.into_iter().all(f64::is_finite)
    }

    /// The same body in the frame in which `pose` places the present one.
    pub(crate) fn placed(&self, pose: Pose) -> Self {
        Self {
            mass: self.mass,
            centre: without_rounding(pose.of(self.centre)),
            tensor: turned(pose.rotation, self.tensor),
        }
    }

    /// The combined inertia of two bodies.
    pub(crate) fn with(&self, other: &Self) -> Self {
        if self.is_nothing() {
            return *other;
        }
        if other.is_nothing() {
            return *self;
        }
        let mass = self.mass + other.mass;
        let centre = if mass == 0.0 {
            self.centre
        } else {
            let moment = add(
                scaled(self.centre, self.mass),
                scaled(other.centre, other.mass),
            );
            without_rounding(scaled(moment, 1.0 / mass))
        };
        let about = |body: &Self| sum(body.tensor, of_point(body.mass, minus(body.centre, centre)));
        Self {
            mass,
            centre,
            tensor: without_rounding(sum(about(self), about(other))),
        }
    }

    /// Raises principal moments that are less than a bound.
    pub(crate) fn bound_moments(&mut self, least: f64) {
        let (moments, axes) = principal(self.tensor);
        if least > 0.0 && moments.iter().any(|moment| *moment < least) {
            let [xx, yy, zz] = moments.map(|moment| moment.max(least));
            self.tensor = turned(axes, [xx, yy, zz, 0.0, 0.0, 0.0]);
        }
    }

    /// Whether a principal moment exceeds the sum of the others.
    pub(crate) fn exceeds_triangle(&self) -> bool {
        let [small, middle, large] = sorted(principal(self.tensor).0);
        large > small + middle
    }

    /// Sets the moments of inertia to zero if they are rounding errors relative to m·|c|².
    pub(crate) fn without_rounding(&self) -> Self {
        let about = self.mass.abs() * dot(self.centre, self.centre);
        let vanishes = |entry: &f64| entry.abs() <= ROUNDING * about;
        let tensor = if self.tensor.iter().all(vanishes) {
            [0.0; 6]
        } else {
            self.tensor
        };
        Self { tensor, ..*self }
    }

    /// The property that is physically impossible, in words; `None` for a valid inertia.
    pub(crate) fn impossible(&self) -> Option<String> {
        let [small, middle, large] = sorted(principal(self.tensor).0);
        let number = |x: f64| plain(format!("{x:.3e}").parse().unwrap_or(x));
        if self.mass < 0.0 {
            return Some(format!("its mass, {} kg, is negative", self.mass));
        }
        if large > 0.0 && small < -WRITTEN * large {
            return Some("its inertia has a negative principal moment".to_owned());
        }
        if large > (small + middle) * (1.0 + WRITTEN) {
            return Some(format!(
                "its largest principal moment, {}, exceeds the sum of the other two, {} and {} (kg m²)",
                number(large),
                number(small),
                number(middle)
            ));
        }
        None
    }
}

/// The tensor with all moments raised by so much that the largest principal one is less than the sum of the others after
/// rounding to twelve digits; the same tensor where it is so, or where more than rounding is missing.
pub(crate) fn within_triangle(tensor: Tensor) -> Tensor {
    let [small, middle, large] = sorted(principal(tensor).0);
    let missing = large * (1.0 + TWELVE_DIGITS) - small - middle;
    let raised = if (0.0..WRITTEN * large).contains(&missing) {
        missing
    } else {
        0.0
    };
    let [xx, yy, zz, products @ ..] = tensor;
    let [xy, xz, yz] = products;
    [xx + raised, yy + raised, zz + raised, xy, xz, yz]
}

/// Principal moments, and the rotation to their axes, by Jacobi's rotations.
fn principal(tensor: Tensor) -> (Vector, Rotation) {
    let mut a = rows(tensor);
    let mut axes = Rotation::IDENTITY.0;
    for _ in 0..50 {
        let (p, q) = [(0, 1), (0, 2), (1, 2)]
            .into_iter()
            .max_by(|x, y| a[x.0][x.1].abs().total_cmp(&a[y.0][y.1].abs()))
            .unwrap_or((0, 1));
        if a[p][q] == 0.0 {
            break;
        }
        let angle = 0.5 * (2.0 * a[p][q]).atan2(a[q][q] - a[p][p]);
        let (s, c) = angle.sin_cos();
        for rows in [&mut a, &mut axes] {
            for row in rows {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
        }
        for k in 0..3 {
            let (x, y) = (a[p][k], a[q][k]);
            a[p][k] = c * x - s * y;
            a[q][k] = s * x + c * y;
        }
        let largest = a
            .iter()
            .flatten()
            .fold(0.0_f64, |most, one| most.max(one.abs()));
        for (i, j) in [(p, q), (q, p)] {
            if a[i][j].abs() <= 1e-16 * largest {
                a[i][j] = 0.0;
            }
        }
    }
    ([a[0][0], a[1][1], a[2][2]], Rotation(axes))
}

/// In increasing order.
fn sorted(mut moments: Vector) -> Vector {
    moments.sort_by(f64::total_cmp);
    moments
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_moments_do_not_depend_on_the_frame() {
        let rotation = Rotation::roll_pitch_yaw([0.3, -0.7, 1.9]);
        let tensor = turned(rotation, [1.0, 2.0, 2.5, 0.0, 0.0, 0.0]);
        let (moments, axes) = principal(tensor);
        let [xx, yy, zz] = moments;
        let back = turned(axes, [xx, yy, zz, 0.0, 0.0, 0.0]);
        assert!(
            (0..6).all(|k| (back[k] - tensor[k]).abs() < 1e-14),
            "{back:?}"
        );
        let moments = sorted(moments);
        assert!(
            minus(moments, [1.0, 2.0, 2.5])
                .iter()
                .all(|d| d.abs() < 1e-14),
            "{moments:?}"
        );
    }

    #[test]
    fn two_halves_of_a_rod_are_the_rod() {
        let half = |x: f64| Inertia {
            mass: 1.0,
            centre: [x, 0.0, 0.0],
            tensor: [0.0, 1.0 / 12.0, 1.0 / 12.0, 0.0, 0.0, 0.0],
        };
        let rod = half(-0.5).with(&half(0.5));
        assert_eq!((rod.mass, rod.centre), (2.0, [0.0; 3]));
        assert!((rod.tensor[1] - 2.0 * 4.0 / 12.0).abs() < 1e-15);
    }
}

//! Vectors and matrices of numbers, in the ground.

pub(super) type Vector = [f64; 3];
/// A matrix, row by row.
pub(super) type Matrix = [Vector; 3];

pub(super) const ZERO: Vector = [0.0; 3];

pub(super) fn unit(axis: usize) -> Vector {
    let mut vector = ZERO;
    vector[axis] = 1.0;
    vector
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// `a + s b`
pub(super) fn add(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(super) fn scaled(s: f64, a: Vector) -> Vector {
    add(ZERO, s, a)
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// `a · M b`
pub(super) fn between(a: Vector, matrix: &Matrix, b: Vector) -> f64 {
    dot(a, matrix.map(|row| dot(row, b)))
}

/// Smallest and largest value of each coordinate.
pub(super) fn spans<const N: usize>(places: impl Iterator<Item = [f64; N]>) -> [[f64; 2]; N] {
    let none = [[f64::INFINITY, f64::NEG_INFINITY]; N];
    places.fold(none, |spans, place| {
        std::array::from_fn(|k| [spans[k][0].min(place[k]), spans[k][1].max(place[k])])
    })
}

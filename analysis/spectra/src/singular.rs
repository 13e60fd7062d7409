//! Singular values with their vectors, by Jacobi rotations of the columns (M. R. Hestenes, 1958).
//!
//! The decomposition that ranks are read from has to be right where the matrix is singular: the
//! rotations find small singular values as accurately as the entries allow, and cannot fail.

use nalgebra::{ComplexField, DMatrix, DVector};

/// Maximum number of sweeps over all pairs of columns; a handful is usual.
const MOST_ROUNDS: usize = 60;

/// `A V = W`: V is unitary, the columns of W are orthogonal, and their norms are the singular values.
#[derive(Debug, Clone, PartialEq)]
pub struct Singular<T: ComplexField<RealField = f64>> {
    /// Singular values, the largest first; one per column of A.
    pub values: Vec<f64>,
    /// V; its last columns span the null space of A.
    pub right: DMatrix<T>,
    /// W.
    pub images: DMatrix<T>,
}

impl<T: ComplexField<RealField = f64>> Singular<T> {
    /// Of a matrix of any shape with finite entries.
    pub fn of(a: &DMatrix<T>) -> Self {
        let columns = a.ncols();
        let (mut images, mut right) = (a.clone(), DMatrix::identity(columns, columns));
        for _ in 0..MOST_ROUNDS {
            let mut turned = false;
            for p in 0..columns {
                for q in p + 1..columns {
                    turned |= turn(&mut images, &mut right, p, q);
                }
            }
            if !turned {
                break;
            }
        }
        let lengths: Vec<f64> = images.column_iter().map(|column| column.norm()).collect();
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|&i, &j| lengths[j].total_cmp(&lengths[i]));
        Self {
            values: order.iter().map(|&i| lengths[i]).collect(),
            right: right.select_columns(&order),
            images: images.select_columns(&order),
        }
    }

    /// How many singular values exceed a part of the largest.
    pub fn rank(&self, part: f64) -> usize {
        let largest = self.values.first().copied().unwrap_or(0.0);
        let counted = self.values.iter();
        counted.take_while(|&&value| value > part * largest).count()
    }

    /// The shortest x that A takes as close as possible to `target`, where only the first `rank`
    /// singular values count.
    pub fn solve(&self, target: &DVector<T>, rank: usize) -> DVector<T> {
        let mut x = DVector::zeros(self.right.nrows());
        for k in 0..rank.min(self.values.len()) {
            let square = T::from_real(self.values[k] * self.values[k]);
            let along = self.images.column(k).dotc(target) / square;
            x.axpy(along, &self.right.column(k), T::one());
        }
        x
    }
}

impl Singular<f64> {
    /// A⁺, where only the first `rank` singular values count.
    pub fn inverse(&self, rank: usize) -> DMatrix<f64> {
        let rank = rank.min(self.values.len());
        let mut scaled = self.right.columns(0, rank).into_owned();
        for (mut column, value) in scaled.column_iter_mut().zip(&self.values) {
            column /= value * value;
        }
        scaled * self.images.columns(0, rank).transpose()
    }
}

/// Turns two columns until they stand at right angles; false where they do already.
fn turn<T: ComplexField<RealField = f64>>(
    images: &mut DMatrix<T>,
    right: &mut DMatrix<T>,
    p: usize,
    q: usize,
) -> bool {
    let (first, second) = (images.column(p).norm(), images.column(q).norm());
    let product = images.column(p).dotc(&images.column(q));
    let size = product.clone().modulus();
    if size <= f64::EPSILON * first * second {
        return false;
    }
    let phase = product.unscale(size);
    let cot = (second * second - first * first) / (2.0 * size);
    let tan = 1.0_f64.copysign(cot) / (cot.abs() + cot.hypot(1.0));
    let cos = 1.0 / tan.hypot(1.0);
    let sin = cos * tan;
    for matrix in [images, right] {
        for i in 0..matrix.nrows() {
            let (x, y) = (matrix[(i, p)].clone(), matrix[(i, q)].clone());
            let y = y * phase.clone().conjugate();
            matrix[(i, p)] = x.clone().scale(cos) - y.clone().scale(sin);
            matrix[(i, q)] = x.scale(sin) + y.scale(cos);
        }
    }
    true
}

//! Normal equations of some columns with nuisance parameters eliminated, and the gains of subsets of columns.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};

/// Relative norm of the part orthogonal to the nuisance columns below which a column is dependent on them.
const LEFT: f64 = 1e-4;
/// Relative regularisation for undetermined nuisance parameters.
const RIDGE: f64 = 1e-10;

/// Gram matrix and scores of the columns, projected on the complement of the nuisance columns.
pub(super) struct Gram {
    pub(super) squares: DMatrix<f64>,
    pub(super) scores: DVector<f64>,
    /// Which columns depend linearly on the nuisance columns.
    pub(super) is_imitated: Vec<bool>,
    /// Log likelihood with all sizes zero.
    pub(super) log_likelihood: f64,
}

/// The best sizes of some columns.
pub(super) struct Solved {
    pub(super) gain: f64,
    pub(super) sizes: Vec<f64>,
    pub(super) deviations: Vec<f64>,
    pub(super) log_volume: f64,
}

impl Gram {
    /// Eliminates the first columns from all others.
    pub(super) fn beside(
        first: Range<usize>,
        (squares, scores): (&DMatrix<f64>, &DVector<f64>),
        log_likelihood: f64,
    ) -> Self {
        let (free, own) = (first.len(), squares.ncols() - first.len());
        let whole = squares.view((free, free), (own, own)).into_owned();
        let mut rest = Self {
            scores: scores.rows(free, own).into_owned(),
            is_imitated: vec![false; own],
            squares: whole.clone(),
            log_likelihood,
        };
        if free > 0 {
            let size = DVector::from_fn(free, |i, _| {
                squares[(i, i)].sqrt().max(f64::MIN_POSITIVE).recip()
            });
            let mut own_squares =
                DMatrix::from_fn(free, free, |i, j| size[i] * squares[(i, j)] * size[j]);
            for i in 0..free {
                own_squares[(i, i)] += RIDGE;
            }
            if let Some(factor) = own_squares.cholesky() {
                let mixed = DMatrix::from_fn(free, own, |i, j| size[i] * squares[(i, free + j)]);
                let of_own = DVector::from_fn(free, |i, _| size[i] * scores[i]);
                let along = factor.l().solve_lower_triangular(&mixed);
                let told = factor.l().solve_lower_triangular(&of_own);
                if let (Some(along), Some(told)) = (along, told) {
                    rest.squares -= along.tr_mul(&along);
                    rest.scores -= along.tr_mul(&told);
                    rest.log_likelihood += 0.5 * told.norm_squared();
                }
            }
        }
        for i in 0..own {
            let left = rest.squares[(i, i)];
            rest.is_imitated[i] = left.is_nan() || left <= LEFT * LEFT * whole[(i, i)];
        }
        rest
    }

    /// The best sizes of some columns; `None` if one depends linearly on the nuisance columns or on the others.
    pub(super) fn solved(&self, columns: &[usize]) -> Option<Solved> {
        let n = columns.len();
        if columns.iter().any(|&column| self.is_imitated[column]) {
            return None;
        }
        // Cholesky's factor by rows, of columns of length one.
        let size: Vec<f64> = columns
            .iter()
            .map(|&c| self.squares[(c, c)].sqrt())
            .collect();
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let mut rest = self.squares[(columns[i], columns[j])] / (size[i] * size[j]);
                for k in 0..j {
                    rest -= l[i * n + k] * l[j * n + k];
                }
                if i > j {
                    l[i * n + j] = rest / l[j * n + j];
                } else if rest > LEFT * LEFT {
                    l[i * n + i] = rest.sqrt();
                } else {
                    return None;
                }
            }
        }
        let forward = |right: &mut [f64]| {
            for i in 0..n {
                for k in 0..i {
                    right[i] -= l[i * n + k] * right[k];
                }
                right[i] /= l[i * n + i];
            }
        };
        let backward = |right: &mut [f64]| {
            for i in (0..n).rev() {
                for k in i + 1..n {
                    right[i] -= l[k * n + i] * right[k];
                }
                right[i] /= l[i * n + i];
            }
        };
        let mut sizes: Vec<f64> = (0..n).map(|i| -self.scores[columns[i]] / size[i]).collect();
        forward(&mut sizes);
        let gain = 0.5 * sizes.iter().map(|part| part * part).sum::<f64>();
        backward(&mut sizes);
        let deviations = (0..n).map(|i| {
            let mut unit = vec![0.0; n];
            unit[i] = 1.0;
            forward(&mut unit);
            unit.iter().map(|part| part * part).sum::<f64>().sqrt() / size[i]
        });
        let deviations = deviations.collect();
        let log_root: f64 = (0..n).map(|i| l[i * n + i].ln() + size[i].ln()).sum();
        for (own, size) in sizes.iter_mut().zip(&size) {
            *own /= size;
        }
        Some(Solved {
            gain,
            sizes,
            deviations,
            log_volume: 0.5 * n as f64 * TAU.ln() - log_root,
        })
    }
}

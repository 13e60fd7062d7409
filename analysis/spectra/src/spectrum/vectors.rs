//! Eigenvectors: the singular vectors of A − λ 1 to its smallest singular value. They are what inverse
//! iteration with (A − λ)ᴴ(A − λ) approaches, and they tell how many vectors a repeated eigenvalue
//! has.

use nalgebra::{Complex, DMatrix, DVector};

use crate::singular::Singular;

use super::{Eigenvalues, SpectrumError, row_by_row, square};

/// Eigenvalues that are closer, relative to the matrix, belong together.
const CLUSTER: f64 = 1e-6;
/// ‖A v − λ v‖ that rounding explains, relative to the matrix. A zero eigenvalue of a chain of k
/// vectors is known to ε^(1/k), and its vector leaves as much.
const RESIDUAL: f64 = 1e-3;
/// Singular values of A − λ that count as zero, relative to the matrix.
const SAME: f64 = 1e-9;

type Vector = DVector<Complex<f64>>;

/// An eigenvalue with its vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// λ.
    pub value: Complex<f64>,
    /// v of A v = λ v, of length 1, its largest component positive.
    pub right: Vector,
    /// w of wᴴ A = λ wᴴ, of length 1, its largest component positive.
    pub left: Vector,
    /// ‖A v − λ v‖.
    pub residual: f64,
    /// By how much a change of A moves λ: 1/|wᴴ v|, of a cluster the largest. Infinite, or large,
    /// where eigenvectors are missing.
    pub condition: f64,
}

/// All modes of a real matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Largest real part first, of a pair the one with positive imaginary part first.
    pub modes: Vec<Mode>,
    /// Frobenius norm of the matrix.
    pub norm: f64,
}

impl Spectrum {
    /// Eigenvalues with right and left eigenvectors; each pair is checked against the matrix.
    pub fn of(a: &DMatrix<f64>) -> Result<Self, SpectrumError> {
        let mut solver = Eigenvalues::new(square(a)?);
        let values = solver.of(&row_by_row(a))?;
        let norm = a.norm();
        let right = vectors(a, values, norm);
        // Aᵀ w = λ̄ w.
        let conjugate: Vec<_> = values.iter().map(Complex::conj).collect();
        let left = vectors(&a.transpose(), &conjugate, norm);
        let a = complex(a);
        let modes = values.iter().enumerate().map(|(i, &value)| {
            let residual = (&a * &right[i] - &right[i] * value).norm();
            let allowed = RESIDUAL * norm;
            // A NaN is no small residual either.
            if residual.is_nan() || residual > allowed {
                let (re, im) = (value.re, value.im);
                return Err(SpectrumError::Residual {
                    re,
                    im,
                    residual,
                    allowed,
                });
            }
            Ok(Mode {
                value,
                right: right[i].clone(),
                left: left[i].clone(),
                residual,
                condition: condition(values, i, norm, &right, &left),
            })
        });
        Ok(Self {
            modes: modes.collect::<Result<_, _>>()?,
            norm,
        })
    }

    /// The eigenvalues.
    pub fn values(&self) -> impl Iterator<Item = Complex<f64>> + '_ {
        self.modes.iter().map(|mode| mode.value)
    }

    /// How far rounding may have moved an eigenvalue: ε ‖A‖ times its condition.
    pub fn uncertainty(&self, mode: usize) -> f64 {
        let condition = self.modes.get(mode).map_or(f64::INFINITY, |m| m.condition);
        f64::EPSILON * self.norm * condition
    }
}

/// Places of the eigenvalues that belong together with the one at `i`.
fn cluster(values: &[Complex<f64>], i: usize, norm: f64) -> impl Iterator<Item = usize> + '_ {
    let near = move |&j: &usize| (values[j] - values[i]).norm() <= CLUSTER * norm;
    (0..values.len()).filter(near)
}

/// 1 over the smallest singular value of Wᴴ V of a cluster.
fn condition(
    values: &[Complex<f64>],
    i: usize,
    norm: f64,
    right: &[Vector],
    left: &[Vector],
) -> f64 {
    let places: Vec<usize> = cluster(values, i, norm).collect();
    let k = places.len();
    let products = DMatrix::from_fn(k, k, |r, c| left[places[r]].dotc(&right[places[c]]));
    let smallest = Singular::of(&products).values.pop();
    1.0 / smallest.unwrap_or(0.0)
}

/// One eigenvector per eigenvalue: the right singular vector of the smallest singular value of A − λ.
fn vectors(a: &DMatrix<f64>, values: &[Complex<f64>], norm: f64) -> Vec<Vector> {
    let (n, a) = (values.len(), complex(a));
    let vector = |(i, &value): (usize, &Complex<f64>)| {
        let singular = Singular::of(&(&a - DMatrix::from_diagonal_element(n, n, value)));
        // A repeated eigenvalue gets several vectors of the null space, as far as its dimension allows.
        let small = |&&size: &&f64| size <= SAME * norm;
        let own = singular.values.iter().rev().take_while(small).count();
        let earlier = cluster(values, i, norm).take_while(|&j| j < i).count();
        let place = n - 1 - earlier.min(own.max(1) - 1);
        phased(singular.right.column(place).into_owned())
    };
    values.iter().enumerate().map(vector).collect()
}

fn complex(a: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    a.map(|entry| Complex::new(entry, 0.0))
}

/// The largest component becomes real and positive; of equal ones the first.
fn phased(vector: Vector) -> Vector {
    let mut largest = Complex::new(0.0, 0.0);
    for component in vector.iter() {
        if component.norm() > 1.0001 * largest.norm() {
            largest = *component;
        }
    }
    if largest.norm() == 0.0 {
        return vector;
    }
    let turn = largest.conj() / largest.norm();
    vector * turn
}

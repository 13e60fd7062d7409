//! Eigenvalues, eigenvectors and the characteristic polynomial of a real matrix.
//!
//! The matrices of mechanics are small and hard in their own way: rows of zeros, zeros on the whole
//! diagonal, entries of many magnitudes, eigenvalues zero several times with fewer eigenvectors.
//! The way is the classical one: balancing, Hessenberg form, implicit double shifts (`francis.rs`);
//! vectors by inverse iteration (`vectors.rs`); coefficients from the Hessenberg form
//! (`polynomial.rs`).

mod francis;
mod hessenberg;
mod polynomial;
mod vectors;

use nalgebra::DMatrix;
pub use nalgebra::{Complex, DVector};

pub use francis::Eigenvalues;
pub use polynomial::characteristic_polynomial;
pub use vectors::{Mode, Spectrum};

/// Why eigenvalues could not be computed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// Only square matrices have eigenvalues.
    #[error("a matrix of {rows} × {columns} has no eigenvalues: it must be square")]
    NotSquare {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// An entry is infinite or not a number.
    #[error("entry ({row}, {column}) of the matrix is {value}, not a finite number")]
    NotFinite {
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The iteration did not isolate an eigenvalue.
    #[error("the QR iteration found {found} of {wanted} eigenvalues in {iterations} steps")]
    NoConvergence {
        /// Eigenvalues isolated.
        found: usize,
        /// Rows of the matrix.
        wanted: usize,
        /// Steps made for the one that failed.
        iterations: usize,
    },
    /// A pair of eigenvalue and eigenvector does not solve its equation.
    #[error(
        "eigenvalue {re:e} + {im:e} i leaves a residual of {residual:e}, allowed is {allowed:e}"
    )]
    Residual {
        /// Real part.
        re: f64,
        /// Imaginary part.
        im: f64,
        /// ‖A v − λ v‖ for ‖v‖ = 1.
        residual: f64,
        /// What rounding explains.
        allowed: f64,
    },
}

/// All eigenvalues: largest real part first, of a pair the one with positive imaginary part first.
pub fn eigenvalues(a: &DMatrix<f64>) -> Result<Vec<Complex<f64>>, SpectrumError> {
    let mut solver = Eigenvalues::new(square(a)?);
    Ok(solver.of(&row_by_row(a))?.to_vec())
}

/// Rows of a square matrix.
fn square(a: &DMatrix<f64>) -> Result<usize, SpectrumError> {
    let (rows, columns) = a.shape();
    if rows == columns {
        Ok(rows)
    } else {
        Err(SpectrumError::NotSquare { rows, columns })
    }
}

fn row_by_row(a: &DMatrix<f64>) -> Vec<f64> {
    a.transpose().as_slice().to_vec()
}

/// The first entry of an n × n matrix, row by row, that is no finite number.
fn finite(a: &[f64], n: usize) -> Result<(), SpectrumError> {
    match a.iter().position(|entry| !entry.is_finite()) {
        None => Ok(()),
        Some(at) => Err(SpectrumError::NotFinite {
            row: at / n,
            column: at % n,
            value: a[at],
        }),
    }
}

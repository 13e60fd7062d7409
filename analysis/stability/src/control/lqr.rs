//! Gains that minimise ∫ (yᵀ Q y + uᵀ R u) dt.

use nalgebra::{Complex, DMatrix};

use super::LinearSystem;
use super::riccati::{self, Riccati, RiccatiError};
use appell_spectra::spectrum;

/// Optimal gains.
#[derive(Debug, Clone, PartialEq)]
pub struct Regulator {
    /// K in u = −K y.
    pub gain: DMatrix<f64>,
    /// X: yᵀ X y is the cost to go from y.
    pub cost: DMatrix<f64>,
    /// Eigenvalues of A − B K.
    pub poles: Vec<Complex<f64>>,
    /// Residual of the Riccati equation relative to its terms.
    pub residual: f64,
}

/// In continuous time.
pub fn continuous(
    system: &LinearSystem,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<Regulator, RiccatiError> {
    regulator(system, riccati::continuous(&system.a, &system.b, q, r)?)
}

/// In discrete time: minimises Σ (yᵀ Q y + uᵀ R u).
pub fn discrete(
    system: &LinearSystem,
    q: &DMatrix<f64>,
    r: &DMatrix<f64>,
) -> Result<Regulator, RiccatiError> {
    regulator(system, riccati::discrete(&system.a, &system.b, q, r)?)
}

fn regulator(system: &LinearSystem, solution: Riccati) -> Result<Regulator, RiccatiError> {
    Ok(Regulator {
        poles: spectrum::eigenvalues(&system.closed(&solution.gain))?,
        gain: solution.gain,
        cost: solution.x,
        residual: solution.residual,
    })
}

/// A diagonal weight.
pub fn weights(diagonal: &[f64]) -> DMatrix<f64> {
    DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(diagonal))
}

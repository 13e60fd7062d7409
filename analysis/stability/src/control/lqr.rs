//! Gains that minimise ∫ (yᵀ Q y + uᵀ R u) dt, by the stabilising solutions of Riccati equations.
//!
//! Those of continuous and of discrete time are solved by doubling, which squares the closed loop in each step (E. K.-W. Chu, H.-Y. Fan,
//! W.-W. Lin, *A structure-preserving doubling algorithm for continuous-time algebraic Riccati
//! equations*, Linear Algebra and its Applications 396, 2005), and polished by Newton's method
//! (D. L. Kleinman 1968; G. A. Hewer 1971), which leaves a residual of rounding.

use nalgebra::{Complex, DMatrix, DVector};

use super::LinearSystem;
use appell_spectra::spectrum::{self, SpectrumError};

/// Doublings after which the closed loop is 2⁶⁰ steps further.
const DOUBLINGS: usize = 60;
/// Newton steps; from a good start two are enough.
const NEWTON_STEPS: usize = 6;
/// Largest residual of a solution, relative to the terms of the equation.
const RESIDUAL: f64 = 1e-9;

type Matrix = DMatrix<f64>;

/// Optimal gains.
#[derive(Debug, Clone, PartialEq)]
pub struct Regulator {
    /// K in u = −K y.
    pub gain: Matrix,
    /// X, symmetric positive semidefinite: yᵀ X y is the cost to go from y.
    pub cost: Matrix,
    /// Eigenvalues of A − B K.
    pub poles: Vec<Complex<f64>>,
    /// Norm of the residual of the Riccati equation relative to the norms of its terms.
    pub residual: f64,
}

/// A diagonal weight.
pub fn weights(diagonal: &[f64]) -> Matrix {
    Matrix::from_diagonal(&DVector::from_column_slice(diagonal))
}

/// Why there is no stabilising solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RiccatiError {
    /// Matrices of inconsistent dimensions.
    #[error("{what} must be {rows} × {columns}, not {found_rows} × {found_columns}")]
    Shape {
        /// Which matrix.
        what: &'static str,
        /// Rows that are needed.
        rows: usize,
        /// Columns that are needed.
        columns: usize,
        /// Rows that were given.
        found_rows: usize,
        /// Columns that were given.
        found_columns: usize,
    },
    /// The weights of the inputs are not positive.
    #[error("the weight R of the inputs is not positive definite")]
    InputWeight,
    /// A weight of the states is negative.
    #[error("the weight Q of the states has the eigenvalue {smallest:e}; none may be negative")]
    StateWeight {
        /// The smallest eigenvalue.
        smallest: f64,
    },
    /// No stabilising solution exists.
    #[error(
        "there is no stabilising solution: an undamped or unstable mode is uncontrollable, or a mode \
         on the stability boundary is unobservable through Q"
    )]
    NoStabilisingSolution,
    /// The residual is larger than rounding explains.
    #[error("the Riccati equation is solved only to a relative residual of {0:e}")]
    Inexact(f64),
    /// The eigenvalues of the closed loop could not be computed.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// In continuous time: solves `AᵀX + X A − X B R⁻¹ Bᵀ X + Q = 0`; `K = R⁻¹ Bᵀ X`.
pub fn continuous(
    system: &LinearSystem,
    q: &Matrix,
    r: &Matrix,
) -> Result<Regulator, RiccatiError> {
    let LinearSystem { a, b } = system;
    let g = control_energy(a, b, q, r)?;
    let gain = |x: &Matrix| r.clone().cholesky().map(|r| r.solve(&(b.transpose() * x)));
    let size = a.norm().max((&g * q).norm().sqrt()).max(f64::MIN_POSITIVE);
    let start = [1.0, 0.3, 3.0]
        .into_iter()
        .find_map(|part| doubled(cayley(a, &g, q, part * size)?))
        .ok_or(RiccatiError::NoStabilisingSolution)?;
    let newton = |x: &Matrix| {
        let k = gain(x)?;
        let right = -(q + k.transpose() * r * &k);
        lyapunov(&(a - b * k), &right)
    };
    let residual = |x: &Matrix| {
        let terms = [a.transpose() * x, x * a, -(x * &g * x), q.clone()];
        relative(&terms)
    };
    let solution = polished(start, newton, residual);
    regulator(system, solution, gain, |pole| pole.re < 0.0)
}

/// In discrete time, for Σ (yᵀ Q y + uᵀ R u): solves `AᵀX A − X − AᵀX B (R + BᵀX B)⁻¹ BᵀX A + Q = 0`;
/// `K = (R + BᵀX B)⁻¹ BᵀX A`.
pub fn discrete(system: &LinearSystem, q: &Matrix, r: &Matrix) -> Result<Regulator, RiccatiError> {
    let LinearSystem { a, b } = system;
    let g = control_energy(a, b, q, r)?;
    let gain = |x: &Matrix| {
        let bx = b.transpose() * x;
        let weight = (r + &bx * b).cholesky()?;
        Some(weight.solve(&(bx * a)))
    };
    let start = doubled([a.clone(), g, q.clone()]).ok_or(RiccatiError::NoStabilisingSolution)?;
    let newton = |x: &Matrix| {
        let k = gain(x)?;
        let right = q + k.transpose() * r * &k;
        stein(&(a - b * k), &right)
    };
    let residual = |x: &Matrix| {
        let k = gain(x).unwrap_or_else(|| Matrix::zeros(b.ncols(), a.nrows()));
        let ax = a.transpose() * x;
        relative(&[&ax * a, -x, -(ax * b * k), q.clone()])
    };
    let solution = polished(start, newton, residual);
    regulator(system, solution, gain, |pole| pole.norm() < 1.0)
}

/// Newton steps as long as the residual falls.
fn polished(
    mut x: Matrix,
    newton: impl Fn(&Matrix) -> Option<Matrix>,
    residual: impl Fn(&Matrix) -> f64,
) -> (Matrix, f64) {
    let mut smallest = residual(&x);
    for _ in 0..NEWTON_STEPS {
        let Some(next) = newton(&x) else { break };
        let remaining = residual(&next);
        if remaining.is_nan() || remaining >= smallest {
            break;
        }
        (x, smallest) = (next, remaining);
    }
    (x, smallest)
}

/// B R⁻¹ Bᵀ, after the matrices were checked.
fn control_energy(a: &Matrix, b: &Matrix, q: &Matrix, r: &Matrix) -> Result<Matrix, RiccatiError> {
    let (n, m) = (a.nrows(), b.ncols());
    for (what, matrix, rows, columns) in [
        ("A", a, n, n),
        ("B", b, n, m),
        ("Q", q, n, n),
        ("R", r, m, m),
    ] {
        let (found_rows, found_columns) = matrix.shape();
        if (found_rows, found_columns) != (rows, columns) {
            return Err(RiccatiError::Shape {
                what,
                rows,
                columns,
                found_rows,
                found_columns,
            });
        }
    }
    let smallest = q.symmetric_eigenvalues().min();
    if smallest < -f64::EPSILON * n as f64 * q.norm() {
        return Err(RiccatiError::StateWeight { smallest });
    }
    let factor = r.clone().cholesky().ok_or(RiccatiError::InputWeight)?;
    Ok(b * factor.solve(&b.transpose()))
}

/// The discrete system (A, G, H) that has the same solution as a continuous one: the Cayley
/// transformation (s + γ)/(s − γ).
fn cayley(a: &Matrix, g: &Matrix, q: &Matrix, gamma: f64) -> Option<[Matrix; 3]> {
    let n = a.nrows();
    let identity = Matrix::identity(n, n);
    let inverse = (a - &identity * gamma).try_inverse()?;
    // W = A_γᵀ + Q A_γ⁻¹ G
    let w = (a.transpose() - &identity * gamma + q * &inverse * g).try_inverse()?;
    Some([
        &identity + w.transpose() * (2.0 * gamma),
        &inverse * g * &w * (2.0 * gamma),
        &w * q * &inverse * (2.0 * gamma),
    ])
}

/// The limit of H under doubling; `None` without convergence.
fn doubled([mut a, mut g, mut h]: [Matrix; 3]) -> Option<Matrix> {
    let identity = Matrix::identity(a.nrows(), a.nrows());
    for _ in 0..DOUBLINGS {
        let inverse = (&identity + &g * &h).try_inverse()?;
        let step = a.transpose() * &h * &inverse * &a;
        g += &a * &inverse * &g * a.transpose();
        a = &a * inverse * &a;
        h += &step;
        h = (&h + h.transpose()) * 0.5;
        let size = h.norm();
        if !size.is_finite() {
            return None;
        }
        if step.norm() <= f64::EPSILON * size {
            return Some(h);
        }
    }
    None
}

/// X of Cᵀ X + X C = F. An equation for each entry: the systems of mechanisms are small.
fn lyapunov(c: &Matrix, f: &Matrix) -> Option<Matrix> {
    let identity = Matrix::identity(c.nrows(), c.nrows());
    entrywise(
        &(identity.kronecker(&c.transpose()) + c.transpose().kronecker(&identity)),
        f,
    )
}

/// X of X − Cᵀ X C = F.
fn stein(c: &Matrix, f: &Matrix) -> Option<Matrix> {
    let n = c.nrows();
    let identity = Matrix::identity(n * n, n * n);
    entrywise(&(identity - c.transpose().kronecker(&c.transpose())), f)
}

fn entrywise(matrix: &Matrix, f: &Matrix) -> Option<Matrix> {
    let right = DVector::from_column_slice(f.as_slice());
    let entries = matrix.clone().lu().solve(&right)?;
    let x = Matrix::from_column_slice(f.nrows(), f.ncols(), entries.as_slice());
    Some((&x + x.transpose()) * 0.5)
}

fn relative(terms: &[Matrix; 4]) -> f64 {
    let sum = terms
        .iter()
        .fold(terms[0].clone() * 0.0, |sum, term| sum + term);
    let sizes: f64 = terms.iter().map(Matrix::norm).sum();
    sum.norm() / sizes.max(f64::MIN_POSITIVE)
}

/// The gains of a solution, if it is exact and stabilises the loop.
fn regulator(
    system: &LinearSystem,
    (cost, residual): (Matrix, f64),
    gain: impl Fn(&Matrix) -> Option<Matrix>,
    is_stable: impl Fn(&Complex<f64>) -> bool,
) -> Result<Regulator, RiccatiError> {
    let gain = gain(&cost).ok_or(RiccatiError::InputWeight)?;
    let poles = spectrum::eigenvalues(&system.closed(&gain))?;
    if !poles.iter().all(is_stable) {
        return Err(RiccatiError::NoStabilisingSolution);
    }
    if residual.is_nan() || residual > RESIDUAL {
        return Err(RiccatiError::Inexact(residual));
    }
    Ok(Regulator {
        gain,
        cost,
        poles,
        residual,
    })
}

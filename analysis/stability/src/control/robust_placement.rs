//! Pole placement with several inputs.
//!
//! The gains are not unique: each pole leaves a choice of eigenvectors, a subspace of as many
//! dimensions as there are inputs. Those as close to orthogonal as possible are chosen, which makes
//! the poles least sensitive to the equations (J. Kautsky, N. K. Nichols, P. Van Dooren, *Robust
//! pole assignment in linear state feedback*, International Journal of Control 41, 1985, method 0;
//! A. L. Tits, Y. Yang, *Globally convergent algorithms for robust pole assignment by state
//! feedback*, IEEE Transactions on Automatic Control 41, 1996).

use nalgebra::{Complex, ComplexField, DMatrix, DVector};

use super::LinearSystem;
use super::placement::{Placement, PlacementError, condition, paired};
use super::staircase::{NEGLIGIBLE, Staircase};
use appell_spectra::singular::Singular;

/// Rounds over all eigenvectors, from each start.
const ROUNDS: usize = 40;
/// Starts; rounds from different ones end at different local optima.
const STARTS: usize = 6;

type Matrix = DMatrix<Complex<f64>>;

/// Gains of several inputs that give A − B K the poles, with well-conditioned eigenvectors. A pole
/// may occur as often as there are inputs.
pub fn place(system: &LinearSystem, poles: &[Complex<f64>]) -> Result<Placement, PlacementError> {
    if system.inputs() == 1 {
        return super::placement::place(system, poles);
    }
    let poles = paired(poles, system.order())?;
    let balanced = system.balanced();
    let (a, b) = (&balanced.system.a, &balanced.system.b);
    check(&balanced.system, &poles)?;
    // Outside the range of B, x must satisfy the equation alone: it is in the kernel of Q₁ᵀ (A −
    // λ1).
    let unreached = left_kernel(b);
    let choices: Vec<Matrix> = poles
        .iter()
        .map(|pole| {
            let shifted = complex(a) - Matrix::from_diagonal_element(a.nrows(), a.nrows(), *pole);
            let rows = complex(&unreached.transpose()) * shifted;
            Singular::of(&rows)
                .right
                .columns_range(a.nrows() - b.ncols()..)
                .into_owned()
        })
        .collect();
    let vectors = (0..STARTS)
        .filter_map(|start| spread(&choices, &poles, start))
        .min_by(|x, y| condition(x).total_cmp(&condition(y)))
        .ok_or(PlacementError::Defective)?;
    let inverse = vectors
        .clone()
        .try_inverse()
        .ok_or(PlacementError::Defective)?;
    let values = Matrix::from_diagonal(&DVector::from_vec(poles.clone()));
    let wanted = (vectors * values * inverse).map(|entry| entry.re);
    // B K = A − X Λ X⁻¹, which lies in the range of B.
    let gain = (b.transpose() * b)
        .lu()
        .solve(&(b.transpose() * (a - wanted)))
        .ok_or(PlacementError::Defective)?;
    Placement::of(&balanced, &gain, &poles)
}

fn check(system: &LinearSystem, poles: &[Complex<f64>]) -> Result<(), PlacementError> {
    let (order, inputs) = (system.order(), system.inputs());
    let rank = Singular::of(&system.b).rank(NEGLIGIBLE);
    if rank < inputs {
        return Err(PlacementError::DependentInputs { inputs, rank });
    }
    let rank = Staircase::of(system).controllable();
    if rank < order {
        return Err(PlacementError::Uncontrollable { rank, order });
    }
    let often = |pole: &Complex<f64>| poles.iter().filter(|other| *other == pole).count();
    match poles.iter().find(|pole| often(pole) > inputs) {
        None => Ok(()),
        Some(pole) => Err(PlacementError::Multiple {
            pole: *pole,
            wanted: often(pole),
            inputs,
        }),
    }
}

/// Columns that are orthogonal to all columns of a matrix.
fn left_kernel(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let singular = Singular::of(&matrix.transpose());
    singular.right.columns_range(matrix.ncols()..).into_owned()
}

/// Well-conditioned eigenvectors from their subspaces: each in turn is rotated towards the
/// direction orthogonal to all others. `None` if they stay dependent.
fn spread(choices: &[Matrix], poles: &[Complex<f64>], start: usize) -> Option<Matrix> {
    let mut vectors = first_vectors(choices, poles, start);
    let mut best: Option<(f64, Matrix)> = None;
    for _ in 0..ROUNDS {
        for j in (0..poles.len()).filter(|&j| poles[j].im >= 0.0) {
            let orthogonal = vectors.clone().try_inverse()?.row(j).adjoint();
            let within = &choices[j] * (choices[j].adjoint() * orthogonal);
            set(&mut vectors, poles, j, &within.normalize());
        }
        let volume = vectors.determinant().modulus();
        if best.as_ref().is_none_or(|(largest, _)| volume > *largest) {
            best = Some((volume, vectors.clone()));
        }
    }
    best.map(|(_, vectors)| vectors)
}

/// A vector of each subspace, with weights that differ for each pole and start.
fn first_vectors(choices: &[Matrix], poles: &[Complex<f64>], start: usize) -> Matrix {
    let n = poles.len();
    let mut vectors = Matrix::zeros(n, n);
    for j in (0..n).filter(|&j| poles[j].im >= 0.0) {
        let weights = DVector::from_fn(choices[j].ncols(), |k, _| {
            let angle = ((start + 1) * (j + 1) * (k + 1)) as f64;
            Complex::new(
                angle.cos(),
                if poles[j].im > 0.0 { angle.sin() } else { 0.0 },
            )
        });
        set(&mut vectors, poles, j, &(&choices[j] * weights).normalize());
    }
    vectors
}

/// Sets the eigenvector of pole `j`; for a complex pole also its conjugate, in the next column.
fn set(vectors: &mut Matrix, poles: &[Complex<f64>], j: usize, vector: &DVector<Complex<f64>>) {
    if poles[j].im > 0.0 {
        vectors.set_column(j + 1, &vector.conjugate());
    }
    vectors.set_column(j, vector);
}

fn complex(matrix: &DMatrix<f64>) -> Matrix {
    matrix.map(Complex::from)
}

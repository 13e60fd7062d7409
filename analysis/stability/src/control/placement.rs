//! Pole placement.
//!
//! With one input the gains are unique. By Ackermann's formula kᵀ = eₙᵀ [b Ab … Aⁿ⁻¹b]⁻¹ p(A); in Hessenberg form,
//! which the staircase gives, the matrix in brackets is triangular, so that only one row has to be
//! multiplied n times (B. N. Datta, *An algorithm to assign eigenvalues in a Hessenberg matrix:
//! single input case*, IEEE Transactions on Automatic Control 32, 1987).
//!
//! With several inputs they are not: each pole leaves a choice of eigenvectors, a subspace of as many
//! dimensions as there are inputs. Those as close to orthogonal as possible are chosen, which makes
//! the poles least sensitive to the equations (J. Kautsky, N. K. Nichols, P. Van Dooren, *Robust
//! pole assignment in linear state feedback*, International Journal of Control 41, 1985, method 0;
//! A. L. Tits, Y. Yang, *Globally convergent algorithms for robust pole assignment by state
//! feedback*, IEEE Transactions on Automatic Control 41, 1996).

use appell_spectra::singular::Singular;
use appell_spectra::spectrum::{Spectrum, SpectrumError, characteristic_polynomial};
use nalgebra::{Complex, ComplexField, DMatrix, DVector, RowDVector};

use super::linear_system::{Balanced, LinearSystem};
use super::staircase::{NEGLIGIBLE, Staircase};

/// Gains and the closed loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// K in u = −K y, a row for each input.
    pub gain: DMatrix<f64>,
    /// Eigenvalues of A − B K as computed. Those of a multiple pole spread: an n-fold pole moves
    /// by the n-th root of the rounding.
    pub poles: Vec<Complex<f64>>,
    /// Largest difference between the coefficients of the characteristic polynomials of A − B K and
    /// of the requested poles, each relative to the sum of the magnitudes of its terms: the
    /// accuracy of the gains, even where the poles spread.
    pub residual: f64,
    /// Condition number of the eigenvectors of A − B K, of length 1 in balanced states: the
    /// sensitivity of the poles to the equations. Infinite for a multiple pole with one
    /// eigenvector.
    pub condition: f64,
}

/// Why poles cannot be placed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlacementError {
    /// Too few or too many poles.
    #[error("{given} poles are given for {order} states")]
    Count {
        /// Number of poles given.
        given: usize,
        /// Number of poles needed.
        order: usize,
    },
    /// A complex pole without its conjugate has complex gains.
    #[error("the complex pole {pole} needs its conjugate")]
    Unpaired {
        /// The pole.
        pole: Complex<f64>,
    },
    /// Not all poles can be moved.
    #[error("the controllable subspace has {rank} of {order} dimensions")]
    Uncontrollable {
        /// Dimension of the controllable subspace.
        rank: usize,
        /// Number of states.
        order: usize,
    },
    /// A pole of higher multiplicity than the number of inputs has too few eigenvectors.
    #[error(
        "the pole {pole} is requested {wanted} times, but {inputs} inputs give it at most {inputs} eigenvectors"
    )]
    Multiple {
        /// The pole.
        pole: Complex<f64>,
        /// Its multiplicity.
        wanted: usize,
        /// Number of independent inputs.
        inputs: usize,
    },
    /// Linearly dependent inputs.
    #[error("{inputs} inputs have only {rank} independent effects")]
    DependentInputs {
        /// Number of inputs.
        inputs: usize,
        /// Rank of B.
        rank: usize,
    },
    /// No independent eigenvectors were found.
    #[error("no independent eigenvectors exist for these poles")]
    Defective,
    /// The eigenvalues of the closed loop could not be computed.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// Gains of one input that place the poles of A − b kᵀ.
fn place_single(
    system: &LinearSystem,
    poles: &[Complex<f64>],
) -> Result<Placement, PlacementError> {
    let poles = paired(poles, system.order())?;
    let balanced = system.balanced();
    let form = Staircase::of(&balanced.system);
    if form.controllable() < system.order() {
        return Err(PlacementError::Uncontrollable {
            rank: form.controllable(),
            order: system.order(),
        });
    }
    let gain = hessenberg_gain(&form.system, &poles) * form.q.transpose();
    let gain = DMatrix::from_row_slice(1, system.order(), gain.as_slice());
    Placement::of(&balanced, &gain, &poles)
}

/// eₙᵀ p(H) / (β h₂₁ h₃₂ …) for an upper Hessenberg H and b = β e₁.
fn hessenberg_gain(system: &LinearSystem, poles: &[Complex<f64>]) -> RowDVector<f64> {
    let (h, n) = (&system.a, system.order());
    let mut row = RowDVector::zeros(n);
    row[n - 1] = 1.0;
    // Divisor of a factor of p, so that the row keeps the magnitude of the gains.
    let mut steps = (1..n)
        .map(|i| h[(i, i - 1)])
        .rev()
        .chain([system.b[(0, 0)]]);
    let mut step = || steps.next().unwrap_or(1.0);
    for pole in poles {
        let next = &row * h;
        if pole.im.abs() <= 0.0 {
            row = (next - &row * pole.re) / step();
        } else if pole.im > 0.0 {
            // (H − λ)(H − λ̄) = H² − 2 Re λ H + |λ|²
            row = (&next * h - next * (2.0 * pole.re) + &row * pole.norm_sqr()) / (step() * step());
        }
    }
    row
}

/// The poles with complex ones in conjugate pairs, positive imaginary part first.
fn paired(poles: &[Complex<f64>], order: usize) -> Result<Vec<Complex<f64>>, PlacementError> {
    if poles.len() != order {
        return Err(PlacementError::Count {
            given: poles.len(),
            order,
        });
    }
    let mut open = poles.to_vec();
    let mut paired = Vec::with_capacity(order);
    while let Some(pole) = open.pop() {
        if pole.im.abs() <= 0.0 {
            paired.push(pole);
            continue;
        }
        let conjugate = open.iter().position(|other| *other == pole.conj());
        let Some(place) = conjugate else {
            return Err(PlacementError::Unpaired { pole });
        };
        open.remove(place);
        let above = Complex::new(pole.re, pole.im.abs());
        paired.extend([above, above.conj()]);
    }
    paired.reverse();
    // Reversed, a pair begins below the axis.
    for i in 1..paired.len() {
        if paired[i - 1].im < 0.0 && paired[i] == paired[i - 1].conj() {
            paired.swap(i - 1, i);
        }
    }
    Ok(paired)
}

impl Placement {
    /// The closed loop of a balanced system.
    fn of(
        balanced: &Balanced,
        scaled_gain: &DMatrix<f64>,
        wanted: &[Complex<f64>],
    ) -> Result<Self, PlacementError> {
        let closed = balanced.system.closed(scaled_gain);
        let spectrum = Spectrum::of(&closed)?;
        let modes = spectrum.modes.iter();
        let vectors: Vec<_> = modes.map(|mode| mode.right.clone()).collect();
        Ok(Self {
            poles: spectrum.values().collect(),
            residual: polynomial_residual(&characteristic_polynomial(&closed)?, wanted),
            condition: condition(&DMatrix::from_columns(&vectors)),
            gain: balanced.gain(scaled_gain),
        })
    }
}

/// Largest singular value over the smallest.
fn condition(vectors: &DMatrix<Complex<f64>>) -> f64 {
    let values = Singular::of(vectors).values;
    match values[..] {
        [first, .., last] => first / last,
        _ => 1.0,
    }
}

/// Largest difference between the coefficients of a polynomial and those of its requested roots,
/// each relative to the same coefficient of Π (s + |λ|).
fn polynomial_residual(coefficients: &[f64], wanted: &[Complex<f64>]) -> f64 {
    let expand = |roots: &mut dyn Iterator<Item = Complex<f64>>| {
        let mut polynomial = vec![Complex::new(1.0, 0.0)];
        for root in roots {
            polynomial.push(0.0.into());
            for place in (1..polynomial.len()).rev() {
                let before = polynomial[place - 1];
                polynomial[place] -= root * before;
            }
        }
        polynomial
    };
    let exact = expand(&mut wanted.iter().copied());
    // A root at zero has no magnitude; it counts as large as the largest.
    let largest = wanted.iter().map(|root| root.norm()).fold(0.0, f64::max);
    let of = |root: &Complex<f64>| {
        if root.norm() > 0.0 {
            root.norm()
        } else {
            largest
        }
    };
    let size = expand(&mut wanted.iter().map(|root| Complex::from(-of(root))));
    let pairs = coefficients.iter().zip(exact.iter().zip(size));
    pairs
        .map(|(got, (exact, size))| (got - exact.re).abs() / size.re.max(f64::MIN_POSITIVE))
        .fold(0.0, f64::max)
}

/// Rounds over all eigenvectors, from each start.
const ROUNDS: usize = 40;
/// Starts; rounds from different ones end at different local optima.
const STARTS: usize = 6;

type Matrix = DMatrix<Complex<f64>>;

/// Gains that give A − B K the poles, with well-conditioned eigenvectors where they are a choice. A pole
/// may occur as often as there are inputs.
pub fn place(system: &LinearSystem, poles: &[Complex<f64>]) -> Result<Placement, PlacementError> {
    if system.inputs() == 1 {
        return place_single(system, poles);
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

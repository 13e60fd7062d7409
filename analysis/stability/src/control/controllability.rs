//! Controllability, and uncontrollable modes.

use appell_spectra::singular::Singular;
use appell_spectra::spectrum::{self, SpectrumError};
use nalgebra::{Complex, ComplexField, DMatrix};

use super::LinearSystem;
use super::staircase::{NEGLIGIBLE, Staircase};

/// Eigenvalues closer than this, relative to the largest entry of a balanced A, count as one: a
/// multiple eigenvalue is known to a root of the rounding error only, its mean to all digits.
const CLUSTER: f64 = 1e-4;

/// A smallest singular value below this, relative to the largest entry, counts as zero. The
/// tolerance is wider than that of the staircase, as the eigenvalue itself is rounded.
const LOST: f64 = 1e-9;

/// Controllability of a linear system.
#[derive(Debug, Clone, PartialEq)]
pub struct Controllability {
    /// Dimension of the controllable subspace, from the staircase form of the balanced system.
    pub rank: usize,
    /// Singular values of [B AB A²B …] relative to the largest, in descending order. A is balanced
    /// and divided by its norm and the columns of B are of similar size, so that small values mean
    /// directions that are hard to control, not small units.
    pub singular_values: Vec<f64>,
    /// Uncontrollable eigenvalues, which no feedback moves.
    pub lost: Vec<Complex<f64>>,
    /// A row for each uncontrollable mode: a combination of the states on which the inputs have no
    /// effect. In reduced row echelon form.
    pub untouched: DMatrix<f64>,
    /// The modes of A with the test of Popov, Belevitch and Hautus.
    pub modes: Vec<Mode>,
}

/// An eigenvalue of A.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// The eigenvalue, in 1/s.
    pub value: Complex<f64>,
    /// How many eigenvalues of A lie here.
    pub multiplicity: usize,
    /// Smallest singular value of [A − λ1  B] of the balanced system, relative to its largest
    /// entry: the relative distance to a system in which the mode is uncontrollable.
    pub distance: f64,
    /// Whether it is uncontrollable; of a multiple mode, whether a part of it is.
    pub lost: bool,
    /// The combinations of states with this mode on which the inputs have no effect, as rows in
    /// reduced row echelon form. None for a controllable mode.
    pub untouched: DMatrix<Complex<f64>>,
}

impl Controllability {
    /// Analyses a system.
    pub fn of(system: &LinearSystem) -> Result<Self, SpectrumError> {
        let balanced = system.balanced();
        let form = Staircase::of(&balanced.system);
        let rank = form.controllable();
        let below = form.q.columns(rank, system.order() - rank).transpose();
        // A combination of scaled states is one of the states themselves, divided by their scales.
        let untouched = DMatrix::from_fn(below.nrows(), below.ncols(), |row, state| {
            below[(row, state)] / balanced.states[state]
        });
        let lost = spectrum::eigenvalues(&form.uncontrollable_part())?;
        Ok(Self {
            rank,
            singular_values: singular_values(&balanced.system),
            lost,
            untouched: row_echelon(untouched, NEGLIGIBLE),
            modes: modes(&balanced.system, &balanced.states)?,
        })
    }

    /// Uncontrollable modes that do not decay: under any feedback the closed loop keeps them.
    pub fn kept(&self) -> impl Iterator<Item = &Mode> {
        let size = self.modes.iter().map(|mode| mode.value.norm());
        let rounding = LOST * size.fold(1.0, f64::max);
        let lost = self.modes.iter().filter(|mode| mode.lost);
        lost.filter(move |mode| mode.value.re >= -rounding)
    }
}

/// Output controllability: the rank of [CB CAB CA²B …] for outputs that are states.
pub fn output_rank(system: &LinearSystem, outputs: &[usize]) -> usize {
    let basis = Staircase::of(&system.balanced().system).basis();
    Singular::of(&basis.select_rows(outputs)).rank(NEGLIGIBLE)
}

/// Singular values of the controllability matrix, relative to the largest.
fn singular_values(system: &LinearSystem) -> Vec<f64> {
    let n = system.order();
    let a = &system.a / system.a.norm().max(f64::MIN_POSITIVE);
    let mut column = &system.b / system.b.norm().max(f64::MIN_POSITIVE);
    let mut krylov = DMatrix::zeros(n, 0);
    for _ in 0..n {
        let (done, more) = (krylov.ncols(), column.ncols());
        krylov = krylov.resize_horizontally(done + more, 0.0);
        krylov.columns_mut(done, more).copy_from(&column);
        column = &a * column;
    }
    // Of the transposed, which has as many columns as there are states.
    let mut values = Singular::of(&krylov.transpose()).values;
    let largest = values.first().copied().unwrap_or(0.0);
    if largest > 0.0 {
        for value in &mut values {
            *value /= largest;
        }
    }
    values
}

/// The eigenvalues of A, multiple ones once, with the test of Popov, Belevitch and Hautus. A complex
/// pair is represented by the eigenvalue above the real axis.
fn modes(system: &LinearSystem, scales: &[f64]) -> Result<Vec<Mode>, SpectrumError> {
    let size = system.a.amax().max(system.b.amax()).max(f64::MIN_POSITIVE);
    let mut open = spectrum::eigenvalues(&system.a)?;
    let mut modes = Vec::new();
    while let Some(&first) = open.first() {
        let near = |value: &Complex<f64>| (value - first).norm() <= CLUSTER * size;
        let (cluster, rest): (Vec<_>, Vec<_>) = open.into_iter().partition(near);
        open = rest;
        let mean = cluster.iter().sum::<Complex<f64>>() / cluster.len() as f64;
        let real = mean.im.abs() <= CLUSTER * size;
        let value = Complex::new(mean.re, if real { 0.0 } else { mean.im });
        if value.im >= 0.0 {
            modes.push(mode(system, scales, value, cluster.len(), size));
        }
    }
    Ok(modes)
}

/// The test of one mode: a combination wᵀ of the states is uncontrollable if wᵀ [A − λ1  B] = 0
/// lives by itself.
fn mode(
    system: &LinearSystem,
    scales: &[f64],
    value: Complex<f64>,
    multiplicity: usize,
    size: f64,
) -> Mode {
    let (n, m) = (system.order(), system.inputs());
    let transposed = DMatrix::from_fn(n + m, n, |row, column| {
        let diagonal = if row == column { value } else { 0.0.into() };
        if row < n {
            (Complex::from(system.a[(column, row)]) - diagonal).conj()
        } else {
            system.b[(column, row - n)].into()
        }
    });
    let singular = Singular::of(&transposed);
    let distances: Vec<f64> = singular.values.iter().map(|value| value / size).collect();
    let lost: Vec<usize> = (0..n).filter(|&place| distances[place] <= LOST).collect();
    let combinations = DMatrix::from_fn(lost.len(), n, |row, state| {
        singular.right[(state, lost[row])].conj() / scales[state]
    });
    Mode {
        value,
        multiplicity,
        distance: distances.last().copied().unwrap_or(0.0),
        lost: !lost.is_empty(),
        untouched: row_echelon(combinations, LOST),
    }
}

/// Smallest pivot, relative to the largest entry.
const PIVOT: f64 = 1e-4;

/// The reduced row echelon form of independent rows: each row has a 1 where the others have 0, and
/// rounding becomes 0. Columns are states; the first ones are eliminated, so that relations
/// give speeds in terms of coordinates.
pub(super) fn row_echelon<T>(mut rows: DMatrix<T>, negligible: f64) -> DMatrix<T>
where
    T: ComplexField<RealField = f64>,
{
    for lead in 0..rows.nrows() {
        let sizes = |column: usize| {
            let below = rows.view_range(lead.., column);
            below
                .iter()
                .map(|entry| entry.clone().modulus())
                .collect::<Vec<f64>>()
        };
        let largest = |column: usize| sizes(column).into_iter().fold(0.0, f64::max);
        let overall = (0..rows.ncols()).map(largest).fold(0.0, f64::max);
        // The first column that is not tiny: rows stay independent.
        let Some(column) = (0..rows.ncols()).find(|&column| largest(column) > PIVOT * overall)
        else {
            break;
        };
        let sizes = sizes(column).into_iter().enumerate();
        let pivot = sizes.max_by(|a, b| a.1.total_cmp(&b.1));
        rows.swap_rows(lead, lead + pivot.map_or(0, |(place, _)| place));
        let leading = rows.row(lead) / rows[(lead, column)].clone();
        rows.set_row(lead, &leading);
        for other in (0..rows.nrows()).filter(|&other| other != lead) {
            let factor = rows[(other, column)].clone();
            let reduced = rows.row(other) - &leading * factor;
            rows.set_row(other, &reduced);
        }
    }
    rows.map(|entry| {
        let rounding = entry.clone().modulus() <= negligible;
        if rounding { T::zero() } else { entry }
    })
}

//! Stability of a steady motion: the eigenvalues of its essential states, without the zero
//! eigenvalues of its family.

pub(crate) mod critical;

use appell_runtime::linearise::{Linearisation, Undetermined};
use appell_runtime::model::Model;
use appell_spectra::singular::Singular;
use appell_spectra::spectrum::{Complex, Mode, Spectrum, SpectrumError, characteristic_polynomial};
use nalgebra::DMatrix;

use crate::point::Point;
use crate::steady::cyclic::Structure;

/// Why stability could not be determined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StabilityError {
    /// Position constraints that do not determine their coordinates.
    #[error(transparent)]
    Undetermined(#[from] Undetermined),
    /// The spectrum could not be computed.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// Linear stability of a steady motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Disturbances decay, to the motion or a neighbouring one of its family.
    Asymptotic,
    /// Disturbances neither grow nor decay; nonlinear terms decide.
    Neutral,
    /// Some disturbance grows.
    Unstable,
    /// At the boundary of stability: a real eigenvalue is zero beyond those of the family, or a
    /// repeated imaginary pair is defective.
    Critical,
}

/// Rounding of a zero coefficient of the characteristic polynomial, relative to the product of as
/// many eigenvalues.
const COEFFICIENT_ROUNDING: f64 = 1e-12;
/// Singular values of the essential matrix that count as zero, relative to the largest: rounding of
/// its entries, which are Jacobians of long formulas.
const ESSENTIAL_RANK: f64 = 1e-9;
/// Growth is significant if it exceeds this many times the uncertainty.
const SAFETY: f64 = 100.0;

/// Eigenvalues and verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Stability {
    /// The independent essential states, by their index in the model.
    pub states: Vec<usize>,
    /// A in these states.
    pub matrix: DMatrix<f64>,
    /// Its modes.
    pub spectrum: Spectrum,
    /// Number of zero eigenvalues.
    pub zeros: usize,
    /// Dimension of the family of steady motions with the same inputs and parameters: the number of
    /// zero eigenvalues that belong to it.
    pub family: usize,
    /// Indices of the deciding modes: all but the zeros.
    pub deciding: Vec<usize>,
    /// The verdict.
    pub verdict: Verdict,
    /// Largest real part of a deciding eigenvalue, in 1/s; minus infinity without one.
    pub growth: f64,
    /// Real parts below this are zero within rounding, in 1/s: machine precision times the norm of A
    /// times the condition of the eigenvalue with the largest real part.
    pub threshold: f64,
}

impl Stability {
    /// Analyses a steady motion.
    pub fn of(
        model: &dyn Model,
        structure: &Structure,
        point: &Point,
    ) -> Result<Self, StabilityError> {
        let (states, matrix) = essential_matrix(model, structure, point)?;
        let spectrum = Spectrum::of(&matrix)?;
        let family = states.len() - Singular::of(&matrix).rank(ESSENTIAL_RANK);
        let zeros = zero_count(&matrix)?.max(family);
        let mut deciding: Vec<usize> = (0..states.len()).collect();
        // The zeros are the smallest, up to rounding.
        let size = |mode: &usize| spectrum.modes[*mode].value.norm();
        deciding.sort_by(|a, b| size(b).total_cmp(&size(a)));
        deciding.truncate(states.len() - zeros);
        deciding.sort_unstable();
        let mut judged = Self {
            verdict: Verdict::Asymptotic,
            growth: f64::NEG_INFINITY,
            threshold: 0.0,
            states,
            matrix,
            spectrum,
            zeros,
            family,
            deciding,
        };
        judged.judge();
        Ok(judged)
    }

    fn judge(&mut self) {
        let mut rest = false;
        for &mode in &self.deciding {
            let re = self.spectrum.modes[mode].value.re;
            // A repeated eigenvalue is known only to the square root of rounding.
            let known = self.spectrum.uncertainty(mode);
            let threshold = (SAFETY * known).min((f64::EPSILON).sqrt() * self.spectrum.norm);
            if re > self.growth {
                (self.growth, self.threshold) = (re, threshold);
            }
            rest |= re.abs() <= threshold;
            if re > threshold {
                self.verdict = Verdict::Unstable;
            }
        }
        if self.verdict != Verdict::Unstable && self.zeros > self.family {
            self.verdict = Verdict::Critical;
        } else if self.verdict != Verdict::Unstable && rest {
            self.verdict = Verdict::Neutral;
        }
    }

    /// The deciding eigenvalues, largest real part first.
    pub fn eigenvalues(&self) -> Vec<Complex<f64>> {
        let values = self.deciding.iter();
        values
            .map(|&mode| self.spectrum.modes[mode].value)
            .collect()
    }
}

/// A in the independent essential states, with their indices in the model.
pub fn essential_matrix(
    model: &dyn Model,
    structure: &Structure,
    point: &Point,
) -> Result<(Vec<usize>, DMatrix<f64>), Undetermined> {
    if model.dependent_coordinates().is_empty() {
        let (n, m) = (point.x.len(), point.u.len());
        let (mut rates, mut a, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
        model.jacobians(point.at(), &mut rates, &mut a, &mut b);
        let states = structure.essential.clone();
        let entry = |i: usize, j: usize| a[states[i] * n + states[j]];
        let matrix = DMatrix::from_fn(states.len(), states.len(), entry);
        return Ok((states, matrix));
    }
    let linear = Linearisation::about(model, point.at())?;
    let n = linear.states.len();
    let essential = |place: &usize| structure.is_essential(linear.states[*place]);
    let places: Vec<usize> = (0..n).filter(essential).collect();
    let turn = structure.turning.turn(&point.x, &point.rates(model));
    let still =
        DMatrix::from_row_slice(n, n, &linear.a) - independent(&linear, model.info().speeds, &turn);
    let mut matrix = still.select_rows(&places).select_columns(&places);
    let mut states: Vec<usize> = places.iter().map(|&place| linear.states[place]).collect();
    let mut turned = structure.turning.directions(&point.x).select_rows(&states);
    while let Some(place) = without_largest(&mut matrix, &mut turned) {
        states.remove(place);
    }
    Ok((states, matrix))
}

/// A matrix of all states, in the independent ones.
pub(crate) fn independent(
    linear: &Linearisation,
    speeds: usize,
    matrix: &DMatrix<f64>,
) -> DMatrix<f64> {
    let n = linear.states.len();
    DMatrix::from_fn(n, n, |row, column| {
        let of = |state: usize| matrix[(linear.states[row], state)];
        let follows = linear
            .dependent
            .iter()
            .zip(linear.dependence.chunks_exact(n));
        let by_way_of = follows.map(|(&q, along)| of(speeds + q) * along[column]);
        of(linear.states[column]) + by_way_of.sum::<f64>()
    })
}

/// Removes perturbations along neutral directions: for each direction, the state with the largest component.
fn without_largest(matrix: &mut DMatrix<f64>, directions: &mut DMatrix<f64>) -> Option<usize> {
    /// Directions that are shorter than this, where all that differ have a length of about 1, are rounding.
    const SHORT: f64 = 1e-9;
    if directions.is_empty() {
        return None;
    }
    let (place, column) = directions.icamax_full();
    let largest = directions[(place, column)];
    if largest.abs() < SHORT {
        return None;
    }
    let shares = directions.column(column) / largest;
    for of in [&mut *matrix, &mut *directions] {
        let row = of.row(place).clone_owned();
        *of -= &shares * row;
    }
    *matrix = matrix.clone().remove_row(place).remove_column(place);
    *directions = directions.clone().remove_row(place);
    Some(place)
}

/// Algebraic multiplicity of the eigenvalue zero: trailing coefficients of the characteristic
/// polynomial that are zero within rounding.
pub(super) fn zero_count(matrix: &DMatrix<f64>) -> Result<usize, SpectrumError> {
    let coefficients = characteristic_polynomial(matrix)?;
    let values = appell_spectra::spectrum::eigenvalues(matrix)?;
    let mut sizes: Vec<f64> = values.iter().map(|value| value.norm()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let n = sizes.len();
    let all_zero = |&zeros: &usize| {
        let (others, product) = (n - zeros, sizes[..n - zeros].iter().product::<f64>());
        // If all eigenvalues are zero, the largest is rounding, too.
        let largest = if others == 0 { matrix.norm() } else { sizes[0] };
        let noise = |j: usize| {
            COEFFICIENT_ROUNDING * product * largest.powi(i32::try_from(j).unwrap_or(i32::MAX))
        };
        (1..=zeros).all(|j| coefficients[others + j].abs() <= noise(j))
    };
    Ok((0..=n).rev().find(all_zero).unwrap_or(0))
}

/// Eigenvalues along a branch, one list per mode: the k-th entry of each belongs to the k-th point.
///
/// From point to point a mode is matched by its eigenvalue and its eigenvector. Modes that a point
/// does not have are NaN there.
pub fn loci<'a>(points: impl IntoIterator<Item = &'a Stability>) -> Vec<Vec<Complex<f64>>> {
    let missing = Complex::new(f64::NAN, f64::NAN);
    let mut loci: Vec<Vec<Complex<f64>>> = Vec::new();
    // The last mode of each list.
    let mut last: Vec<Option<&Mode>> = Vec::new();
    for (count, point) in points.into_iter().enumerate() {
        let modes: Vec<&Mode> = point
            .deciding
            .iter()
            .map(|&m| &point.spectrum.modes[m])
            .collect();
        let unit = point.spectrum.norm.max(f64::MIN_POSITIVE);
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, from) in last.iter().enumerate() {
            let distances = modes.iter().enumerate();
            pairs
                .extend(distances.filter_map(|(j, to)| Some((distance((*from)?, to, unit), i, j))));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut next: Vec<Option<&Mode>> = vec![None; last.len()];
        let mut taken = vec![false; modes.len()];
        for (_, i, j) in pairs {
            if next[i].is_none() && !taken[j] {
                next[i] = Some(modes[j]);
                taken[j] = true;
            }
        }
        for (mode, _) in modes.iter().zip(&taken).filter(|(_, taken)| !**taken) {
            loci.push(vec![missing; count]);
            last.push(None);
            next.push(Some(mode));
        }
        for (i, locus) in loci.iter_mut().enumerate() {
            locus.push(next[i].map_or(missing, |mode| mode.value));
            // A list that has ended is not resumed.
            last[i] = next[i];
        }
    }
    loci
}

/// Distance of two modes: eigenvalues relative to the matrix, and the angle between eigenvectors.
fn distance(from: &Mode, to: &Mode, unit: f64) -> f64 {
    let alike = if from.right.len() == to.right.len() {
        from.right.dotc(&to.right).norm()
    } else {
        0.0
    };
    10.0 * (from.value - to.value).norm() / unit + (1.0 - alike)
}

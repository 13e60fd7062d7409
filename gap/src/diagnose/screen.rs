//! The expected gain of every candidate, to first order: C. R. Rao's score test of its size, projected on the
//! complement of the sensitivities to the nominal parameters with their priors.
//!
//! With r the whitened innovations and S their sensitivities, the best step is −(SᵀS)⁻¹ Sᵀ r. The priors of the
//! parameters are further rows after those of the samples.

use std::f64::consts::TAU;

use appell_estimate::{Direction, Estimation, Tangent, Unknown, in_parallel};
use nalgebra::{DMatrix, DVector};

use super::DiagnoseError;
use super::augmented;
use super::bench::Bench;
use super::evidence::Fitted;
use super::nuisance::{known, moving};
use crate::effects::{Acts, Part};

/// A candidate after the screen.
#[derive(Debug, Clone)]
pub(super) struct Screened {
    /// Its index.
    pub(super) candidate: usize,
    /// Expected gain in log likelihood, in excess of the gain by impulses of feedback inputs.
    pub(super) gain: f64,
    /// The best sizes, one for each direction of the candidate.
    pub(super) sizes: Vec<f64>,
    /// Their standard deviations.
    pub(super) deviations: Vec<f64>,
    /// Further initial values of its fit: values of its parameters by their indices, one list for each start.
    pub(super) starts: Vec<Vec<(usize, f64)>>,
    /// Factor on the process noise at the start of its fit.
    pub(super) levels: f64,
}

impl Screened {
    /// A candidate with a gain from a grid search.
    pub(super) fn tried(
        candidate: usize,
        gain: f64,
        sizes: Vec<f64>,
        starts: Vec<Vec<(usize, f64)>>,
    ) -> Self {
        Self {
            candidate,
            gain,
            deviations: vec![0.0; sizes.len()],
            sizes,
            starts,
            levels: 1.0,
        }
    }

    /// The same with process noise multiplied by `levels`.
    pub(super) fn beside(self, levels: f64) -> Self {
        Self { levels, ..self }
    }

    /// The same, without the part of its gain that feedback inputs explain.
    pub(super) fn told(self, by_inputs: f64) -> Self {
        let gain = (self.gain - by_inputs).max(0.0);
        Self { gain, ..self }
    }
}

/// Relative norm of the part orthogonal to the free columns below which a column is dependent on them.
const LEFT: f64 = 1e-4;
/// Factor on the process noise so that it does not absorb a missing effect.
pub(super) const QUIET: f64 = 0.1;

/// Smallest gain of a promising candidate: a smaller one cannot compensate for the prior.
pub(super) const LEAST_GAIN: f64 = 4.0;
/// Smallest gain of a promising candidate relative to the largest one.
const LEAST_PART: f64 = 0.25;

/// The smallest gain of a candidate that is worth a fit, given the largest gain.
pub(super) fn least(best: f64) -> f64 {
    LEAST_GAIN.max(LEAST_PART * best)
}

/// All candidates.
#[derive(Debug, Clone)]
pub(super) struct Screen {
    /// The candidates, with the greatest gain first.
    pub(super) list: Vec<Screened>,
}

/// Whitened innovations and their sensitivities, projected on the complement of the free columns of a hypothesis.
pub(super) struct Projected<'t> {
    pub(super) tangent: &'t Tangent,
    /// Root of the likelihood weight of a row.
    root: f64,
    /// Orthogonal basis of the free columns.
    basis: DMatrix<f64>,
    /// Number of rows of the priors.
    prior_rows: usize,
    /// Projected innovations.
    pub(super) rest: DVector<f64>,
}

impl<'t> Projected<'t> {
    /// About a fit; the first directions of `tangent` and the `others` are free.
    pub(super) fn new(
        tangent: &'t Tangent,
        weight: f64,
        fitted: &Fitted,
        free: usize,
        others: &[usize],
    ) -> Self {
        let (samples, root) = (tangent.samples.len(), weight.sqrt());
        let known: Vec<(usize, f64, f64)> = (0..free)
            .filter_map(|i| {
                let [off, slope] = known(&fitted.fit.free[i], fitted.fit.coordinates[i])?;
                Some((i, off, slope))
            })
            .collect();
        let rows = samples + known.len();
        let mut own = DMatrix::zeros(rows, free + others.len());
        for (column, slope) in (0..free).chain(others.iter().copied()).enumerate() {
            let slope = root * tangent.slopes.column(slope);
            own.view_mut((0, column), (samples, 1)).copy_from(&slope);
        }
        let mut rest = DVector::zeros(rows);
        for (row, (_, sample)) in tangent.samples.iter().enumerate() {
            rest[row] = root * sample.whitened();
        }
        for (row, &(column, off, slope)) in known.iter().enumerate() {
            own[(samples + row, column)] = slope;
            rest[samples + row] = off;
        }
        let basis = orthogonal(&own);
        let along = basis.tr_mul(&rest);
        rest -= &basis * along;
        Self {
            tangent,
            root,
            basis,
            prior_rows: known.len(),
            rest,
        }
    }

    /// Log likelihood, maximised over the free directions.
    pub(super) fn log_likelihood(&self) -> f64 {
        let samples = self.tangent.samples.iter();
        let scales: f64 = samples
            .map(|(_, sample)| (TAU * sample.white_variance).ln())
            .sum();
        -0.5 * (self.root * self.root * scales + self.rest.norm_squared())
    }

    /// Projected sensitivities of some columns.
    pub(super) fn slopes(&self, columns: &[usize]) -> DMatrix<f64> {
        let samples = self.tangent.samples.len();
        let mut slopes = DMatrix::zeros(samples + self.prior_rows, columns.len());
        for (place, &column) in columns.iter().enumerate() {
            slopes
                .view_mut((0, place), (samples, 1))
                .copy_from(&(self.root * self.tangent.slopes.column(column)));
        }
        // The transpose is contiguous in memory for the product.
        let along = self.basis.transpose() * &slopes;
        slopes -= &self.basis * along;
        slopes
    }
}

/// An orthonormal basis of the span of the columns.
fn orthogonal(columns: &DMatrix<f64>) -> DMatrix<f64> {
    /// Smallest relative norm of the part of an independent column that is orthogonal to the others.
    const NEW: f64 = 1e-6;
    let mut basis: Vec<DVector<f64>> = Vec::new();
    for column in columns.column_iter() {
        let mut column = column.into_owned();
        let size = column.norm();
        // Twice is enough (Kahan).
        for _ in 0..2 {
            for own in &basis {
                let along = own.dot(&column);
                column.axpy(-along, own, 1.0);
            }
        }
        let rest = column.norm();
        if rest > NEW * size {
            basis.push(column / rest);
        }
    }
    if basis.is_empty() {
        return DMatrix::zeros(columns.nrows(), 0);
    }
    DMatrix::from_columns(&basis)
}

impl Screen {
    /// Screens all candidates that are not members of a fit.
    pub(super) fn of(bench: &Bench<'_>, fitted: &Fitted) -> Result<Self, DiagnoseError> {
        let mut screen = Self::first_order(bench, fitted)?;
        let best = screen.list.first().map_or(0.0, |best| best.gain);
        let augmented = augmented::screened((bench, fitted), fitted.evidence.by_inputs, best)?;
        screen.list.extend(augmented);
        screen.list.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(screen)
    }

    /// Screens all candidates without an additional coordinate.
    fn first_order(bench: &Bench<'_>, fitted: &Fitted) -> Result<Self, DiagnoseError> {
        let setup = bench.whole_setup(&fitted.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let free = moving(&fitted.fit);
        let (directions, own) = others(bench, fitted, &free);
        let mut values = bench.carried(fitted, &estimation);
        shapes(bench, &mut values, &fitted.members);
        let tangent = bench
            .input_innovations
            .with_kicks(|kicks| estimation.tangent(&values, &directions, kicks))?;
        let projected = Projected::new(&tangent, bench.weight, fitted, free.len(), &[]);
        let kicked: Vec<usize> = (directions.len()..tangent.slopes.ncols()).collect();
        let for_kicks = fitted.evidence.by_inputs;
        let beyond = Projected::new(&tangent, bench.weight, fitted, free.len(), &kicked);
        let all = in_parallel(own, |(candidate, columns)| {
            let positive = positive(bench, candidate);
            let one = screened(&projected, candidate, &columns, &positive)?;
            let beyond = screened(&beyond, candidate, &columns, &positive);
            let beyond = beyond.map_or(0.0, |beyond| beyond.gain);
            let told = (one.gain - beyond).clamp(0.0, for_kicks);
            Some(one.told(told))
        });
        let mut list: Vec<Screened> = all.into_iter().flatten().collect();
        list.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok(Self { list })
    }
}

/// Multiplies the process noise among values.
pub(super) fn quieten(
    estimation: &Estimation<'_>,
    values: &mut [f64],
    levels: f64,
) -> Result<(), DiagnoseError> {
    for index in 0..estimation.setup().disturbances.len() {
        values[estimation.layout().place(Unknown::Disturbance(index))?] *= levels;
    }
    Ok(())
}

/// Candidates whose sensitivities about a fit are non-zero, but linearly dependent on those of its free parameters.
pub(super) fn imitated(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<usize>, DiagnoseError> {
    let setup = bench.whole_setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let free = moving(&fitted.fit);
    let (directions, own) = others(bench, fitted, &free);
    let mut values = bench.carried(fitted, &estimation);
    shapes(bench, &mut values, &fitted.members);
    let tangent = estimation.tangent(&values, &directions, None)?;
    let projected = Projected::new(&tangent, bench.weight, fitted, free.len(), &[]);
    let is_imitated = |(_, columns): &(usize, Vec<usize>)| {
        let slopes = projected.slopes(columns);
        let mut columns = columns.iter().zip(slopes.column_iter());
        columns.all(|(&column, left)| {
            let whole = projected.root * tangent.slopes.column(column).norm();
            whole > 0.0 && left.norm() <= LEFT * whole
        })
    };
    let imitated = own.into_iter().filter(is_imitated);
    Ok(imitated.map(|(candidate, _)| candidate).collect())
}

/// The free directions, then those of all candidates outside a hypothesis; and the columns of each candidate.
fn others(
    bench: &Bench<'_>,
    fitted: &Fitted,
    free: &[Direction],
) -> (Vec<Direction>, Vec<(usize, Vec<usize>)>) {
    let mut directions = free.to_vec();
    let mut columns: Vec<(usize, Vec<usize>)> = Vec::new();
    for candidate in 0..bench.effects.candidates.len() {
        let own = bench.candidate(candidate);
        let is_beside = bench.imperfections.iter().any(|one| one.acts == own.acts);
        if own.brings.is_some() || is_beside || fitted.members.contains(&candidate) {
            continue;
        }
        let first = directions.len();
        directions.extend(self::directions(bench, candidate));
        columns.push((candidate, (first..directions.len()).collect()));
    }
    (directions, columns)
}

/// Sets candidates that are not members to zero size, with the shapes of their specs.
pub(super) fn shapes(bench: &Bench<'_>, values: &mut [f64], members: &[usize]) {
    let info = bench.effects.info();
    for (index, candidate) in bench.effects.candidates.iter().enumerate() {
        if members.contains(&index) {
            continue;
        }
        for (place, part) in bench.own(candidate) {
            values[place] = match part {
                Part::Shape(_) => info.parameters[place].value,
                Part::Size | Part::Term(_) | Part::Switch => 0.0,
            };
        }
    }
}

/// The directions of a candidate at zero size.
pub(super) fn directions(bench: &Bench<'_>, candidate: usize) -> Vec<Direction> {
    let candidate = bench.candidate(candidate);
    let value = |unknown| vec![Direction::Value(unknown)];
    match candidate.acts {
        Acts::Items => bench
            .own(candidate)
            .into_iter()
            .filter(|(_, part)| !part.is_shape())
            .map(|(index, _)| Direction::Value(Unknown::Parameter(index)))
            .collect(),
        Acts::Parameter(_) => bench
            .effects
            .info()
            .parameter_index(&candidate.site)
            .map_or_else(Vec::new, |index| value(Unknown::Parameter(index))),
        Acts::Lag(input) | Acts::Delay(input) => vec![Direction::LateInput(input)],
        Acts::Bias(channel) => value(Unknown::Bias(channel)),
        Acts::Scale(channel) => value(Unknown::Scale(channel)),
        Acts::Late(channel) | Acts::Slow(channel) => vec![Direction::LateChannel(channel)],
    }
}

/// Which directions are one-sided.
pub(super) fn positive(bench: &Bench<'_>, candidate: usize) -> Vec<bool> {
    let candidate = bench.candidate(candidate);
    let info = bench.effects.info();
    match candidate.acts {
        Acts::Items => bench
            .own(candidate)
            .into_iter()
            .filter(|(_, part)| !part.is_shape())
            .map(|(index, _)| info.parameters[index].range[0] >= 0.0)
            .collect(),
        Acts::Lag(_) | Acts::Delay(_) | Acts::Late(_) | Acts::Slow(_) => vec![true],
        Acts::Parameter(_) | Acts::Bias(_) | Acts::Scale(_) => vec![false],
    }
}

/// The best step along the columns of a candidate, without one-sided ones of the wrong sign.
fn screened(
    projected: &Projected<'_>,
    candidate: usize,
    columns: &[usize],
    positive: &[bool],
) -> Option<Screened> {
    let slopes = projected.slopes(columns);
    let squares = slopes.tr_mul(&slopes);
    let score = slopes.tr_mul(&projected.rest);
    let seen = |place: &usize| {
        let whole = projected.root * projected.tangent.slopes.column(columns[*place]).norm();
        let left = squares[(*place, *place)].sqrt();
        whole > 0.0 && left.is_finite() && left > LEFT * whole
    };
    let mut open: Vec<usize> = (0..columns.len()).filter(seen).collect();
    loop {
        if open.is_empty() {
            return None;
        }
        let part = DMatrix::from_fn(open.len(), open.len(), |i, j| squares[(open[i], open[j])]);
        let right = DVector::from_fn(open.len(), |i, _| -score[open[i]]);
        let factor = part.cholesky()?;
        let step = factor.solve(&right);
        let against = (0..open.len()).find(|&i| positive[open[i]] && step[i] <= 0.0);
        if let Some(place) = against {
            open.remove(place);
            continue;
        }
        let inverse = factor.inverse();
        let mut sizes = vec![0.0; columns.len()];
        let mut deviations = vec![0.0; columns.len()];
        for (place, &column) in open.iter().enumerate() {
            sizes[column] = step[place];
            deviations[column] = inverse[(place, place)].sqrt();
        }
        return Some(Screened {
            candidate,
            gain: 0.5 * right.dot(&step),
            sizes,
            deviations,
            starts: vec![Vec::new()],
            levels: 1.0,
        });
    }
}

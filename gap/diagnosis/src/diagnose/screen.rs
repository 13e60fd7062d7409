//! The expected gain of every candidate, to first order: C. R. Rao's score test of its size, projected on the
//! complement of the sensitivities to the nominal parameters with their priors.
//!
//! With r the whitened innovations and S their sensitivities, the best step is −(SᵀS)⁻¹ Sᵀ r. The priors of the
//! parameters are further rows after those of the samples.

use appell_estimate::{Direction, Estimation, Unknown, in_parallel};
use nalgebra::{DMatrix, DVector};

use super::DiagnoseError;
use super::augmented;
use super::bench::Bench;
use super::evidence::Fitted;
use super::gram::{Gram, Normal, whitened};
use super::nuisance::{moving, priors};
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
    /// The same, without the part of its gain that feedback inputs explain.
    pub(super) fn beyond_inputs(self, by_inputs: f64) -> Self {
        let gain = (self.gain - by_inputs).max(0.0);
        Self { gain, ..self }
    }
}

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

/// Screens all candidates that are not members of a fit, those with the greatest gain first.
pub(super) fn screen(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Screened>, DiagnoseError> {
    let mut list = first_order(bench, fitted)?;
    let best = list.first().map_or(0.0, |best| best.gain);
    list.extend(augmented::screened(
        bench,
        fitted,
        fitted.evidence.by_inputs,
        best,
    )?);
    list.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    Ok(list)
}

/// Screens all candidates without an additional coordinate.
fn first_order(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Screened>, DiagnoseError> {
    let setup = bench.whole_setup(&fitted.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let free = moving(&fitted.fit);
    let (directions, own) = others(bench, fitted, &free);
    let mut values = bench.carried(fitted, &estimation);
    shapes(bench, &mut values, &fitted.members);
    let tangent = bench
        .input_innovations
        .with_kicks(|kicks| estimation.tangent(&values, &directions, kicks))?;
    let normal = Normal::of(
        &tangent,
        &whitened(&tangent),
        bench.weight,
        &priors(&fitted.fit),
    );
    let columns = free.len()..directions.len();
    let mut nuisances: Vec<usize> = (0..free.len()).collect();
    let gram = normal.beside(&nuisances, columns.clone());
    nuisances.extend(directions.len()..tangent.slopes.nrows());
    let beyond = normal.beside(&nuisances, columns);
    let for_kicks = fitted.evidence.by_inputs;
    let all = in_parallel(own, |(candidate, columns)| {
        let positive = positive(bench, candidate);
        let one = screened(&gram, candidate, &columns, &positive)?;
        let beyond = screened(&beyond, candidate, &columns, &positive);
        let beyond = beyond.map_or(0.0, |beyond| beyond.gain);
        let by_inputs = (one.gain - beyond).clamp(0.0, for_kicks);
        Some(one.beyond_inputs(by_inputs))
    });
    let mut list: Vec<Screened> = all.into_iter().flatten().collect();
    list.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    Ok(list)
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
    let normal = Normal::of(
        &tangent,
        &whitened(&tangent),
        bench.weight,
        &priors(&fitted.fit),
    );
    let nuisances: Vec<usize> = (0..free.len()).collect();
    let gram = normal.beside(&nuisances, free.len()..directions.len());
    let is_imitated = |(_, columns): &(usize, Vec<usize>)| {
        let is_there = |column: &usize| {
            let column = free.len() + column;
            normal.squares[(column, column)] > 0.0
        };
        (columns.iter()).all(|column| is_there(column) && gram.is_imitated[*column])
    };
    let imitated = own.into_iter().filter(is_imitated);
    Ok(imitated.map(|(candidate, _)| candidate).collect())
}

/// The free directions, then those of all candidates outside a hypothesis; and the columns of each candidate after the
/// free ones.
fn others(
    bench: &Bench<'_>,
    fitted: &Fitted,
    free: &[Direction],
) -> (Vec<Direction>, Vec<(usize, Vec<usize>)>) {
    let mut directions = free.to_vec();
    let mut columns: Vec<(usize, Vec<usize>)> = Vec::new();
    for candidate in 0..bench.effects.candidates.len() {
        let own = bench.candidate(candidate);
        if own.brings.is_some() || fitted.members.contains(&candidate) {
            continue;
        }
        let first = directions.len();
        directions.extend(self::directions(bench, candidate));
        let columns_of = first - free.len()..directions.len() - free.len();
        columns.push((candidate, columns_of.collect()));
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
        Acts::Parameter(index) => value(Unknown::Parameter(index)),
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
    gram: &Gram,
    candidate: usize,
    columns: &[usize],
    positive: &[bool],
) -> Option<Screened> {
    let seen = |place: &usize| !gram.is_imitated[columns[*place]];
    let mut open: Vec<usize> = (0..columns.len()).filter(seen).collect();
    loop {
        if open.is_empty() {
            return None;
        }
        let part = DMatrix::from_fn(open.len(), open.len(), |i, j| {
            gram.squares[(columns[open[i]], columns[open[j]])]
        });
        let right = DVector::from_fn(open.len(), |i, _| -gram.scores[columns[open[i]]]);
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

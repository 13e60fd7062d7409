//! The expected gain of every candidate, to first order: C. R. Rao's score test of its size, projected on the
//! complement of the sensitivities to the nominal parameters with their priors.
//!
//! With r the whitened innovations and S their sensitivities, the best step is −(SᵀS)⁻¹ Sᵀ r. The priors of the
//! parameters are further rows after those of the samples.

use appell_estimate::{Direction, Estimation, Unknown, in_parallel};
use nalgebra::{DMatrix, DVector};

use super::augmented;
use super::gram::{Gram, Normal, moving, priors, whitened};
use super::{Bench, Fitted, Result};
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
pub(super) fn screen(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Screened>> {
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

/// A linearisation about a hypothesis.
struct Linearised {
    normal: Normal,
    /// Number of free directions; those of the candidates come next, then impulses of feedback inputs.
    free: usize,
    /// Number of both.
    directions: usize,
    columns: Vec<Columns>,
}

/// The columns of a candidate.
struct Columns {
    candidate: usize,
    /// The first one, after the free directions.
    first: usize,
    /// Which of them are one-sided.
    is_positive: Vec<bool>,
}

impl Linearised {
    /// With the directions of all candidates outside a hypothesis that add no coordinate.
    fn of(bench: &Bench<'_>, fitted: &Fitted, has_kicks: bool) -> Result<Self> {
        let setup = bench.whole_setup(&fitted.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut directions = moving(&fitted.fit);
        let free = directions.len();
        let mut columns = Vec::new();
        for candidate in 0..bench.effects.candidates.len() {
            let own = bench.candidate(candidate);
            if own.brings.is_some() || fitted.members.contains(&candidate) {
                continue;
            }
            let first = directions.len() - free;
            let (own, is_positive): (Vec<Direction>, Vec<bool>) =
                self::directions(bench, candidate).into_iter().unzip();
            directions.extend(own);
            columns.push(Columns {
                candidate,
                first,
                is_positive,
            });
        }
        let mut values = bench.carried(fitted, &estimation);
        shapes(bench, &mut values, &fitted.members);
        let tangent = bench.input_innovations.with_kicks(|kicks| {
            estimation.tangent(&values, &directions, kicks.filter(|_| has_kicks))
        })?;
        let rest = whitened(&tangent);
        Ok(Self {
            normal: Normal::of(&tangent, &rest, bench.weight, &priors(&fitted.fit)),
            free,
            directions: directions.len(),
            columns,
        })
    }
}

/// Screens all candidates without an additional coordinate.
fn first_order(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<Screened>> {
    let about = Linearised::of(bench, fitted, true)?;
    let columns = about.free..about.directions;
    let mut nuisances: Vec<usize> = (0..about.free).collect();
    let gram = about.normal.beside(&nuisances, columns.clone());
    nuisances.extend(about.directions..about.normal.scores.len());
    let beyond = about.normal.beside(&nuisances, columns);
    let for_kicks = fitted.evidence.by_inputs;
    let all = in_parallel(about.columns, |own| {
        let one = screened(&gram, &own)?;
        let beyond = screened(&beyond, &own).map_or(0.0, |beyond| beyond.gain);
        let by_inputs = (one.gain - beyond).clamp(0.0, for_kicks);
        Some(one.beyond_inputs(by_inputs))
    });
    let mut list: Vec<Screened> = all.into_iter().flatten().collect();
    list.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    Ok(list)
}

/// Candidates whose sensitivities about a fit are non-zero, but linearly dependent on those of its free parameters.
pub(super) fn imitated(bench: &Bench<'_>, fitted: &Fitted) -> Result<Vec<usize>> {
    let about = Linearised::of(bench, fitted, false)?;
    let nuisances: Vec<usize> = (0..about.free).collect();
    let gram = about
        .normal
        .beside(&nuisances, about.free..about.directions);
    let is_imitated = |own: &Columns| {
        (own.first..own.first + own.is_positive.len()).all(|column| {
            let place = about.free + column;
            about.normal.squares[(place, place)] > 0.0 && gram.is_imitated[column]
        })
    };
    let imitated = about.columns.iter().filter(|own| is_imitated(own));
    Ok(imitated.map(|own| own.candidate).collect())
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

/// The directions of a candidate at zero size, and whether each is one-sided.
pub(super) fn directions(bench: &Bench<'_>, candidate: usize) -> Vec<(Direction, bool)> {
    let (candidate, info) = (bench.candidate(candidate), bench.effects.info());
    let value = |unknown| vec![(Direction::Value(unknown), false)];
    let of_size = |index: usize| {
        let is_positive = info.parameters[index].range[0] >= 0.0;
        (Direction::Value(Unknown::Parameter(index)), is_positive)
    };
    match candidate.acts {
        Acts::Items => bench
            .own(candidate)
            .into_iter()
            .filter(|(_, part)| !part.is_shape())
            .map(|(index, _)| of_size(index))
            .collect(),
        Acts::Parameter(index) => value(Unknown::Parameter(index)),
        Acts::Lag(input) | Acts::Delay(input) => vec![(Direction::LateInput(input), true)],
        Acts::Bias(channel) => value(Unknown::Bias(channel)),
        Acts::Scale(channel) => value(Unknown::Scale(channel)),
        Acts::Late(channel) | Acts::Slow(channel) => vec![(Direction::LateChannel(channel), true)],
    }
}

/// The best step along the columns of a candidate, without one-sided ones of the wrong sign.
fn screened(gram: &Gram, own: &Columns) -> Option<Screened> {
    let (count, column) = (own.is_positive.len(), |place: usize| own.first + place);
    let seen = |place: &usize| !gram.is_imitated[column(*place)];
    let mut open: Vec<usize> = (0..count).filter(seen).collect();
    loop {
        if open.is_empty() {
            return None;
        }
        let part = DMatrix::from_fn(open.len(), open.len(), |i, j| {
            gram.squares[(column(open[i]), column(open[j]))]
        });
        let right = DVector::from_fn(open.len(), |i, _| -gram.scores[column(open[i])]);
        let factor = part.cholesky()?;
        let step = factor.solve(&right);
        let against = (0..open.len()).find(|&i| own.is_positive[open[i]] && step[i] <= 0.0);
        if let Some(place) = against {
            open.remove(place);
            continue;
        }
        let inverse = factor.inverse();
        let [mut sizes, mut deviations] = [vec![0.0; count], vec![0.0; count]];
        for (place, &direction) in open.iter().enumerate() {
            sizes[direction] = step[place];
            deviations[direction] = inverse[(place, place)].sqrt();
        }
        return Some(Screened {
            candidate: own.candidate,
            gain: 0.5 * right.dot(&step),
            sizes,
            deviations,
            starts: vec![Vec::new()],
            levels: 1.0,
        });
    }
}

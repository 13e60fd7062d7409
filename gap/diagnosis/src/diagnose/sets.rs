//! First-order evaluation of all sets of effects.
//!
//! One pass of the filter gives the sensitivities of its innovations to every candidate. Projected on the complement of
//! the sensitivities to the nominal parameters with their priors, their Gram matrix and scores give the expected gain of
//! each single effect, each pair and each triple from a few linear equations. Effects that are significant only together
//! are therefore found, whatever the order. As fitted process noise absorbs missing effects, this is repeated with
//! less of it, and a set counts at its most probable level.
//!
//! About a fit with members, the innovations are extrapolated linearly to sizes of zero, so that sets without
//! these members are evaluated too.

mod columns;

use std::collections::{BTreeMap, BTreeSet};

use appell_estimate::{Direction, Estimation, Unknown, in_parallel};

pub(super) use self::columns::is_fixed;
use self::columns::{columns, nuisances};
use super::augmented;
use super::calibration::{counts, of_components, of_count, prior, subsets};
use super::evidence::occam;
use super::gram::{Gram, Solved};
use super::screen::{Screened, directions, shapes};
use super::starts::{SizeEstimates, scale_process_noise};
use super::{Bench, DiagnoseError, Fitted, Result};
use crate::effects::Acts;

/// Process noise relative to the fitted one.
const LEVELS: [f64; 3] = [1.0, 0.1, 0.01];
/// Largest number of effects of a set.
const TOGETHER: usize = 3;
/// Smallest expected ratio of the residual deviations, the limit of the linearisation.
const LEAST_SPREAD: f64 = 0.1;
/// Largest first-order delay relative to the longest one.
const BEYOND: f64 = 1.5;
/// Number of choices of which all triples are evaluated: the best ones alone or in a pair.
const MOST_CHOICES: usize = 60;

/// A set of candidates with its expected posterior.
#[derive(Debug, Clone)]
pub(super) struct Set {
    pub(super) members: Vec<usize>,
    /// The best sizes of its candidates.
    pub(super) sizes: Vec<SizeEstimates>,
    /// Expected log posterior, comparable with that of fits.
    pub(super) log_posterior: f64,
    /// Factor on the process noise at the start of its fit.
    pub(super) levels: f64,
    /// Further initial values of its fit, one list for each start.
    pub(super) starts: Vec<Vec<(usize, f64)>>,
}

/// A candidate, or some components of one vector, as one effect.
struct Choice {
    /// Number of effects as which it counts.
    counts: usize,
    /// Logarithm of its share in the prior probability of the effect.
    log_prior: f64,
    candidates: Vec<usize>,
    columns: Vec<usize>,
}

/// A column of the sensitivities.
struct Column {
    candidate: usize,
    /// Index among the directions of its candidate.
    place: usize,
    direction: Direction,
    is_positive: bool,
    /// Its largest size.
    most: f64,
    /// Prior standard deviation of its size, if any.
    known: Option<f64>,
    /// Its size in the fit of the linearisation.
    size: f64,
}

/// A free direction of every set, with its prior.
struct Nuisance {
    direction: Direction,
    /// Deviation from its prior mean, in prior standard deviations, and the derivative of that.
    known: Option<[f64; 2]>,
}

/// Gram matrix and scores of the columns for one level of process noise.
struct Level {
    scale: f64,
    /// With the nuisance directions and the impulses of feedback inputs eliminated.
    gram: Gram,
    /// Effective sample size, and the log likelihood of zero residuals, if the noise variance is that of the residuals.
    free_noise: Option<[f64; 2]>,
}

impl Level {
    /// Log likelihood with a gain, and the ratio of the residual deviations after and before. Over windows the noise
    /// variance of each hypothesis is that of its residuals, so that the likelihood depends on the ratio of squares.
    fn with_gain(&self, gain: f64) -> (f64, f64) {
        let before = self.gram.log_likelihood;
        let Some([told, of_spreads]) = self.free_noise else {
            return (before + gain, 1.0);
        };
        let square = 2.0 * (of_spreads - before - gain);
        let spread = (square / told).max(LEAST_SPREAD * LEAST_SPREAD);
        (of_spreads - 0.5 * told * (spread.ln() + 1.0), spread.sqrt())
    }
}

/// The evaluation of sets about a fit.
pub(super) struct Sets<'b, 'a> {
    bench: &'b Bench<'a>,
    columns: Vec<Column>,
    levels: Vec<Level>,
    /// Members of the fit.
    members: Vec<usize>,
    /// Members of every set, as the linearisation does not apply without them.
    fixed: Vec<usize>,
    choices: Vec<Choice>,
    /// Log prior probabilities, by the number of choices.
    prior: Vec<f64>,
    /// Difference between the log posterior of the fit and its first-order value.
    offset: f64,
}

impl<'b, 'a> Sets<'b, 'a> {
    /// All sets about a fit, the most probable first; `log_posterior` is that of the fit.
    pub(super) fn about(
        bench: &'b Bench<'a>,
        fitted: &Fitted,
        log_posterior: f64,
    ) -> Result<Vec<Set>> {
        let sets = Self::of(bench, fitted, log_posterior)?;
        let mut all = sets.all();
        all.extend(sets.with_coordinates(fitted, log_posterior)?);
        all.sort_by(|a, b| b.log_posterior.total_cmp(&a.log_posterior));
        Ok(all)
    }

    fn of(bench: &'b Bench<'a>, fitted: &Fitted, log_posterior: f64) -> Result<Self> {
        let setup = bench.whole_setup(&fitted.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut values = bench.carried(fitted, &estimation);
        shapes(bench, &mut values, &fitted.members);
        let is_fixed = |&member: &usize| is_fixed(bench, member);
        let fixed: Vec<usize> = fitted.members.iter().copied().filter(is_fixed).collect();
        let columns = columns(bench, fitted, &estimation, &values)?;
        let nuisances = nuisances(bench, fitted, &columns);
        let directions: Vec<Direction> = (nuisances.iter().map(|one| one.direction))
            .chain(columns.iter().map(|one| one.direction))
            .collect();
        let scales: &[f64] = if bench.is_over_windows() {
            &LEVELS[..1]
        } else {
            &LEVELS
        };
        let levels = in_parallel(scales.to_vec(), |scale| {
            let mut values = values.clone();
            scale_process_noise(&estimation, &mut values, scale)?;
            let tangent = bench
                .input_innovations
                .with_kicks(|kicks| estimation.tangent(&values, &directions, kicks))?;
            Ok::<Level, DiagnoseError>(Level::of(bench, scale, &tangent, &nuisances, &columns))
        });
        // With less process noise the filter may diverge.
        let (found, mut failed): (Vec<_>, Vec<_>) = levels.into_iter().partition(Result::is_ok);
        if let (true, Some(Err(failure))) = (found.is_empty(), failed.pop()) {
            return Err(failure);
        }
        let names: BTreeSet<String> = (fixed.iter())
            .map(|&own| bench.candidate(own).name())
            .collect();
        let of_fixed = names.iter().map(|name| of_components(bench.effects, name));
        let of_fixed: f64 = of_fixed.sum();
        let mut sets = Self {
            bench,
            levels: found.into_iter().flatten().collect(),
            choices: Vec::new(),
            prior: (0..=TOGETHER * most_counts(bench))
                .map(|effects| of_count(bench.effects, effects + fixed.len()) + of_fixed)
                .collect(),
            columns,
            members: fitted.members.clone(),
            fixed,
            offset: 0.0,
        };
        sets.choices = sets.choices();
        let own = |column: &usize| fitted.members.contains(&sets.columns[*column].candidate);
        let own: Vec<usize> = (0..sets.columns.len()).filter(own).collect();
        let own_prior = prior(bench.effects, &fitted.members);
        let level = sets.levels.first();
        let value = level.and_then(|level| sets.value(level, &own, own_prior));
        sets.offset = log_posterior - value.map_or(log_posterior, |(value, ..)| value);
        Ok(sets)
    }

    /// Candidates that are not linearly dependent on the nuisance directions; for a vector all subsets of components.
    fn choices(&self) -> Vec<Choice> {
        let mut by_candidate: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (place, column) in self.columns.iter().enumerate() {
            let mut levels = self.levels.iter();
            if levels.any(|level| !level.gram.is_imitated[place]) {
                let own = by_candidate.entry(column.candidate).or_default();
                own.push(place);
            }
        }
        let mut choices: Vec<Choice> = Vec::new();
        let mut vectors: BTreeMap<String, Vec<(usize, Vec<usize>)>> = BTreeMap::new();
        for (candidate, columns) in by_candidate {
            let own = self.bench.candidate(candidate);
            if own.is_component {
                let vector = vectors.entry(own.name()).or_default();
                vector.push((candidate, columns));
            } else {
                choices.push(Choice {
                    counts: own.counts,
                    log_prior: of_components(self.bench.effects, &own.name()),
                    candidates: vec![candidate],
                    columns,
                });
            }
        }
        for (name, components) in vectors {
            let is_of_group = |(own, _): &(usize, _)| self.bench.candidate(*own).is_of_group();
            let subsets: Vec<Vec<usize>> = if components.iter().all(is_of_group) {
                vec![(0..components.len()).collect()]
            } else {
                subsets(components.len(), TOGETHER)
            };
            for some in subsets {
                let own = some.iter().map(|&place| &components[place]);
                choices.push(Choice {
                    counts: counts(self.bench.effects, &name),
                    log_prior: of_components(self.bench.effects, &name),
                    candidates: own.clone().map(|(candidate, _)| *candidate).collect(),
                    columns: own.flat_map(|(_, columns)| columns.clone()).collect(),
                });
            }
        }
        choices
    }

    /// All sets of at most three choices whose one-sided sizes have the right sign.
    fn all(&self) -> Vec<Set> {
        let mut sets: Vec<Set> = Vec::new();
        let mut best = vec![f64::NEG_INFINITY; self.choices.len()];
        for i in 0..self.choices.len() {
            let set = self.set(&[i]);
            best[i] = set
                .as_ref()
                .map_or(f64::NEG_INFINITY, |set| set.log_posterior);
            sets.extend(set);
        }
        for i in 0..self.choices.len() {
            for j in i + 1..self.choices.len() {
                let Some(set) = self.set(&[i, j]) else {
                    continue;
                };
                for place in [i, j] {
                    best[place] = best[place].max(set.log_posterior);
                }
                sets.push(set);
            }
        }
        let mut leading: Vec<usize> = (0..self.choices.len()).collect();
        leading.sort_by(|&a, &b| best[b].total_cmp(&best[a]));
        leading.truncate(MOST_CHOICES);
        leading.sort_unstable();
        let threes = in_parallel(leading.clone(), |i| {
            let mut own = Vec::new();
            for (place, &j) in leading.iter().enumerate().filter(|(_, j)| **j > i) {
                let others = leading[place + 1..].iter();
                own.extend(others.filter_map(|&k| self.set(&[i, j, k])));
            }
            own
        });
        sets.extend(threes.into_iter().flatten());
        sets
    }

    /// A set of different choices, at its most probable level of process noise.
    fn set(&self, choices: &[usize]) -> Option<Set> {
        let choices: Vec<&Choice> = choices.iter().map(|&place| &self.choices[place]).collect();
        // An effect at a group of sites acts like those at each of them.
        let is_same = |one: usize, other: usize| {
            let [one, other] = [one, other].map(|own| self.bench.candidate(own));
            one.name() == other.name() || one.acts == other.acts && one.acts != Acts::Items
        };
        let is_like = |choice: &Choice, others: &[usize]| {
            let mut own = choice.candidates.iter();
            own.any(|&one| others.iter().any(|&other| is_same(one, other)))
        };
        let of_fixed = |choice: &&Choice| is_like(choice, &self.fixed);
        let is_twice = (1..choices.len()).any(|i| {
            let mut before = choices[..i].iter();
            before.any(|own| is_like(own, &choices[i].candidates))
        });
        if is_twice || choices.iter().any(of_fixed) {
            return None;
        }
        let columns: Vec<usize> = choices.iter().flat_map(|own| own.columns.clone()).collect();
        // The sensitivity to a parameter depends on the members: it does not apply to sets without one of them.
        let lacks = |member: &usize| {
            let mut own = choices.iter();
            !self.fixed.contains(member) && !own.any(|own| own.candidates.contains(member))
        };
        let has_parameter = columns
            .iter()
            .any(|&column| self.columns[column].known.is_some());
        if has_parameter && self.members.iter().any(lacks) {
            return None;
        }
        let counts = choices.iter().map(|choice| choice.counts).sum::<usize>();
        // An effect that counts as several is not combined beyond the largest number of effects.
        if choices.len() > 1 && counts > TOGETHER {
            return None;
        }
        let log_prior =
            self.prior[counts] + choices.iter().map(|choice| choice.log_prior).sum::<f64>();
        let levels = self.levels.iter();
        let valued =
            levels.filter_map(|level| Some((level, self.value(level, &columns, log_prior)?)));
        let (level, (value, solved)) = valued.max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
        let members = choices.iter().flat_map(|own| own.candidates.clone());
        let mut members: Vec<usize> = members.collect();
        let sizes = members.iter().map(|&candidate| {
            let count = directions(self.bench, candidate).len();
            let [mut values, mut deviations] = [vec![0.0; count], vec![0.0; count]];
            for (place, &column) in columns.iter().enumerate() {
                let column = &self.columns[column];
                if column.candidate == candidate {
                    values[column.place] = solved.sizes[place];
                    deviations[column.place] = solved.deviations[place];
                }
            }
            SizeEstimates {
                candidate,
                values,
                deviations,
            }
        });
        let sizes: Vec<SizeEstimates> = sizes.collect();
        // The delay stands for a lag that no recording resolves.
        let is_short = |own: &SizeEstimates| self.bench.is_too_short(own.candidate, &own.values);
        let mut lags = sizes
            .iter()
            .filter(|own| matches!(self.bench.candidate(own.candidate).acts, Acts::Lag(_)));
        if lags.clone().next().is_some() && lags.all(is_short) {
            return None;
        }
        members.extend(&self.fixed);
        members.sort_unstable();
        Some(Set {
            members,
            sizes,
            log_posterior: value + self.offset,
            levels: level.scale,
            starts: vec![Vec::new()],
        })
    }

    /// Log posterior of some columns up to a constant, and their best sizes;
    /// `None` if a one-sided size has the wrong sign, if a size is too large, or if the columns are linearly dependent.
    fn value(&self, level: &Level, columns: &[usize], log_prior: f64) -> Option<(f64, Solved)> {
        let mut solved = level.gram.solved(columns)?;
        let is_wrong = |(place, &column): (usize, &usize)| {
            let own = &self.columns[column];
            let size = solved.sizes[place];
            own.is_positive && size <= 0.0 || size > own.most
        };
        if columns.iter().enumerate().any(is_wrong) {
            return None;
        }
        let (log_likelihood, spread) = level.with_gain(solved.gain);
        for deviation in &mut solved.deviations {
            *deviation *= spread;
        }
        let mut value = log_likelihood + solved.log_volume + columns.len() as f64 * spread.ln();
        for (place, &column) in columns.iter().enumerate() {
            let own = &self.columns[column];
            let (size, deviation) = (solved.sizes[place], solved.deviations[place]);
            let hardware = &self.bench.hardware;
            let unknown = match own.direction {
                Direction::Value(unknown) => unknown,
                // Directions that are no values have no further prior.
                _ => Unknown::Disturbance(0),
            };
            let of_error = hardware
                .of_error(unknown, size)
                .filter(|_| own.known.is_some());
            value += match (of_error, own.known) {
                (Some((density, _)), Some(wrong)) => density + 0.5 * (size / wrong).powi(2),
                _ => hardware.of_size(unknown, size, deviation, !own.is_positive),
            };
        }
        Some((value + log_prior, solved))
    }

    /// Adds one candidate with an additional coordinate to the fit: these have no sensitivities.
    fn with_coordinates(&self, fitted: &Fitted, log_posterior: f64) -> Result<Vec<Set>> {
        let bench = self.bench;
        let for_kicks = fitted.evidence.by_inputs;
        let singles = (0..self.choices.len()).filter_map(|place| {
            let level = self.levels.first()?;
            Some(level.gram.solved(&self.choices[place].columns)?.gain)
        });
        let best = singles.fold(0.0, f64::max);
        let list = augmented::screened(bench, fitted, for_kicks, best)?;
        let set = |one: Screened| {
            let mut members = fitted.members.clone();
            members.push(one.candidate);
            members.sort_unstable();
            let before = prior(bench.effects, &fitted.members);
            let more = prior(bench.effects, &members) - before;
            Set {
                members,
                log_posterior: log_posterior + one.gain - occam(one.gain) + more,
                levels: one.levels,
                sizes: vec![SizeEstimates {
                    candidate: one.candidate,
                    values: one.sizes,
                    deviations: one.deviations,
                }],
                starts: one.starts,
            }
        };
        Ok(list.into_iter().map(set).collect())
    }
}

fn most_counts(bench: &Bench<'_>) -> usize {
    let counts = bench.effects.candidates.iter().map(|own| own.counts);
    counts.max().unwrap_or(1)
}

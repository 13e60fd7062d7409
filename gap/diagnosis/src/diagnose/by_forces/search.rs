//! The most probable hypotheses on residual forces.
//!
//! Every candidate is tried alone, then added to each of the best hypotheses, up to four effects.

use std::collections::BTreeSet;

use appell_recordings::DataSet;
use nalgebra::DVector;

use super::super::bench::wrong;
use super::super::calibration::{
    inexact, names, prior, tempered, unlisted, unlisted_beside_nothing,
};
use super::hypothesis::{Hypothesis, Member, Open, Solved, Squares};
use super::motions::Motions;
use crate::effects::{Acts, EffectModel, Part};
use crate::identify::possible;

/// Number of best hypotheses to which candidates are added.
const KEPT: usize = 6;
/// Largest number of effects of a hypothesis.
const MOST_EFFECTS: usize = 4;
/// Hypotheses below this probability are not reported.
const IMPROBABLE: f64 = 1e-4;
/// Where a shape is further away than this part of its prior deviation, its forces are evaluated there.
const FAR: f64 = 0.2;
/// Number of fits in which the prior of shapes follows the size.
const SHAPED: usize = 3;
/// Largest number of candidates of a hypothesis; components of a vector count as one effect.
const MOST_MEMBERS: usize = 6;

/// Result of a search.
pub(super) struct Findings {
    /// Hypotheses with their probabilities, the most probable first.
    pub(super) fits: Vec<(Hypothesis, f64)>,
    /// Index of the nominal model among them.
    pub(super) nominal: usize,
    /// Probability that no effect of the library explains the gap.
    pub(super) unknown: f64,
    /// Effective sample size relative to the number of motions, mean over the equations.
    pub(super) independent: f64,
    /// Noise of each equation's force.
    pub(super) noise: DVector<f64>,
    /// The hypothesis of every candidate alone.
    pub(super) alone: Vec<Hypothesis>,
}

impl Findings {
    pub(super) fn nominal(&self) -> &Hypothesis {
        &self.fits[self.nominal].0
    }

    pub(super) fn best(&self) -> &Hypothesis {
        &self.fits[0].0
    }
}

/// A search for hypotheses.
pub(super) struct Search<'s> {
    pub(super) effects: &'s EffectModel,
    pub(super) set: &'s DataSet,
    pub(super) motions: &'s Motions,
    pub(super) squares: Squares,
}

impl<'s> Search<'s> {
    pub(super) fn new(effects: &'s EffectModel, set: &'s DataSet, motions: &'s Motions) -> Self {
        Self {
            effects,
            set,
            motions,
            squares: Squares::of(motions),
        }
    }

    /// Searches twice, with the effective sample size by the residuals of the best hypothesis of the first search.
    /// `None` if not even the nominal model has finite forces.
    pub(super) fn found(&self) -> Option<Findings> {
        let first = self.fits(&self.squares);
        let log = |own: &&Hypothesis| self.log_posterior(own);
        let best = first.iter().max_by(|a, b| log(a).total_cmp(&log(b)));
        let squares = match best {
            Some(best) => self.squares.correlated(self.motions, best),
            None => self.squares.clone(),
        };
        self.weighed(&squares, self.fits(&squares))
    }

    fn weighed(&self, squares: &Squares, all: Vec<Hypothesis>) -> Option<Findings> {
        let base = all.first().filter(|first| first.members.is_empty())?.log;
        let alone = all.iter().filter(|own| own.members.len() == 1);
        let alone = alone.cloned().collect();
        let logs: Vec<f64> = all.iter().map(|own| self.log_posterior(own)).collect();
        let best = (0..all.len())
            .max_by(|&a, &b| logs[a].total_cmp(&logs[b]))
            .unwrap_or(0);
        let explained = |own: &Hypothesis| own.log - base;
        let weight = |(log, own): (&f64, &Hypothesis)| {
            let weight = tempered(log - logs[best]).exp();
            let mut members = own.members.iter();
            let is_part = members.all(|one| all[best].members.contains(one));
            if !is_part || own.members.len() == all[best].members.len() {
                return weight;
            }
            // A subset that explains nearly as much may be the truth with an inexact law.
            weight.max(inexact(1.0 - explained(own) / explained(&all[best])))
        };
        let weights: Vec<f64> = logs.iter().zip(&all).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        let noise = self.motions.noise(&all[best].changes);
        let weighed = all.into_iter().zip(weights);
        let mut fits: Vec<(Hypothesis, f64)> =
            weighed.map(|(own, weight)| (own, weight / sum)).collect();
        fits.retain(|(own, probability)| *probability > IMPROBABLE || own.members.is_empty());
        fits.sort_by(|a, b| b.1.total_cmp(&a.1));
        let nominal = fits.iter().position(|(own, _)| own.members.is_empty());
        let nominal = nominal.unwrap_or(0);
        let odds = if nominal == 0 {
            unlisted_beside_nothing(squares.beyond(&fits[0].0, &noise))
        } else {
            let [whole, left] = [nominal, 0].map(|place| beyond(&fits[place].0, &noise));
            unlisted(left / whole)
        };
        let count = squares.independent.len().max(1) as f64;
        Some(Findings {
            unknown: odds / (1.0 + odds),
            independent: squares.independent.iter().sum::<f64>() / count,
            fits,
            nominal,
            noise,
            alone,
        })
    }

    /// All fitted hypotheses, the nominal model first.
    fn fits(&self, squares: &Squares) -> Vec<Hypothesis> {
        let mut all: Vec<Hypothesis> = self.fitted(squares, &[]).into_iter().collect();
        let mut tried: BTreeSet<Vec<usize>> = BTreeSet::new();
        let mut kept = all.clone();
        for _ in 0..MOST_MEMBERS {
            let mut more: Vec<Hypothesis> = Vec::new();
            for base in &kept {
                for candidate in 0..self.effects.candidates.len() {
                    let mut members = base.members.clone();
                    members.push(candidate);
                    members.sort_unstable();
                    if self.may_join(base, candidate) && tried.insert(members.clone()) {
                        more.extend(self.fitted(squares, &members));
                    }
                }
            }
            more.sort_by(|a, b| self.log_posterior(b).total_cmp(&self.log_posterior(a)));
            let best = |list: &[Hypothesis]| {
                let logs = list.iter().map(|own| self.log_posterior(own));
                logs.fold(f64::NEG_INFINITY, f64::max)
            };
            let is_better = best(&more) > best(&kept);
            kept = more.iter().take(KEPT).cloned().collect();
            all.extend(more);
            if !is_better {
                break;
            }
        }
        all
    }

    /// Variants of an effect exclude each other, unless they are components.
    fn may_join(&self, base: &Hypothesis, candidate: usize) -> bool {
        let own = &self.effects.candidates[candidate];
        let name = own.name();
        let mut members = base.members.iter();
        let is_there = members.any(|&member| {
            member == candidate
                || !own.is_component && self.effects.candidates[member].name() == name
        });
        let together = [base.members.as_slice(), &[candidate]].concat();
        !is_there && names(self.effects, &together).len() <= MOST_EFFECTS
    }

    /// Logarithm of the probability, up to a constant.
    fn log_posterior(&self, fitted: &Hypothesis) -> f64 {
        fitted.log + prior(self.effects, &fitted.members)
    }

    /// The sizes of a candidate.
    fn sizes(&self, candidate: usize) -> Vec<Open> {
        let info = self.effects.info();
        let own = &self.effects.candidates[candidate];
        let own = self.effects.own(own).into_iter();
        let sizes = own.filter(|(_, part)| *part == Part::Size);
        let open = sizes.filter_map(|(parameter, _)| {
            Some(Open {
                column: self.motions.column(parameter)?,
                prior: None,
                range: info.parameters[parameter].range,
            })
        });
        open.collect()
    }

    /// The products of a candidate's size with its shapes.
    fn shapes(&self, candidate: usize, size: f64) -> Vec<Open> {
        let own = self.effects.own(&self.effects.candidates[candidate]);
        let open = own.iter().filter_map(|&(index, _)| {
            let column = self.motions.column(index)?;
            let shaped = self.motions.variables[column].shapes?;
            let stated = self.effects.info().parameters[index].value;
            Some(Open {
                column,
                prior: Some(
                    [stated - self.set.parameters[index].value, shaped.std].map(|own| size * own),
                ),
                range: [f64::NEG_INFINITY, f64::INFINITY],
            })
        });
        open.collect()
    }

    /// The shapes of a hypothesis, where one of them is far from where its forces were evaluated.
    pub(super) fn moved(&self, fitted: &Hypothesis) -> Option<Vec<(usize, f64)>> {
        let mut is_far = false;
        let mut shapes = Vec::new();
        for variable in &self.motions.variables {
            let Some(shaped) = variable.shapes else {
                continue;
            };
            let (change, deviation) = fitted.change(self.motions, variable.parameter);
            if deviation.is_some() {
                is_far |= change.abs() > FAR * shaped.std;
                let value = self.set.parameters[variable.parameter].value;
                shapes.push((variable.parameter, value + change));
            }
        }
        is_far.then_some(shapes)
    }

    /// A parameter within its tolerance.
    fn tolerance(&self, parameter: usize) -> Option<Open> {
        let own = self.set.parameters.get(parameter)?;
        let range = self.effects.info().parameters[parameter].range;
        Some(Open {
            column: self.motions.column(parameter)?,
            prior: Some([0.0, own.std.filter(|std| *std > 0.0)?]),
            range: possible(range, *own).map(|end| end - own.value),
        })
    }

    /// The hypothesis of some members, with all variable parameters of the mechanism.
    pub(super) fn fitted(&self, squares: &Squares, members: &[usize]) -> Option<Hypothesis> {
        let is_wrong = |parameter: usize| {
            members.iter().any(|&member| {
                matches!(self.effects.candidates[member].acts, Acts::Parameter(own) if own == parameter)
            })
        };
        let tolerance = |parameter: usize| {
            let own = self.tolerance(parameter)?;
            let value = self.set.parameters[parameter].value;
            let wider = |[mean, std]: [f64; 2]| [mean, wrong(value).max(std)];
            let prior = if is_wrong(parameter) {
                own.prior.map(wider)
            } else {
                own.prior
            };
            Some(Open { prior, ..own })
        };
        let others = (0..self.set.parameters.len()).filter(|&parameter| !is_wrong(parameter));
        let others: Vec<Open> = others.filter_map(tolerance).collect();
        let own = members.iter().map(|&member| {
            let open = match self.effects.candidates[member].acts {
                Acts::Parameter(own) => tolerance(own).into_iter().collect(),
                _ => self.sizes(member),
            };
            Member {
                candidate: member,
                open,
                shapes: Vec::new(),
                is_whole: !self.effects.candidates[member].is_of_group(),
            }
        });
        self.shaped(squares, own.collect(), &others)
    }

    /// With shapes, whose products with the size have a prior that follows the size.
    fn shaped(
        &self,
        squares: &Squares,
        mut members: Vec<Member>,
        others: &[Open],
    ) -> Option<Hypothesis> {
        let mut fitted: Option<Hypothesis> = None;
        for _ in 0..SHAPED {
            for member in &mut members {
                let [size] = member.open[..] else { continue };
                let size = match &fitted {
                    Some(fitted) => fitted.changes[size.column].abs(),
                    None => squares.scale(size.column),
                };
                member.shapes = self.shapes(member.candidate, size);
            }
            fitted = Some(squares.fitted(&members, others)?);
            if members.iter().all(|member| member.shapes.is_empty()) {
                break;
            }
        }
        fitted
    }

    /// Indices of the re-fitted parameters, their differences and the information about these.
    pub(super) fn refitted(&self) -> Option<(Vec<usize>, Solved)> {
        let nominal = self.fitted(&self.squares, &[])?;
        let squares = self.squares.correlated(self.motions, &nominal);
        let nominal = self.fitted(&squares, &[])?;
        let (free, open): (Vec<usize>, Vec<Open>) = (0..self.set.parameters.len())
            .filter_map(|parameter| Some((parameter, self.tolerance(parameter)?)))
            .filter(|(_, open)| nominal.deviations[open.column].is_some())
            .unzip();
        Some((free, squares.solved(&open)?))
    }
}

/// Sum over the equations of the residual mean squares in excess of the noise, in units of the noise.
fn beyond(fitted: &Hypothesis, noise: &DVector<f64>) -> f64 {
    let squares = fitted.variances.iter().zip(noise.iter());
    squares
        .map(|(variance, noise)| (variance / (noise * noise) - 1.0).max(0.0))
        .sum()
}

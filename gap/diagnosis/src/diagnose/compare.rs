//! Posterior probabilities of the hypotheses.

use std::collections::{BTreeMap, BTreeSet};

use appell_estimate::Fit;

use super::calibration::{
    IMMATERIAL, MUCH, NO_GAP, Rest, TIED, inexact, names, prior, tempered, unlisted,
    unlisted_alone, unlisted_beside_an_effect, unlisted_beside_nothing,
};
use super::search::{Look, SLACK, Search};
use super::unknown::{Leftover, leftover};
use super::whiteness::independent;
use super::{Bench, Fitted, Result};

/// A larger expected gain of a step is due to diverging sensitivities.
const MOST_PROMISED: f64 = 1e4;

/// Probability below which a hypothesis changes no conclusion.
const UNLIKELY: f64 = 0.01;

/// Hypotheses with their probabilities.
#[derive(Debug, Clone)]
pub(super) struct Comparison {
    /// Fitted hypotheses, the most probable first; the nominal model is one of them.
    pub(super) fits: Vec<(Fitted, f64)>,
    /// Hypotheses whose fit failed or ended before an optimum, with the reason.
    pub(super) failed: Vec<(Vec<usize>, String)>,
    /// Effective sample size relative to the number of samples: see `whiteness`.
    pub(super) independent: f64,
    /// Probability that no effect of the library explains the gap.
    pub(super) unknown: f64,
    /// The laws of the remainder of the best hypothesis.
    pub(super) left: Option<Leftover>,
    /// Mean square error of the best hypothesis over windows, relative to that of the nominal model, of a robot as its
    /// file states it.
    pub(super) stays: f64,
    /// Log likelihood of that model.
    from: f64,
    /// Index of the nominal model among the fits.
    pub(super) nominal: usize,
}

impl Comparison {
    /// The nominal model.
    pub(super) fn nominal(&self) -> &Fitted {
        &self.fits[self.nominal].0
    }

    /// The most probable hypothesis of the library.
    pub(super) fn best(&self) -> &Fitted {
        &self.fits[0].0
    }

    /// Whether there is no gap.
    pub(super) fn is_null(&self) -> bool {
        self.best().members.is_empty() && !self.leads_unknown()
    }

    /// Gain of the most probable hypothesis over the nominal model: in likelihood or in evidence, whichever is larger,
    /// as the nominal parameters may imitate the effect at the expense of their prior.
    pub(super) fn explained(&self) -> f64 {
        let [best, nominal] = [self.best(), self.nominal()].map(|own| own.evidence);
        (best.log_likelihood - nominal.log_likelihood).max(best.log() - nominal.log())
    }

    /// The remainder of the best hypothesis: its evidence, and the share of a law in the gap.
    fn rest(&self, bench: &Bench<'_>) -> Rest {
        let left = self.left.as_ref();
        let gain = left.map_or(0.0, |left| left.first.gains.gain);
        let explained = self.explained().max(0.0);
        Rest {
            // A law has to explain more than process noise with memory does.
            log_bayes_factor: left.map_or(f64::NEG_INFINITY, |left| {
                self.independent * (left.log_bayes_factor - self.best().coloured)
            }),
            share: if bench.is_over_windows() {
                self.stays * (1.0 - bench.left(gain))
            } else {
                gain / (gain + explained).max(f64::MIN_POSITIVE)
            },
        }
    }

    /// Whether `unknown` is the most probable hypothesis.
    pub(super) fn leads_unknown(&self) -> bool {
        self.unknown > (1.0 - self.unknown) * self.fits[0].1
    }

    /// Share in the gap of a law for the remainder of the best hypothesis.
    pub(super) fn rest_share(&self, bench: &Bench<'_>) -> f64 {
        if self.best().members.is_empty() {
            return 1.0;
        }
        self.rest(bench).share
    }

    /// Sets the probability that no effect of the library explains the gap.
    pub(super) fn weigh_unknown(&mut self, bench: &Bench<'_>) -> Result<()> {
        // Nor can a law close more than what stays.
        let is_closed = bench.is_of_robot
            && bench.is_over_windows()
            && !self.best().members.is_empty()
            && self.left_of_gap(bench) < IMMATERIAL;
        self.left = if is_closed || bench.leaves_nothing(self.best())? {
            None
        } else {
            leftover(bench, self.best())?
        };
        self.weigh_left(bench);
        Ok(())
    }

    /// Part of the mean square error over windows that stays.
    fn left_of_gap(&self, bench: &Bench<'_>) -> f64 {
        bench.left(self.best().fit.log_likelihood - self.from)
    }

    /// The same by the laws that are known for the residual.
    fn weigh_left(&mut self, bench: &Bench<'_>) {
        let members = self.best().members.len();
        let odds = match (bench.is_over_windows(), members) {
            (true, 0) => MUCH,
            (true, _) => {
                self.stays = self.left_of_gap(bench);
                unlisted_beside_an_effect(self.rest(bench)) + unlisted(self.stays)
            }
            (false, 0) => unlisted_beside_nothing(self.rest(bench).log_bayes_factor),
            // A remainder that is immaterial in simulations does not count.
            (false, _) => {
                unlisted_beside_an_effect(self.rest(bench)) * (self.stays / IMMATERIAL).min(1.0)
            }
        };
        // The odds are those against all hypotheses with as many members as the best one.
        let is_alike = |(own, _): &&(Fitted, f64)| own.members.len() == members;
        let alike = self.fits.iter().filter(is_alike);
        let weight = odds * alike.map(|(_, probability)| probability).sum::<f64>();
        self.unknown = weight / (1.0 + weight);
    }

    /// Whether a law alone is decisively more probable than several effects that may imitate it; if so, it is taken.
    pub(super) fn weigh_alone(
        &mut self,
        bench: &Bench<'_>,
        log_evidence: f64,
        law: &Leftover,
    ) -> bool {
        let best = self.best();
        let gain = self.independent * (log_evidence - best.evidence.log());
        let beforehand = prior(bench.effects, &best.members) - (1.0 - NO_GAP).ln();
        let odds = unlisted_alone(gain - beforehand) * self.fits[0].1;
        if odds.ln() < TIED {
            return false;
        }
        self.unknown = self.unknown.max(odds / (1.0 + odds));
        self.left = Some(law.clone());
        true
    }

    /// Reduces the probability of `unknown` if its law is immaterial in simulations: `again` is the best hypothesis
    /// over windows. A law that is not found there may be below their resolution, except for a robot: all of it
    /// is driven and measured, and whatever does not show over windows is immaterial.
    pub(super) fn bear_out_unknown(&mut self, over: &Bench<'_>, again: &Fitted) -> Result<()> {
        let share = match leftover(over, again)? {
            Some(seen) => self.stays * (1.0 - over.left(seen.first.gains.gain)),
            None if over.is_of_robot => 0.0,
            None => return Ok(()),
        };
        let weight = self.unknown * (share / IMMATERIAL).min(1.0);
        self.unknown = weight / (weight + (1.0 - self.unknown)).max(f64::MIN_POSITIVE);
        Ok(())
    }

    /// The same without hypotheses with a reason against them; those that are hardly probable are not asked.
    pub(super) fn without(&mut self, mut reason: impl FnMut(&Fitted) -> Option<String>) {
        let nominal = self.nominal().members.clone();
        let mut asked = BTreeSet::new();
        loop {
            let sum: f64 = self.fits.iter().map(|(_, probability)| probability).sum();
            if sum <= 0.0 {
                // Beside what is left out the others were too improbable for a number.
                let evidence = |(own, _): &&mut (Fitted, f64)| own.evidence.log();
                let left = self.fits.iter_mut();
                let best = left.max_by(|a, b| evidence(a).total_cmp(&evidence(b)));
                let Some((_, probability)) = best else { break };
                *probability = 1.0;
                self.fits.sort_by(|(_, a), (_, b)| b.total_cmp(a));
                continue;
            }
            for (_, probability) in &mut self.fits {
                *probability /= sum;
            }
            let is_next = |(own, probability): &(Fitted, f64)| {
                *probability > UNLIKELY && own.members != nominal && !asked.contains(&own.members)
            };
            let Some(next) = self.fits.iter().position(is_next) else {
                break;
            };
            let members = self.fits[next].0.members.clone();
            if let Some(reason) = reason(&self.fits[next].0) {
                self.fits.remove(next);
                self.failed.push((members, reason));
            } else {
                asked.insert(members);
            }
        }
        let is_nominal = |(own, _): &(Fitted, f64)| own.members == nominal;
        self.nominal = self.fits.iter().position(is_nominal).unwrap_or(0);
    }

    /// Searches from the nominal model and other known hypotheses. `look` validates the best hypothesis before others
    /// are tried; `None` if it is rejected.
    pub(super) fn of(
        bench: &Bench<'_>,
        nominal: Fitted,
        known: Vec<Fitted>,
        look: impl FnMut(&Fitted) -> Look,
    ) -> Result<Option<Self>> {
        let mut search = Search::new(bench, nominal, known);
        let holds = search.run(look)?;
        holds.then(|| Self::found(bench, search)).transpose()
    }

    /// The nominal model and known hypotheses, without a search.
    pub(super) fn of_known(bench: &Bench<'_>, nominal: Fitted, known: Vec<Fitted>) -> Result<Self> {
        Self::found(bench, Search::new(bench, nominal, known))
    }

    /// Compares the nominal model and known hypotheses, and extends the best of them while that improves it.
    pub(super) fn among(bench: &Bench<'_>, nominal: Fitted, known: Vec<Fitted>) -> Result<Self> {
        let mut search = Search::new(bench, nominal, known);
        search.better()?;
        Self::found(bench, search)
    }

    /// The same after increases of the evidence of some hypotheses by another process noise.
    pub(super) fn again(self, bench: &Bench<'_>) -> Result<Self> {
        let best = self.best().members.clone();
        let (unknown, stays, left) = (self.unknown, self.stays, self.left.clone());
        let mut again = self.with(bench, Vec::new())?;
        again.stays = stays;
        if again.best().members == best {
            again.left = left;
            again.weigh_left(bench);
            again.unknown = again.unknown.min(unknown);
        } else {
            again.weigh_unknown(bench)?;
        }
        Ok(again)
    }

    /// The same with further hypotheses that were fitted elsewhere.
    pub(super) fn with(self, bench: &Bench<'_>, known: Vec<Fitted>) -> Result<Self> {
        let nominal = self.nominal().clone();
        let own = self.fits.into_iter().map(|(own, _)| own);
        let mut search = Search::new(bench, nominal, own.chain(known));
        search.failed = self.failed;
        search.stated = Some(self.from);
        Self::found(bench, search)
    }

    /// The result of a search.
    fn found(bench: &Bench<'_>, mut search: Search<'_, '_>) -> Result<Self> {
        search.recount_late();
        // Searches that were given up need no word.
        let log = |own: &Fitted| search.log_posterior(own);
        let best = search.fits.iter().map(log);
        let best = best.fold(f64::NEG_INFINITY, f64::max);
        let is_early = |own: &&Fitted| !own.fit.is_optimum() && log(own) > best - SLACK;
        let ended_early = search.fits.iter().filter(is_early);
        let ended_early = ended_early.map(|own| (own.members.clone(), ended(&own.fit)));
        let ended_early: Vec<(Vec<usize>, String)> = ended_early.collect();
        let unfitted = |(members, _): &(Vec<usize>, String)| {
            !search.fits.iter().any(|own| own.members == *members)
        };
        search.failed.retain(unfitted);
        search.failed.extend(ended_early);
        search.fits.retain(Fitted::is_there);
        let logs = search.fits.iter().map(|own| search.log_posterior(own));
        let logs: Vec<f64> = logs.collect();
        let best = (0..logs.len()).max_by(|&a, &b| logs[a].total_cmp(&logs[b]));
        let best = best.unwrap_or(0);
        let independent = if bench.is_over_windows() {
            1.0
        } else {
            independent(bench, &search.fits[best])?
        };
        let sizes = |fitted: &Fitted| bench.sizes_of(&fitted.members);
        let none = search.fits[0].evidence;
        let explained = |fitted: &Fitted| fitted.evidence.log() - none.log();
        let (all, most) = (explained(&search.fits[best]), sizes(&search.fits[best]));
        let weight = |(log, fitted): (&f64, &Fitted)| {
            let weight = tempered(independent * (log - logs[best])).exp();
            if sizes(fitted) >= most || bench.is_over_windows() {
                return weight;
            }
            // A hypothesis with fewer sizes that explains nearly as much may be the truth with an inexact law.
            weight.max(inexact(1.0 - explained(fitted) / all))
        };
        let weights: Vec<f64> = logs.iter().zip(&search.fits).map(weight).collect();
        let sum: f64 = weights.iter().sum();
        let fits = search.fits.into_iter().zip(weights);
        let fits = fits.map(|(fitted, weight)| (fitted, weight / sum));
        let mut fits: Vec<(Fitted, f64)> = fits.collect();
        // Variants of one effect are one hypothesis.
        let mut of_names: BTreeMap<Vec<String>, f64> = BTreeMap::new();
        for (fitted, weight) in &fits {
            *of_names
                .entry(names(bench.effects, &fitted.members))
                .or_default() += weight;
        }
        let together = |fitted: &Fitted| of_names[&names(bench.effects, &fitted.members)];
        fits.sort_by(|(a, own_a), (b, own_b)| {
            (together(b).total_cmp(&together(a))).then(own_b.total_cmp(own_a))
        });
        let nominal = fits.iter().position(|(own, _)| own.members.is_empty());
        let nominal = nominal.unwrap_or(0);
        let likelihood = fits[nominal].0.fit.log_likelihood;
        Ok(Self {
            nominal,
            from: search.stated.unwrap_or(likelihood).min(likelihood),
            fits,
            failed: search.failed,
            independent,
            unknown: 0.0,
            left: None,
            stays: 1.0,
        })
    }
}

/// Whether the sensitivities at the end of a search have no meaning.
fn diverges(fit: &Fit) -> bool {
    fit.gain > MOST_PROMISED
}

/// Whether the deviation of a coordinate has a meaning; where sensitivities diverge, only its prior bounds it.
pub(super) fn has_deviation(fit: &Fit, place: usize) -> bool {
    !diverges(fit) || fit.free[place].prior.is_some()
}

/// The reason why a search ended early.
fn ended(fit: &Fit) -> String {
    let steps = fit.steps;
    if diverges(fit) {
        return format!(
            "its search ended after {steps} steps at diverging sensitivities, as with stiff friction: it may explain \
             more than reported"
        );
    }
    format!(
        "its search ended after {steps} steps: the next one should increase the log likelihood by {:.1} but does not; \
         it may explain more than reported",
        fit.gain
    )
}

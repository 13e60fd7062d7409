//! Search for the most probable set of effects.
//!
//! All sets are evaluated to first order about the nominal model, and the best of them fitted; then again about the best
//! fit, where sensitivities differ, until no better set is found. The fits of all sets have the same stopping rule.

use std::collections::BTreeSet;

use appell_estimate::Estimation;

use super::calibration::{TIED, names, prior};
use super::sets::{Set, Sets, is_fixed};
use super::starts::{place, scale_process_noise};
use super::{Bench, DiagnoseError, Fitted, Result};
use crate::effects::Acts;

/// Number of sets that are fitted before the next linearisation, and of rivals that are fitted about the best one.
pub(super) const LEADING: usize = 2;
const RIVALS: usize = 6;
/// The same for a robot, whose fits take long.
const FEW_RIVALS: usize = 2;
/// Number of single effects about which sets are also evaluated.
const SINGLES: usize = 6;
/// Largest number of linearisations.
const ROUNDS: usize = 4;
/// Sets are fitted if their expected log posterior is below the best one by at most this, plus a part of the gain of
/// that one: the linearisation is inaccurate for large sizes. Of a robot a smaller one, as its strong single effects are
/// all fitted.
const WORTH: f64 = 1.5 * TIED;
const BY_SLOPES: [f64; 2] = [0.5, 0.25];
/// Parts of the sizes that are tried as initial values.
const PARTS: [f64; 4] = [0.5, 0.2, 0.05, 0.01];
/// Log posterior of the values below that of the best hypothesis from which a slow search is given up.
pub(super) const SLACK: f64 = 40.0;
/// Part of the gain of the re-fitted parameters that a delay of all drives has to reach with the others as stated, of the
/// gain of the best single effect that others have to promise, and of the gain of the best hypothesis that a single
/// effect of a robot has to reach for sets about it.
pub(super) const IMITATED: f64 = 0.5;
/// Why a fit does not count.
const NO_EVIDENCE: &str = "its parameters are not identifiable";

/// Validation of a hypothesis by other predictions.
pub(super) enum Look {
    /// It is valid.
    Holds,
    /// It is valid only together with this candidate.
    Lacks(usize),
    /// It is rejected.
    Refuted,
}

/// A search for hypotheses.
pub(super) struct Search<'b, 'a> {
    pub(super) bench: &'b Bench<'a>,
    /// The fitted hypotheses, the nominal model first.
    pub(super) fits: Vec<Fitted>,
    /// Hypotheses whose fit failed, with the reason.
    pub(super) failed: Vec<(Vec<usize>, String)>,
    /// Sets that need no further fit.
    settled: BTreeSet<Vec<usize>>,
    /// Log likelihood of the model as stated, once it is known.
    pub(super) stated: Option<f64>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// From the nominal model and other known fits.
    pub(super) fn new(
        bench: &'b Bench<'a>,
        nominal: Fitted,
        known: impl IntoIterator<Item = Fitted>,
    ) -> Self {
        let mut search = Self {
            bench,
            fits: vec![nominal],
            failed: Vec::new(),
            settled: BTreeSet::new(),
            stated: None,
        };
        for fitted in known {
            search.keep(fitted);
        }
        search
    }

    /// Fits sets about the nominal model, then about the best fits. `look` validates the best hypothesis of each
    /// round; returns whether none of them was rejected.
    pub(super) fn run(&mut self, mut look: impl FnMut(&Fitted) -> Look) -> Result<bool> {
        let mut first: Vec<Set> = Vec::new();
        let mut referred: BTreeSet<Vec<usize>> = BTreeSet::new();
        let rivals = if self.bench.is_of_robot {
            FEW_RIVALS
        } else {
            RIVALS
        };
        let is_stated = self.bench.is_of_robot && self.start_from_stated().is_ok();
        for round in 0..ROUNDS {
            // The first linearisation is about the nominal model, even with other known fits.
            let next = if round == 0 && !is_stated {
                0
            } else {
                self.best().unwrap_or(0)
            };
            let members = self.fits[next].members.clone();
            let log_posterior = self.log_posterior(&self.fits[next]);
            let sets = Sets::about(self.bench, &self.fits[next], log_posterior)?;
            let is_best = |search: &Self| {
                let best = search.best().unwrap_or(0);
                search.fits[best].members == members
            };
            let mut leading = self.worth_a_fit(&sets, LEADING, None);
            if round == 0 && !is_stated {
                // The best single effects and pairs too: to first order they may not be among the best sets.
                for effects in [1, 2] {
                    leading.extend(self.worth_a_fit(&sets, LEADING, Some(effects)));
                }
            }
            for set in leading {
                self.take(next, set);
            }
            // Rivals are compared by a linearisation about the best set.
            if is_best(self) || round + 1 == ROUNDS {
                for set in self.worth_a_fit(&sets, rivals, None) {
                    self.take(next, set);
                }
                let promised = first.first().map_or(0.0, |set| set.log_posterior);
                let own = first
                    .iter()
                    .filter(|set| set.log_posterior > promised - WORTH);
                for set in own.take(rivals) {
                    self.take(0, set);
                }
            }
            self.try_instead();
            if let Some(best) = self.best().filter(|&best| best > 0)
                && !self.goes_on(best, &mut look)?
            {
                return Ok(false);
            }
            if is_best(self) && !self.led_on_by_singles(&mut referred)? {
                break;
            }
            if round == 0 {
                first = sets;
            }
        }
        self.drop_idle();
        Ok(true)
    }

    /// Adds the most promising effects to the best hypothesis while that improves it, and fits the rivals of the result.
    pub(super) fn better(&mut self) -> Result<()> {
        for _ in 0..ROUNDS {
            let best = self.best().unwrap_or(0);
            let log_posterior = self.log_posterior(&self.fits[best]);
            let sets = Sets::about(self.bench, &self.fits[best], log_posterior)?;
            for most in [LEADING, RIVALS] {
                for set in self.worth_a_fit(&sets, most, None) {
                    self.take(best, set);
                }
                if self.best() != Some(best) {
                    break;
                }
            }
            if self.best() == Some(best) {
                break;
            }
        }
        Ok(())
    }

    /// Evaluates sets about the best single effects as well: a linearisation about a wrong effect may mask a set of
    /// others. Returns whether they lead to a better hypothesis.
    fn led_on_by_singles(&mut self, referred: &mut BTreeSet<Vec<usize>>) -> Result<bool> {
        let Some(best) = self.best().filter(|_| self.bench.is_over_windows()) else {
            return Ok(false);
        };
        let members = self.fits[best].members.clone();
        let is_single = |fitted: &&Fitted| {
            fitted.is_there()
                && names(self.bench.effects, &fitted.members).len() == 1
                && fitted.members != members
        };
        let mut singles: Vec<Fitted> = self.fits.iter().filter(is_single).cloned().collect();
        singles.sort_by(|a, b| self.log_posterior(b).total_cmp(&self.log_posterior(a)));
        if self.bench.is_of_robot {
            let [none, most] = [0, best].map(|fit| self.log_posterior(&self.fits[fit]));
            singles.retain(|own| self.log_posterior(own) - none > IMITATED * (most - none));
        }
        let mut told: BTreeSet<Vec<String>> = BTreeSet::new();
        singles.retain(|single| told.insert(names(self.bench.effects, &single.members)));
        singles.truncate(SINGLES);
        for single in singles {
            if !referred.insert(single.members.clone()) {
                continue;
            }
            let log_posterior = self.log_posterior(&single);
            let sets = Sets::about(self.bench, &single, log_posterior)?;
            let mut fits = self.fits.iter();
            let from = fits.position(|own| own.members == single.members);
            // More effects beside a single one have to gain by it.
            let gains = |set: &&Set| {
                let holds = single.members.iter().all(|own| set.members.contains(own));
                !holds || set.log_posterior > log_posterior
            };
            let sets: Vec<Set> = sets.iter().filter(gains).cloned().collect();
            for set in self.worth_a_fit(&sets, LEADING, None) {
                self.take(from.unwrap_or(0), set);
            }
        }
        Ok(self.best() != Some(best))
    }

    /// The most promising sets that are not fitted yet, of any or of a given number of effects.
    pub(super) fn worth_a_fit<'s>(
        &self,
        sets: &'s [Set],
        most: usize,
        size: Option<usize>,
    ) -> Vec<&'s Set> {
        let log = |fit: usize| self.log_posterior(&self.fits[fit]);
        let fitted = self.best().map_or(f64::NEG_INFINITY, log);
        let best = sets
            .first()
            .map_or(fitted, |set| set.log_posterior.max(fitted));
        let part = BY_SLOPES[usize::from(self.bench.is_of_robot)];
        let least = best - WORTH - part * (best - log(0)).max(0.0);
        let leading = self.best().map_or(&[][..], |best| &self.fits[best].members);
        let is_new = |set: &&Set| {
            let is_fitted = self.fits.iter().any(|own| own.members == set.members);
            let is_of_size =
                size.is_none_or(|size| names(self.bench.effects, &set.members).len() == size);
            // A set with more sizes than the best one and a lower posterior is no rival.
            let is_idle = set.log_posterior < fitted
                && !leading.is_empty()
                && self.bench.sizes_of(&set.members) > self.bench.sizes_of(leading);
            set.log_posterior > least
                && is_of_size
                && !is_idle
                && !is_fitted
                && !self.settled.contains(&set.members)
        };
        let mut told = BTreeSet::new();
        let is_other = |set: &&Set| {
            !self.bench.is_of_robot || {
                let names = names(self.bench.effects, &set.members);
                !self.is_hopeless(&names) && told.insert(names)
            }
        };
        let new = sets.iter().filter(is_new).filter(is_other);
        new.take(most).collect()
    }

    /// Whether effects of these names, maybe with other components, are far below the best hypothesis.
    fn is_hopeless(&self, of: &[String]) -> bool {
        let log = |own: &Fitted| self.log_posterior(own);
        let best = self
            .best()
            .map_or(f64::NEG_INFINITY, |best| log(&self.fits[best]));
        self.fits.iter().any(|own| {
            own.fit.is_optimum()
                && log(own) < best - SLACK
                && names(self.bench.effects, &own.members) == of
        })
    }

    /// Whether the best hypothesis is valid, if necessary with the candidate that it lacks.
    fn goes_on(&mut self, best: usize, look: &mut impl FnMut(&Fitted) -> Look) -> Result<bool> {
        let lacks = match look(&self.fits[best]) {
            Look::Holds => return Ok(true),
            Look::Refuted => return Ok(false),
            Look::Lacks(candidate) => candidate,
        };
        let mut members = self.fits[best].members.clone();
        members.push(lacks);
        members.sort_unstable();
        let both = |search: &Self| search.fits.iter().position(|own| own.members == members);
        if both(self).is_none() {
            let log_posterior = self.log_posterior(&self.fits[best]);
            let sets = Sets::about(self.bench, &self.fits[best], log_posterior)?;
            if let Some(set) = sets.iter().find(|set| set.members == members) {
                self.take(best, set);
            }
        }
        Ok(both(self).is_some_and(|both| matches!(look(&self.fits[both]), Look::Holds)))
    }

    /// Fits a set from the optimum of another hypothesis.
    fn take(&mut self, from: usize, set: &Set) {
        let from = self.fits[from].clone();
        self.take_from(&from, set);
    }

    pub(super) fn take_from(&mut self, from: &Fitted, set: &Set) {
        let members = set.members.clone();
        if self.settled.contains(&members) {
            return;
        }
        match self.fitted(from, set) {
            Ok(fitted) if fitted.evidence.log().is_finite() => {
                if fitted.fit.is_optimum() {
                    self.settled.insert(members);
                }
                if self.bench.is_of_robot && !fitted.is_there() {
                    self.keep_without_idle(&fitted);
                }
                self.keep(fitted);
            }
            Ok(_) => {
                self.settled.insert(members.clone());
                self.failed.push((members, NO_EVIDENCE.to_owned()));
            }
            Err(error) => self.failed.push((members, error.to_string())),
        }
    }

    /// Fits the rest of a hypothesis with a member that is not determined beside others, such as dry friction at a drive
    /// beside that of its joint.
    fn keep_without_idle(&mut self, whole: &Fitted) {
        let bench = self.bench;
        let is_idle =
            |&&own: &&usize| !bench.candidate(own).is_of_group() && whole.is_idle(bench, own);
        let idle = whole.members.iter().filter(is_idle);
        for &idle in idle.filter(|_| whole.members.len() > 1) {
            let rest = whole.members.iter().filter(|&&own| own != idle);
            let rest: Vec<usize> = rest.copied().collect();
            if self.settled.contains(&rest) {
                continue;
            }
            if let Ok(fitted) = self.fitted_without(whole, idle) {
                self.settled.insert(rest);
                self.keep(fitted);
            }
        }
    }

    /// Keeps the better of two fits of a hypothesis. A search that ended before an optimum gives a lower bound of its
    /// evidence. What a command knows is no evidence for an effect: impulses gain at most as much as in addition to the
    /// nominal model.
    pub(super) fn keep(&mut self, mut fitted: Fitted) {
        if !fitted.members.is_empty() {
            let evidence = &mut fitted.evidence;
            evidence.by_inputs = (evidence.by_inputs).min(self.fits[0].evidence.by_inputs);
        }
        let mut fits = self.fits.iter_mut();
        match fits.find(|own| own.members == fitted.members) {
            Some(own) if own.evidence.log() < fitted.evidence.log() => *own = fitted,
            Some(_) => {}
            None => self.fits.push(fitted),
        }
    }

    fn fitted(&self, from: &Fitted, set: &Set) -> Result<Fitted> {
        let bench = self.bench;
        let setup = bench.setup(&set.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut start = bench.carried(from, &estimation);
        let carried = start.clone();
        for &member in &from.members {
            if !is_fixed(bench, member) {
                self.take_away(member, from, &estimation, &mut start);
            }
        }
        scale_process_noise(&estimation, &mut start, set.levels)?;
        self.place_all(from, set, &carried, &estimation, &mut start)?;
        let new: Vec<usize> = (set.members.iter().copied())
            .filter(|member| !from.members.contains(member))
            .collect();
        let fits = set.starts.iter().map(|values| {
            let mut start = start.clone();
            for &(place, value) in values {
                start[place] = value;
            }
            bench.hide(&new, &estimation, &mut start)?;
            let effort = bench.above(self.floor(&set.members));
            bench.fit(effort, &set.members, &estimation, &start)
        });
        // The fit with the greatest evidence, or the last error if all failed.
        let (found, mut failed): (Vec<_>, Vec<_>) = fits.partition(Result::is_ok);
        let greater = |best: Fitted, next: Fitted| {
            if next.evidence.log() > best.evidence.log() {
                next
            } else {
                best
            }
        };
        let best = found.into_iter().flatten().reduce(greater);
        let failure = failed.pop().and_then(Result::err);
        let mut fitted = best.ok_or_else(|| failure.unwrap_or(DiagnoseError::NothingToFit))?;
        self.count_late(&mut fitted)?;
        Ok(fitted)
    }

    /// Writes the sizes of a set as initial values. Of a robot a part of them, where the motion depends on them so
    /// strongly that with all of them it is predicted worse than without.
    fn place_all(
        &self,
        from: &Fitted,
        set: &Set,
        carried: &[f64],
        estimation: &Estimation<'_>,
        start: &mut [f64],
    ) -> Result<()> {
        let bench = self.bench;
        let put = |part: f64, start: &mut [f64]| -> Result<()> {
            for sizes in &set.sizes {
                let is_known = from.members.contains(&sizes.candidate);
                let part = if is_known { 1.0 } else { part };
                place(bench, estimation, sizes, part, start)?;
                if is_known {
                    // Its shape has been estimated already.
                    for (index, part) in bench.own(bench.candidate(sizes.candidate)) {
                        if part.is_shape() {
                            start[index] = carried[index];
                        }
                    }
                }
            }
            Ok(())
        };
        let without = start.to_vec();
        put(1.0, start)?;
        if !bench.is_of_robot {
            return Ok(());
        }
        let likelihood = |values: &[f64]| {
            estimation
                .log_likelihood(values)
                .unwrap_or(f64::NEG_INFINITY)
        };
        let least = likelihood(&without);
        for part in PARTS {
            if likelihood(start) > least {
                break;
            }
            start.copy_from_slice(&without);
            put(part, start)?;
        }
        Ok(())
    }

    /// The log posterior of the values of the best hypothesis, less what others may make up for by fewer values, for a
    /// robot, whose fits take long; that of a delayed channel refers to fewer rows.
    fn floor(&self, members: &[usize]) -> f64 {
        if !self.bench.is_of_robot {
            return f64::NEG_INFINITY;
        }
        let is_late = |members: &[usize]| self.bench.is_late(members);
        let mut best = (self.best().map(|best| &self.fits[best])).into_iter();
        let comparable = best.find(|best| !is_late(&best.members) && !is_late(members));
        comparable.map_or(f64::NEG_INFINITY, |best| best.fit.log_posterior - SLACK)
    }

    /// Resets the values of a member of a fit.
    pub(super) fn take_away(
        &self,
        member: usize,
        whole: &Fitted,
        estimation: &Estimation<'_>,
        values: &mut [f64],
    ) {
        let (bench, neutral) = (self.bench, estimation.nominal());
        let candidate = bench.candidate(member);
        let own = bench.own(candidate).into_iter();
        let mut places: Vec<usize> = own.map(|(place, _)| place).collect();
        if let Acts::Parameter(index) = candidate.acts {
            values[index] = bench.set.parameters[index].value;
        }
        for free in bench.brought(member, &bench.setup(&whole.members)) {
            // Values that the other filter does not have are skipped.
            places.extend(estimation.layout().place(free.unknown));
        }
        for place in places {
            values[place] = neutral[place];
        }
    }

    /// A delayed channel loses rows: its likelihood is that of another hypothesis plus the gain on the remaining rows.
    /// Over windows, which have few rows, that is the best one without delayed channels, so that what both explain
    /// counts on all rows; otherwise it is the nominal model.
    pub(super) fn count_late(&self, fitted: &mut Fitted) -> Result<()> {
        if !self.bench.is_late(&fitted.members) {
            return Ok(());
        }
        let is_rival = |own: &&Fitted| {
            self.bench.is_over_windows() && own.is_there() && !self.bench.is_late(&own.members)
        };
        let others = self.fits.iter().filter(is_rival);
        let best = others.max_by(|a, b| self.log_posterior(a).total_cmp(&self.log_posterior(b)));
        let best = best.unwrap_or(&self.fits[0]);
        let gain = self.bench.gain_of_late(best, fitted)?;
        fitted.evidence.log_likelihood = best.evidence.log_likelihood + gain;
        Ok(())
    }

    /// The same for all hypotheses over windows, after a search; without a likelihood on these rows they keep theirs.
    pub(super) fn recount_late(&mut self) {
        if !self.bench.is_over_windows() {
            return;
        }
        for place in 0..self.fits.len() {
            let mut evidence = self.fits[place].clone();
            if self.count_late(&mut evidence).is_ok() {
                self.fits[place] = evidence;
            }
        }
    }

    /// Removes each member of the best hypothesis in turn and refits from the optimum: a member may have been needed
    /// only to find the others.
    fn drop_idle(&mut self) {
        while let Some(best) = self
            .best()
            .filter(|&best| self.fits[best].members.len() > 1)
        {
            let whole = self.fits[best].clone();
            // What acts at all drives has no idle part.
            let is_whole = |member: usize| !self.bench.candidate(member).is_of_group();
            for &idle in whole.members.iter().filter(|&&member| is_whole(member)) {
                if let Ok(fitted) = self.fitted_without(&whole, idle) {
                    self.keep(fitted);
                }
            }
            if self.best() == Some(best) {
                return;
            }
        }
    }

    /// A hypothesis without a member, from the optimum with it.
    fn fitted_without(&self, whole: &Fitted, idle: usize) -> Result<Fitted> {
        let bench = self.bench;
        let mut members = whole.members.clone();
        members.retain(|&own| own != idle);
        let setup = bench.setup(&members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut start = bench.carried(whole, &estimation);
        self.take_away(idle, whole, &estimation, &mut start);
        let effort = bench.above(self.floor(&members));
        let mut fitted = bench.fit(effort, &members, &estimation, &start)?;
        self.count_late(&mut fitted)?;
        Ok(fitted)
    }

    /// The most probable hypothesis.
    pub(super) fn best(&self) -> Option<usize> {
        let there = (0..self.fits.len()).filter(|&i| self.fits[i].is_there());
        let log = |i: usize| self.log_posterior(&self.fits[i]);
        there.max_by(|&a, &b| log(a).total_cmp(&log(b)))
    }

    /// Logarithm of the probability, up to a constant.
    pub(super) fn log_posterior(&self, fitted: &Fitted) -> f64 {
        fitted.evidence.log() + prior(self.bench.effects, &fitted.members)
    }
}

//! The best candidates fitted, alone and together.
//!
//! Every hypothesis has the same effort. One effect joins another where the evidence for both
//! outweighs that there are many pairs.

use std::collections::BTreeSet;

use appell_estimate::{Estimation, Unknown};

use super::DiagnoseError;
use super::bench::{Bench, WRONG};
use super::calibration::TIED;
use super::evidence::Fitted;
use super::prior::{effects, prior};
use super::screen::{LEAST_GAIN, Screen, Screened, least, quieten};
use crate::effects::{Acts, Part};

/// Candidates that are fitted alone.
const KEPT: usize = 8;
/// Candidates that are fitted before the first look at what they explain.
const FIRST: usize = 3;
/// Candidates that are tried beside another.
const KEPT_BESIDE: usize = 4;
/// By how much a disturbance becomes smaller beside an effect that it has followed.
const FOLLOWED: f64 = 3.0;
/// Most effects of a hypothesis.
const MOST_MEMBERS: usize = 4;
/// Part of the longest delay at which a search begins at most.
const BELOW: f64 = 0.9;
/// Why a fit does not count.
const NO_EVIDENCE: &str = "its parameters cannot be told from each other";
/// Signatures that are this much alike are those of one effect in two guises.
const ALIKE: f64 = 0.8;

/// What is seen elsewhere of a hypothesis.
pub(super) enum Look {
    /// It holds, as far as it goes.
    Holds,
    /// It lacks a candidate to hold.
    Lacks(usize),
    /// It does not hold.
    Refuted,
}

/// The candidates worth a fit beside some members: the best variant of each other effect at each place.
fn kept(bench: &Bench<'_>, screen: &Screen, members: &[usize], most: usize) -> Vec<Screened> {
    let mut kept: Vec<Screened> = Vec::new();
    // What brings a coordinate was tried at some sizes and not to first order: it is no measure for others.
    let is_plain = |one: &&Screened| bench.candidate(one.candidate).brings.is_none();
    let best = screen
        .list
        .iter()
        .find(is_plain)
        .map_or(0.0, |one| one.gain);
    for screened in (screen.list.iter()).filter(|one| one.gain > least(best)) {
        let candidate = bench.candidate(screened.candidate);
        let is_alike = |own: usize| bench.candidate(own).name() == candidate.name();
        let is_part = |own: usize| is_alike(own) && !candidate.is_component;
        let is_known = kept.iter().any(|own| is_alike(own.candidate))
            || members.contains(&screened.candidate)
            || members.iter().any(|&own| is_part(own));
        let is_guise = kept
            .first()
            .is_some_and(|best| best.alike(screened) > ALIKE);
        if !is_known && (kept.len() < most || is_guise && kept.len() < 2 * most) {
            kept.push(screened.clone());
        }
    }
    kept
}

/// A search for hypotheses.
pub(super) struct Search<'b, 'a> {
    bench: &'b Bench<'a>,
    /// What was fitted, the nominal model first.
    pub(super) fits: Vec<Fitted>,
    /// Hypotheses whose fit failed, with the reason.
    pub(super) failed: Vec<(Vec<usize>, String)>,
    /// What needs no other fit.
    settled: BTreeSet<Vec<usize>>,
}

impl<'b, 'a> Search<'b, 'a> {
    /// From the nominal model and what else is known.
    pub(super) fn new(
        bench: &'b Bench<'a>,
        (nominal, known): (Fitted, impl IntoIterator<Item = Fitted>),
    ) -> Self {
        let mut search = Self {
            bench,
            fits: vec![nominal],
            failed: Vec::new(),
            settled: BTreeSet::new(),
        };
        for fitted in known {
            search.keep(fitted);
        }
        search
    }

    /// Fits the candidates that a screen of the nominal model finds, alone and together. `look` is asked about the
    /// best hypothesis before others are tried; whether none of them was refuted.
    pub(super) fn run(
        &mut self,
        screen: &Screen,
        mut look: impl FnMut(&Fitted) -> Look,
    ) -> Result<bool, DiagnoseError> {
        let bench = self.bench;
        for (place, screened) in kept(bench, screen, &[], KEPT).iter().enumerate() {
            // The nominal model alone may be wrong; the best of the first ones may not be far off.
            if place == FIRST && !self.goes_on(1, &mut look)? {
                return Ok(false);
            }
            self.join(0, screened);
        }
        self.join_quiet(0)?;
        for members in 1..MOST_MEMBERS {
            self.try_lags(members);
            if !self.betters(members) {
                break;
            }
            if !self.goes_on(members, &mut look)? {
                return Ok(false);
            }
            for base in self.bases(members) {
                let screen = Screen::of(bench, &self.fits[base])?;
                let members = self.fits[base].members.clone();
                let kept = kept(bench, &screen, &members, KEPT_BESIDE);
                for screened in &kept {
                    self.join(base, screened);
                }
                self.join_quiet(base)?;
                self.join_tied(base, &kept);
                self.join_components(base, &screen);
            }
        }
        self.drop_idle();
        Ok(true)
    }

    /// Whether the best hypothesis with so many members holds, or does with what it lacks.
    fn goes_on(
        &mut self,
        members: usize,
        look: &mut impl FnMut(&Fitted) -> Look,
    ) -> Result<bool, DiagnoseError> {
        let Some(best) = self.best_of(members) else {
            return Ok(true);
        };
        let lacks = match look(&self.fits[best]) {
            Look::Holds => return Ok(true),
            Look::Refuted => return Ok(false),
            Look::Lacks(candidate) => candidate,
        };
        let screen = Screen::of(self.bench, &self.fits[best])?;
        let of_other = |one: &&Screened| one.candidate == lacks;
        let Some(other) = screen.list.iter().find(of_other) else {
            return Ok(false);
        };
        let mut members = self.fits[best].members.clone();
        members.push(lacks);
        members.sort_unstable();
        let both = |search: &Self| search.fits.iter().position(|own| own.members == members);
        if both(self).is_none() {
            self.join(best, other);
        }
        Ok(both(self).is_some_and(|both| matches!(look(&self.fits[both]), Look::Holds)))
    }

    /// Where the disturbances of a hypothesis follow what it lacks, others may take their place as well as the one
    /// that shows in spite of them.
    fn join_quiet(&mut self, to: usize) -> Result<(), DiagnoseError> {
        let members = self.fits[to].members.clone();
        let Some(better) = self.best_of(members.len() + 1) else {
            return Ok(());
        };
        if self.bench.is_over_windows() || !self.follows(to, better) {
            return Ok(());
        }
        let screen = Screen::quiet(self.bench, &self.fits[to])?;
        for screened in kept(self.bench, &screen, &members, KEPT_BESIDE) {
            let name = |candidate: usize| self.bench.candidate(candidate).name();
            let mut fits = self.fits.iter();
            let is_known = fits.any(|own| {
                let mut others = own.members.iter().filter(|one| !members.contains(one));
                own.members.len() == members.len() + 1
                    && others.any(|&one| name(one) == name(screened.candidate))
            });
            if !is_known {
                self.join(to, &screened);
            }
        }
        Ok(())
    }

    /// Whether a disturbance of a hypothesis is far larger than beside a better one.
    fn follows(&self, own: usize, better: usize) -> bool {
        let [own, better] = [own, better].map(|index| &self.fits[index]);
        own.fit.is_optimum()
            && (0..self.bench.effects.info().speeds).any(|index| {
                let level = |fitted: &Fitted| {
                    let place = fitted.layout.place(Unknown::Disturbance(index)).ok()?;
                    Some(fitted.fit.values[place])
                };
                level(own) > level(better).map(|level| FOLLOWED * level)
            })
    }

    /// Fits a candidate beside the members of a hypothesis.
    fn join(&mut self, to: usize, screened: &Screened) {
        let mut members = self.fits[to].members.clone();
        members.push(screened.candidate);
        members.sort_unstable();
        if self.settled.contains(&members) {
            return;
        }
        match self.fitted(to, screened, &members) {
            Ok(fitted) if fitted.evidence.log().is_finite() => {
                if fitted.fit.is_optimum() {
                    self.settled.insert(members);
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

    /// Of two fits of a hypothesis the better one counts. What a search reached that ended before an
    /// optimum speaks for its hypothesis whatever the optimum would add.
    fn keep(&mut self, fitted: Fitted) {
        let mut fits = self.fits.iter_mut();
        match fits.find(|own| own.members == fitted.members) {
            Some(own) if own.evidence.log() < fitted.evidence.log() => *own = fitted,
            Some(_) => {}
            None => self.fits.push(fitted),
        }
    }

    /// The hypotheses with so many members that others join: the best one; that with fewest sizes of those
    /// tied with it, for a size that tells nothing hides what joins it; the best one whose search came to
    /// its end.
    fn bases(&self, members: usize) -> BTreeSet<usize> {
        let own = self.ranked(members);
        let log = |i: usize| self.log_posterior(&self.fits[i]);
        let sizes = |i: &&usize| self.bench.sizes_of(&self.fits[**i].members);
        let tied = own.iter().take_while(|i| log(own[0]) - log(**i) < TIED);
        let bases = [
            own.first(),
            tied.min_by_key(sizes),
            own.iter().find(|i| self.fits[**i].fit.is_optimum()),
        ];
        bases.into_iter().flatten().copied().collect()
    }

    /// What betters a hypothesis most may better those that are tied with it as much.
    fn join_tied(&mut self, hypothesis: usize, joined: &[Screened]) {
        let members = self.fits[hypothesis].members.len();
        let log = self.log_posterior(&self.fits[hypothesis]);
        let Some(better) = self.best_of(members + 1) else {
            return;
        };
        let better = &self.fits[better];
        let is_new = |one: &&Screened| better.members.contains(&one.candidate);
        let Some(new) = joined.iter().find(is_new) else {
            return;
        };
        if self.log_posterior(better) < log {
            return;
        }
        let tied = |fitted: &Fitted| {
            fitted.members.len() == members && log - self.log_posterior(fitted) < TIED
        };
        let others = (0..self.fits.len()).filter(|&i| i != hypothesis && tied(&self.fits[i]));
        for other in others.collect::<Vec<_>>() {
            if !self.fits[other].members.contains(&new.candidate) {
                self.join(other, new);
            }
        }
    }

    /// What is tied with a hypothesis and is a component of a vector gets the other components.
    fn join_components(&mut self, hypothesis: usize, screen: &Screen) {
        let members = self.fits[hypothesis].members.len();
        let log = self.log_posterior(&self.fits[hypothesis]);
        for other in 0..self.fits.len() {
            let fitted = &self.fits[other];
            let is_tied =
                fitted.members.len() == members && log - self.log_posterior(fitted) < TIED;
            if !is_tied {
                continue;
            }
            let own = fitted.members.clone();
            let is_sibling = |one: &&Screened| {
                let candidate = self.bench.candidate(one.candidate);
                let name = candidate.name();
                let mut own = own.iter().map(|&own| self.bench.candidate(own).name());
                candidate.is_component && one.gain > LEAST_GAIN && own.any(|own| own == name)
            };
            let siblings: Vec<Screened> = (screen.list.iter())
                .filter(is_sibling)
                .filter(|one| !own.contains(&one.candidate))
                .cloned()
                .collect();
            for one in &siblings {
                self.join(other, one);
            }
        }
    }

    fn fitted(
        &self,
        to: usize,
        screened: &Screened,
        members: &[usize],
    ) -> Result<Fitted, DiagnoseError> {
        let bench = self.bench;
        let setup = bench.setup(members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let from = &self.fits[to];
        let mut start = bench.carried(from, &estimation);
        let begin = start.clone();
        quieten(&estimation, &mut start, screened.levels)?;
        place(bench, &estimation, screened, &mut start)?;
        let fits = screened.starts.iter().map(|values| {
            let mut start = start.clone();
            for &(place, value) in values {
                start[place] = value;
            }
            bench.hide(&[screened.candidate], &estimation, &mut start)?;
            bench.fit(members, &estimation, &start)
        });
        let mut fitted = best_fit(fits)?;
        fitted.evidence.told_by_inputs = from.evidence.told_by_inputs + screened.told_by_inputs;
        self.count_late((from, &begin), &mut fitted)?;
        Ok(fitted)
    }

    /// A late channel loses rows, so that likelihoods compare by what is gained over another hypothesis, whose
    /// values are `begin`.
    fn count_late(
        &self,
        (from, begin): (&Fitted, &[f64]),
        fitted: &mut Fitted,
    ) -> Result<(), DiagnoseError> {
        let bench = self.bench;
        let is_late = |&member: &usize| matches!(bench.candidate(member).acts, Acts::Late(_));
        if fitted.members.iter().any(is_late) {
            let gain = bench.gain_of_late(&fitted.members, begin, &fitted.fit.values)?;
            fitted.evidence.log_likelihood = from.evidence.log_likelihood + gain;
        }
        Ok(())
    }

    /// Members may have led to others beside which they are not needed: the best hypothesis without each of them, from
    /// where it ended.
    fn drop_idle(&mut self) {
        while let Some(best) = self
            .best()
            .filter(|&best| self.fits[best].members.len() > 1)
        {
            let whole = self.fits[best].clone();
            for &idle in &whole.members {
                if let Ok(fitted) = self.fitted_without(&whole, idle) {
                    self.keep(fitted);
                }
            }
            if self.best() == Some(best) {
                return;
            }
        }
    }

    /// To first order a lag of a channel is a delay. The best hypotheses with a delay and so many members are fitted
    /// with a lag in its place.
    fn try_lags(&mut self, members: usize) {
        let Some(best) = self.best_of(members) else {
            return;
        };
        let log = self.log_posterior(&self.fits[best]);
        let tied = self.ranked(members).into_iter();
        let tied = tied.take_while(|&own| log - self.log_posterior(&self.fits[own]) < TIED);
        for own in tied.collect::<Vec<_>>() {
            let fitted = self.fits[own].clone();
            for &late in &fitted.members {
                if let Ok(Some(fitted)) = self.fitted_with_lag(&fitted, late) {
                    self.keep(fitted);
                }
            }
        }
    }

    /// A hypothesis with a lag in place of a member that is the delay of a channel; nothing for other members, and
    /// where the lag would be too short to be told.
    fn fitted_with_lag(
        &self,
        whole: &Fitted,
        late: usize,
    ) -> Result<Option<Fitted>, DiagnoseError> {
        let bench = self.bench;
        let Acts::Late(channel) = bench.candidate(late).acts else {
            return Ok(None);
        };
        let mut candidates = bench.effects.candidates.iter();
        let slow = candidates.position(|own| own.acts == Acts::Slow(channel));
        let delay = whole.fit.values[whole.layout.place(Unknown::SensorDelay(channel))?];
        let Some(slow) = slow.filter(|&slow| !bench.is_too_short(slow, &[delay])) else {
            return Ok(None);
        };
        let mut members = whole.members.clone();
        members.retain(|&own| own != late);
        members.push(slow);
        members.sort_unstable();
        let setup = bench.setup(&members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut start = bench.carried(whole, &estimation);
        start[estimation.layout().place(Unknown::SensorDelay(channel))?] = 0.0;
        let Some(free) = bench.of_signal(Acts::Slow(channel), &setup) else {
            return Ok(None);
        };
        start[estimation.layout().place(free.unknown)?] = delay;
        let mut fitted = bench.fit(&members, &estimation, &start)?;
        fitted.evidence.told_by_inputs = whole.evidence.told_by_inputs;
        Ok(Some(fitted))
    }

    /// A hypothesis without a member, from where it ended with it.
    fn fitted_without(&self, whole: &Fitted, idle: usize) -> Result<Fitted, DiagnoseError> {
        let bench = self.bench;
        let mut members = whole.members.clone();
        members.retain(|&own| own != idle);
        let setup = bench.setup(&members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let (mut start, neutral) = (bench.carried(whole, &estimation), estimation.nominal());
        let own = bench.own(bench.candidate(idle)).into_iter();
        let mut places: Vec<usize> = own.map(|(place, _)| place).collect();
        for free in bench.brought(idle, &setup) {
            places.push(estimation.layout().place(free.unknown)?);
        }
        for place in places {
            start[place] = neutral[place];
        }
        let mut fitted = bench.fit(&members, &estimation, &start)?;
        fitted.evidence.told_by_inputs = whole.evidence.told_by_inputs;
        let nominal = &self.fits[0];
        self.count_late((nominal, &bench.carried(nominal, &estimation)), &mut fitted)?;
        Ok(fitted)
    }

    /// The most probable hypothesis.
    fn best(&self) -> Option<usize> {
        let there = (0..self.fits.len()).filter(|&i| self.fits[i].is_there());
        let log = |i: usize| self.log_posterior(&self.fits[i]);
        there.max_by(|&a, &b| log(a).total_cmp(&log(b)))
    }

    /// Whether the last of so many members made a hypothesis more probable. Two are tried always: neither may
    /// show without the other.
    fn betters(&self, members: usize) -> bool {
        let log = |members| Some(self.log_posterior(&self.fits[self.best_of(members)?]));
        members < 2 || log(members) > log(members - 1)
    }

    /// The best hypothesis with so many members.
    fn best_of(&self, members: usize) -> Option<usize> {
        self.ranked(members).first().copied()
    }

    /// The hypotheses with so many members that are there, the most probable one first.
    fn ranked(&self, members: usize) -> Vec<usize> {
        let is_one = |fitted: &Fitted| fitted.members.len() == members && fitted.is_there();
        let own = (0..self.fits.len()).filter(|&i| is_one(&self.fits[i]));
        let mut own: Vec<usize> = own.collect();
        let log = |i: usize| self.log_posterior(&self.fits[i]);
        own.sort_by(|&a, &b| log(b).total_cmp(&log(a)));
        own
    }

    /// Logarithm of the probability, up to a constant.
    pub(super) fn log_posterior(&self, fitted: &Fitted) -> f64 {
        fitted.evidence.log() + prior(self.bench.effects, effects(self.bench, &fitted.members))
    }
}

/// The fit with the greatest evidence; why the last one failed if none is left.
fn best_fit(
    fits: impl Iterator<Item = Result<Fitted, DiagnoseError>>,
) -> Result<Fitted, DiagnoseError> {
    let (mut best, mut failure) = (None::<Fitted>, None);
    for fit in fits {
        match fit {
            Ok(fit) => {
                let log = fit.evidence.log();
                if best.as_ref().is_none_or(|best| log > best.evidence.log()) {
                    best = Some(fit);
                }
            }
            Err(error) => failure = Some(error),
        }
    }
    match (best, failure) {
        (Some(best), _) => Ok(best),
        (None, Some(error)) => Err(error),
        (None, None) => Err(DiagnoseError::NothingToFit),
    }
}

/// Puts the best step of the screen into the values: no size starts at its bound.
fn place(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    screened: &Screened,
    values: &mut [f64],
) -> Result<(), DiagnoseError> {
    let layout = estimation.layout();
    let setup = estimation.setup();
    let candidate = bench.candidate(screened.candidate);
    let first = screened.sizes.first().copied().unwrap_or(0.0);
    let at = |list: &[usize], input| list.iter().position(|own| *own == input).unwrap_or(0);
    let values_now = bench
        .effects
        .info()
        .parameter_index(&candidate.site)
        .map_or(0.0, |index| values[index]);
    let mut set = |unknown, value: f64| -> Result<(), DiagnoseError> {
        values[layout.place(unknown)?] = value;
        Ok(())
    };
    match candidate.acts {
        Acts::Items => {
            let mut direction = 0;
            for (index, part) in bench.own(candidate) {
                let unknown = Unknown::Parameter(index);
                let quantity = &bench.effects.info().parameters[index];
                match part {
                    Part::Switch => set(unknown, 1.0)?,
                    Part::Shape => {
                        set(unknown, quantity.value)?;
                        continue;
                    }
                    Part::Size | Part::Term(_) => {
                        let size = screened.sizes[direction];
                        let least = screened.deviations[direction];
                        let size = if size.abs() > 0.0 { size } else { least };
                        set(unknown, size)?;
                    }
                }
                direction += 1;
            }
        }
        Acts::Parameter(_) => {
            let info = bench.effects.info();
            if let Some(index) = info.parameter_index(&candidate.site) {
                let nominal = bench.set.parameters[index].value;
                let most = WRONG * nominal.abs();
                let [low, high] = info.parameters[index].range;
                let moved = values_now + first.clamp(-most, most);
                set(Unknown::Parameter(index), moved.clamp(low, high))?;
            }
        }
        Acts::Bias(channel) => set(Unknown::Bias(channel), first)?,
        Acts::Scale(channel) => set(Unknown::Scale(channel), 1.0 + first)?,
        Acts::Late(channel) => {
            let longest = setup.channels[channel].longest_delay.unwrap_or(0.0);
            set(Unknown::SensorDelay(channel), first.clamp(0.0, longest))?;
        }
        Acts::Lag(_) | Acts::Slow(_) => {
            if let Some(free) = bench.of_signal(candidate.acts, setup) {
                let [shortest, longest] = free.range;
                set(free.unknown, first.clamp(2.0 * shortest, 0.2 * longest))?;
            }
        }
        Acts::Delay(input) => {
            let unknown = Unknown::InputDelay(at(&setup.delayed, input));
            set(unknown, first.clamp(0.0, BELOW * bench.longest_delay()))?;
        }
    }
    Ok(())
}

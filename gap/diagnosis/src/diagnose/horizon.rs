//! Validation by free-running predictions over windows of the recordings.
//!
//! One step ahead, process noise may absorb errors that would ruin a simulation. Over a window there is no process
//! noise: the initial state is estimated, the rest is the model. As no law is exact, a part of the errors is
//! unmodelled whatever the number of rows: the likelihood is tempered so that only differences
//! beyond a tolerance count (J. W. Miller and D. B. Dunson, *Robust Bayesian inference via
//! coarsening*, Journal of the American Statistical Association 114, 2019).

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::bench::SHARES;
use super::calibration::{IMMATERIAL, TIED};
use super::coloured;
use super::scales::{deviation, rates};
use super::screen::{Screened, screen};
use super::search::Look;
use super::unknown::leftover;
use super::{Bench, Comparison, DiagnoseError, Fitted, Result, Window};
use appell_estimate::Unknown;
use appell_recordings::{DataSet, Measured, Role, Run};

/// Number of windows, spread over all runs.
const WINDOWS: usize = 40;
/// The same for a robot, which has many joints in each window.
const OF_ROBOT: usize = 20;
/// Number of rows of a window: enough to resolve an error that grows over it.
const ROWS: usize = 40;
/// Smallest number of rows of a window.
const FEWEST_ROWS: usize = 20;
/// Ratio of the longest run to the longest window.
const PARTS: f64 = 4.0;
/// Gain over windows, by other values or by one more effect, at which a hypothesis is rejected: odds of some hundred.
const REFUTED: f64 = 2.0 * TIED;
/// The same for a hypothesis to which others may be added: missing effects bias its values.
const REFUTED_ALONE: f64 = 5.0 * TIED;
/// The same, by one more effect, for a hypothesis that hardly improves on the nominal model: its gain is below this
/// part of the gain by that effect.
const IDLE: f64 = 0.2;
const REFUTED_IDLE: f64 = 3.0 * TIED;

/// Longer windows: factor on their length, their number, and their largest number of rows.
const LONGER: [(f64, usize, usize); 2] = [(4.0, 16, 80), (16.0, 8, 160)];
/// Largest length of a longer window relative to the longest run.
const LONGEST: f64 = 0.7;
/// Number of hypotheses that are compared over longer windows.
const COMPARED: usize = 8;

/// Probability of `unknown` for a gap that shows in a few windows only.
const EVENTS: f64 = 0.95;

/// The hypotheses, with the estimation problem by which they are ranked.
pub(super) struct Judged<'a> {
    pub(super) bench: Bench<'a>,
    pub(super) screen: Vec<Screened>,
    pub(super) comparison: Comparison,
    /// Windows of the training runs that the best hypothesis does not predict, once they are known.
    pub(super) outside: Option<Vec<Window>>,
}

impl<'a> Judged<'a> {
    fn of(bench: Bench<'a>, screen: Vec<Screened>, comparison: Comparison) -> Self {
        Self {
            bench,
            screen,
            comparison,
            outside: None,
        }
    }

    /// One-step predictions that find a gap, with coloured process noise as well. Over windows there is no process
    /// noise.
    pub(super) fn with_coloured_noise(mut self) -> Result<Self> {
        if !self.bench.is_over_windows() && !self.comparison.is_null() {
            self.comparison = coloured::weighed(&self.bench, self.comparison)?;
            self.outside = None;
        }
        Ok(self)
    }

    /// The result for recordings without the windows that no hypothesis predicts: without a gap elsewhere, the cause in
    /// these windows is still outside the library.
    pub(super) fn without_events(mut self) -> Self {
        if self.comparison.best().members.is_empty() {
            self.comparison.unknown = self.comparison.unknown.max(EVENTS);
        }
        self
    }
}

/// The ranking by one-step predictions if it is validated by simulations over windows, otherwise that by these.
pub(super) fn judged<'a>(
    bench: Bench<'a>,
    screen: Vec<Screened>,
    nominal: Fitted,
    over: Bench<'a>,
    stage: &mut impl FnMut(&'static str),
) -> Result<Judged<'a>> {
    let mut seen = Seen {
        over: &over,
        bench: &bench,
        again: BTreeMap::new(),
    };
    // One-step predictions of a robot take long, and their process noise absorbs what its servos leave.
    let mut stepwise = if bench.is_of_robot {
        None
    } else {
        seen.one_step(&nominal)?
    };
    let holds = stepwise.as_ref().filter(|(_, holds)| *holds);
    let again = holds.and_then(|(stepwise, _)| seen.again(stepwise.best()));
    let again = again.map(|again| again.fitted.clone());
    let none = |comparison: &Comparison| comparison.best().members.is_empty();
    let mut only_imitations = false;
    let of_windows = if holds.is_some() {
        None
    } else {
        stage("fitting simulations over windows");
        let mut found = simulated(&over, seen.comparable()).ok();
        let may_imitate = bench.is_of_robot || bench.input_innovations.is_closed;
        if let Some((_, windows)) = found.as_mut().filter(|_| may_imitate) {
            let leads = !none(windows);
            windows.without_imitations(&bench, &over, &nominal);
            only_imitations = leads && none(windows);
        }
        found
    };
    // Without an effect over its windows a robot is judged by the innovations of the nominal model, and so is a closed
    // loop whose windows show nothing but imitations of disturbances.
    let shows_nothing = of_windows
        .as_ref()
        .is_some_and(|(_, windows)| none(windows));
    if only_imitations || bench.is_of_robot && shows_nothing {
        let known = Comparison::of_known(&bench, nominal.clone(), Vec::new())?;
        stepwise = Some((known, true));
    }
    // Without an effect in either ranking there is no gap.
    let nominal_over = of_windows.as_ref().filter(|_| bench.is_of_robot);
    let nominal_over = nominal_over.map(|(_, windows)| windows.nominal().clone());
    let of_windows = of_windows.filter(|(_, windows)| {
        !(none(windows) && stepwise.as_ref().is_some_and(|(own, _)| none(own)))
    });
    let mut stepwise = stepwise.map(|(stepwise, _)| stepwise);
    if let Some((of_windows, mut comparison)) = of_windows {
        stage("testing laws outside the library");
        if let Some(mut stepwise) = outdone(&bench, &over, &nominal, comparison.best())? {
            stepwise.weigh_unknown(&bench)?;
            return Ok(Judged::of(bench, screen, stepwise));
        }
        comparison.weigh_unknown(&over)?;
        let is_open = comparison.leads_unknown() && !none(&comparison);
        let whole = if is_open {
            let again = bench.fitted_again(&over, comparison.best());
            let known = again.into_iter().map(|(_, again)| again).collect();
            // One-step predictions that diverge tell nothing.
            nothing_left(&bench, &nominal, known, stepwise.take()).unwrap_or_default()
        } else {
            None
        };
        if let Some(comparison) = whole {
            return Ok(Judged::of(bench, screen, comparison));
        }
        if none(&comparison) {
            // One-step predictions resolve smaller remainders.
            comparison.left = leftover(&bench, &nominal)?;
        }
        return Ok(Judged::of(over, of_windows, comparison));
    }
    // One-step predictions decide also if no simulation reproduces the recordings.
    let comparison = match stepwise {
        Some(stepwise) => Some(stepwise),
        None => Comparison::of(&bench, nominal, Vec::new(), |_| Look::Holds)?,
    };
    let mut comparison = comparison.ok_or(DiagnoseError::NothingToFit)?;
    stage("testing laws outside the library");
    comparison.weigh_unknown(&bench)?;
    let again = if none(&comparison) {
        nominal_over
    } else {
        again
    };
    if let Some(again) = again.filter(|_| comparison.leads_unknown()) {
        comparison.bear_out_unknown(&over, &again)?;
    }
    Ok(Judged::of(bench, screen, comparison))
}

impl Comparison {
    /// Over windows, where there is no process noise, effects may imitate the disturbances to which a controller
    /// responds: hypotheses are left out if one step ahead, with process noise, a robot is predicted worse than by the
    /// nominal model or with fewer effects, and any other closed loop if it is not predicted better. A filter does not
    /// carry the coordinates that effects add. `levels` are those of the nominal model one step ahead.
    fn without_imitations(&mut self, bench: &Bench<'_>, over: &Bench<'_>, levels: &Fitted) {
        let levels = (&levels.fit.values[..], &levels.layout);
        let taken = |fitted: &Fitted| bench.with_levels(over, fitted, levels, SHARES).ok();
        // One-step predictions that diverge tell nothing.
        let Some(without) = taken(self.nominal()) else {
            return;
        };
        let nominal = without.fit.log_likelihood;
        // The command of a controller answers disturbances, so that windows without them are biased.
        let is_closed = bench.input_innovations.is_closed && !bench.is_of_robot;
        let lowest = if is_closed { TIED } else { -TIED };
        let one_step = |fitted: &Fitted| {
            let taken = taken(fitted)?;
            if bench.is_late(&fitted.members) {
                return Some(nominal + bench.gain_of_late(&without, &taken).ok()?);
            }
            Some(taken.fit.log_likelihood)
        };
        let all: Vec<Fitted> = self.fits.iter().map(|(own, _)| own.clone()).collect();
        let within = |fitted: &Fitted| {
            let is_part = |own: &&Fitted| {
                let mut members = own.members.iter();
                !own.members.is_empty()
                    && own.members.len() < fitted.members.len()
                    && members.all(|member| fitted.members.contains(member))
            };
            all.iter().find(is_part)
        };
        self.without(|fitted| {
            let adds = |&member: &usize| bench.candidate(member).brings.is_some();
            if fitted.members.iter().any(adds) {
                return None;
            }
            let fewer = within(fitted).and_then(&one_step);
            let least = fewer.map_or(nominal, |fewer| fewer.max(nominal));
            let gain = one_step(fitted)? - least;
            (gain < lowest).then(|| {
                format!(
                    "it predicts windows better, but one step ahead it changes the log likelihood by {gain:.1}: over \
                     windows it imitates disturbances"
                )
            })
        });
    }
}

/// The comparison one step ahead, with coloured process noise, of the nominal model and a hypothesis that leads over
/// windows, if the former leads there: the command of a controller answers disturbances, so that windows without them
/// are biased.
fn outdone(
    bench: &Bench<'_>,
    over: &Bench<'_>,
    nominal: &Fitted,
    best: &Fitted,
) -> Result<Option<Comparison>> {
    let is_closed = bench.input_innovations.is_closed && !bench.is_of_robot;
    if !is_closed || best.members.is_empty() {
        return Ok(None);
    }
    // One-step predictions that diverge tell nothing.
    let Ok((_, again)) = bench.fitted_again(over, best) else {
        return Ok(None);
    };
    let both = Comparison::of_known(bench, nominal.clone(), vec![again])?;
    let weighed = coloured::weighed(bench, both)?;
    Ok(weighed.best().members.is_empty().then_some(weighed))
}

/// The ranking over longer windows, if no effect of the library explains the one-step predictions but one nearly closes
/// the gap there. Slow effects, such as friction that is hardly visible over one period, dominate the errors over many
/// periods.
pub(super) fn lengthened<'a>(
    judged: Judged<'a>,
    levels: &[(Unknown, f64)],
    whole: &DataSet,
    stage: &mut impl FnMut(&'static str),
) -> Result<Judged<'a>> {
    let mut before = length(whole);
    for (times, count, rows) in LONGER {
        let best = judged.comparison.best();
        let longer = (length(whole) * times).min(LONGEST * longest(whole));
        let is_open = judged.comparison.leads_unknown() && !best.members.is_empty();
        if !is_open || longer < 2.0 * before {
            break;
        }
        before = longer;
        stage("fitting simulations over longer windows");
        let windows = whole.windows(longer, count, rows)?;
        let over = Bench::over(&windows, &judged.bench, levels)?;
        let Ok((_, again)) = over.fitted_again(&judged.bench, best) else {
            break;
        };
        if !over.predicts(&again)? {
            break;
        }
        let fits = judged.comparison.fits.iter().take(COMPARED);
        let known = fits.filter(|(own, _)| !own.members.is_empty());
        let known = known.filter_map(|(own, _)| over.fitted_again(&judged.bench, own).ok());
        let known = known.map(|(_, again)| again).collect();
        let mut comparison = Comparison::among(&over, over.nominal()?, known)?;
        let [found, nominal] = [comparison.best(), comparison.nominal()];
        let gain = found.fit.log_likelihood - nominal.fit.log_likelihood;
        if over.left(gain) < IMMATERIAL {
            comparison.weigh_unknown(&over)?;
            return Ok(Judged {
                screen: screen(&over, comparison.nominal())?,
                bench: over,
                comparison,
                outside: None,
            });
        }
    }
    Ok(judged)
}

/// The ranking by one-step predictions, if they leave no significant remainder: an unstable mechanism cannot be predicted
/// over windows of any length. Some hypotheses may be `known`.
fn nothing_left(
    bench: &Bench<'_>,
    nominal: &Fitted,
    known: Vec<Fitted>,
    stepwise: Option<Comparison>,
) -> Result<Option<Comparison>> {
    let comparison = match stepwise {
        Some(stepwise) => Some(stepwise.with(bench, known)?),
        None => Comparison::of(bench, nominal.clone(), known, |_| Look::Holds)?,
    };
    let Some(mut comparison) = comparison else {
        return Ok(None);
    };
    comparison.stays = 1.0;
    comparison.weigh_unknown(bench)?;
    let explains = !comparison.leads_unknown() && !comparison.best().members.is_empty();
    Ok(explains.then_some(comparison))
}

/// The ranking by simulations, with some known hypotheses.
fn simulated(over: &Bench<'_>, known: Vec<Fitted>) -> Result<(Vec<Screened>, Comparison)> {
    let nominal = over.nominal()?;
    let screen = screen(over, &nominal)?;
    let comparison = Comparison::of(over, nominal, known, |_| Look::Holds)?;
    Ok((screen, comparison.ok_or(DiagnoseError::NothingToFit)?))
}

/// Validation of hypotheses of one-step predictions over windows.
struct Seen<'s, 'a> {
    over: &'s Bench<'a>,
    bench: &'s Bench<'a>,
    again: BTreeMap<Vec<usize>, Option<Again>>,
}

/// A hypothesis refitted to the windows.
struct Again {
    fitted: Fitted,
    /// Gain by the refitted values.
    gain: f64,
    /// Expected gain by one more effect, and its candidate.
    by_others: f64,
    other: Option<usize>,
}

impl Seen<'_, '_> {
    /// The ranking by one-step predictions, `None` if the windows reject it early; and whether the windows confirm it.
    /// They do not if process noise absorbs a missing effect.
    fn one_step(&mut self, nominal: &Fitted) -> Result<Option<(Comparison, bool)>> {
        let (bench, over) = (self.bench, self.over);
        let look = |fitted: &Fitted| self.look(fitted, nominal);
        let found = Comparison::of(bench, nominal.clone(), Vec::new(), look)?;
        let Some(mut comparison) = found else {
            return Ok(None);
        };
        let of_nominal = self.log_likelihood(nominal);
        let Some(again) = self.again(comparison.best()) else {
            return Ok(Some((comparison, true)));
        };
        if let Some(of_nominal) = of_nominal {
            comparison.stays = over.left(again.fitted.fit.log_likelihood - of_nominal);
        }
        let holds = again.gain.max(again.by_others) < REFUTED;
        Ok(Some((comparison, holds)))
    }

    /// Refitted hypotheses that are comparable with those of the windows: a delayed channel has other samples.
    fn comparable(&self) -> Vec<Fitted> {
        let fits = self.again.values().flatten().map(|again| &again.fitted);
        fits.filter(|fitted| !self.over.is_late(&fitted.members))
            .cloned()
            .collect()
    }

    /// A refitted hypothesis; `None` if the fit over windows fails, which does not reject it.
    fn again(&mut self, fitted: &Fitted) -> Option<&Again> {
        let again = self.again.entry(fitted.members.clone());
        let fit = || {
            let (gain, fitted) = self.over.fitted_again(self.bench, fitted).ok()?;
            let others = screen(self.over, &fitted).unwrap_or_default();
            let other = others.first();
            Some(Again {
                gain,
                by_others: other.map_or(0.0, |other| other.gain),
                other: other.map(|other| other.candidate),
                fitted,
            })
        };
        again.or_insert_with(fit).as_ref()
    }

    fn log_likelihood(&mut self, fitted: &Fitted) -> Option<f64> {
        Some(self.again(fitted)?.fitted.fit.log_likelihood)
    }

    /// Validates a hypothesis before others are added to it. A single effect may need another one; but it is rejected
    /// if it shows only one step ahead, together with others that predict.
    fn look(&mut self, fitted: &Fitted, nominal: &Fitted) -> Look {
        let of_nominal = self.log_likelihood(nominal);
        let Some(again) = self.again(fitted) else {
            return Look::Holds;
        };
        let gain = of_nominal.map(|nominal| again.fitted.fit.log_likelihood - nominal);
        let is_idle = gain.is_some_and(|gain| gain < IDLE * again.by_others);
        let lacks = |most: f64| again.by_others >= most;
        if again.gain >= REFUTED_ALONE {
            return Look::Refuted;
        }
        match (fitted.members.len(), again.other) {
            (1, Some(other)) if is_idle && lacks(REFUTED_IDLE) => Look::Lacks(other),
            (2.., _) if lacks(if is_idle { REFUTED_IDLE } else { REFUTED_ALONE }) => Look::Refuted,
            _ => Look::Holds,
        }
    }
}

/// The runs, cut into windows of half a typical period: long enough that forces affect the motion, short
/// enough that errors do not dominate it.
pub(super) fn windows(set: &DataSet, is_of_robot: bool) -> Result<DataSet> {
    let windows = if is_of_robot { OF_ROBOT } else { WINDOWS };
    Ok(set.windows(length(set), windows, ROWS)?)
}

/// Half of a typical period in s: that of a harmonic motion with the ratio of deviation to rate of a channel, the
/// shortest one of all channels.
///
/// Of a robot only positions count: torques and rates follow the noise of its controllers.
fn length(set: &DataSet) -> f64 {
    let is_position = |&column: &usize| {
        let role = set.channels[column].role;
        matches!(role, Role::Measures(Measured::Coordinate(_)))
    };
    let measured = (0..set.channels.len()).filter(|&column| set.channels[column].is_measured());
    let measured: Vec<usize> = measured.collect();
    let positions: Vec<usize> = measured.iter().copied().filter(is_position).collect();
    let measured = if set.robot.is_some() && !positions.is_empty() {
        positions
    } else {
        measured
    };
    let half = |column: usize| {
        let [rate, _] = rates(set, column)?;
        Some(PI * deviation(set, column) / rate)
    };
    let middle = measured.into_iter().filter_map(half).reduce(f64::min);
    let longest = longest(set);
    let steps = set.runs.iter().map(|run| run.sampling.step);
    let step = steps.fold(f64::INFINITY, f64::min);
    let length = middle.unwrap_or(longest).min(longest / PARTS);
    length.max(FEWEST_ROWS as f64 * step)
}

/// Duration of the longest run in s.
fn longest(set: &DataSet) -> f64 {
    set.runs.iter().map(Run::duration).fold(0.0, f64::max)
}

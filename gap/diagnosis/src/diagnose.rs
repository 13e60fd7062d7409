//! Where a model deviates from recordings, which effect is missing, and how far the effect closes the
//! gap.
//!
//! ```text
//!          --split--> training runs | held-out runs, which no fit reads
//!          --effects--> candidates: every effect at every site, derived at once with sizes of zero
//!          --stated--> gains and scales with tolerances become parameters of the spec
//!          --reading--> torques of robots: means about their rows, or readings at them
//!          --bench, evidence--> the nominal model in innovations form, parameters within tolerance
//!          --sets--> expected gain of every set of candidates, to first order
//!          --search, compare--> the most promising sets fitted; their evidence
//!          --screen--> score test of each candidate alone: gain, detectable size
//!          (robots: --by_forces--> the same by inverse dynamics of recorded motions, and the report)
//!          (other robots: --horizon, scan--> simulations over windows about the model as stated)
//!          --horizon--> validation by simulations over windows; if it fails, these rank the hypotheses
//!          --outside--> windows that no hypothesis predicts are cut, and the steps above repeated
//!          --coloured--> one-step predictions with process noise that has memory
//!          --materiality--> members that close nothing on held-out runs are no members
//!          --alternative--> other specs, fitted to the same recordings
//!          --unknown--> nonparametric laws for the residual of the best hypothesis
//!          --localise, outside--> equations, windows of time, regions, events that no hypothesis predicts
//!          --assumptions--> stated tolerances and interpolation of inputs
//!          --assembly--> hypotheses with their values and ties, as in the report
//!          --law--> the residual, measured as a force law
//!          --held_out, prediction--> prediction errors: nominal, re-fitted, with the effect, noise
//!          --budget--> the share of each effect in the gap, and the remainder
//!          --force_history, held_out, force_law--> data of the plots
//!          --experiment--> an input that discriminates between tied hypotheses
//!          --changes--> the changes of the spec under each hypothesis
//!          --yardstick, advice--> sizes relative to known quantities; which changes are certain
//! ```
//!
//! Decisions rest on the likelihood of the innovations of an extended Kalman filter whose process and measurement
//! noise are estimated under every hypothesis. On a real rig no law is exact, and process noise may absorb errors that
//! would ruin a simulation. Results are therefore validated by free-running predictions, without process noise, over
//! windows of half a typical period. If they fail, these windows rank the hypotheses, and small differences do not count.

mod advice;
mod against;
mod alternative;
mod assembly;
mod assumptions;
mod augmented;
mod bench;
mod budget;
mod by_forces;
mod calibration;
mod changes;
mod coloured;
mod compare;
mod error;
mod evidence;
mod experiment;
mod feedback;
mod force_history;
mod force_law;
mod forms;
mod gram;
mod hardware;
mod held_out;
mod horizon;
mod instead;
mod law;
mod localise;
mod materiality;
mod nominal;
mod outside;
mod prediction;
mod reading;
mod report;
mod scales;
mod scan;
mod screen;
mod search;
mod sets;
mod start_levels;
mod starts;
mod stated;
mod unknown;
mod unmodelled;
mod verdict;
mod whiteness;
mod window_bench;
mod yardstick;

use crate::effects::{Effect, EffectModel, candidates};
use appell_recordings::{DataSet, Part};

pub use crate::held_out::AHEAD;
pub use against::against;
pub use changes::{Changes, Refitted, SignalEffect};
use error::Result;
pub use error::{ChangeError, DiagnoseError};
pub use report::{
    Advice, Ahead, Before, Change, Detectable, ErrorOf, Experiment, ForceHistory, ForceLaw, Form,
    Found, GapVerdict, Hint, HowFar, Hypothesis, Interpolated, Law, Left, Limit, MissingForce,
    Open, Options, Pictures, QUANTILE, Region, Report, Share, ShareOf, Tolerances, Trace, Value,
    Where, Window, Yardstick,
};

use alternative::{Alternative, Rival};
use bench::Bench;
use compare::Comparison;
use evidence::Fitted;
use held_out::{HeldOut, Leader};
use horizon::Judged;
use scales::whole;
use screen::screen;
use stated::Stated;

/// Version of the engine. Every change that affects a number of some report increments it, so that scores and
/// calibration can state the version to which they belong.
pub const ENGINE: u32 = 30;

/// Largest number of rows and of measured values in a fit: with more, statistical errors are far below modelling errors.
const MOST_ROWS: usize = 4000;
const MOST_VALUES: usize = 20_000;
/// The same for robots, which are judged over windows.
const ROBOT_VALUES: usize = 4_000;

/// Diagnoses a data set with a library of effects. `stage` is called with the name of each stage.
pub fn diagnose(
    set: &DataSet,
    effects: &[Effect],
    options: &Options,
    mut stage: impl FnMut(&'static str),
) -> Result<Report, DiagnoseError> {
    diagnosed(set, None, effects, options, &mut stage)
}

/// The same; prediction errors on earlier recordings, which are not fitted, are reported in addition.
fn diagnosed(
    set: &DataSet,
    before: Option<&DataSet>,
    effects: &[Effect],
    options: &Options,
    mut stage: &mut dyn FnMut(&'static str),
) -> Result<Report> {
    stage("deriving the mechanism with all effects");
    let whole = set.only(Part::Fit);
    let fitted = whole.stretches(most_rows(set, options));
    if fitted.runs.is_empty() {
        return Err(DiagnoseError::NothingToFit);
    }
    let in_spec = |set: &DataSet| {
        let scales = scales::of(&fitted.bound_to(&set.mechanism));
        let mut all = candidates(&set.mechanism, &set.spec, effects, &scales)?;
        all.retain(|one| !options.present.contains(&one.name()));
        Ok::<_, DiagnoseError>(all)
    };
    let mut all = in_spec(set)?;
    let stated = Stated::of(set, &all)?;
    if let Some(stated) = &stated {
        all = stated.replaced(in_spec(&stated.set)?);
    }
    let [set, whole, fitted] = [set, &whole, &fitted].map(|own| match &stated {
        Some(stated) => stated.bound(own),
        None => own.clone(),
    });
    let set = &set;
    let added = stated.map_or_else(Vec::new, |stated| stated.candidates);
    if by_forces::applies(set, options) {
        let forces = all.iter().filter(|one| by_forces::acts(one)).cloned();
        let model = EffectModel::of_forces(&set.spec, forces.collect())?;
        let model = model.in_spec(&added);
        match by_forces::diagnose(set, before, &model, options, &mut stage) {
            // Runs may be too short for splines.
            Err(DiagnoseError::Forces(_)) => {}
            told => return told,
        }
    }
    let mut model = EffectModel::new(&set.spec, all)?.in_spec(&added);
    model.is_of_changes = before.is_some();
    let reading = reading::likely(&fitted, &model)?;
    let [set, whole, fitted] = [set, &whole, &fitted].map(|own| DataSet {
        reading,
        ..own.clone()
    });
    by_filter(&set, before, [&whole, &fitted], &model, options, stage)
}

/// The diagnosis by the innovations of a filter and by simulations. The training runs are whole runs, and segments of
/// them that are fitted, with a limited number of rows.
fn by_filter(
    set: &DataSet,
    before: Option<&DataSet>,
    [whole, segments]: [&DataSet; 2],
    model: &EffectModel,
    options: &Options,
    mut stage: impl FnMut(&'static str),
) -> Result<Report> {
    let first = judged([whole, segments], model, options, &mut stage)?;
    let training_runs = HeldOut::of(&whole.all(Part::Test), &first.bench)?;
    let (judged, rest) = without_events(first, whole, model, options, &mut stage)?;
    let is_whole = rest.is_none();
    let (fitted, rest) = (rest.as_ref()).map_or((segments, whole), |(fitted, rest)| (fitted, rest));
    let Judged {
        bench,
        screen,
        mut comparison,
        outside,
    } = judged;
    stage("measuring the residual force");
    let test = set.only(Part::Test);
    let held_out = HeldOut::of(&test, &bench)?;
    // Hypotheses whose predictions diverge keep their members.
    let _ = comparison.without_immaterial(&bench, &held_out, options);
    // A law that cannot be written is listed as failed; the diagnosis continues.
    let (laws, unwritten) = match law::lawful(&bench, &comparison) {
        Ok(laws) => (laws, None),
        Err(reason) => (Vec::new(), Some(Err(reason))),
    };
    let measured = law::measured(&laws, &mut comparison, &bench, rest, &test).or(unwritten);
    stage("fitting the alternatives");
    let alternatives = options.alternatives.iter();
    let alternatives = alternatives.map(|spec| Alternative::new(fitted, spec));
    let alternatives = alternatives.collect::<Result<Vec<_>, _>>()?;
    let (rivals, mut lost) = Rival::all(&alternatives, &bench)?;
    stage("localising the gap");
    let mut place = localise::place(&bench, &comparison)?;
    localise::tell(&bench, &comparison, &mut place)?;
    let mut report = assembly::assemble(&bench, &screen, &comparison, place.clone(), &rivals)?;
    report.failed.append(&mut lost);
    report.rows = [fitted.rows(), whole.rows()];
    report.hints = unknown::hints(&bench, comparison.nominal())?;
    report.tolerances = assumptions::tolerances(comparison.best());
    // Without a result if the filter diverges with the other interpolation.
    report.interpolated =
        assumptions::interpolated(&bench, comparison.best(), fitted).unwrap_or_default();
    let before = before.map(|set| HeldOut::of(&set.all(Part::Test), &bench));
    let before = before.transpose()?;
    let measured = report.measured(measured)?;
    stage("predicting the held-out runs");
    let leading = rivals
        .iter()
        .find(|rival| report.which[0].effects == [rival.name.clone()]);
    let rebound = match leading {
        Some(rival) => Some((
            rival,
            HeldOut::of(&test.rebound(&rival.bench.set.spec)?, &rival.bench)?,
        )),
        None => None,
    };
    let known = outside.filter(|_| is_whole);
    let sets = [(whole, &training_runs), (&test, &held_out)];
    (report.place.windows).extend(outside::of_both(&bench, comparison.best(), sets, known)?);
    let best = Leader {
        bench: &bench,
        fitted: comparison.best(),
        runs: &held_out,
        noise: prediction::noise(&bench, comparison.best())?,
        alternative: None,
        law: measured.as_ref(),
    };
    let far = |leader: &Leader<'_>| {
        held_out.how_far(&bench, &comparison, leader, before.as_ref(), options)
    };
    let rebound = rebound.as_ref();
    let mut leader = leader_of(&report, best.clone(), rebound);
    let mut how_far = far(&leader)?;
    if let Some(found) = &how_far
        && report.recall_law(found, &place)
    {
        leader = leader_of(&report, best, rebound);
        how_far = far(&leader)?;
    }
    report.settle(how_far.as_ref(), &bench);
    let horizons = held_out.horizons(&bench, &comparison, &leader)?;
    let pictures = if options.pictures {
        stage("drawing");
        Some(pictures(&held_out, &bench, &comparison, &leader, &place)?)
    } else {
        None
    };
    let experiment = match report.rivals().as_slice() {
        [first, second, ..] => {
            stage("designing the next experiment");
            let pair = [*first, *second];
            experiment::experiment(&bench, &comparison, pair, &options.limits)?
        }
        _ => None,
    };
    Ok(Report {
        how_far,
        horizons,
        pictures,
        experiment,
        ..report
    })
}

/// The leader of a report, where the `best` hypothesis of the library is known: an alternative, with its held-out runs,
/// or the law of a cause outside the library.
fn leader_of<'l>(
    report: &Report,
    best: Leader<'l>,
    rebound: Option<&'l (&Rival<'l>, HeldOut)>,
) -> Leader<'l> {
    match (rebound, best.law) {
        (Some((rival, runs)), _) => Leader {
            bench: &rival.bench,
            fitted: &rival.fitted,
            runs,
            noise: rival.noise(best.bench, &best.noise),
            alternative: Some(&rival.name),
            law: None,
        },
        (None, Some(law)) if report.which[0].is_unknown() => Leader {
            bench: &law.bench,
            fitted: &law.fitted,
            runs: &law.runs,
            ..best
        },
        _ => best,
    }
}

/// The hypotheses fitted without the windows that none of them predicts, with the segments and the runs of that fit;
/// unchanged if there are no such windows or if that fit fails.
fn without_events<'m>(
    mut first: Judged<'m>,
    whole: &DataSet,
    model: &'m EffectModel,
    options: &Options,
    stage: &mut impl FnMut(&'static str),
) -> Result<(Judged<'m>, Option<(DataSet, DataSet)>)> {
    let Some(rest) = outside::rest(&mut first, whole)? else {
        return Ok((first, None));
    };
    let fitted = rest.stretches(most_rows(&rest, options));
    stage("fitting without the windows that no hypothesis predicts");
    Ok(match judged([&rest, &fitted], model, options, stage) {
        Ok(again) => (again.without_events(), Some((fitted, rest))),
        Err(_) => (first, None),
    })
}

/// Largest number of rows in a fit.
fn most_rows(set: &DataSet, options: &Options) -> usize {
    let measured = set.channels.iter().filter(|channel| channel.is_measured());
    let most = if by_forces::is_of_robot(set, options) {
        ROBOT_VALUES
    } else {
        MOST_VALUES
    };
    MOST_ROWS.min(most / measured.count().max(1))
}

/// Data of the plots.
fn pictures(
    held_out: &HeldOut,
    bench: &Bench<'_>,
    comparison: &Comparison,
    leader: &Leader<'_>,
    place: &Where,
) -> Result<Pictures> {
    let (force_law, joints) = match leader.alternative {
        Some(_) => (None, Vec::new()),
        None => force_law::force_laws(bench, comparison, place)?,
    };
    Ok(Pictures {
        force_history: force_history::force_history(bench, comparison)?,
        traces: held_out.traces(bench, comparison, leader)?,
        force_law,
        joints,
    })
}

/// The hypotheses ranked on the training runs, whole and in segments.
fn judged<'m>(
    [whole, segments]: [&DataSet; 2],
    model: &'m EffectModel,
    options: &Options,
    stage: &mut impl FnMut(&'static str),
) -> Result<Judged<'m>> {
    let whole = &whole.bound_to(&model.mechanism);
    let mut bench = Bench::new(segments, model)?;
    bench.whole.clone_from(&whole.runs);
    bench.is_of_robot = by_forces::is_of_robot(whole, options);
    stage("fitting the nominal model");
    let nominal = bench.nominal().map_err(DiagnoseError::of_nominal)?;
    stage("screening the effects");
    let screened = screen(&bench, &nominal)?;
    stage("fitting the remaining effects");
    let windows = horizon::windows(whole, bench.is_of_robot)?;
    let levels = bench.levels(&nominal)?;
    let over = Bench::over(&windows, &bench, &levels)?;
    let judged = horizon::judged(bench, screened, nominal, over, stage)?;
    let mut judged = horizon::lengthened(judged, &levels, whole, stage)?;
    // An event is no process noise.
    if outside::rest(&mut judged, whole)?.is_some() {
        return Ok(judged);
    }
    judged.with_coloured_noise()
}

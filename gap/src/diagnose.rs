//! Where a model falls short of recordings, which effect it lacks, and how far the effect closes the
//! gap.
//!
//! ```text
//!          --split--> runs to fit | runs held out, which the last step alone can read
//!          --effects--> candidates: every effect at every place, derived at once with sizes of zero
//!          --bench, evidence--> the nominal model in innovations form, parameters within tolerance
//!          --sets--> what every set of candidates promises, to first order
//!          --search, compare--> the best ones fitted; evidence on equal terms
//!          --screen--> what each candidate would gain alone: sizes that would show, what windows miss
//!          (robots: --by_forces--> the same by forces of recorded motions, and the report)
//!          --horizon--> whether simulations over windows agree; if not, they decide instead
//!          --alternative--> other specs, fitted to the same recordings
//!          --unknown--> what no candidate explains, and what it depends on
//!          --localise, windows, outside--> equations, windows of time, regions, events that no hypothesis predicts
//!          --assembly--> hypotheses with their values and ties, in the words of the report
//!          --law--> what is left, measured as a force that depends on something
//!          --held_out, prediction--> errors of predictions: nominal, re-fitted, with the effect, noise
//!          --budget--> the part of the gap that is each effect's, and what stays
//!          --force_history, traces, force_law--> what people look at
//!          --experiment--> the input that tells tied hypotheses apart
//!          --changes--> what each hypothesis changes in the spec
//! ```
//!
//! Decisions rest on the likelihood of the innovations of an extended Kalman filter whose levels of
//! disturbance are found anew under every hypothesis. On a real rig, where no law is exact, that disturbance
//! may follow what ruins a simulation. So what is found has to hold where nothing follows: over windows of half a
//! swing. Where it does not, hypotheses are ranked by these windows, and small differences do not count.

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
mod forces;
mod forms;
mod gram;
mod hardware;
mod held_out;
mod horizon;
mod imperfection;
mod imperfections;
mod law;
mod localise;
mod nuisance;
mod options;
mod outside;
mod prediction;
mod prior;
mod report;
mod scales;
mod screen;
mod search;
mod sets;
mod starts;
mod traces;
mod twins;
mod unknown;
mod unmodelled;
mod whiteness;
mod window_bench;
mod windows;

use crate::effects::{Effect, EffectModel, candidates};
use appell_recordings::{DataSet, Part};

pub use crate::held_out::AHEAD;
pub use against::against;
pub use changes::{Changes, Refitted, SignalEffect};
pub use error::{ChangeError, DiagnoseError};
pub use options::Options;
pub use report::{
    Ahead, Before, Change, Detectable, Experiment, ForceHistory, ForceLaw, Form, Found, GapVerdict,
    Hint, HowFar, Hypothesis, Interpolated, Law, Left, Limit, MissingForce, Pictures, Region,
    Report, Share, ShareOf, Tolerances, Trace, Value, Where, Window,
};

use alternative::{Alternative, Rival};
use bench::Bench;
use compare::Comparison;
use held_out::{HeldOut, Leader};
use horizon::Judged;
use imperfection::Imperfection;
use imperfections::{immaterial, known};
use screen::Screen;

/// Version of the engine. Every change that moves a number of some report raises it, so that scores and
/// calibration tell which engine they are of.
pub const ENGINE: u32 = 10;

/// Rows that are fitted, and values in them: with so many, sizes are known far better than laws are right.
const MOST_ROWS: usize = 4000;
const MOST_VALUES: usize = 20_000;

/// Diagnoses a data set with a library of effects. `stage` is called with the name of each stage.
pub fn diagnose(
    set: &DataSet,
    effects: &[Effect],
    options: &Options,
    mut stage: impl FnMut(&'static str),
) -> Result<Report, DiagnoseError> {
    diagnosed((set, None), effects, options, &mut stage)
}

/// The same; predictions of recordings before, which nothing is fitted to, are told beside those of held-out runs.
fn diagnosed(
    (set, before): (&DataSet, Option<&DataSet>),
    effects: &[Effect],
    options: &Options,
    mut stage: &mut dyn FnMut(&'static str),
) -> Result<Report, DiagnoseError> {
    stage("deriving the mechanism with all effects");
    let whole = set.only(Part::Fit);
    let fitted = whole.stretches(most_rows(set));
    if fitted.runs.is_empty() {
        return Err(DiagnoseError::NothingToFit);
    }
    let scales = scales::of(&fitted);
    let mut all = candidates(&set.mechanism, &set.spec, effects, &scales)?;
    all.retain(|one| !options.present.contains(&one.name()));
    if by_forces::applies(set, options) {
        let forces = all.iter().filter(|one| by_forces::acts(one)).cloned();
        let model = EffectModel::of_forces(&set.spec, forces.collect())?;
        match by_forces::diagnose((set, before), &model, options, &mut stage) {
            // Runs may be too short for splines.
            Err(DiagnoseError::Forces(_)) => {}
            told => return told,
        }
    }
    let mut model = EffectModel::new(&set.spec, all)?;
    model.is_of_changes = before.is_some();
    by_filter((set, before), (&whole, &fitted), &model, options, stage)
}

/// The same by the innovations of a filter, and by simulations.
fn by_filter(
    (set, before): (&DataSet, Option<&DataSet>),
    (whole, fitted): (&DataSet, &DataSet),
    model: &EffectModel,
    options: &Options,
    mut stage: impl FnMut(&'static str),
) -> Result<Report, DiagnoseError> {
    let mut first = judged((whole, fitted), model, &mut stage)?;
    let training = HeldOut::of(&whole.all(Part::Test), &first.bench)?;
    let rest = outside::rest(&first, whole)?;
    let rest = rest.map(|rest| (rest.stretches(most_rows(&rest)), rest));
    if let Some((fitted, rest)) = &rest {
        stage("fitting without the windows that no hypothesis predicts");
        if let Ok(again) = judged((rest, fitted), model, &mut stage) {
            first = again.without_events();
        }
    }
    let (fitted, rest) = (rest.as_ref()).map_or((fitted, whole), |(fitted, rest)| (fitted, rest));
    let Judged {
        bench,
        screen,
        mut comparison,
    } = first;
    stage("measuring what is left");
    let test = set.only(Part::Test);
    // A law that cannot be written is a row, not the end.
    let (laws, unwritten) = match law::lawful(&bench, &comparison) {
        Ok(laws) => (laws, None),
        Err(reason) => (Vec::new(), Some(Err(reason))),
    };
    let fitted_laws = law::fitted(&laws, &bench, &test);
    let measured = law::measured(fitted_laws, &mut comparison, (&bench, rest)).or(unwritten);
    stage("fitting the alternatives");
    let alternatives = Alternative::all(&options.alternatives, fitted)?;
    let (rivals, mut lost) = Rival::all(&alternatives, &bench)?;
    stage("localising the gap");
    let mut place = localise::place(&bench, &comparison)?;
    windows::tell(&bench, &comparison, &mut place)?;
    let mut report = assembly::assemble(&bench, &screen, &comparison, place.clone(), &rivals)?;
    report.failed.append(&mut lost);
    report.rows = [fitted.rows(), whole.rows()];
    report.hints = assembly::hints(&bench, &comparison)?;
    report.tolerances = assumptions::tolerances(comparison.best());
    // A filter that loses the other reading says nothing of it.
    report.interpolated =
        assumptions::interpolated(&bench, comparison.best(), fitted).unwrap_or_default();
    let held_out = HeldOut::of(&test, &bench)?;
    let before = before.map(|set| HeldOut::of(&set.all(Part::Test), &bench));
    let before = before.transpose()?;
    let measured = report.measured(measured)?;
    stage("predicting the runs that were held out");
    let leading = rivals
        .iter()
        .find(|rival| report.which[0].effects == [rival.name.clone()]);
    let rebound = match leading {
        Some(rival) => Some((rival, HeldOut::of(&rival.rebound(&test)?, &rival.bench)?)),
        None => None,
    };
    for (set, runs) in [(whole, &training), (&test, &held_out)] {
        let outside = outside::windows((&bench, comparison.best()), set, &runs.recordings);
        report.place.windows.extend(outside?);
    }
    let best = Leader {
        bench: &bench,
        fitted: comparison.best(),
        runs: &held_out,
        noise: prediction::noise(&bench, comparison.best())?,
        alternative: None,
        law: measured.as_ref(),
    };
    let leader = match (&rebound, &measured) {
        (Some((rival, runs)), _) => Leader {
            bench: &rival.bench,
            fitted: &rival.fitted,
            runs,
            noise: rival.noise(&bench, &best.noise),
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
    };
    let judged = (&bench, &comparison, &leader);
    let how_far = held_out.how_far(judged, before.as_ref(), options)?;
    report.verdict = report
        .verdict
        .after(&report.which, how_far.as_ref(), bench.is_over_windows());
    let horizons = held_out.horizons(&bench, &comparison, &leader)?;
    let pictures = if options.pictures {
        stage("drawing");
        Some(pictures(&held_out, judged, &place)?)
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

/// Rows that are fitted.
fn most_rows(set: &DataSet) -> usize {
    let measured = set.channels.iter().filter(|channel| channel.is_measured());
    MOST_ROWS.min(MOST_VALUES / measured.count().max(1))
}

/// What people look at.
fn pictures(
    held_out: &HeldOut,
    (bench, comparison, leader): (&Bench<'_>, &Comparison, &Leader<'_>),
    place: &Where,
) -> Result<Pictures, DiagnoseError> {
    Ok(Pictures {
        force_history: force_history::force_history(bench, comparison)?,
        traces: held_out.traces(bench, comparison, leader)?,
        force_law: match leader.alternative {
            Some(_) => None,
            None => force_law::force_law(bench, comparison, place)?,
        },
    })
}

/// The hypotheses, judged by what they say of the runs to fit; once more beside what channels lack, where that changes
/// no prediction.
fn judged<'m>(
    (whole, fitted): (&DataSet, &DataSet),
    model: &'m EffectModel,
    stage: &mut impl FnMut(&'static str),
) -> Result<Judged<'m>, DiagnoseError> {
    let whole = whole.bound_to(&model.mechanism);
    let mut judged = judged_beside((&[], None), (&whole, fitted), model, stage)?;
    loop {
        let more = immaterial(&judged).unwrap_or_default();
        if more.is_empty() {
            return Ok(judged);
        }
        stage("fitting imperfections of channels beside every hypothesis");
        let imperfections = [judged.bench.imperfections.clone(), more].concat();
        let beside = (imperfections.as_slice(), Some(&judged));
        match judged_beside(beside, (&whole, fitted), model, stage) {
            Ok(again) => judged = again,
            Err(_) => return Ok(judged),
        }
    }
}

/// The same beside some imperfections of channels; `before` is what was found without them.
fn judged_beside<'m>(
    (imperfections, before): (&[Imperfection], Option<&Judged<'m>>),
    (whole, fitted): (&DataSet, &DataSet),
    model: &'m EffectModel,
    stage: &mut impl FnMut(&'static str),
) -> Result<Judged<'m>, DiagnoseError> {
    let mut bench = Bench::new(fitted, model, imperfections)?;
    bench.whole.clone_from(&whole.runs);
    stage("fitting the nominal model");
    let nominal = bench.nominal().map_err(DiagnoseError::of_nominal)?;
    stage("screening the effects");
    let screen = Screen::of(&bench, &nominal)?;
    stage("fitting the effects that remain");
    let windows = horizon::windows(whole)?;
    let levels = bench.levels(&nominal)?;
    let over = Bench::over(&windows, (&bench, &levels))?;
    let known = before.and_then(|before| known(&bench, before).ok());
    let hypotheses = (nominal, known.into_iter().collect());
    let judged = horizon::judged((bench, hypotheses, screen), over, stage)?;
    let mut judged = horizon::lengthened(judged, (&levels, whole), stage)?;
    judged.comparison = coloured::weighed(&judged.bench, judged.comparison)?;
    Ok(judged)
}

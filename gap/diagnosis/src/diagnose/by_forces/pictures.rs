//! Missing forces over time and over their variables, and forces of inputs with those predicted by inverse dynamics.

use super::super::force_history::median;
use super::super::force_law::{Step, over_its_variable, over_rates_and_positions};
use super::super::localise::force_unit;
use super::super::report::{ForceHistory, MissingForce, Pictures, Trace, Where};
use super::motions::{Motion, Motions};
use super::report::added;
use super::search::Findings;
use crate::effects::EffectModel;

/// Largest number of intervals over all runs, the resolution of the plot.
const PARTS: f64 = 160.0;
/// Shortest interval in s.
const SHORTEST: f64 = 0.5;

pub(super) fn of(
    model: &EffectModel,
    found: &Findings,
    training: &Motions,
    test: Option<&Motions>,
    place: &Where,
) -> Pictures {
    let info = model.info();
    let all = (0..info.speeds).map(|equation| steps(model, found, training, equation));
    let all: Vec<Vec<Step>> = all.collect();
    let force_law = place.equations.first().and_then(|first| {
        let mut names = info.states[..info.speeds].iter().map(|own| &*own.name);
        let equation = names.position(|name| name == first.name)?;
        over_its_variable(info, first, &all[equation])
    });
    Pictures {
        force_history: force_history(model, found, training),
        traces: test.map_or_else(Vec::new, |test| traces(model, found, test)),
        force_law,
        joints: over_rates_and_positions(model, &all),
    }
}

/// The missing force of each motion, M ω̇ + b − Π with re-fitted parameters.
fn steps(model: &EffectModel, found: &Findings, motions: &Motions, equation: usize) -> Vec<Step> {
    let best = found.best();
    let mut steps = Vec::new();
    for (_, own) in motions.runs() {
        for (place, motion) in own.iter().enumerate() {
            let law = -added(model, best, motions, motion)[equation];
            let left = motion.left(&best.changes)[equation];
            steps.push(Step {
                is_early: 2 * place < own.len(),
                variables: [motion.x.as_slice(), &motion.u].concat(),
                force: law + left,
                law,
            });
        }
    }
    steps
}

fn force_history(model: &EffectModel, found: &Findings, motions: &Motions) -> ForceHistory {
    let info = model.info();
    let ends = |own: &[&Motion]| match own {
        [first, .., last] => (first.t, last.t),
        _ => (0.0, 0.0),
    };
    let all = motions.runs();
    let lengths = all.iter().map(|(_, own)| ends(own));
    let length: f64 = lengths.map(|(from, to)| to - from).sum();
    let part = SHORTEST.max(length / PARTS);
    let mut runs = Vec::new();
    let mut sizes: Vec<Vec<Vec<f64>>> = vec![Vec::new(); info.speeds];
    for (run, own) in &all {
        let (from, to) = ends(own);
        // The number of intervals is small.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let parts = ((to - from) / part).ceil().max(1.0) as usize;
        let first = sizes[0].len();
        for sizes in &mut sizes {
            sizes.resize(first + parts, Vec::new());
        }
        for motion in own {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let place = (((motion.t - from) / part) as usize).min(parts - 1);
            let left = motion.left(&found.nominal().changes);
            for (sizes, force) in sizes.iter_mut().zip(left.iter()) {
                sizes[first + place].push(force.abs());
            }
        }
        runs.push(((*run).to_owned(), from, parts));
    }
    let equations = sizes.into_iter().enumerate();
    let equations = equations.map(|(equation, sizes)| MissingForce {
        name: info.states[equation].name.to_string(),
        unit: force_unit(&model.mechanism, equation),
        medians: sizes.into_iter().map(median).collect(),
    });
    ForceHistory {
        part,
        runs,
        equations: equations.collect(),
    }
}

/// The forces of the inputs in the first run, and those that the models predict for its motion.
fn traces(model: &EffectModel, found: &Findings, motions: &Motions) -> Vec<Trace> {
    let info = model.info();
    let runs = motions.runs();
    let Some((run, own)) = runs.first() else {
        return Vec::new();
    };
    let stated = found.nominal().changes.map(|_| 0.0);
    let equations = 0..info.speeds;
    let trace = |equation: usize| {
        let measured = own.iter().map(|motion| motion.driven[equation]);
        let needed = |changes| {
            let all = own.iter();
            all.map(|motion| motion.driven[equation] + motion.left(changes)[equation])
                .collect()
        };
        Trace {
            run: (*run).to_owned(),
            column: info.states[equation].name.to_string(),
            unit: force_unit(&model.mechanism, equation),
            times: own.iter().map(|motion| motion.t).collect(),
            measured: measured.collect(),
            nominal: needed(&stated),
            refitted: needed(&found.nominal().changes),
            with_effect: needed(&found.best().changes),
            deviation: found.best().variances[equation].sqrt(),
        }
    };
    equations.map(trace).collect()
}

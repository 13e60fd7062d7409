//! Missing forces over time and over their variables, and forces of inputs with those predicted by inverse dynamics.

use super::super::force_history::OfRun;
use super::super::force_law::{Step, over_its_variable, over_rates_and_positions};
use super::super::localise::force_unit;
use super::super::report::{ForceHistory, Pictures, Trace, Where};
use super::motions::Motions;
use super::report::added;
use super::search::Findings;
use crate::effects::EffectModel;

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
    let runs = motions.runs().into_iter().map(|(run, own)| {
        let forces = own.iter().map(|motion| {
            let left = motion.left(&found.nominal().changes);
            (motion.t, left.iter().copied().collect())
        });
        OfRun {
            name: run.to_owned(),
            ends: match own.as_slice() {
                [first, .., last] => [first.t, last.t],
                _ => [0.0, 0.0],
            },
            forces: forces.collect(),
        }
    });
    ForceHistory::of(model, runs.collect(), SHORTEST)
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

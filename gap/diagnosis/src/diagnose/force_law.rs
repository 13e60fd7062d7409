//! The missing force over its variable, with the law of the best hypothesis.
//!
//! The states are those of the smoother under the nominal model, whose process noise estimates the
//! missing force: the plotted data do not depend on the law.

use appell_estimate::Estimation;
use appell_runtime::model::ModelInfo;

use super::force_history::{Forces, mean_missing, median, together};
use super::localise::force_unit;
use super::prediction::followed;
use super::{Bench, Comparison, ForceLaw, Result, Where};
use crate::effects::EffectModel;

/// Largest number of steps that are evaluated.
const STEPS: usize = 6000;
/// Largest number of plotted points.
const POINTS: usize = 500;
/// Number of cells of a variable over which a law is plotted.
const PARTS: usize = 60;
/// Smallest part of its variance that a variable of a law has to explain.
const DEPENDS: f64 = 0.3;

/// One step of a recording.
pub(super) struct Step {
    /// Whether it lies in the first half of its run.
    pub(super) is_early: bool,
    /// States, then inputs.
    pub(super) variables: Vec<f64>,
    /// The force by the data.
    pub(super) force: f64,
    /// The force by the law.
    pub(super) law: f64,
}

/// The missing force of the equation with the greatest share, and of a robot those of all joints.
pub(super) fn force_laws(
    bench: &Bench<'_>,
    comparison: &Comparison,
    place: &Where,
) -> Result<(Option<ForceLaw>, Vec<[ForceLaw; 2]>)> {
    if place.equations.is_empty() {
        return Ok((None, Vec::new()));
    }
    let steps = steps(bench, comparison)?;
    let joints = if bench.is_of_robot {
        over_rates_and_positions(bench.effects, &steps)
    } else {
        Vec::new()
    };
    Ok((over_its_variable(bench.effects, place, &steps), joints))
}

/// The force in the equation with the greatest share over the variable that explains most of the law, or of the force
/// itself without a law.
pub(super) fn over_its_variable(
    model: &EffectModel,
    place: &Where,
    steps: &[Vec<Step>],
) -> Option<ForceLaw> {
    let info = model.info();
    let first = place.equations.first()?;
    let mut speeds = info.states[..info.speeds].iter();
    let steps = &steps[speeds.position(|own| own.name == first.name)?];
    let variables = info.state_len() + info.inputs.len();
    let has_law = steps.iter().any(|step| step.law != 0.0);
    let target = |step: &Step| if has_law { step.law } else { step.force };
    let varies = |v: &usize| {
        let mut values = steps.iter().map(|step| step.variables[*v].to_bits());
        values
            .next()
            .is_some_and(|first| values.any(|value| value != first))
    };
    let varying = (0..variables).filter(varies);
    let explained = varying.map(|v| (v, explained(steps, v, target)));
    let best = explained.max_by(|a, b| a.1.total_cmp(&b.1));
    let (variable, part) = best.filter(|(_, part)| part.is_finite())?;
    over(info, [&first.name, &first.unit], variable, part, steps)
}

/// The forces of all equations, each over its pseudo-velocity and over the coordinate of the same index.
pub(super) fn over_rates_and_positions(
    model: &EffectModel,
    steps: &[Vec<Step>],
) -> Vec<[ForceLaw; 2]> {
    let info = model.info();
    if info.state_len() != 2 * info.speeds {
        return Vec::new();
    }
    let of = |(equation, steps): (usize, &Vec<Step>)| {
        let unit = force_unit(&model.mechanism, equation);
        let names = [&*info.states[equation].name, &unit];
        let law = |variable: usize| {
            let part = explained(steps, variable, |step| step.law);
            over(info, names, variable, part, steps)
        };
        Some([law(equation)?, law(info.speeds + equation)?])
    };
    steps.iter().enumerate().filter_map(of).collect()
}

/// The force of an equation, its name and unit given, over a state or an input that explains a part of the law.
fn over(
    info: &ModelInfo,
    [equation, unit]: [&str; 2],
    variable: usize,
    part: f64,
    steps: &[Step],
) -> Option<ForceLaw> {
    let quantity = info.states.iter().chain(info.inputs.iter()).nth(variable)?;
    let has_law = steps.iter().any(|step| step.law != 0.0);
    let stride = steps.len().div_ceil(POINTS).max(1);
    let in_unit = |[x, force]: [f64; 2]| [x / quantity.scale, force];
    let of = |step: &Step| in_unit([step.variables[variable], step.force]);
    let medians = |of: &dyn Fn(&Step) -> f64| {
        let medians = medians(steps, variable, of).into_iter();
        medians.map(in_unit).collect()
    };
    Some(ForceLaw {
        equation: equation.to_owned(),
        unit: unit.to_owned(),
        variable: quantity.name.to_string(),
        variable_unit: quantity.unit.to_string(),
        points: steps.iter().step_by(stride).map(of).collect(),
        medians: medians(&|step| step.force),
        law: if has_law && part > DEPENDS {
            medians(&|step| step.law)
        } else {
            Vec::new()
        },
    })
}

/// The steps of all runs, by equation.
fn steps(bench: &Bench<'_>, comparison: &Comparison) -> Result<Vec<Vec<Step>>> {
    let (nominal, best) = (comparison.nominal(), comparison.best());
    let setup = bench.setup(&nominal.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let values = followed(bench, nominal, &estimation)?;
    let rows: usize = bench.recordings.iter().map(|run| run.times().len()).sum();
    let stride = rows.div_ceil(STEPS).max(1);
    let model = bench.effects.with(&bench.locked(&best.members));
    let with = &best.fit.values[..model.info().parameter_len()];
    let without = bench.without(best);
    let mut steps: Vec<Vec<Step>> = Vec::new();
    steps.resize_with(bench.effects.info().speeds, Vec::new);
    for (index, recording) in bench.recordings.iter().enumerate() {
        let states = estimation.smoothed(&values, index)?;
        let several = together(bench, recording);
        for row in (1..states.len()).step_by(stride) {
            let rows = row..(row + several).min(states.len());
            let forces = Forces::new(model, recording, &states, rows.start + rows.len() / 2);
            let missing = mean_missing(model, recording, &states, rows, &without);
            let law = forces.between(with, &without);
            for (equation, steps) in steps.iter_mut().enumerate() {
                let (force, law) = (missing[equation], law[equation]);
                if force.is_finite() && law.is_finite() {
                    steps.push(Step {
                        is_early: 2 * row < states.len(),
                        variables: forces.variables(),
                        force,
                        law,
                    });
                }
            }
        }
    }
    Ok(steps)
}

/// The steps sorted by a variable, in cells with equally many steps.
fn parts(steps: &[Step], variable: usize) -> Vec<Vec<&Step>> {
    let mut sorted: Vec<&Step> = steps.iter().collect();
    sorted.sort_by(|a, b| a.variables[variable].total_cmp(&b.variables[variable]));
    let size = sorted.len().div_ceil(PARTS).max(1);
    sorted.chunks(size).map(<[&Step]>::to_vec).collect()
}

fn mean(part: &[&Step], of: impl Fn(&Step) -> f64) -> f64 {
    part.iter().map(|step| of(step)).sum::<f64>() / part.len() as f64
}

/// Means of the variable, and medians of a force.
fn medians(steps: &[Step], variable: usize, of: impl Fn(&Step) -> f64) -> Vec<[f64; 2]> {
    let parts = parts(steps, variable);
    let point = |part: &Vec<&Step>| {
        let forces = part.iter().map(|step| of(step)).collect();
        [mean(part, |s| s.variables[variable]), median(forces)]
    };
    parts.iter().map(point).collect()
}

/// Part of the variance of a force that its means over a variable explain, cross-validated between the halves of each
/// run: forces that merely differ from run to run, or drift, are not explained.
fn explained(steps: &[Step], variable: usize, of: impl Fn(&Step) -> f64) -> f64 {
    let all: Vec<&Step> = steps.iter().collect();
    let centre = mean(&all, &of);
    let whole: f64 = steps.iter().map(|step| (of(step) - centre).powi(2)).sum();
    let missed = parts(steps, variable).into_iter().map(|part| {
        let halves = part.into_iter().partition(|step| step.is_early);
        let (early, late): (Vec<&Step>, Vec<&Step>) = halves;
        let missed = |own: &[&Step], other: &[&Step]| {
            let told = if other.is_empty() {
                centre
            } else {
                mean(other, &of)
            };
            own.iter()
                .map(|step| (of(step) - told).powi(2))
                .sum::<f64>()
        };
        missed(&early, &late) + missed(&late, &early)
    });
    1.0 - missed.sum::<f64>() / whole
}

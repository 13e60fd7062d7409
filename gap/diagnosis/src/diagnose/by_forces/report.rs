//! The report of a diagnosis by forces.

use appell_recordings::DataSet;
use nalgebra::DVector;

use super::super::assembly::{detectable, found, shortened, tied};
use super::super::budget::{self, Ends};
use super::super::calibration::IMMATERIAL;
use super::super::changes::{Changes, Equations};
use super::super::localise::{Added, force_unit};
use super::super::prediction::{Errors, Paired};
use super::super::prior::names;
use super::super::report::{
    ErrorOf, GapVerdict, HowFar, Hypothesis as Told, Report, Value, Where, Yardstick,
};
use super::super::{DiagnoseError, Options};
use super::hypothesis::Hypothesis;
use super::motions::{Motion, Motions};
use super::pictures;
use super::search::{Findings, Search};
use crate::effects::{Acts, EffectModel};

/// Length of a block of correlated errors in s.
const BLOCK_S: f64 = 2.0;

/// Motions that are not fitted.
pub(super) struct HeldOut<'m> {
    pub(super) test: Option<&'m Motions>,
    /// Those of earlier recordings.
    pub(super) before: Option<&'m Motions>,
}

/// The whole report, from the motions of training and held-out runs.
pub(super) fn report(
    model: &EffectModel,
    set: &DataSet,
    found: &Findings,
    training: &Motions,
    held_out: &HeldOut<'_>,
    options: &Options,
) -> Result<Report, DiagnoseError> {
    let test = held_out.test;
    let which = which(model, set, found, training)?;
    let tied = tied(&which);
    let (nominal, best) = (found.nominal(), found.best());
    let place = place(model, found, training);
    let far = match test {
        Some(test) => Some(HowFar {
            // The noise of the forces is that of the new recordings.
            before: held_out.before.map(|before| {
                let stated = nominal.changes.map(|_| 0.0);
                errors(before, &stated, &found.noise).mean().sqrt()
            }),
            ..how_far(model, set, found, training, test, options)?
        }),
        None => None,
    };
    let first = GapVerdict::of(&which[0], &tied);
    let stayed = nominal.variances.iter().zip(&best.variances);
    let names = model.info().speed_quantities().iter();
    let deviations = found.alone.iter().filter_map(|fitted| {
        let candidate = fitted.members[0];
        let parameter = model.first_parameter(model.candidate(candidate))?;
        Some((candidate, fitted.change(training, parameter).1?))
    });
    Ok(Report {
        verdict: first.after(&which, far.as_ref(), false),
        is_by_forces: true,
        rows: [training.all().count(), set.rows()],
        disturbances: (names.zip(stayed))
            .map(|(speed, (before, after))| (speed.name.to_string(), before.sqrt(), after.sqrt()))
            .collect(),
        pictures: (options.pictures && first != GapVerdict::NoGap)
            .then(|| pictures::of(model, found, training, test, &place)),
        place: match first {
            GapVerdict::NoGap => Where::default(),
            _ => place,
        },
        which: shortened(&which).unwrap_or(which),
        tied,
        how_far: far,
        detectable: detectable(model, set, deviations),
        independent: found.independent,
        found: self::found(model, &best.members),
        ..Report::of(set)
    })
}

/// The hypotheses of the library, and `unknown`.
fn which(
    model: &EffectModel,
    set: &DataSet,
    found: &Findings,
    motions: &Motions,
) -> Result<Vec<Told>, DiagnoseError> {
    let base = found.nominal().log;
    let mut which: Vec<Told> = Vec::new();
    for (fitted, probability) in &found.fits {
        let effects = names(model, &fitted.members);
        let probability = probability * (1.0 - found.unknown);
        // Variants of one effect are one hypothesis.
        if let Some(own) = which.iter_mut().find(|own| own.effects == effects) {
            own.probability += probability;
            continue;
        }
        which.push(Told {
            effects,
            probability,
            same_as: None,
            log_bayes_factor: Some(fitted.log - base),
            parameters: values(model, set, fitted, motions),
            changes: Some(changes(model, set, fitted, motions)?),
        });
    }
    which.push(Told::unknown(found.unknown));
    which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Ok(which)
}

/// Values of the members of a hypothesis; a size at its limit has no deviation.
fn values(
    model: &EffectModel,
    set: &DataSet,
    fitted: &Hypothesis,
    motions: &Motions,
) -> Vec<Value> {
    let info = model.info();
    let mut values = Vec::new();
    for &member in &fitted.members {
        let candidate = model.candidate(member);
        let own = match candidate.acts {
            Acts::Parameter(parameter) => vec![(parameter, "value")],
            _ => (model.own(candidate).into_iter())
                .filter(|(index, _)| motions.column(*index).is_some())
                .map(|(index, _)| (index, candidate.short(&info.parameters[index].name)))
                .collect(),
        };
        for (index, short) in own {
            let quantity = &info.parameters[index];
            let (change, deviation) = fitted.change(motions, index);
            let shaped = motions.column(index);
            let shaped = shaped.and_then(|column| motions.variables[column].shapes);
            let stated = set.parameters[index].value;
            let value = stated + change;
            let told = Value {
                name: format!("{}.{short}", candidate.name()),
                value: value / quantity.scale,
                std: deviation.unwrap_or(f64::NAN) / quantity.scale,
                unit: quantity.unit.to_string(),
                without: None,
                is_determined: deviation
                    .zip(shaped)
                    .is_none_or(|(own, z)| own < 0.5 * z.std),
                yardstick: match candidate.acts {
                    _ if shaped.is_some() => None,
                    Acts::Parameter(_) => Yardstick::of_parameter(value, stated),
                    _ => yardstick(model, motions, index, change),
                },
            };
            values.push(match shaped {
                Some(_) => told,
                None => told.of_size(stated / quantity.scale),
            });
        }
    }
    values
}

/// The forces of a size, relative to those of the inputs.
fn yardstick(
    model: &EffectModel,
    motions: &Motions,
    parameter: usize,
    size: f64,
) -> Option<Yardstick> {
    let names = model.info().speed_quantities();
    let column = motions.column(parameter)?;
    let mut squares = vec![[0.0; 2]; names.len()];
    for motion in motions.all() {
        for (equation, [added, driven]) in squares.iter_mut().enumerate() {
            *added += (size * motion.slopes[(equation, column)]).powi(2);
            *driven += motion.driven[equation].powi(2);
        }
    }
    let named = squares.into_iter().zip(names);
    Yardstick::of_forces(named)
}

/// The changes of the spec under a hypothesis.
fn changes(
    model: &EffectModel,
    set: &DataSet,
    fitted: &Hypothesis,
    motions: &Motions,
) -> Result<Changes, DiagnoseError> {
    let info = model.info();
    let all = 0..info.parameter_len();
    let changed = all.map(|index| {
        let (change, deviation) = fitted.change(motions, index);
        let shape = info.parameters[index].value;
        let stated = set.parameters.get(index).map_or(shape, |own| own.value);
        (stated + change, deviation)
    });
    let (values, deviations): (Vec<f64>, Vec<Option<f64>>) = changed.unzip();
    let members = fitted.members.iter();
    Changes::of_equations(&Equations {
        effects: model,
        members: members.map(|&member| model.candidate(member)).collect(),
        rig: &set.parameters,
        values: &values,
        deviations,
    })
}

/// Forces that the sizes of a hypothesis add.
pub(super) fn added(
    model: &EffectModel,
    fitted: &Hypothesis,
    motions: &Motions,
    motion: &Motion,
) -> DVector<f64> {
    let mut sizes = DVector::zeros(motions.variables.len());
    for &member in &fitted.members {
        let candidate = model.candidate(member);
        let own = match candidate.acts {
            Acts::Parameter(parameter) => vec![parameter],
            _ => model
                .own(candidate)
                .iter()
                .map(|(index, _)| *index)
                .collect(),
        };
        for (column, variable) in motions.variables.iter().enumerate() {
            if own.contains(&variable.parameter) {
                sizes[column] = fitted.changes[column];
            }
        }
    }
    &motion.slopes * sizes
}

/// The equations of the best hypothesis, weighted by their residual variances.
fn place(model: &EffectModel, found: &Findings, motions: &Motions) -> Where {
    let (nominal, best) = (found.nominal(), found.best());
    let Some(&first) = best.members.first() else {
        return Where::default();
    };
    let (mut squares, mut count) = (vec![0.0; model.info().speeds], 0.0_f64);
    for motion in motions.all() {
        let added = added(model, best, motions, motion);
        for (square, force) in squares.iter_mut().zip(added.iter()) {
            *square += force * force;
        }
        count += 1.0;
    }
    let of_noise = squares.iter().zip(&best.variances);
    let energies = of_noise.map(|(square, variance)| square / variance);
    let added = Added {
        energies: energies.collect(),
        squares,
        count,
        gain: best.log_likelihood - nominal.log_likelihood,
    };
    added.place(model, first)
}

/// Residual forces of the held-out runs, in units of their noise.
fn how_far(
    model: &EffectModel,
    set: &DataSet,
    found: &Findings,
    training: &Motions,
    test: &Motions,
    options: &Options,
) -> Result<HowFar, DiagnoseError> {
    let (refitted, best) = (found.nominal(), found.best());
    let errors = |changes: &DVector<f64>| errors(test, changes, &found.noise);
    let stated = errors(&DVector::zeros(training.variables.len()));
    let (refit, effect) = (errors(&refitted.changes), errors(&best.changes));
    let floor = 1.0;
    let paired = Paired::of(&[&stated, &refit, &effect]);
    let ends = Ends {
        stated: &stated,
        refitted: &refit,
        effects: &effect,
        law: None,
        floor,
        tolerance: options.tolerance.unwrap_or(IMMATERIAL),
    };
    let search = Search::new(model, set, training);
    let parts = budget::effects(model, &best.members);
    let budget = budget::of(&parts, &ends, |members| {
        let fitted = search.of(members);
        Ok(errors(
            fitted
                .as_ref()
                .map_or(&refitted.changes, |own| &own.changes),
        ))
    })?;
    let mut runs: Vec<String> = test.stretches.iter().map(|(run, _)| run.clone()).collect();
    runs.dedup();
    let speeds = model.info().speed_quantities().iter().enumerate();
    let channels = speeds.map(|(equation, speed)| {
        let rms = |errors: &Errors| errors.rms_of(equation) * found.noise[equation];
        ErrorOf {
            name: speed.name.to_string(),
            unit: force_unit(&model.mechanism, equation),
            nominal: rms(&stated),
            refitted: rms(&refit),
            with_effect: rms(&effect),
        }
    });
    Ok(HowFar {
        channels: channels.collect(),
        ..HowFar::of(&paired, 0.0, floor, budget, runs)
    })
}

/// Mean squares of the residual forces, by blocks of time.
fn errors(motions: &Motions, changes: &DVector<f64>, noise: &DVector<f64>) -> Errors {
    let mut errors = Errors::default();
    for (stretch, (_, own)) in motions.stretches.iter().enumerate() {
        let start = own.first().map_or(0.0, |first| first.t);
        for motion in own {
            // A count of blocks in memory.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let block = ((motion.t - start) / BLOCK_S) as usize;
            let left = motion.left(changes).component_div(noise);
            for (equation, force) in left.iter().enumerate() {
                errors.add([stretch, block], equation, force * force);
            }
        }
    }
    errors
}

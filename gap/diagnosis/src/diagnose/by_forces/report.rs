//! The report of a diagnosis by forces: missing forces over time and over their variables, and forces of inputs with
//! those predicted by inverse dynamics.

use nalgebra::DVector;

use super::super::assembly::{detectable, found, shortened, tied};
use super::super::budget::{self, Ends};
use super::super::calibration::{IMMATERIAL, names};
use super::super::changes::Equations;
use super::super::force_history::OfRun;
use super::super::force_law::{Step, over_its_variable, over_rates_and_positions};
use super::super::localise::{Added, force_unit};
use super::super::prediction::Errors;
use super::super::{
    Changes, ErrorOf, ForceHistory, GapVerdict, HowFar, Hypothesis as Told, Options, Pictures,
    Report, Result, Trace, Value, Where, Yardstick, whole,
};
use super::hypothesis::Hypothesis;
use super::motions::{Motion, Motions};
use super::search::{Findings, Search};
use crate::effects::Acts;

/// Length of a block of correlated errors in s.
const BLOCK_S: f64 = 2.0;
/// Shortest interval of a history in s.
const SHORTEST: f64 = 0.5;

impl Search<'_> {
    /// The whole report, with the motions of held-out runs and of earlier recordings.
    pub(super) fn report(
        &self,
        found: &Findings,
        test: Option<&Motions>,
        before: Option<&Motions>,
        options: &Options,
    ) -> Result<Report> {
        let (model, motions) = (self.effects, self.motions);
        let which = self.which(found)?;
        let tied = tied(&which);
        let (nominal, best) = (found.nominal(), found.best());
        let place = self.place(found);
        let far = match test {
            Some(test) => Some(HowFar {
                // The noise of the forces is that of the new recordings.
                before: before.map(|before| {
                    let stated = nominal.changes.map(|_| 0.0);
                    errors(before, &stated, &found.noise).mean().sqrt()
                }),
                ..self.how_far(found, test, options)?
            }),
            None => None,
        };
        let first = GapVerdict::of(&which[0], &tied);
        let stayed = nominal.variances.iter().zip(&best.variances);
        let names = model.info().speed_quantities().iter();
        let deviations = found.alone.iter().filter_map(|fitted| {
            let candidate = fitted.members[0];
            let parameter = model.first_parameter(model.candidate(candidate))?;
            Some((candidate, fitted.change(motions, parameter).1?))
        });
        Ok(Report {
            verdict: first.after(&which, far.as_ref(), false),
            is_by_forces: true,
            rows: [motions.all().count(), self.set.rows()],
            disturbances: (names.zip(stayed))
                .map(|(speed, (before, after))| {
                    (speed.name.to_string(), before.sqrt(), after.sqrt())
                })
                .collect(),
            pictures: (options.pictures && first != GapVerdict::NoGap)
                .then(|| self.pictures(found, test, &place)),
            place: match first {
                GapVerdict::NoGap => Where::default(),
                _ => place,
            },
            which: shortened(&which).unwrap_or(which),
            tied,
            how_far: far,
            detectable: detectable(model, self.set, deviations),
            independent: found.independent,
            found: self::found(model, &best.members),
            ..Report::of(self.set)
        })
    }

    /// The hypotheses of the library, and `unknown`.
    fn which(&self, found: &Findings) -> Result<Vec<Told>> {
        let base = found.nominal().log;
        let mut which: Vec<Told> = Vec::new();
        for (fitted, probability) in &found.fits {
            let effects = names(self.effects, &fitted.members);
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
                parameters: self.values(fitted),
                changes: Some(self.changes(fitted)?),
            });
        }
        which.push(Told::unknown(found.unknown));
        which.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        Ok(which)
    }

    /// Values of the members of a hypothesis; a size at its limit has no deviation.
    fn values(&self, fitted: &Hypothesis) -> Vec<Value> {
        let (motions, info) = (self.motions, self.effects.info());
        let mut values = Vec::new();
        for &member in &fitted.members {
            let candidate = self.effects.candidate(member);
            for index in self.parameters(member) {
                let Some(column) = motions.column(index) else {
                    continue;
                };
                let quantity = &info.parameters[index];
                let (change, deviation) = fitted.change(motions, index);
                let shaped = motions.variables[column].shapes;
                let stated = self.set.parameters[index].value;
                let value = stated + change;
                let short = match candidate.acts {
                    Acts::Parameter(_) => "value",
                    _ => candidate.short(&quantity.name),
                };
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
                        _ => self.yardstick(column, change),
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

    /// Indices of the parameters of a candidate.
    fn parameters(&self, candidate: usize) -> Vec<usize> {
        let candidate = self.effects.candidate(candidate);
        match candidate.acts {
            Acts::Parameter(parameter) => vec![parameter],
            _ => (self.effects.own(candidate).iter())
                .map(|own| own.0)
                .collect(),
        }
    }

    /// The forces of a size, relative to those of the inputs.
    fn yardstick(&self, column: usize, size: f64) -> Option<Yardstick> {
        let names = self.effects.info().speed_quantities();
        let mut squares = vec![[0.0; 2]; names.len()];
        for motion in self.motions.all() {
            for (equation, [added, driven]) in squares.iter_mut().enumerate() {
                *added += (size * motion.slopes[(equation, column)]).powi(2);
                *driven += motion.driven[equation].powi(2);
            }
        }
        Yardstick::of_forces(squares.into_iter().zip(names))
    }

    /// The changes of the spec under a hypothesis.
    fn changes(&self, fitted: &Hypothesis) -> Result<Changes> {
        let (info, rig) = (self.effects.info(), &self.set.parameters);
        let changed = (0..info.parameter_len()).map(|index| {
            let (change, deviation) = fitted.change(self.motions, index);
            let shape = info.parameters[index].value;
            let stated = rig.get(index).map_or(shape, |own| own.value);
            (stated + change, deviation)
        });
        let (values, deviations): (Vec<f64>, Vec<Option<f64>>) = changed.unzip();
        let members = fitted.members.iter();
        Changes::of_equations(&Equations {
            effects: self.effects,
            members: members.map(|&own| self.effects.candidate(own)).collect(),
            rig,
            values: &values,
            deviations,
        })
    }

    /// Forces that the sizes of a hypothesis add to a motion.
    fn added(&self, fitted: &Hypothesis, motion: &Motion) -> DVector<f64> {
        let variables = &self.motions.variables;
        let mut sizes = DVector::zeros(variables.len());
        for &member in &fitted.members {
            let own = self.parameters(member);
            for (column, variable) in variables.iter().enumerate() {
                if own.contains(&variable.parameter) {
                    sizes[column] = fitted.changes[column];
                }
            }
        }
        &motion.slopes * sizes
    }

    /// The equations of the best hypothesis, weighted by their residual variances.
    fn place(&self, found: &Findings) -> Where {
        let (nominal, best) = (found.nominal(), found.best());
        let Some(&first) = best.members.first() else {
            return Where::default();
        };
        let mut squares = vec![0.0; self.effects.info().speeds];
        let mut count = 0.0_f64;
        for motion in self.motions.all() {
            let added = self.added(best, motion);
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
        added.place(self.effects, first)
    }

    /// Residual forces of the held-out runs, in units of their noise.
    fn how_far(&self, found: &Findings, test: &Motions, options: &Options) -> Result<HowFar> {
        let model = self.effects;
        let (refitted, best) = (found.nominal(), found.best());
        let errors = |changes: &DVector<f64>| errors(test, changes, &found.noise);
        let stated = errors(&DVector::zeros(self.motions.variables.len()));
        let (refit, effect) = (errors(&refitted.changes), errors(&best.changes));
        let floor = 1.0;
        let ends = Ends {
            stated: &stated,
            refitted: &refit,
            effects: &effect,
            law: None,
            floor,
            tolerance: options.tolerance.unwrap_or(IMMATERIAL),
        };
        let parts = budget::effects(model, &best.members);
        let budget = budget::of(&parts, &ends, |members| {
            let fitted = self.fitted(&self.squares, members);
            let fitted = fitted.as_ref().unwrap_or(refitted);
            Ok(errors(&fitted.changes))
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
            ..HowFar::of([&stated, &refit, &effect], 0.0, floor, budget, runs)
        })
    }
}

/// Plots.
impl Search<'_> {
    fn pictures(&self, found: &Findings, test: Option<&Motions>, place: &Where) -> Pictures {
        let speeds = 0..self.effects.info().speeds;
        let all: Vec<Vec<Step>> = speeds.map(|own| self.steps(found.best(), own)).collect();
        Pictures {
            force_history: self.force_history(found.nominal()),
            traces: test.map_or_else(Vec::new, |test| self.traces(found, test)),
            force_law: over_its_variable(self.effects, place, &all),
            joints: over_rates_and_positions(self.effects, &all),
        }
    }

    /// The missing force of each motion, M ω̇ + b − Π with re-fitted parameters.
    fn steps(&self, best: &Hypothesis, equation: usize) -> Vec<Step> {
        let mut steps = Vec::new();
        for (_, own) in self.motions.runs() {
            for (place, motion) in own.iter().enumerate() {
                let law = -self.added(best, motion)[equation];
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

    fn force_history(&self, nominal: &Hypothesis) -> ForceHistory {
        let runs = self.motions.runs().into_iter().map(|(run, own)| {
            let forces = own.iter().map(|motion| {
                let left = motion.left(&nominal.changes);
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
        ForceHistory::of(self.effects, runs.collect(), SHORTEST)
    }

    /// The forces of the inputs in the first run, and those that the models predict for its motion.
    fn traces(&self, found: &Findings, motions: &Motions) -> Vec<Trace> {
        let info = self.effects.info();
        let runs = motions.runs();
        let Some((run, own)) = runs.first() else {
            return Vec::new();
        };
        let stated = found.nominal().changes.map(|_| 0.0);
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
                unit: force_unit(&self.effects.mechanism, equation),
                times: own.iter().map(|motion| motion.t).collect(),
                measured: measured.collect(),
                nominal: needed(&stated),
                refitted: needed(&found.nominal().changes),
                with_effect: needed(&found.best().changes),
                deviation: found.best().variances[equation].sqrt(),
            }
        };
        (0..info.speeds).map(trace).collect()
    }
}

/// Mean squares of the residual forces, by blocks of time.
fn errors(motions: &Motions, changes: &DVector<f64>, noise: &DVector<f64>) -> Errors {
    let mut errors = Errors::default();
    for (stretch, (_, own)) in motions.stretches.iter().enumerate() {
        let start = own.first().map_or(0.0, |first| first.t);
        for motion in own {
            let block = whole((motion.t - start) / BLOCK_S);
            let left = motion.left(changes).component_div(noise);
            for (equation, force) in left.iter().enumerate() {
                errors.add([stretch, block], equation, force * force);
            }
        }
    }
    errors
}

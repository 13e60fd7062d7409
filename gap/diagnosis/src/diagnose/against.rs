//! Detection of changes: recordings compared with earlier ones of the same rig.
//!
//! ```text
//! earlier recordings --diagnose--> effects that were missing already --apply--> a spec with these
//!                    --identify--> its parameters, each with its interval and its spread from run to run
//!                    (robots: by forces of recorded motions, as in their diagnosis)
//! new recordings     --diagnose, with these as tolerances--> differences
//! ```
//!
//! Two sets of recordings never show exactly the same rig. A difference is therefore a change only if its explanation
//! significantly improves the prediction of held-out runs, and if these were predicted less well than the earlier ones.

use appell_estimate::chi_squared_quantile;
use appell_recordings::{Channel, DataSet, Parameter, Part, Spec};
use nalgebra::{DMatrix, DVector};

use crate::effects::{Effect, EffectModel};
use crate::identify::{self, Answer, Estimate, identify};

use super::report::Told;
use super::{
    Before, Change, Changes, DiagnoseError, GapVerdict, Hypothesis, Options, Report, Result,
    by_forces, diagnose, diagnosed,
};

/// Smallest part of the mean square prediction error that was not there on the earlier recordings.
const CHANGED: f64 = 0.1;
/// Significance level of a difference of re-fitted parameters from their earlier estimates.
const LEVEL: f64 = 1e-3;
/// Relative standard deviation of the size of an effect that was found in the earlier recordings.
const FOUND: f64 = 1.0;
/// Comment above the items that are added to the spec.
const NOTE: &str = "found in the earlier recordings";

/// Diagnoses recordings against earlier ones. `stage` is called with the name of each stage.
pub fn against(
    before: &DataSet,
    now: &DataSet,
    effects: &[Effect],
    options: &Options,
    mut stage: impl FnMut(&'static str),
) -> Result<Report, DiagnoseError> {
    let whole = before.all(Part::Fit);
    let was = diagnose(&whole, effects, &Options::default(), &mut stage)?;
    let taken = was.which.iter().find(|one| one.changes.is_some());
    let Some((taken, changes)) = taken.and_then(|one| Some((one, one.changes.as_ref()?))) else {
        return Err(DiagnoseError::NothingToFit);
    };
    let spec = Spec {
        file: before.spec.file.clone(),
        text: changes.improved(&before.spec.text, NOTE)?,
    };
    stage("fitting the earlier recordings");
    let mut known = whole.rebound(&spec)?;
    start(&mut known, changes);
    undo(&mut known, taken, changes);
    let told = if was.is_by_forces {
        by_forces::told(&known)?
    } else {
        Told::of(&known)?
    };
    let mut set = now.rebound(&spec)?;
    undo(&mut set, taken, changes);
    let mut parameters = Vec::new();
    let mechanism = set.mechanism.clone();
    for (place, parameter) in mechanism.parameters.iter().enumerate() {
        let name = &parameter.label.name;
        let stated = |set: &DataSet| {
            let mut own = set.mechanism.parameters.iter();
            let place = own.position(|one| one.label.name == *name);
            place.map(|place| set.parameters[place].value)
        };
        // A difference that the data sets themselves state is kept.
        let moved = match (stated(before), stated(now)) {
            (Some(before), Some(now)) => now - before,
            _ => 0.0,
        };
        let Some(own) = told.parameters.iter().position(|one| one.name == *name) else {
            set.parameters[place].value = known.parameters[place].value + moved;
            if changes.brought.iter().any(|one| one.name == *name) {
                set.parameters[place].std = None;
            }
            continue;
        };
        known.parameters[place].value = told.parameters[own].value;
        set.parameters[place] = Parameter {
            value: told.parameters[own].value + moved,
            std: Some(told.covariance[(own, own)].sqrt()),
        };
        parameters.push(told.parameters[own].clone());
    }
    let options = Options {
        present: taken.effects.clone(),
        ..options.clone()
    };
    let mut report = diagnosed(&set, Some(&known), effects, &options, &mut stage)?;
    let is_changed = report.verdict != GapVerdict::NoGap && matters(&report, &set, &told);
    if !is_changed {
        report.verdict = GapVerdict::NoGap;
    }
    report.change = Some(Change {
        is_changed,
        before: (was.verdict, taken.effects.clone()),
        parameters,
    });
    Ok(report)
}

impl Told {
    /// By a filter.
    fn of(set: &DataSet) -> Result<Self> {
        let model = EffectModel::new(&set.spec, Vec::new())?;
        let rough = identify::Options {
            rough: true,
            ..identify::Options::tolerant()
        };
        let Answer {
            parameters,
            correlation,
            repeatability,
            ..
        } = identify(set, model.with(&[]), &rough, |_| {})?;
        let widening = widening(&parameters);
        let before = parameters.iter().map(|one| {
            let name = one.quantity.name.to_string();
            let std = widened(one, widening);
            // Values of single runs lie within the tolerance too.
            let most = one
                .tolerance
                .map_or(f64::INFINITY, |all| all.powi(2) - std.powi(2));
            let mut spreads = repeatability.iter();
            let spread = spreads.find(|own| own.name == name);
            let spread = spread.map_or(0.0, |own| own.spread);
            Before {
                name,
                value: one.value,
                std,
                spread: spread.min(most.max(0.0).sqrt()),
            }
        });
        Ok(Self::new(before.collect(), &correlation))
    }

    pub(super) fn new(parameters: Vec<Before>, correlation: &DMatrix<f64>) -> Self {
        let covariance = DMatrix::from_fn(parameters.len(), parameters.len(), |i, j| {
            let spread = if i == j { parameters[i].spread } else { 0.0 };
            correlation[(i, j)] * parameters[i].std * parameters[j].std + spread.powi(2)
        });
        Self {
            parameters,
            covariance,
        }
    }
}

/// Factor on variances for correlated residuals: the median ratio of sandwich to model-based variance over the
/// parameters that the recordings determine, as the ratio of a single one is uncertain (F. Pauli, W. Racugno,
/// L. Ventura, *Bayesian composite marginal likelihoods*, Statistica Sinica 21, 2011).
fn widening(parameters: &[Estimate]) -> f64 {
    /// Largest posterior deviation of a determined parameter relative to its tolerance.
    const TOLD: f64 = 0.7;
    let told = parameters.iter();
    let told = told.filter(|one| one.left.is_none_or(|left| left < TOLD));
    let ratios = told.map(|one| (one.robust_std / one.std).powi(2));
    let mut ratios: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
    ratios.sort_by(f64::total_cmp);
    ratios
        .get(ratios.len() / 2)
        .map_or(1.0, |ratio| ratio.max(1.0))
}

/// Posterior deviation of a parameter with the information of the recordings divided by a factor, that of its tolerance
/// unchanged.
fn widened(parameter: &Estimate, factor: f64) -> f64 {
    let known = parameter.tolerance.map_or(0.0, |std| std.powi(-2));
    let told = (parameter.std.powi(-2) - known).max(0.0);
    (known + told / factor).sqrt().recip()
}

/// Whether the explanation of a difference improves predictions significantly, and their error was smaller on the earlier
/// recordings. Parameters within the uncertainty of their earlier estimates do not count.
fn matters(report: &Report, set: &DataSet, told: &Told) -> bool {
    let far = report.how_far.as_ref();
    far.is_none_or(|far| {
        let bases = [far.nominal, far.refitted];
        let base = usize::from(is_open(report, set, told) && far.refitted < far.nominal);
        let before = far.before.unwrap_or(far.with_effect);
        let new = 1.0 - (before / bases[base]).powi(2);
        far.bettered_ci95[base][0] > 0.0 && new > CHANGED
    })
}

/// Whether the re-fitted parameters are jointly within the uncertainty of their earlier estimates, by a χ² test of
/// their differences. The earlier estimates are their priors, so that the test is conservative.
fn is_open(report: &Report, set: &DataSet, told: &Told) -> bool {
    let mut which = report.which.iter();
    let refitted = which.find(|one| one.effects.is_empty());
    let Some(changes) = refitted.and_then(|one| one.changes.as_ref()) else {
        return false;
    };
    let count = told.parameters.len();
    let moved = told.parameters.iter().map(|told| {
        let mut own = set.mechanism.parameters.iter();
        let scale = own.find(|one| one.label.name == told.name);
        let scale = scale.map_or(1.0, |one| one.label.unit.scale);
        let mut refitted = changes.parameters.iter();
        let one = refitted.find(|one| one.name == told.name);
        one.map_or(0.0, |one| (one.value - one.stated) * scale)
    });
    let moved = DVector::from_iterator(count, moved);
    let solved = told.covariance.clone().cholesky();
    let solved = solved.map(|roots| roots.solve(&moved));
    let most = chi_squared_quantile(1.0 - LEVEL, count as f64);
    count == 0 || solved.is_some_and(|solved| moved.dot(&solved) <= most)
}

/// Values and tolerances for a spec with added effects: parameters of the rig, and sizes of the effects.
fn start(set: &mut DataSet, changes: &Changes) {
    let mechanism = set.mechanism.clone();
    for (place, parameter) in mechanism.parameters.iter().enumerate() {
        let (name, scale) = (&parameter.label.name, parameter.label.unit.scale);
        let own = &mut set.parameters[place];
        if let Some(one) = changes.parameters.iter().find(|one| one.name == *name) {
            own.value = one.value * scale;
        }
        if let Some(one) = changes.brought.iter().find(|one| one.name == *name) {
            let value = one.value * scale;
            // A parameter that was not fitted is kept as known.
            let std = one.std.map(|_| FOUND * value.abs());
            *own = Parameter { value, std };
        }
    }
}

/// Removes the effects on channels and inputs that were found in the earlier recordings.
fn undo(set: &mut DataSet, taken: &Hypothesis, changes: &Changes) {
    for effect in &changes.signal_effects {
        let mut values = taken.parameters.iter();
        let own = values.find(|value| value.effect() == effect.effect);
        let mut channels = set.channels.iter();
        let is_on = |channel: &Channel| {
            let label = channel.role.label(&set.mechanism);
            channel.column == effect.on || label.is_some_and(|label| label.name == effect.on)
        };
        let (Some(size), Some(column)) = (own.map(|own| own.value), channels.position(is_on))
        else {
            continue;
        };
        let is_joined = set.channels[column].is_joined();
        for run in &mut set.runs {
            let values = &run.values[column];
            run.values[column] = match effect.acts.as_str() {
                "bias" => values.iter().map(|value| value - size).collect(),
                "scale" => values.iter().map(|value| value / size).collect(),
                // To first order a lag is a delay.
                "late" | "slow" => shifted(&run.times, values, size, false),
                "delay" => shifted(&run.times, values, -size, !is_joined),
                "lag" => lagging(&run.times, values, size, is_joined),
                _ => continue,
            };
        }
    }
}

/// The values at times shifted by `by`: held, or interpolated linearly.
fn shifted(times: &[f64], values: &[f64], by: f64, is_held: bool) -> Vec<f64> {
    let at = |&time: &f64| {
        let next = times.partition_point(|&own| own <= time + by);
        let before = next.saturating_sub(1);
        if is_held || next == 0 || next >= times.len() {
            return values[before];
        }
        let part = (time + by - times[before]) / (times[next] - times[before]);
        values[before] + part * (values[next] - values[before])
    };
    times.iter().map(at).collect()
}

/// Values after a first-order lag: at the rows for piecewise linear values, means until the next row for held ones.
fn lagging(times: &[f64], values: &[f64], time_constant: f64, is_joined: bool) -> Vec<f64> {
    let mut state = values.first().copied().unwrap_or(0.0);
    let mut after = Vec::with_capacity(values.len());
    for row in 0..values.len() {
        let step = times.get(row + 1).map_or(0.0, |next| next - times[row]);
        let left = (-step / time_constant).exp();
        if is_joined {
            after.push(state);
            let next = values.get(row + 1).copied().unwrap_or(values[row]);
            // Lag of the response to a ramp.
            let behind = if step > 0.0 {
                (next - values[row]) / step * time_constant
            } else {
                0.0
            };
            state = next - behind + (state - values[row] + behind) * left;
        } else {
            let end = values[row] + (state - values[row]) * left;
            after.push(0.5 * (state + end));
            state = end;
        }
    }
    after
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_late_comes_in_time_and_what_lags_gets_there() {
        let times: Vec<f64> = (0..100).map(|row| f64::from(row) * 0.01).collect();
        let late: Vec<f64> = times.iter().map(|t| (t - 0.025).max(0.0)).collect();
        let in_time = shifted(&times, &late, 0.025, false);
        assert!((in_time[50] - times[50]).abs() < 1e-12);
        let step: Vec<f64> = times
            .iter()
            .map(|t| if *t < 0.1 { 0.0 } else { 1.0 })
            .collect();
        let after = lagging(&times, &step, 0.1, false);
        let expected = 1.0 - (-(times[30] + 0.005 - 0.1) / 0.1_f64).exp();
        assert!((after[30] - expected).abs() < 2e-3, "{}", after[30]);
        // A ramp is delayed by the time constant.
        let after = lagging(&times, &times, 0.1, true);
        let expected = times[99] - 0.1 * (1.0 - (-times[99] / 0.1_f64).exp());
        assert!((after[99] - expected).abs() < 1e-12, "{}", after[99]);
    }
}

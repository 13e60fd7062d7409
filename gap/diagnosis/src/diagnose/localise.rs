//! Localisation of the gap: the equations in which the best hypothesis acts.
//!
//! The members add the force M Δω̇ to Appell's equation of a pseudo-velocity along the recordings. Its mean square,
//! relative to the process noise of the equation, is the share of that equation in the gap.

use appell_estimate::{Estimation, Unknown, chi_squared_probability};
use appell_runtime::model::At;
use appell_spec::Mechanism;
use appell_spec::mechanism::SpeedId;
use appell_spec::units::Unit;

use super::DiagnoseError;
use super::bench::Bench;
use super::compare::Comparison;
use super::report::{ShareOf, Where};
use crate::effects::{Acts, EffectModel};

/// Number of points along the recordings.
const PLACES: usize = 400;

/// The equations of the best hypothesis.
pub(super) fn place(bench: &Bench<'_>, comparison: &Comparison) -> Result<Where, DiagnoseError> {
    let best = comparison.best();
    let Some(&first) = best.members.first() else {
        return Ok(Where::default());
    };
    let setup = bench.setup(&best.members);
    let estimation = Estimation::new(&setup, &bench.recordings)?;
    let (augmented, layout) = (estimation.setup().model, estimation.layout());
    // Without the member, its additional coordinate is locked.
    let model = bench.effects.with(&bench.locked(&best.members));
    let info = model.info();
    let (n, s, k) = (info.state_len(), info.speeds, info.parameter_len());
    let m = info.input_len();
    let values = &best.fit.values;
    let p = &values[..k];
    let mut added = vec![0.0; s];
    let mut count = 0.0_f64;
    let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
    let (mut rates, mut a, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
    let plain = bench.without(best);
    let mut moving = vec![0.0; augmented.info().state_len()];
    for run in 0..bench.recordings.len() {
        let recording = &bench.recordings[run];
        let states = estimation.smoothed(values, run)?;
        let rows = states.len();
        let stride = (rows * bench.recordings.len() / PLACES).max(1);
        for row in (1..rows).step_by(stride) {
            let state = &states[row].state[..moving.len()];
            let x = &bench.own_states(state, augmented)[..];
            let mut u = vec![0.0; m];
            u[..recording.input_len()].copy_from_slice(recording.inputs(row));
            let t = recording.times()[row];
            let at = At { t, x, u: &u, p };
            augmented.rates(At { x: state, ..at }, &mut moving);
            let mut difference = bench.own_states(&moving, augmented);
            model.rates(At { p: &plain, ..at }, &mut rates);
            for (with, without) in difference.iter_mut().zip(&rates) {
                *with -= without;
            }
            for &member in &best.members {
                if let Acts::Lag(input) | Acts::Delay(input) = bench.candidate(member).acts {
                    model.jacobians(at, &mut rates, &mut a, &mut b);
                    let jump = recording.inputs(row)[input] - recording.inputs(row - 1)[input];
                    for state in 0..n {
                        difference[state] += b[state * m + input] * jump;
                    }
                }
            }
            model.appell(at, &mut mass, &mut bias, &mut forces);
            for i in 0..s {
                let force: f64 = (0..s).map(|j| mass[i * s + j] * difference[j]).sum();
                added[i] += force * force;
            }
            count += 1.0;
        }
    }
    let gain = best.evidence.log_likelihood - comparison.nominal().evidence.log_likelihood;
    let mut energies = Vec::new();
    for i in 0..s {
        let level = values[layout.place(Unknown::Disturbance(i))?];
        let level = level.max(bench.negligible.get(i).copied().unwrap_or_default());
        energies.push(added[i] / level.powi(2).max(f64::MIN_POSITIVE));
    }
    let added = Added {
        squares: added,
        energies,
        count,
        gain,
    };
    Ok(added.place(bench.effects, first))
}

/// Forces that a hypothesis adds to each equation.
pub(super) struct Added {
    /// Sums of their squares.
    pub(super) squares: Vec<f64>,
    /// The same relative to the noise of the equation.
    pub(super) energies: Vec<f64>,
    /// Number of forces.
    pub(super) count: f64,
    /// Gain in log likelihood by the hypothesis.
    pub(super) gain: f64,
}

impl Added {
    /// The equations by their shares; `first` is the first member of the hypothesis.
    pub(super) fn place(&self, model: &EffectModel, first: usize) -> Where {
        let info = model.info();
        let p_value = 1.0 - chi_squared_probability(2.0 * self.gain, 1.0);
        let whole: f64 = self.energies.iter().sum();
        let equations = self.energies.iter().zip(&self.squares).enumerate();
        let equations = equations.map(|(equation, (energy, square))| ShareOf {
            name: info.states[equation].name.to_string(),
            share: energy / whole.max(f64::MIN_POSITIVE),
            p_value,
            rms: (square / self.count.max(1.0)).sqrt(),
            unit: force_unit(&model.mechanism, equation),
        });
        let mut equations: Vec<ShareOf> = equations.collect();
        equations.sort_by(|a, b| b.share.total_cmp(&a.share));
        Where {
            domain: model.candidate(first).family.domain(),
            equations,
            ..Where::default()
        }
    }
}

/// SI unit of the force along a pseudo-velocity: a watt divided by its unit.
pub(super) fn force_unit(mechanism: &Mechanism, equation: usize) -> String {
    let speed = &mechanism.pseudo_velocities[SpeedId::new(equation)]
        .label
        .unit;
    let speed = Unit::si(speed.dimension).text;
    match speed.as_str() {
        "m/s" => "N".to_owned(),
        // An angle has no dimension.
        "1/s" | "rad/s" => "N m".to_owned(),
        other => format!("W/({other})"),
    }
}

//! Estimates with their intervals, and sizes relative to known quantities of the rig: 36 times the stated inertia says
//! more than 0.0043 kg m².
//!
//! What a size adds to the equations decides what it is compared with: an inertia with the stated one of the same
//! pseudo-velocity, a force with those that the stated model applies along it. So no kind of effect is treated
//! separately, and user-defined effects are compared as well.

use appell_estimate::Estimation;
use appell_runtime::model::{At, Model, Quantity};
use appell_spec::units::{self, Dimension};
use serde::Serialize;

use super::{Bench, Fitted, Result};
use crate::effects::{Candidate, Family, Part};

/// The 97.5 % quantile of the normal distribution: half of a 95 % interval in standard deviations.
pub const QUANTILE: f64 = 1.959_964;
/// Number of motions along the recordings that are evaluated.
const MOTIONS: usize = 100;
/// A relative change below this is rounding.
const ROUNDING: f64 = 1e-9;
/// A parameter that is wrong by this factor is hardly the one that was stated.
const WRONG: f64 = 2.0;
/// The inertia of a motor, reflected through its gear, may exceed that of a link, but hardly by this factor.
const REFLECTED: f64 = 10.0;

/// An estimate.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Value {
    /// Effect and parameter.
    pub name: String,
    /// Most likely value.
    pub value: f64,
    /// Standard deviation; NaN if it is undefined, as at a limit, or where sensitivities diverge and there is no prior.
    pub std: f64,
    /// Unit.
    pub unit: String,
    /// Value without the effect; `None` for a shape, which then has no meaning.
    pub without: Option<f64>,
    /// Whether the recordings determine it: the 95 % interval of a size does not reach the value without the effect, and
    /// that of a shape is less than half of the prior one.
    #[serde(rename = "determined")]
    pub is_determined: bool,
    /// Its size relative to a known quantity, where there is one.
    pub yardstick: Option<Yardstick>,
}

impl Value {
    /// The effect.
    pub(super) fn effect(&self) -> &str {
        self.name.rsplit_once('.').map_or("", |(effect, _)| effect)
    }

    /// Of a size, which has this value without the effect.
    pub(super) fn of_size(mut self, without: f64) -> Self {
        self.without = Some(without);
        let interval = QUANTILE * self.std;
        // At a limit there is no interval.
        self.is_determined = self.std.is_nan() || (self.value - without).abs() > interval;
        self
    }
}

/// A size in units of a known quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Yardstick {
    /// The size divided by the quantity.
    pub ratio: f64,
    /// The quantity.
    pub of: String,
    /// Whether it is implausible: an added inertia ten times the stated one, a parameter that is wrong by a factor of
    /// two. Forces have no such limit: a mechanism that coasts has friction and hardly any applied force.
    #[serde(rename = "large")]
    pub is_large: bool,
}

impl Yardstick {
    fn new(ratio: f64, of: String, usual: std::ops::RangeInclusive<f64>) -> Option<Self> {
        ratio.is_finite().then(|| Self {
            ratio,
            of,
            is_large: !usual.contains(&ratio),
        })
    }

    /// Of forces that are added along pseudo-velocities, against those applied by the stated model; both are sums of
    /// squares, and the largest ratio counts.
    pub(super) fn of_forces<'s>(
        squares: impl Iterator<Item = ([f64; 2], &'s Quantity)>,
    ) -> Option<Self> {
        let ratios = squares.filter_map(|([added, applied], speed)| {
            let is_there = added > 0.0 && applied > ROUNDING * added;
            is_there.then(|| ((added / applied).sqrt(), speed))
        });
        let (ratio, speed) = ratios.max_by(|a, b| a.0.total_cmp(&b.0))?;
        // An angle has no dimension.
        let is_angular = units::parse(&speed.unit).is_ok_and(|unit| {
            Dimension::NONE
                .rate()
                .is_ok_and(|rate| rate == unit.dimension)
        });
        let force = if is_angular { "torque" } else { "force" };
        let of = format!("the rms {force} applied along {}", speed.name);
        Self::new(ratio, of, 0.0..=f64::INFINITY)
    }

    /// Of the value of a parameter.
    pub(super) fn of_parameter(value: f64, stated: f64) -> Option<Self> {
        let of = "the stated value".to_owned();
        Self::new(value / stated, of, WRONG.recip()..=WRONG)
    }

    /// Of a lag or a delay.
    pub(super) fn of_time(value: f64, step: f64) -> Option<Self> {
        let of = "the sampling interval".to_owned();
        Self::new(value / step, of, 0.0..=f64::INFINITY)
    }
}

/// A recorded motion.
struct Motion {
    t: f64,
    x: Vec<f64>,
    u: Vec<f64>,
}

/// What the sizes of effects are compared with.
pub(super) struct Yardsticks<'b> {
    bench: &'b Bench<'b>,
    motions: Vec<Motion>,
}

impl<'b> Yardsticks<'b> {
    /// Along the motions of the training runs, smoothed under a hypothesis.
    pub(super) fn new(bench: &'b Bench<'b>, fitted: &Fitted) -> Result<Self> {
        let setup = bench.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let inputs = bench.effects.info().input_len();
        let mut motions = Vec::new();
        for (run, recording) in bench.recordings.iter().enumerate() {
            let states = estimation.smoothed(&fitted.fit.values, run)?;
            let stride = (states.len() * bench.recordings.len() / MOTIONS).max(1);
            for row in (1..states.len()).step_by(stride) {
                let mut u = vec![0.0; inputs];
                u[..recording.input_len()].copy_from_slice(recording.inputs(row));
                let x = bench.own_states(&states[row].state, setup.model);
                let t = recording.times()[row];
                motions.push(Motion { t, x, u });
            }
        }
        Ok(Self { bench, motions })
    }

    /// Of the size with this index among the parameters. Members with other coordinates than the recorded ones have
    /// none.
    pub(super) fn of_size(
        &self,
        fitted: &Fitted,
        candidate: &Candidate,
        size: usize,
    ) -> Option<Yardstick> {
        let bench = self.bench;
        let has_others = candidate.brings.is_some() || candidate.hides.is_some();
        let creeps = |member: &usize| bench.candidate(*member).creeps();
        // An error of a channel is no property of the rig, even if it acts in a loop.
        let is_read = candidate.family == Family::Sensor;
        if has_others || is_read || fitted.members.iter().any(creeps) {
            return None;
        }
        let model = bench.effects.with(&bench.locked(&fitted.members));
        let count = model.info().parameter_len();
        let stated = bench.set.parameters[..count].iter();
        let mut plain: Vec<f64> = stated.map(|parameter| parameter.value).collect();
        for &member in &fitted.members {
            for (index, part) in bench.own(bench.candidate(member)) {
                if !part.is_shape() && index < count {
                    plain[index] = 0.0;
                }
            }
        }
        let mut with = plain.clone();
        for (index, part) in bench.own(candidate) {
            if part.is_shape() || part == Part::Switch || index == size {
                with[index] = fitted.fit.values[index];
            }
        }
        self.added(model, &plain, &with)
    }

    /// Of what parameters add to the equations.
    fn added(&self, model: &dyn Model, plain: &[f64], with: &[f64]) -> Option<Yardstick> {
        let names = model.info().speed_quantities();
        let speeds = names.len();
        // Added and stated inertias, and squares of forces.
        let [mut inertias, mut squares] = [0, 1].map(|_| vec![[0.0; 2]; speeds]);
        for Motion { t, x, u } in &self.motions {
            let [stated, more] = [plain, with].map(|p| {
                let mut mass = vec![0.0; speeds * speeds];
                let [mut bias, mut forces] = [0, 1].map(|_| vec![0.0; speeds]);
                model.appell(At { t: *t, x, u, p }, &mut mass, &mut bias, &mut forces);
                [mass, bias, forces]
            });
            for i in 0..speeds {
                let [from, to] = [&stated, &more].map(|[mass, ..]| mass[i * (speeds + 1)]);
                inertias[i][0] += to - from;
                inertias[i][1] += from;
                let [from, to] = [&stated, &more].map(|[_, bias, forces]| forces[i] - bias[i]);
                squares[i][0] += (to - from).powi(2);
                squares[i][1] += stated[2][i].powi(2);
            }
        }
        let ratios = inertias.iter().map(|[added, stated]| added / stated);
        let ratios = ratios.zip(names).filter(|(ratio, _)| ratio.is_finite());
        let (ratio, speed) = ratios.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
        if ratio.abs() > ROUNDING {
            let of = format!("the stated inertia of {}", speed.name);
            return Yardstick::new(ratio, of, -1.0..=REFLECTED);
        }
        let named = squares.into_iter().zip(names);
        Yardstick::of_forces(named)
    }
}

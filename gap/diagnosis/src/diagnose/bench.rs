//! The estimation problem common to all hypotheses: recordings, the model with all candidates, the free
//! parameters of each hypothesis, and the initial values of a search.

use appell_estimate::{
    Coordinate, Effort, EstimateError, Estimation, Fit, Free, Innovation, Layout, Measured,
    Recording, Setup, Unknown,
};
use appell_runtime::model::Model;

use super::evidence::Evidence;
use super::feedback::{InputInnovations, for_kicks};
use super::hardware::Hardware;
use super::start_levels::{level, sizes};
use super::unmodelled::UnmodelledChannel;
use super::{DiagnoseError, Fitted, Result};
use crate::effects::{Acts, Candidate, EffectModel, Part as Role};
use crate::identify::{Options, Problem, longest_step};
use appell_recordings::{DataSet, Part, Run};

/// Largest delay of inputs and channels: the larger of a time in s and a number of steps.
const LONGEST_DELAY: f64 = 0.1;
const DELAY_STEPS: f64 = 5.0;
/// Shortest and longest lag, in steps. A shorter lag is a delay that no recording resolves, and the integration has to
/// take steps as short.
const LAG: [f64; 2] = [0.05, 500.0];
/// The same for a channel: a shorter one is modelled as a delay.
const LAG_OF_CHANNEL: [f64; 2] = [0.2, 500.0];
/// Fits end when the expected gain of a further step is below this, far below the difference of log likelihood that
/// separates hypotheses. The initial values may be far from the optimum, and valleys are narrow.
const EFFORT: Effort = Effort {
    gain: 0.05,
    steps: 60,
    floor: f64::NEG_INFINITY,
};
/// The same over windows, whose likelihood is coarsened.
const COARSE: Effort = Effort {
    gain: 0.3,
    steps: 20,
    floor: f64::NEG_INFINITY,
};
/// The same for shares of a gap, which are needed to a hundredth.
pub(super) const SHARES: Effort = Effort {
    gain: 0.5,
    steps: 12,
    floor: f64::NEG_INFINITY,
};
/// The same for noise levels that are re-estimated in the next step.
pub(super) const ROUGHLY: Effort = Effort {
    gain: 10.0,
    steps: 30,
    floor: f64::NEG_INFINITY,
};
/// Factor on the gain at which a search ends, for the fit of a law.
const FINELY: f64 = 0.02;
/// Prior standard deviation of the logarithm of a shape.
const SHAPE: f64 = 1.0;
/// Relative prior standard deviation of a parameter whose error is a hypothesis.
const WRONG: f64 = 0.5;

/// An optimisation method.
type Search = fn(&Estimation<'_>, &[f64], &[Free], Effort) -> Result<Fit, EstimateError>;

/// The estimation problem common to all hypotheses.
pub(super) struct Bench<'a> {
    /// The training runs, bound to the mechanism with all candidates.
    pub(super) set: DataSet,
    /// The whole runs of which they are segments.
    pub(super) whole: Vec<Run>,
    pub(super) effects: &'a EffectModel,
    pub(super) recordings: Vec<Recording>,
    pub(super) measured: Vec<Measured>,
    pub(super) problem: Problem,
    /// Indices of the values in its start.
    pub(super) layout: Layout,
    /// Typical sizes of the states that are not measured.
    pub(super) sizes: Vec<f64>,
    /// Innovations of feedback inputs.
    pub(super) input_innovations: InputInnovations,
    /// Recorded channels that are not in the model.
    pub(super) unmodelled: Vec<UnmodelledChannel>,
    /// Shortest step between rows.
    pub(super) step: f64,
    /// Likelihood weight of a row: 1 if all rows count as independent.
    pub(super) weight: f64,
    /// Noise levels of the filter that estimates the state before a prediction.
    pub(super) predicting: Vec<(Unknown, f64)>,
    /// Negligible process noise along each disturbance, if there is none otherwise: the unit of forces over windows.
    pub(super) negligible: Vec<f64>,
    /// Effective sample size; infinite if all rows count as independent.
    pub(super) told: f64,
    /// Prior of the sizes of effects.
    pub(super) hardware: Hardware,
    /// Whether every coordinate is driven and measured, so that simulations over windows are stable.
    pub(super) is_of_robot: bool,
}

impl<'a> Bench<'a> {
    /// For one-step predictions of the training runs, with process noise.
    pub(super) fn new(set: &DataSet, effects: &'a EffectModel) -> Result<Self> {
        Self::of(set, effects, level)
    }

    pub(super) fn of(
        set: &DataSet,
        effects: &'a EffectModel,
        mut level: impl FnMut(&Estimation<'_>, &mut Problem) -> Result<()>,
    ) -> Result<Self> {
        let set = set.bound_to(&effects.mechanism);
        let info = effects.info();
        let measured: Vec<Measured> = set.measured(info).iter().map(|(_, m)| *m).collect();
        if measured.is_empty() {
            return Err(DiagnoseError::NothingMeasured);
        }
        let recordings = set.recordings(Part::Fit, info)?;
        let steps = recordings.iter().map(|run| {
            let times = run.times();
            (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64
        });
        let step = steps.fold(f64::INFINITY, f64::min);
        let setup = Setup {
            longest_step: longest_step(effects.longest_step(&[])),
            has_corners: true,
            ..Setup::new(effects.with(&[]), &measured)
        };
        let (problem, sizes, layout) = {
            let estimation = Estimation::new(&setup, &recordings)?;
            let mut problem = Problem::of(&set, &estimation, &Options::tolerant(), &[])?;
            level(&estimation, &mut problem)?;
            let sizes = sizes(&estimation, &problem)?;
            (problem, sizes, estimation.layout())
        };
        Ok(Self {
            input_innovations: InputInnovations::of(&recordings),
            unmodelled: UnmodelledChannel::of(&set),
            whole: set.runs.clone(),
            hardware: Hardware::of(effects, &problem.wanted),
            set,
            effects,
            recordings,
            measured,
            problem,
            layout,
            sizes,
            step,
            weight: 1.0,
            predicting: Vec::new(),
            negligible: Vec::new(),
            told: f64::INFINITY,
            is_of_robot: false,
        })
    }

    /// The same problem for other equations, with the noise levels of this one.
    pub(super) fn beside<'o>(&self, effects: &'o EffectModel) -> Result<Bench<'o>> {
        let levels = |_: &Estimation<'_>, problem: &mut Problem| {
            problem.levels.clone_from(&self.problem.levels);
            Ok(())
        };
        Ok(Bench {
            whole: self.whole.clone(),
            weight: self.weight,
            predicting: self.predicting.clone(),
            negligible: self.negligible.clone(),
            told: self.told,
            ..Bench::of(&self.set, effects, levels)?
        })
    }

    pub(super) fn candidate(&self, index: usize) -> &Candidate {
        self.effects.candidate(index)
    }

    pub(super) fn longest_delay(&self) -> f64 {
        longest_delay(self.step)
    }

    /// Whether a channel measures a state that a candidate replaces by an output.
    pub(super) fn is_shown(&self, candidate: &Candidate) -> bool {
        let info = self.effects.info();
        candidate.shows.iter().any(|(state, _)| {
            let shown = info.state_index(state).map(Measured::State);
            self.measured.iter().any(|own| Some(*own) == shown)
        })
    }

    /// Members without those that add a coordinate.
    pub(super) fn locked(&self, members: &[usize]) -> Vec<usize> {
        let own = members.iter().copied();
        own.filter(|&member| self.candidate(member).brings.is_none())
            .collect()
    }

    /// Index of a state of the mechanism in a model that may have more states.
    pub(super) fn place(&self, state: usize, of: &dyn Model) -> usize {
        let own = self.effects.info().speeds;
        let coordinate = state.checked_sub(own);
        coordinate.map_or(state, |coordinate| of.info().speeds + coordinate)
    }

    /// States of the mechanism, or their rates, among those of a model that may have more.
    pub(super) fn own_states(&self, states: &[f64], of: &dyn Model) -> Vec<f64> {
        let own = 0..self.effects.info().state_len();
        own.map(|state| states[self.place(state, of)]).collect()
    }

    /// The filter of a hypothesis, with its lags and delays.
    pub(super) fn setup(&self, members: &[usize]) -> Setup<'_> {
        self.setup_of(self.effects.with(members), members)
    }

    /// The filter of a hypothesis on the equations with all compatible candidates.
    pub(super) fn whole_setup(&self, members: &[usize]) -> Setup<'_> {
        self.setup_of(self.effects.beside(members), members)
    }

    /// The quantities that the channels measure, with their indices in a model that may have more coordinates.
    pub(super) fn measured_by(&self, model: &dyn Model) -> Vec<Measured> {
        let measured = self.set.measured(model.info());
        measured.iter().map(|(_, shown)| *shown).collect()
    }

    fn setup_of<'s>(&'s self, model: &'s dyn Model, members: &[usize]) -> Setup<'s> {
        // Additional and hidden coordinates have no process noise.
        let mut measured = self.measured_by(model);
        for candidate in members.iter().map(|&member| self.candidate(member)) {
            show(candidate, model, &mut measured);
        }
        let mut setup = Setup {
            longest_step: longest_step(self.effects.longest_step(members)),
            has_corners: true,
            ..Setup::new(model, &measured)
        };
        let candidates = self.effects.candidates.iter();
        let hidden = candidates.filter(|candidate| candidate.hides.is_some());
        let forces = self.effects.info().speeds - hidden.count();
        setup.disturbances.truncate(forces);
        let members = members.iter().map(|&member| self.candidate(member).acts);
        for acts in members {
            admit(&mut setup, acts, self.step);
        }
        setup
    }

    /// The innovations of a hypothesis.
    pub(super) fn innovations(&self, fitted: &Fitted) -> Result<Vec<Vec<Innovation>>> {
        let setup = self.setup(&fitted.members);
        let estimation = Estimation::new(&setup, &self.recordings)?;
        Ok(estimation.innovations(&fitted.fit.values)?)
    }

    /// Difference in log likelihood between a hypothesis with delayed channels and another one, on the rows that the
    /// delay leaves.
    pub(super) fn gain_of_late(&self, from: &Fitted, to: &Fitted) -> Result<f64> {
        let (mut before, mut after) = (self.setup(&from.members), self.setup(&to.members));
        let channels = before.channels.iter_mut().zip(&mut after.channels);
        for (index, (before, after)) in channels.enumerate() {
            if let Some(longest) = &mut after.longest_delay {
                let delay = to.fit.values[to.layout.place(Unknown::SensorDelay(index))?];
                *longest = delay.max(f64::MIN_POSITIVE);
                before.longest_delay = Some(*longest);
            }
        }
        let of = |setup: &Setup<'_>, fitted: &Fitted| {
            let estimation = Estimation::new(setup, &self.recordings)?;
            Ok::<f64, DiagnoseError>(estimation.log_likelihood(&self.carried(fitted, &estimation))?)
        };
        Ok(self.weight * (of(&after, to)? - of(&before, from)?))
    }

    /// Whether members delay channels.
    pub(super) fn is_late(&self, members: &[usize]) -> bool {
        let mut members = members.iter();
        members.any(|&member| matches!(self.candidate(member).acts, Acts::Late(_)))
    }

    /// Indices of the parameters of a candidate, with their roles.
    pub(super) fn own(&self, candidate: &Candidate) -> Vec<(usize, Role)> {
        self.effects.own(candidate)
    }

    /// Whether a member is the error of a parameter.
    pub(super) fn is_wrong(&self, members: &[usize], unknown: Unknown) -> bool {
        members.iter().any(|&member| {
            let is_wrong = self.candidate(member).acts.in_error();
            is_wrong == Some(unknown)
        })
    }

    /// The free values of a hypothesis: parameters of the mechanism, parameters of the members, noise levels.
    pub(super) fn free(&self, members: &[usize], setup: &Setup<'_>) -> Vec<Free> {
        let mut free: Vec<Free> = Vec::new();
        for one in &self.problem.wanted {
            match one.prior {
                Some([value, _]) if self.is_wrong(members, one.unknown) => {
                    free.push(one.around(value, wrong(value)));
                }
                _ => free.push(*one),
            }
        }
        let is_wanted = |one: &Free| self.wanted(one.unknown).is_some();
        for &member in members {
            let brought = self.brought(member, setup).into_iter();
            free.extend(brought.filter(|one| !is_wanted(one)));
        }
        free.extend(&self.problem.levels);
        free
    }

    /// A value with a tolerance.
    pub(super) fn wanted(&self, unknown: Unknown) -> Option<&Free> {
        let mut wanted = self.problem.wanted.iter();
        wanted.find(|own| own.unknown == unknown)
    }

    /// The errors of gains and scales with tolerances that are not members.
    pub(super) fn stated_beside(&self, members: &[usize]) -> impl Iterator<Item = &Candidate> {
        let candidates = self.effects.candidates.iter().enumerate();
        let beside = candidates.filter(|(index, own)| {
            let unknown = own.acts.in_error().filter(|_| own.has_tolerance);
            !members.contains(index) && unknown.is_some_and(|own| self.wanted(own).is_some())
        });
        beside.map(|(_, own)| own)
    }

    /// The free parameters of a member.
    pub(super) fn brought(&self, member: usize, setup: &Setup<'_>) -> Vec<Free> {
        let candidate = self.candidate(member);
        if candidate.acts != Acts::Items {
            return self.of_signal(candidate.acts, setup).into_iter().collect();
        }
        let info = self.effects.info();
        let own = self.own(candidate).into_iter();
        own.filter(|(_, role)| *role != Role::Switch)
            .map(|(index, role)| {
                let quantity = &info.parameters[index];
                let [low, high] = quantity.range;
                let free = Free::of(Unknown::Parameter(index)).within(low, high);
                match role {
                    Role::Shape(None) => Free {
                        coordinate: Coordinate::Logarithm,
                        ..free.around(quantity.value, SHAPE)
                    },
                    Role::Shape(Some(std)) => free.around(quantity.value, std),
                    Role::Term([expected, deviation]) => free.around(expected, deviation),
                    Role::Size | Role::Switch => free,
                }
            })
            .collect()
    }

    /// Sets scales with tolerances to those of perfect channels; effects of members remain.
    pub(super) fn perfected(&self, fitted: &mut Fitted) -> Result<()> {
        for free in &self.problem.wanted {
            let is_scale = matches!(free.unknown, Unknown::Scale(_));
            if is_scale && !self.is_wrong(&fitted.members, free.unknown) {
                let place = fitted.layout.place(free.unknown)?;
                fitted.fit.values[place] = 1.0;
            }
        }
        Ok(())
    }

    /// The free parameter of an effect on an input or a channel; `None` for others.
    pub(super) fn of_signal(&self, acts: Acts, setup: &Setup<'_>) -> Option<Free> {
        let at = |list: &[usize], input: usize| list.iter().position(|own| *own == input);
        match acts {
            Acts::Items | Acts::Parameter(_) => None,
            Acts::Bias(channel) => Some(Free::of(Unknown::Bias(channel))),
            Acts::Scale(channel) => Some(Free::of(Unknown::Scale(channel))),
            Acts::Late(channel) => {
                let free = Free::of(Unknown::SensorDelay(channel));
                Some(free.within(0.0, self.longest_delay()))
            }
            Acts::Slow(channel) => {
                let place = setup.lag_of_channel(channel)?;
                let [shortest, longest] = LAG_OF_CHANNEL.map(|part| part * self.step);
                Some(Free::of(Unknown::Lag(place)).within(shortest, longest))
            }
            Acts::Lag(input) => {
                let place = at(&setup.lagging, input)?;
                let [shortest, longest] = LAG.map(|part| part * setup.longest_step);
                Some(Free::of(Unknown::Lag(place)).within(shortest, longest))
            }
            Acts::Delay(input) => {
                let place = at(&setup.delayed, input)?;
                Some(Free::of(Unknown::InputDelay(place)).within(0.0, self.longest_delay()))
            }
        }
    }

    /// Whether a lag is so short that it is equivalent to a delay.
    pub(super) fn is_too_short(&self, candidate: usize, sizes: &[f64]) -> bool {
        let shortest = match self.candidate(candidate).acts {
            Acts::Slow(_) => LAG_OF_CHANNEL[0],
            Acts::Lag(_) => LAG[0],
            _ => return false,
        };
        sizes.iter().all(|size| *size < shortest * self.step)
    }

    /// Number of sizes and shapes of some members.
    pub(super) fn sizes_of(&self, members: &[usize]) -> usize {
        let own = |candidate: &Candidate| {
            let roles = candidate.parameters.iter().map(|(_, role)| *role);
            roles.filter(|role| *role != Role::Switch).count().max(1)
        };
        let members = members.iter().map(|&member| self.candidate(member));
        members.map(own).sum()
    }

    /// The parameters of a fit with the sizes of its members set to zero.
    pub(super) fn without(&self, fitted: &Fitted) -> Vec<f64> {
        let parameters = self.effects.with(&fitted.members).info().parameter_len();
        let mut plain = fitted.fit.values[..parameters].to_vec();
        for &member in &fitted.members {
            let candidate = self.candidate(member);
            for (index, part) in self.own(candidate) {
                if !part.is_shape() {
                    plain[index] = 0.0;
                }
            }
            if let Acts::Parameter(index) = candidate.acts {
                plain[index] = self.set.parameters[index].value;
            }
        }
        plain
    }
}

/// Fits of hypotheses.
impl Bench<'_> {
    /// Fits a hypothesis from initial values.
    pub(super) fn fit(
        &self,
        effort: Effort,
        members: &[usize],
        estimation: &Estimation<'_>,
        start: &[f64],
    ) -> Result<Fitted> {
        self.fit_by(Fit::quick, effort, members, estimation, start)
    }

    /// The effort of a fit.
    pub(super) fn effort(&self) -> Effort {
        if self.is_over_windows() {
            COARSE
        } else {
            EFFORT
        }
    }

    /// The effort of a fit that is given up where it stays far below a log posterior.
    pub(super) fn above(&self, floor: f64) -> Effort {
        Effort {
            floor,
            ..self.effort()
        }
    }

    /// The effort of a fit to a twentieth of a standard deviation, for values that are reported alone.
    pub(super) fn finely(&self) -> Effort {
        Effort {
            gain: FINELY * self.effort().gain,
            ..self.effort()
        }
    }

    /// Fits a hypothesis by an optimisation method.
    pub(super) fn fit_by(
        &self,
        search: Search,
        effort: Effort,
        members: &[usize],
        estimation: &Estimation<'_>,
        start: &[f64],
    ) -> Result<Fitted> {
        let free = self.free(members, estimation.setup());
        let fit = if self.is_over_windows() && self.is_late(members) {
            // With the delay the states at the beginnings of the windows change.
            let mut start = start.to_vec();
            self.begin_later(estimation, &mut start)?;
            start = self
                .weighed(estimation, &start, &free, search, effort)?
                .values;
            self.begin_later(estimation, &mut start)?;
            self.weighed(estimation, &start, &free, search, effort)?
        } else {
            self.weighed(estimation, start, &free, search, effort)?
        };
        let by_inputs = for_kicks(&self.input_innovations, self.weight, estimation, &fit)?;
        let evidence = Evidence::of(self, members, &fit, by_inputs);
        Ok(Fitted {
            members: members.to_vec(),
            layout: estimation.layout(),
            fit,
            evidence,
            coloured: 0.0,
        })
    }

    /// A fit with weighted rows: the objective is divided by the weight, so that the prior is scaled instead.
    pub(super) fn weighed(
        &self,
        estimation: &Estimation<'_>,
        start: &[f64],
        free: &[Free],
        search: Search,
        effort: Effort,
    ) -> Result<Fit> {
        let firm = free.iter().map(|one| Free {
            prior: (one.prior).map(|[value, deviation]| [value, deviation * self.weight.sqrt()]),
            ..*one
        });
        let effort = Effort {
            gain: effort.gain / self.weight,
            floor: effort.floor / self.weight,
            ..effort
        };
        let fit = search(estimation, start, &firm.collect::<Vec<_>>(), effort)?;
        Ok(Fit {
            free: free.to_vec(),
            log_likelihood: self.weight * fit.log_likelihood,
            log_posterior: self.weight * fit.log_posterior,
            information: self.weight * fit.information,
            curvature: self.weight * fit.curvature,
            gain: self.weight * fit.gain,
            ..fit
        })
    }
}

/// Replaces measured states by the outputs of a member.
fn show(member: &Candidate, model: &dyn Model, measured: &mut [Measured]) {
    let info = model.info();
    for (state, output) in &member.shows {
        let (state, output) = (info.state_index(state), info.output_index(output));
        let (Some(state), Some(output)) = (state, output) else {
            continue;
        };
        let of_state = measured.iter_mut();
        for shown in of_state.filter(|shown| **shown == Measured::State(state)) {
            *shown = Measured::Output(output);
        }
    }
}

/// Adds an effect on an input or a channel to a filter, with rows a `step` apart.
fn admit(setup: &mut Setup<'_>, acts: Acts, step: f64) {
    match acts {
        Acts::Lag(input) => {
            setup.lagging.push(input);
            setup.longest_step = setup.longest_step.min(step);
        }
        Acts::Delay(input) => setup.delayed.push(input),
        Acts::Late(channel) => setup.channels[channel].longest_delay = Some(longest_delay(step)),
        Acts::Slow(channel) => setup.channels[channel].lags = true,
        Acts::Items | Acts::Parameter(_) | Acts::Bias(_) | Acts::Scale(_) => {}
    }
}

/// Prior standard deviation of the error of a value that is in error; of a relative error, which is stated as zero,
/// relative to one.
pub(super) fn wrong(value: f64) -> f64 {
    let size = if value == 0.0 { 1.0 } else { value.abs() };
    WRONG * size
}

fn longest_delay(step: f64) -> f64 {
    LONGEST_DELAY.max(DELAY_STEPS * step)
}

//! Initial values of searches and predictions.

use appell_estimate::{Estimation, Setup, Unknown};

use super::bench::wrong;
use super::{Bench, Fitted, Result};
use crate::effects::{Acts, Part};
use crate::identify::begin;

/// Factor on the standard deviation of initial values that are measured: the filter uses the first row once more.
const CAUTION: f64 = 10.0;
/// Largest initial delay relative to the longest one.
const BELOW: f64 = 0.9;

/// The best sizes of a candidate.
#[derive(Debug, Clone)]
pub(super) struct SizeEstimates {
    /// Index of the candidate.
    pub(super) candidate: usize,
    /// One for each of its directions.
    pub(super) values: Vec<f64>,
    /// Their standard deviations.
    pub(super) deviations: Vec<f64>,
}

impl Bench<'_> {
    /// States at the first rows. Channels are assumed to measure the quantities of the model without members; the
    /// outputs that replace them are close.
    pub(super) fn begin(&self, estimation: &Estimation<'_>, values: &mut [f64]) -> Result<()> {
        let mut setup = estimation.setup().clone();
        let plain = self.measured_by(setup.model);
        for (channel, measures) in setup.channels.iter_mut().zip(plain) {
            channel.measures = measures;
        }
        begin(&Estimation::new(&setup, estimation.recordings())?, values)?;
        Ok(())
    }

    /// The states at the first rows of windows that delayed channels show there only after their delay.
    pub(super) fn begin_later(
        &self,
        estimation: &Estimation<'_>,
        values: &mut [f64],
    ) -> Result<()> {
        let mut later = values.to_vec();
        self.begin(estimation, &mut later)?;
        let layout = estimation.layout();
        for run in 0..estimation.recordings().len() {
            for state in 0..self.effects.info().state_len() {
                let initial = layout.place(Unknown::Initial { run, state })?;
                values[initial] = later[initial];
            }
        }
        Ok(())
    }

    /// Values of a hypothesis for another filter, as far as both have them.
    pub(super) fn carried(&self, from: &Fitted, to: &Estimation<'_>) -> Vec<f64> {
        self.carried_by(from, to, Some)
    }

    /// The same for other equations, with parameters matched by name.
    pub(super) fn carried_by_name(&self, from: &Fitted, to: &Estimation<'_>) -> Vec<f64> {
        let (was, is) = (self.effects.info(), to.setup().model.info());
        let before = |place: usize| was.parameter_index(&is.parameters[place].name);
        self.carried_by(from, to, before)
    }

    /// `before` gives the former index of a parameter.
    fn carried_by(
        &self,
        from: &Fitted,
        to: &Estimation<'_>,
        before: impl Fn(usize) -> Option<usize>,
    ) -> Vec<f64> {
        let mut values = to.nominal();
        let (setup, was) = (to.setup(), self.setup(&from.members));
        let info = setup.model.info();
        let mut carry = |old: Unknown, new: Unknown| {
            if let (Ok(old), Ok(new)) = (from.layout.place(old), to.layout().place(new)) {
                values[new] = from.fit.values[old];
            }
        };
        for is in 0..info.parameter_len() {
            if let Some(was) = before(is) {
                carry(Unknown::Parameter(was), Unknown::Parameter(is));
            }
        }
        let forces = (0..setup.disturbances.len()).map(Unknown::Disturbance);
        let of_channels = (0..setup.channels.len()).flat_map(|channel| {
            // A channel without a delay has no such value.
            let delay = setup.channels[channel].longest_delay;
            let delay = delay.map(|_| Unknown::SensorDelay(channel));
            let others = [Unknown::Noise, Unknown::Bias, Unknown::Scale].map(|own| own(channel));
            others.into_iter().chain(delay)
        });
        for same in forces.chain(of_channels) {
            carry(same, same);
        }
        let inputs = |list: &[usize], input: &usize| list.iter().position(|own| own == input);
        for (new, input) in setup.lagging.iter().enumerate() {
            if let Some(old) = inputs(&was.lagging, input) {
                carry(Unknown::Lag(old), Unknown::Lag(new));
            }
        }
        for (new, input) in setup.delayed.iter().enumerate() {
            if let Some(old) = inputs(&was.delayed, input) {
                carry(Unknown::InputDelay(old), Unknown::InputDelay(new));
            }
        }
        for channel in 0..setup.channels.len() {
            let lag = |setup: &Setup<'_>| setup.lag_of_channel(channel).map(Unknown::Lag);
            if let Some((old, new)) = lag(&was).zip(lag(setup)) {
                carry(old, new);
            }
        }
        // The initial states of other recordings have the distribution of those that were fitted. Coordinates come
        // after the pseudo-velocities, of which there may be one more.
        let speeds = [was.model.info().speeds, info.speeds];
        for run in 0..to.recordings().len() {
            let old = run.min(self.recordings.len() - 1);
            for state in 0..info.state_len() {
                let Some(before) = moved(state, speeds) else {
                    continue;
                };
                let initial = |run, state| Unknown::Initial { run, state };
                let spread = |run, state| Unknown::Spread { run, state };
                carry(initial(old, before), initial(run, state));
                carry(spread(old, before), spread(run, state));
            }
        }
        begin_lags(to, &mut values);
        values
    }

    /// Sets the initial uncertainty of additional and hidden coordinates; the filter soon converges.
    pub(super) fn hide(
        &self,
        members: &[usize],
        estimation: &Estimation<'_>,
        values: &mut [f64],
    ) -> Result<()> {
        /// Initial standard deviation of the rate, in sizes per second.
        const CROSSED: f64 = 1.0;
        let (info, layout) = (estimation.setup().model.info(), estimation.layout());
        for candidate in members.iter().map(|&member| self.candidate(member)) {
            let spreads = match (candidate.brings, candidate.hides) {
                (Some(_), _) => {
                    let own = self.own(candidate);
                    let size = own.iter().find(|(_, role)| *role == Part::Size);
                    let size = size.map_or(0.0, |(place, _)| values[*place].abs());
                    [CROSSED * size, size]
                }
                (None, Some(spreads)) => spreads,
                (None, None) => continue,
            };
            for run in 0..estimation.recordings().len() {
                let states = [info.speeds - 1, info.state_len() - 1];
                for (state, spread) in states.into_iter().zip(spreads) {
                    values[layout.place(Unknown::Initial { run, state })?] = 0.0;
                    values[layout.place(Unknown::Spread { run, state })?] = spread;
                }
            }
        }
        Ok(())
    }
}

/// Multiplies the process noise among values by a factor.
pub(super) fn scale_process_noise(
    estimation: &Estimation<'_>,
    values: &mut [f64],
    factor: f64,
) -> Result<()> {
    for index in 0..estimation.setup().disturbances.len() {
        values[estimation.layout().place(Unknown::Disturbance(index))?] *= factor;
    }
    Ok(())
}

/// The likeliest of some values; `None` if the filter diverges with each of them.
pub(super) fn likeliest(
    estimation: &Estimation<'_>,
    all: impl IntoIterator<Item = Vec<f64>>,
) -> Option<Vec<f64>> {
    let likelihood = |values: Vec<f64>| Some((estimation.log_likelihood(&values).ok()?, values));
    let known = all.into_iter().filter_map(likelihood);
    let best = known.reduce(|best, next| if next.0 > best.0 { next } else { best });
    best.map(|(_, values)| values)
}

/// Sets the initial lag states of channels near their first readings.
fn begin_lags(estimation: &Estimation<'_>, values: &mut [f64]) {
    let (setup, layout) = (estimation.setup(), estimation.layout());
    for channel in 0..setup.channels.len() {
        let Some(lag) = setup.lag_of_channel(channel) else {
            continue;
        };
        let state = setup.model.info().state_len() + lag;
        for run in 0..estimation.recordings().len() {
            let spread = layout.place(Unknown::Spread { run, state });
            if let (Ok(spread), Ok(noise)) = (spread, layout.place(Unknown::Noise(channel))) {
                values[spread] = CAUTION * values[noise];
            }
        }
    }
}

/// Index of a state in a model with other pseudo-velocities; `None` for one that it did not have.
fn moved(state: usize, [was, is]: [usize; 2]) -> Option<usize> {
    if state < is {
        (state < was).then_some(state)
    } else {
        Some(was + state - is)
    }
}

/// Writes a `part` of the best sizes as initial values, none of them at a bound.
pub(super) fn place(
    bench: &Bench<'_>,
    estimation: &Estimation<'_>,
    sizes: &SizeEstimates,
    part: f64,
    values: &mut [f64],
) -> Result<()> {
    let layout = estimation.layout();
    let setup = estimation.setup();
    let candidate = bench.candidate(sizes.candidate);
    let first = sizes.values.first().map_or(0.0, |value| part * value);
    let now = match candidate.acts {
        Acts::Parameter(index) => values[index],
        _ => 0.0,
    };
    let mut set = |unknown, value: f64| -> Result<()> {
        values[layout.place(unknown)?] = value;
        Ok(())
    };
    match candidate.acts {
        Acts::Items => {
            let mut direction = 0;
            for (index, role) in bench.own(candidate) {
                let unknown = Unknown::Parameter(index);
                let quantity = &bench.effects.info().parameters[index];
                match role {
                    Part::Switch => set(unknown, 1.0)?,
                    Part::Shape(_) => {
                        set(unknown, quantity.value)?;
                        continue;
                    }
                    Part::Size | Part::Term(_) => {
                        let size = part * sizes.values[direction];
                        let least = sizes.deviations[direction];
                        let size = if size.abs() > 0.0 { size } else { least };
                        set(unknown, size)?;
                    }
                }
                direction += 1;
            }
        }
        Acts::Parameter(index) => {
            let most = wrong(bench.set.parameters[index].value);
            let [low, high] = bench.effects.info().parameters[index].range;
            let moved = now + first.clamp(-most, most);
            set(Unknown::Parameter(index), moved.clamp(low, high))?;
        }
        acts => {
            if let Some(free) = bench.of_signal(acts, setup) {
                let [low, high] = free.range;
                let value = match acts {
                    Acts::Scale(_) => 1.0 + first,
                    Acts::Late(_) => first.clamp(0.0, high),
                    Acts::Lag(_) | Acts::Slow(_) => first.clamp(2.0 * low, 0.2 * high),
                    Acts::Delay(_) => first.clamp(0.0, BELOW * high),
                    _ => first,
                };
                set(free.unknown, value)?;
            }
        }
    }
    Ok(())
}

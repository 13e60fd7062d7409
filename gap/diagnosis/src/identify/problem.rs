//! The free values, and the start of the search.

use appell_estimate::{Effort, Estimation, Free, Recording, Unknown};
use appell_runtime::model::{ModelInfo, Quantity};

use super::additions::Addition;
use super::drift::{self, Drift};
use super::start::{Start, forces, of_channels, start};
use super::{IdentifyError, Options};
use appell_recordings::{Channel, DataSet, Parameter};

/// Logarithm of the factor by which a stated noise level may be wrong.
const NOISE_FACTOR: f64 = std::f64::consts::LN_2;
/// Fraction of a signal assumed as noise if nothing is known.
const NOISE_PART: f64 = 1e-2;
/// Limits of the estimated noise, relative to the initial one.
const NOISE_RANGE: [f64; 2] = [1e-2, 1e3];
/// Initial levels of process noise, relative to the forces, over one second.
const PARTS: [f64; 5] = [1e-4, 1e-3, 1e-2, 1e-1, 1.0];
/// The search ends within a hundredth of a standard deviation.
pub(super) const EFFORT: Effort = Effort {
    gain: 5e-5,
    steps: 200,
    floor: f64::NEG_INFINITY,
};
/// Limits of process noise, relative to the forces.
const DISTURBANCE_RANGE: [f64; 2] = [1e-7, 1e3];

/// A fitting problem.
pub(crate) struct Problem {
    /// Initial values: the parameters of the rig.
    pub(crate) start: Vec<f64>,
    /// Parameters and additions that are free.
    pub(crate) wanted: Vec<Free>,
    /// Their quantities, with nominal values.
    pub(super) quantities: Vec<Quantity>,
    /// Levels of process and measurement noise, which are always free.
    pub(crate) levels: Vec<Free>,
    /// Sizes of the forces in each equation.
    pub(super) sizes: Vec<f64>,
}

impl Problem {
    pub(crate) fn of(
        set: &DataSet,
        estimation: &Estimation<'_>,
        options: &Options,
        additions: &[Addition],
    ) -> Result<Self, IdentifyError> {
        let (layout, setup) = (estimation.layout(), estimation.setup());
        let drifts = drift::named(&options.drifting, set, setup.model.info())?;
        let (mut wanted, mut quantities) =
            free_parameters(set, setup.model.info(), &drifts, options)?;
        let mut values = estimation.nominal();
        let own = setup.model.info().parameter_len();
        for (value, parameter) in values[..own].iter_mut().zip(&set.parameters) {
            *value = parameter.value;
        }
        for addition in additions {
            let (free, quantity) = addition.free(estimation, &set.runs);
            values[layout.place(free.unknown)?] = quantity.value;
            wanted.push(free);
            quantities.push(quantity);
        }
        let mut levels = Vec::new();
        let measured = set.measured(setup.model.info());
        for (index, (channel, _)) in measured.iter().enumerate() {
            let scale = Unknown::Scale(index);
            if let Some(std) = channel.tolerance
                && !wanted.iter().any(|own| own.unknown == scale)
            {
                let (free, quantity) = Addition::scale(channel, index).free(estimation, &set.runs);
                wanted.push(free.around(1.0, std));
                quantities.push(quantity);
            }
            let (level, free) = noise(channel, index, estimation.recordings());
            values[layout.place(free.unknown)?] = level;
            levels.push(free);
        }
        let starts = begin(estimation, &mut values)?;
        drift::begin(&drifts, estimation, &mut values)?;
        let sizes = forces(setup, &starts, &values, estimation.recordings());
        for (index, &size) in sizes.iter().enumerate() {
            let [low, high] = DISTURBANCE_RANGE.map(|factor| factor * size);
            levels.push(Free::of(Unknown::Disturbance(index)).within(low, high));
        }
        Ok(Self {
            start: most_likely(estimation, &values, &sizes)?,
            wanted,
            quantities,
            levels,
            sizes,
        })
    }
}

/// The parameter of a name.
pub(super) fn parameter(name: &str, info: &ModelInfo) -> Result<usize, IdentifyError> {
    info.parameter_index(name)
        .ok_or_else(|| IdentifyError::UnknownParameter {
            name: name.to_owned(),
            known: info.parameters.iter().map(|p| p.name.to_string()).collect(),
        })
}

/// Values that a parameter may have within a declared range: masses and inertias remain positive in every fit.
pub(crate) fn possible([low, high]: [f64; 2], parameter: Parameter) -> [f64; 2] {
    /// Distance from zero, in tolerances, beyond which a value keeps its sign.
    const FAR: f64 = 2.0;
    /// Lower limit relative to the value.
    const LEAST: f64 = 0.01;
    let (value, least) = (parameter.value, LEAST * parameter.value);
    let is_far = |std: f64| value.abs() > FAR * std;
    match parameter.std {
        Some(std) if is_far(std) && value > 0.0 => [low.max(least), high],
        Some(std) if is_far(std) => [low, high.min(least)],
        _ => [low, high],
    }
}

/// The free parameters, each within its range and with its prior.
fn free_parameters(
    set: &DataSet,
    info: &ModelInfo,
    drifts: &[Drift],
    options: &Options,
) -> Result<(Vec<Free>, Vec<Quantity>), IdentifyError> {
    let has_tolerance = |&i: &usize| set.parameters[i].std.is_some_and(|std| std > 0.0);
    let mut chosen: Vec<usize> = if let Some(names) = &options.free {
        let names = names.iter().map(|name| parameter(set.in_spec(name), info));
        names.collect::<Result<_, _>>()?
    } else {
        (0..set.parameters.len()).filter(has_tolerance).collect()
    };
    // Drifting parameters are states.
    chosen.retain(|index| drifts.iter().all(|own| own.parameter != *index));
    if chosen.is_empty()
        && options.drifting.is_empty()
        && options.additional.is_empty()
        && !options.allow_none
    {
        return Err(IdentifyError::NothingFree);
    }
    let chosen = chosen.into_iter().map(|index| {
        let (parameter, own) = (set.parameters[index], &info.parameters[index]);
        let [low, high] = possible(own.range, parameter);
        let free = Free::of(Unknown::Parameter(index)).within(low, high);
        let free = match parameter.std {
            Some(std) if std > 0.0 => free.around(parameter.value, std),
            _ => free,
        };
        let quantity = Quantity {
            name: set.named(&own.name).into_owned().into(),
            value: parameter.value,
            ..own.clone()
        };
        (free, quantity)
    });
    Ok(chosen.unzip())
}

/// The initial noise of a channel, and its limits.
fn noise(channel: &Channel, index: usize, recordings: &[Recording]) -> (f64, Free) {
    let free = Free::of(Unknown::Noise(index));
    let Some(noise) = channel.noise else {
        let level = NOISE_PART * deviation(recordings, index);
        let level = if level > 0.0 { level } else { NOISE_PART };
        return (level, free);
    };
    let [low, high] = NOISE_RANGE.map(|factor| factor * noise.std);
    let steps = noise.quantum.unwrap_or(0.0) / 12.0_f64.sqrt();
    let free = free
        .within(low.max(steps.min(noise.std)), high)
        .around(noise.std, NOISE_FACTOR);
    (noise.std, free)
}

/// Standard deviation of a channel along all recordings.
fn deviation(recordings: &[Recording], channel: usize) -> f64 {
    let values = recordings.iter().flat_map(|recording| {
        let rows = 0..recording.times().len();
        rows.map(|row| recording.measured(row)[channel])
    });
    let values: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / count).sqrt()
}

/// Writes the states at the first rows of all runs.
pub(crate) fn begin(
    estimation: &Estimation<'_>,
    values: &mut [f64],
) -> Result<Vec<Start>, IdentifyError> {
    let (layout, setup) = (estimation.layout(), estimation.setup());
    let channels = of_channels(estimation, values)?;
    let parameters = values[..setup.model.info().parameter_len()].to_vec();
    let mut starts = Vec::new();
    for (run, recording) in estimation.recordings().iter().enumerate() {
        let start = start(setup, &channels, &parameters, recording);
        for (state, (&expected, &spread)) in start.state.iter().zip(&start.spread).enumerate() {
            values[layout.place(Unknown::Initial { run, state })?] = expected;
            values[layout.place(Unknown::Spread { run, state })?] = spread;
        }
        for (lag, &input) in setup.lagging.iter().enumerate() {
            let state = start.state.len() + lag;
            values[layout.place(Unknown::Spread { run, state })?] = course(recording, input);
        }
        starts.push(start);
    }
    Ok(starts)
}

/// The values of a fit on other runs, with the states at the first rows of these.
pub(super) fn begun(estimation: &Estimation<'_>, fit: &[f64]) -> Result<Vec<f64>, IdentifyError> {
    let first_run = Unknown::Initial { run: 0, state: 0 };
    let first_run = estimation.layout().place(first_run)?;
    let mut values = estimation.nominal();
    // The values before those of the runs have the same indices.
    values[..first_run].copy_from_slice(&fit[..first_run]);
    begin(estimation, &mut values)?;
    Ok(values)
}

/// Root mean square of an input about its first value. The input before the first row is unknown to that extent, and
/// so is the initial state of a lag.
fn course(recording: &Recording, input: usize) -> f64 {
    let rows = 0..recording.times().len();
    let first = recording.inputs(0)[input];
    let squares = rows.map(|row| (recording.inputs(row)[input] - first).powi(2));
    (squares.sum::<f64>() / recording.times().len() as f64).sqrt()
}

/// The values with the most likely of some initial levels of process noise.
pub(super) fn most_likely(
    estimation: &Estimation<'_>,
    values: &[f64],
    sizes: &[f64],
) -> Result<Vec<f64>, IdentifyError> {
    let layout = estimation.layout();
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut failure = None;
    for part in PARTS {
        let mut values = values.to_vec();
        for (index, size) in sizes.iter().enumerate() {
            values[layout.place(Unknown::Disturbance(index))?] = part * size;
        }
        match estimation.log_likelihood(&values) {
            Ok(likelihood) if best.as_ref().is_none_or(|(most, _)| likelihood > *most) => {
                best = Some((likelihood, values));
            }
            Ok(_) => {}
            Err(error) => failure = Some(error),
        }
    }
    match (best, failure) {
        (Some((_, values)), _) => Ok(values),
        (None, Some(error)) => Err(error.into()),
        (None, None) => Ok(values.to_vec()),
    }
}

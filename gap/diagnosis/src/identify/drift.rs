//! Drifting parameters, such as friction that changes with temperature: one random-walk state each,
//! of given rate.

use appell_estimate::{Disturbance, Estimation, Setup, Unknown};
use appell_runtime::model::{ModelInfo, Quantity};

use super::IdentifyError;
use super::problem::parameter;
use appell_recordings::{DataSet, Run};

/// Relative initial standard deviation of a value without a tolerance.
const KNOWN_TO: f64 = 0.1;
/// Largest number of points of a course.
const POINTS: usize = 1000;

/// A parameter that drifts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drift {
    pub(super) parameter: usize,
    /// Standard deviation of its change in one second, in SI.
    rate: f64,
    /// Standard deviation at the beginning of a run, in SI.
    spread: f64,
}

/// A drifting parameter along a run, given all of the run.
#[derive(Debug, Clone)]
pub struct Course {
    /// Name, sentence and unit.
    pub quantity: Quantity,
    /// File of the run.
    pub run: String,
    /// Times in s.
    pub times: Vec<f64>,
    /// Values in SI.
    pub values: Vec<f64>,
    /// Their standard deviations in SI.
    pub deviations: Vec<f64>,
}

/// Finds the parameters by their names; rates are in their units per √s.
pub(super) fn named(
    list: &[(String, f64)],
    set: &DataSet,
    info: &ModelInfo,
) -> Result<Vec<Drift>, IdentifyError> {
    let mut drifts: Vec<Drift> = Vec::new();
    for (name, rate) in list {
        let parameter = parameter(name, info)?;
        if !(*rate > 0.0 && rate.is_finite()) || drifts.iter().any(|own| own.parameter == parameter)
        {
            let (name, rate) = (name.clone(), *rate);
            return Err(IdentifyError::Rate { name, rate });
        }
        let own = set.parameters[parameter];
        let tolerance = own.std.filter(|std| *std > 0.0);
        drifts.push(Drift {
            parameter,
            rate: rate * info.parameters[parameter].scale,
            spread: tolerance.unwrap_or(KNOWN_TO * own.value.abs()),
        });
    }
    Ok(drifts)
}

/// Adds them to a setup that has its lags.
pub(super) fn prepare(drifts: &[Drift], setup: &mut Setup<'_>) {
    let first = setup.model.info().state_len() + setup.lagging.len();
    for (index, drift) in drifts.iter().enumerate() {
        setup.drifting.push(drift.parameter);
        setup.disturbances.push(Disturbance::Rate(first + index));
    }
}

/// Writes their rates and their initial standard deviations.
pub(super) fn begin(
    drifts: &[Drift],
    estimation: &Estimation<'_>,
    values: &mut [f64],
) -> Result<(), IdentifyError> {
    let (layout, setup) = (estimation.layout(), estimation.setup());
    for (index, drift) in drifts.iter().enumerate() {
        let (level, state) = places(setup, index);
        values[layout.place(Unknown::Disturbance(level))?] = drift.rate;
        for run in 0..estimation.recordings().len() {
            values[layout.place(Unknown::Initial { run, state })?] = values[drift.parameter];
            values[layout.place(Unknown::Spread { run, state })?] = drift.spread;
        }
    }
    Ok(())
}

/// Indices of the process noise and of the state of a drift.
fn places(setup: &Setup<'_>, index: usize) -> (usize, usize) {
    let info = setup.model.info();
    (
        info.speeds + index,
        info.state_len() + setup.lagging.len() + index,
    )
}

/// Their courses along the runs.
pub(super) fn courses(
    drifts: &[Drift],
    estimation: &Estimation<'_>,
    values: &[f64],
    runs: &[&Run],
) -> Result<Vec<Course>, IdentifyError> {
    if drifts.is_empty() {
        return Ok(Vec::new());
    }
    let setup = estimation.setup();
    let mut courses = Vec::new();
    for (run, file) in runs.iter().enumerate() {
        let states = estimation.smoothed(values, run)?;
        let shown = || states.iter().step_by(states.len().div_ceil(POINTS));
        for (index, drift) in drifts.iter().enumerate() {
            let (_, state) = places(setup, index);
            courses.push(Course {
                quantity: setup.model.info().parameters[drift.parameter].clone(),
                run: file.name.clone(),
                times: shown().map(|one| one.t).collect(),
                values: shown().map(|one| one.state[state]).collect(),
                deviations: shown().map(|one| one.deviation(state)).collect(),
            });
        }
    }
    Ok(courses)
}

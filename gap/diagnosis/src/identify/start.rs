//! Initial values of a fit: states at the first rows, magnitudes of forces.

use appell_estimate::{Channel, Estimation, Measured, Recording, Setup, Unknown};
use appell_runtime::model::{At, Model, ModelInfo};
use nalgebra::{DMatrix, DVector};

use super::IdentifyError;
use crate::slope::{Slope, WINDOW};

/// Number of points along a run at which slopes and forces are evaluated.
const PLACES: usize = 100;
/// Factor on the standard deviation of initial values that are measured: the filter uses the first
/// row once more.
const CAUTION: f64 = 10.0;
/// Smallest standard deviation of an initial slope relative to its estimate: a parabola over the first samples cannot
/// reproduce a motion that starts with a step of a force.
const CAREFUL: f64 = 3.0;

/// Initial state of a run.
pub(crate) struct Start {
    /// Expected state.
    pub(crate) state: Vec<f64>,
    /// Standard deviations.
    pub(crate) spread: Vec<f64>,
}

/// Noise and delays of the channels.
pub(super) fn of_channels(
    estimation: &Estimation<'_>,
    values: &[f64],
) -> Result<[Vec<f64>; 2], IdentifyError> {
    let layout = estimation.layout();
    let channels = estimation.setup().channels.iter().enumerate();
    let of = |(index, channel): (usize, &Channel)| {
        let noise = values[layout.place(Unknown::Noise(index))?];
        let delay = match channel.longest_delay {
            Some(_) => values[layout.place(Unknown::SensorDelay(index))?],
            None => 0.0,
        };
        Ok((noise, delay))
    };
    let both: Vec<(f64, f64)> = channels.map(of).collect::<Result<_, IdentifyError>>()?;
    let (noise, delays) = both.into_iter().unzip();
    Ok([noise, delays])
}

/// States at the first row: measured ones as measured, at the time at which delayed channels show them; other pseudo-velocities from slopes of the
/// coordinates, the rest as in the spec, known to one SI unit.
pub(super) fn start(
    setup: &Setup<'_>,
    [noise, delays]: &[Vec<f64>; 2],
    parameters: &[f64],
    recording: &Recording,
) -> Start {
    let info = setup.model.info();
    let mut start = Start {
        state: info.initial_state(),
        spread: vec![1.0; info.state_len()],
    };
    let columns = columns(setup, info);
    for (state, column) in columns.iter().enumerate() {
        let Some(column) = *column else { continue };
        if let Some(first) = shown_at(recording, column, delays[column]) {
            start.state[state] = first;
            start.spread[state] = CAUTION * noise[column];
        }
    }
    let unknown: Vec<usize> = (0..info.speeds).filter(|&s| columns[s].is_none()).collect();
    let seen: Vec<(usize, Slopes)> = (info.speeds..info.state_len())
        .filter_map(|state| Some((state, Slopes::of(recording, columns[state]?)?)))
        .collect();
    if let Some((speeds, sizes)) = speeds(setup.model, &start.state, parameters, &unknown, &seen) {
        for (place, &state) in unknown.iter().enumerate() {
            start.state[state] = speeds[place];
            start.spread[state] = sizes[place];
        }
    }
    start
}

/// The reading of a channel at a time after the first one, between two readings in proportion.
fn shown_at(recording: &Recording, column: usize, after: f64) -> Option<f64> {
    let times = recording.times().iter().enumerate();
    let readings = times.map(|(row, &t)| (t, recording.measured(row)[column]));
    let mut readings = readings.filter(|(_, value)| !value.is_nan());
    let (begins, mut value) = readings.next()?;
    let (at, mut before) = (begins + after, begins);
    for (t, next) in readings {
        if before >= at {
            break;
        }
        let part = ((at - before) / (t - before)).min(1.0);
        (before, value) = (t, value + part * (next - value));
    }
    Some(value)
}

/// The column of each state, if it is measured.
fn columns(setup: &Setup<'_>, info: &ModelInfo) -> Vec<Option<usize>> {
    let shows = |state| {
        let mut channels = setup.channels.iter();
        channels.position(|channel| channel.measures == Measured::State(state))
    };
    (0..info.state_len()).map(shows).collect()
}

/// Slopes of a measured coordinate.
struct Slopes {
    /// At the first samples.
    first: f64,
    /// Root of the mean square along the run.
    size: f64,
}

impl Slopes {
    fn of(recording: &Recording, column: usize) -> Option<Self> {
        let rows = 0..recording.times().len();
        let samples: Vec<(f64, f64)> = rows
            .map(|row| (recording.times()[row], recording.measured(row)[column]))
            .filter(|(_, value)| !value.is_nan())
            .collect();
        let slope = |samples: &[(f64, f64)]| {
            let times: Vec<f64> = samples.iter().map(|(t, _)| *t).collect();
            let values = samples.iter().map(|(_, y)| *y);
            Slope::at(times[0], &times, values).map(|slope| slope.value)
        };
        let window = WINDOW.min(samples.len());
        let stride = (samples.len() / PLACES).max(1);
        let windows = samples.windows(window.max(3)).step_by(stride);
        let slopes: Vec<f64> = windows.filter_map(slope).collect();
        let squares: f64 = slopes.iter().map(|slope: &f64| slope * slope).sum();
        Some(Self {
            first: *slopes.first()?,
            size: (squares / slopes.len() as f64).sqrt(),
        })
    }
}

/// Pseudo-velocities whose generalised velocities are the slopes, by least squares, and their sizes
/// along the run. Generalised velocities are affine in the pseudo-velocities.
fn speeds(
    model: &dyn Model,
    state: &[f64],
    parameters: &[f64],
    unknown: &[usize],
    seen: &[(usize, Slopes)],
) -> Option<(DVector<f64>, DVector<f64>)> {
    if unknown.is_empty() || seen.is_empty() {
        return None;
    }
    let (info, u) = (model.info(), vec![0.0; model.info().input_len()]);
    let velocities = |speed: Option<usize>| {
        let mut x = state.to_vec();
        for &unknown in unknown {
            x[unknown] = if Some(unknown) == speed { 1.0 } else { 0.0 };
        }
        let mut rates = vec![0.0; info.state_len()];
        let (t, x, u, p) = (0.0, &x, &u, parameters);
        model.rates(At { t, x, u, p }, &mut rates);
        DVector::from_iterator(seen.len(), seen.iter().map(|(state, _)| rates[*state]))
    };
    let at_rest = velocities(None);
    let columns: Vec<_> = unknown
        .iter()
        .map(|&speed| velocities(Some(speed)) - &at_rest)
        .collect();
    let inverse = DMatrix::from_columns(&columns).pseudo_inverse(1e-9).ok()?;
    let slopes = seen.iter().map(|(_, slopes)| slopes);
    let sizes = slopes.clone();
    let sizes = sizes.map(|own| own.size.max(CAREFUL * own.first.abs()));
    let size = DVector::from_iterator(seen.len(), sizes);
    let first = DVector::from_iterator(seen.len(), slopes.map(|own| own.first));
    let speeds = &inverse * (first - at_rest);
    // Pseudo-velocities that no slope determines stay uncertain.
    let floor = f64::EPSILON.sqrt();
    let sizes = (inverse.abs() * size).map(|size| if size > floor { size } else { 1.0 });
    speeds
        .iter()
        .all(|speed| speed.is_finite())
        .then_some((speeds, sizes))
}

/// Size of the forces in each of Appell's equations along the recordings: root of the mean squares of
/// pseudo-forces and bias.
pub(super) fn forces(
    setup: &Setup<'_>,
    starts: &[Start],
    values: &[f64],
    recordings: &[Recording],
) -> Vec<f64> {
    let (model, info) = (setup.model, setup.model.info());
    let parameters = &values[..info.parameter_len()];
    let columns = columns(setup, info);
    let s = info.speeds;
    let (mut mass, mut bias, mut forces) = (vec![0.0; s * s], vec![0.0; s], vec![0.0; s]);
    let mut squares = vec![0.0; s];
    let mut inertias = vec![0.0; s];
    let mut count: f64 = 0.0;
    for (start, recording) in starts.iter().zip(recordings) {
        let rows = recording.times().len();
        for row in (0..rows).step_by((rows / PLACES).max(1)) {
            let mut x = start.state.clone();
            for (x, column) in x.iter_mut().zip(&columns) {
                let value = column.map_or(f64::NAN, |column| recording.measured(row)[column]);
                if !value.is_nan() {
                    *x = value;
                }
            }
            let mut u = vec![0.0; info.input_len()];
            u[..recording.input_len()].copy_from_slice(recording.inputs(row));
            let (t, x, u, p) = (recording.times()[row], &x, &u, parameters);
            model.appell(At { t, x, u, p }, &mut mass, &mut bias, &mut forces);
            count += 1.0;
            for i in 0..s {
                squares[i] += forces[i].powi(2) + bias[i].powi(2);
                inertias[i] += mass[i * (s + 1)];
            }
        }
    }
    let size = |(square, inertia): (f64, f64)| {
        // Without forces, those of a unit acceleration.
        let size = (square / count).sqrt();
        if size.is_finite() && size > 0.0 {
            size
        } else {
            inertia / count
        }
    };
    squares.into_iter().zip(inertias).map(size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_reading_of_the_first_row_is_between_two_later_ones() {
        let (times, inputs) = (vec![1.0, 1.1, 1.2, 1.3], Vec::new());
        let values = vec![f64::NAN, 2.0, 6.0, 4.0];
        let recording = Recording::new(times, inputs, values).expect("a recording");
        // The last one stands for all later times.
        for (after, value) in [(0.0, 2.0), (0.05, 4.0), (0.1, 6.0), (0.15, 5.0), (9.0, 4.0)] {
            let found = shown_at(&recording, 0, after).expect("a reading");
            assert!((found - value).abs() < 1e-9, "{after}: {found}");
        }
    }
}

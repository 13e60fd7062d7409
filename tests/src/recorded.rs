//! Simulated recordings: motions under white noise, seen through noise.

use appell_estimate::{Disturbance, Estimation, Layout, Measured, Recording, Setup, Unknown};
use appell_runtime::model::{At, Model};
use appell_runtime::positions::{Moving, Positions};

use appell_test_kit::Random;

/// Sampling times and the inputs from each of them on.
#[derive(Debug, Clone)]
pub struct Drive {
    /// Times in s.
    pub times: Vec<f64>,
    /// Inputs, row by row.
    pub inputs: Vec<f64>,
}

impl Drive {
    /// A sum of sines on every input, sampled regularly.
    pub fn sines(rows: usize, dt: f64, amplitudes: &[f64]) -> Self {
        let times: Vec<f64> = (0..rows).map(|row| row as f64 * dt).collect();
        Self::sines_at(times, amplitudes)
    }

    /// The same at any times.
    pub fn sines_at(times: Vec<f64>, amplitudes: &[f64]) -> Self {
        let at = |t: f64, k: f64| (1.7 * t + k).sin() + 0.6 * (4.3 * t + 2.0 * k).sin();
        let inputs = times.iter().flat_map(|&t| {
            let inputs = amplitudes.iter().enumerate();
            inputs.map(move |(k, amplitude)| amplitude * at(t, k as f64))
        });
        Self {
            inputs: inputs.collect(),
            times,
        }
    }

    /// A recording of nothing, to ask a setup for its layout.
    pub fn unseen(&self, channels: usize) -> Recording {
        let measurements = vec![f64::NAN; self.times.len() * channels];
        Recording::new(self.times.clone(), self.inputs.clone(), measurements).unwrap()
    }
}

/// What a setup measures when its values are true: initial states, disturbances and noise are
/// drawn. No lags and no delays. The motion takes the steps of the filter: noise enters half before
/// and half after a step. Loops are closed.
pub fn record(setup: &Setup<'_>, values: &[f64], drive: &Drive, random: &mut Random) -> Recording {
    record_with_states(setup, values, drive, random).0
}

/// The same with the true states at all rows.
pub fn record_with_states(
    setup: &Setup<'_>,
    values: &[f64],
    drive: &Drive,
    random: &mut Random,
) -> (Recording, Vec<Vec<f64>>) {
    let unseen = [drive.unseen(setup.channels.len())];
    let layout = Estimation::new(setup, &unseen).unwrap().layout();
    let value = |unknown| values[layout.place(unknown).unwrap()];
    let model = setup.model;
    let n = model.info().state_len();
    let mut x: Vec<f64> = (0..n)
        .map(|state| {
            let spread = value(Unknown::Spread { run: 0, state });
            value(Unknown::Initial { run: 0, state }) + spread * random.normal()
        })
        .collect();
    let p = &values[..model.info().parameter_len()];
    let width = model.info().declared_inputs;
    let mut positions = Positions::of(model);
    let mut close = |t: f64, x: &mut [f64], u: &[f64]| {
        if let Some(positions) = &mut positions {
            positions
                .restore(model, t, x, u, p, Moving::Dependent)
                .unwrap();
        }
    };
    let (mut measurements, mut states) = (Vec::new(), Vec::new());
    close(drive.times[0], &mut x, &drive.inputs[..width]);
    for (row, &t) in drive.times.iter().enumerate() {
        let u = &drive.inputs[row * width..(row + 1) * width];
        states.push(x.clone());
        let mut outputs = vec![0.0; model.info().output_len()];
        model.outputs(At { t, x: &x, u, p }, &mut outputs);
        for (index, channel) in setup.channels.iter().enumerate() {
            let quantity = match channel.measures {
                Measured::State(state) => x[state],
                Measured::Output(output) => outputs[output],
            };
            let noise = value(Unknown::Noise(index)) * random.normal();
            let seen = value(Unknown::Scale(index)) * quantity + value(Unknown::Bias(index));
            measurements.push(seen + noise);
        }
        let Some(next) = drive.times.get(row + 1) else {
            break;
        };
        let steps = ((next - t) / setup.longest_step).ceil().max(1.0);
        let h = (next - t) / steps;
        let mut step = 0.0;
        while step < steps {
            let at = At {
                t: t + step * h,
                x: &x.clone(),
                u,
                p,
            };
            let [before, after] = kicks(setup, &layout, values, at, h, random);
            add(&before, &mut x);
            runge_kutta(model, u, p, h, &mut x);
            add(&after, &mut x);
            close(at.t + h, &mut x, u);
            step += 1.0;
        }
    }
    let (times, inputs) = (drive.times.clone(), drive.inputs.clone());
    let recording = Recording::new(times, inputs, measurements).unwrap();
    (recording, states)
}

/// What the disturbances change before and after a step.
fn kicks(
    setup: &Setup<'_>,
    layout: &Layout,
    values: &[f64],
    at: At<'_>,
    h: f64,
    random: &mut Random,
) -> [Vec<f64>; 2] {
    let (n, s) = (at.x.len(), setup.model.info().speeds);
    let [mut mass, mut bias, mut forces] = [vec![0.0; s * s], vec![0.0; s], vec![0.0; s]];
    setup.model.appell(at, &mut mass, &mut bias, &mut forces);
    let mass = nalgebra::DMatrix::from_row_slice(s, s, &mass);
    let mut kick = || {
        let mut force = nalgebra::DVector::zeros(s);
        let mut kick = vec![0.0; n];
        for (index, disturbance) in setup.disturbances.iter().enumerate() {
            let level = values[layout.place(Unknown::Disturbance(index)).unwrap()];
            let impulse = level * (0.5 * h).sqrt() * random.normal();
            match *disturbance {
                Disturbance::Force(speed) => force[speed] += impulse,
                Disturbance::Rate(state) => kick[state] += impulse,
            }
        }
        let change = mass.clone().lu().solve(&force).unwrap();
        add(change.as_slice(), &mut kick);
        kick
    };
    [kick(), kick()]
}

fn add(change: &[f64], x: &mut [f64]) {
    for (x, change) in x.iter_mut().zip(change) {
        *x += change;
    }
}

/// A step of the classical Runge-Kutta method.
fn runge_kutta(model: &dyn Model, u: &[f64], p: &[f64], h: f64, x: &mut [f64]) {
    let start = x.to_vec();
    let mut k = vec![0.0; x.len()];
    let mut there = start.clone();
    for (weight, ahead) in [(1.0, 0.5), (2.0, 0.5), (2.0, 1.0), (1.0, 0.0)] {
        model.rates(
            At {
                t: 0.0,
                x: &there,
                u,
                p,
            },
            &mut k,
        );
        for i in 0..x.len() {
            x[i] += h / 6.0 * weight * k[i];
            there[i] = start[i] + ahead * h * k[i];
        }
    }
}

//! Commands that a controller computes from the readings of the same row: nothing of the filter's tangent finds their
//! noise in the innovations.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Along, Direction, Estimation, Innovation, Measured, Recording, Setup, Shapes, Tangent, Unknown,
};
use appell_models::Shipped;
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;

const BETWEEN: f64 = 0.02;
const ROWS: usize = 1500;
const NOISE: f64 = 2e-3;
/// Deviation of a force that is constant from row to row.
const DISTURBANCE: f64 = 0.05;
/// One in a hundred thousand.
const CHANCE: f64 = 4.4;

/// A carriage that follows a reference by a digital controller over the recorded, noisy position; nothing is wrong.
fn ridden(model: &dyn Model, random: &mut Random) -> Recording {
    let info = model.info();
    let mass = info.parameters[info.parameter_index("m").unwrap()].value;
    let (mut x, mut v, mut before) = (0.0, 0.0, 0.0);
    let (mut times, mut inputs, mut readings) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..ROWS {
        let t = row as f64 * BETWEEN;
        let reading = x + NOISE * random.normal();
        let rate = (reading - before) / BETWEEN;
        before = reading;
        let force =
            mass * (30.0 * ((0.7 * t).sin() + 0.3 * (3.1 * t).sin() - reading) - 8.0 * rate);
        times.push(t);
        inputs.push(force);
        readings.push(reading);
        let a = (force + DISTURBANCE * random.normal()) / mass;
        x += BETWEEN * v + 0.5 * BETWEEN * BETWEEN * a;
        v += BETWEEN * a;
    }
    Recording::new(times, inputs, readings).unwrap()
}

/// Scores of the columns in their standard deviations.
fn scores(tangent: &Tangent) -> Vec<f64> {
    let innovations = tangent.samples.iter();
    let whitened: Vec<f64> = innovations
        .map(|(_, own)| Innovation::whitened(own))
        .collect();
    let directions = tangent.slopes.row_iter();
    directions
        .map(|column| {
            let along: f64 = column.iter().zip(&whitened).map(|(s, r)| s * r).sum();
            along / column.norm()
        })
        .collect()
}

#[test]
fn no_column_finds_the_noise_of_a_reading_in_the_command_of_its_row() {
    let model = Shipped::find("carriage").unwrap().model;
    let setup = Setup::new(model, &[Measured::State(1)]);
    let recordings = [ridden(model, &mut Random::of("closed loop"))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = estimation.nominal();
    let mass = model.info().parameters[model.info().parameter_index("m").unwrap()].value;
    let known = [
        (Unknown::Noise(0), NOISE),
        (Unknown::Disturbance(0), DISTURBANCE / mass * BETWEEN.sqrt()),
        (Unknown::Spread { run: 0, state: 1 }, 1e-3),
    ];
    for (unknown, value) in known {
        values[estimation.layout().place(unknown).unwrap()] = value;
    }
    let late = [Direction::LateInput(0), Direction::LateChannel(0)];
    let write = |_: usize, at: At<'_>, values: &mut [f64]| values[0] = at.u[0];
    for along in [Along::Channels, Along::Disturbances] {
        let shapes = Shapes {
            along,
            count: 1,
            values: &write,
        };
        let tangent = estimation.tangent(&values, &late, Some(shapes)).unwrap();
        let scores = scores(&tangent);
        assert!(
            scores.iter().all(|z| z.abs() < CHANCE),
            "{along:?}: {scores:?}"
        );
    }
}

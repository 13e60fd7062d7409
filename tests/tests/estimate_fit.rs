//! Fits to simulated recordings.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{Coordinate, Effort, Estimation, Fit, Free, Measured, Setup, Unknown};
use appell_models::Shipped;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record};

fn shipped(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

/// Levels, noise and spread of a run of the hanging pole.
const LEVEL: f64 = 0.02;
const NOISE: f64 = 0.002;

fn known(estimation: &Estimation<'_>) -> Vec<f64> {
    let (mut values, layout) = (estimation.nominal(), estimation.layout());
    let mut set = |unknown, value| values[layout.place(unknown).unwrap()] = value;
    for index in 0..2 {
        set(Unknown::Disturbance(index), LEVEL);
        set(Unknown::Noise(index), NOISE);
    }
    for run in 0..estimation.recordings().len() {
        for state in 0..4 {
            set(Unknown::Spread { run, state }, 0.05);
        }
    }
    values
}

#[test]
fn parameters_and_levels_of_noise_are_found_together() {
    let model = shipped("cart_pole");
    let setup = Setup::new(model, &[Measured::State(2), Measured::State(3)]);
    let drive = Drive::sines(600, 0.01, &[3.0]);
    let unseen = [drive.unseen(2), drive.unseen(2)];
    let truth = known(&Estimation::new(&setup, &unseen).unwrap());
    let mut random = Random::of("fit");
    let recordings = [0, 1].map(|_| record(&setup, &truth, &drive, &mut random));
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let layout = estimation.layout();

    let mut start = truth.clone();
    for (place, factor) in [(0, 1.1), (1, 0.85), (2, 1.08)] {
        start[place] *= factor;
    }
    for unknown in [0, 1]
        .map(Unknown::Disturbance)
        .iter()
        .chain(&[0, 1].map(Unknown::Noise))
    {
        start[layout.place(*unknown).unwrap()] *= 3.0;
    }
    let parameters = [0, 1, 2].map(|i| Free {
        coordinate: Coordinate::Logarithm,
        ..Free::of(Unknown::Parameter(i)).within(0.0, f64::INFINITY)
    });
    let levels = [0, 1].map(|i| Free::of(Unknown::Disturbance(i)));
    let noise = [0, 1].map(|i| Free::of(Unknown::Noise(i)));
    let free = [&parameters[..], &levels, &noise].concat();
    let fit = Fit::of(&estimation, &start, &free, Effort::default()).unwrap();
    assert!(fit.steps <= 40, "{} steps", fit.steps);
    assert!(fit.log_likelihood > estimation.log_likelihood(&truth).unwrap());
    for (index, one) in free.iter().enumerate() {
        let wanted = truth[layout.place(one.unknown).unwrap()];
        // Three standard deviations: seven values have to fit at once.
        let reach = 3.0 * fit.deviation(index).unwrap();
        let [low, high] = [-reach, reach].map(|off| one.to_value(fit.coordinates[index] + off));
        assert!(
            (low..=high).contains(&wanted),
            "{:?}: {wanted} in {low}..{high}",
            one.unknown
        );
    }
}

//! The gradient of the log-likelihood against central differences, in every value it depends on.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Channel, Disturbance, Estimation, Layout, Measured, Recording, Setup, Unknown,
};
use appell_models::Shipped;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record};
use appell_tests::shipped;

/// Differences of a sum of some thousand terms lose digits; what the gradient itself loses is less.
const TOLERANCE: f64 = 1e-6;
/// The same where motions are chaotic and bend the likelihood more.
const TOLERANCE_ALONG_CHAOS: f64 = 1e-5;
/// The same where the likelihood holds differences itself: slopes of outputs without formulas.
const TOLERANCE_OF_DIFFERENCES: f64 = 2e-5;

fn shipped(name: &str) -> &'static dyn Model {
    Shipped::find(name).unwrap().model
}

fn set(values: &mut [f64], layout: &Layout, unknown: Unknown, value: f64) {
    values[layout.place(unknown).unwrap()] = value;
}

/// Values that make a setup noisy everywhere.
fn noisy(estimation: &Estimation<'_>, level: f64, noise: f64) -> Vec<f64> {
    let (layout, setup) = (estimation.layout(), estimation.setup());
    let mut values = estimation.nominal();
    for index in 0..setup.disturbances.len() {
        set(&mut values, &layout, Unknown::Disturbance(index), level);
    }
    for index in 0..setup.channels.len() {
        set(&mut values, &layout, Unknown::Noise(index), noise);
    }
    let lagging = setup.channels.iter().filter(|channel| channel.lags).count();
    let added = setup.lagging.len() + lagging + setup.drifting.len();
    let states = setup.model.info().state_len() + added;
    for run in 0..estimation.recordings().len() {
        for state in 0..states {
            set(&mut values, &layout, Unknown::Spread { run, state }, 0.1);
        }
    }
    values
}

/// Central differences of order four.
fn slope(estimation: &Estimation<'_>, values: &[f64], place: usize, step: f64) -> f64 {
    let h = step * values[place].abs().max(1e-2);
    let at = |offset: f64| {
        let mut varied = values.to_vec();
        varied[place] += offset * h;
        estimation.log_likelihood(&varied).unwrap()
    };
    (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h)
}

fn assert_gradient(estimation: &Estimation<'_>, values: &[f64], tolerance: f64) {
    // The less exact the likelihood is, the wider the best step.
    let step = 1e-4 * (tolerance / TOLERANCE);
    assert_gradient_by_steps(estimation, values, tolerance, step);
}

fn assert_gradient_by_steps(
    estimation: &Estimation<'_>,
    values: &[f64],
    tolerance: f64,
    step: f64,
) {
    let (value, gradient) = estimation.gradient(values).unwrap();
    let again = estimation.log_likelihood(values).unwrap();
    assert_eq!(value.to_bits(), again.to_bits());
    let (layout, channels) = (estimation.layout(), &estimation.setup().channels);
    let fixed = channels
        .iter()
        .enumerate()
        .filter(|(_, c)| c.longest_delay.is_none());
    let fixed: Vec<usize> = fixed
        .map(|(index, _)| layout.place(Unknown::SensorDelay(index)).unwrap())
        .collect();
    for (place, &got) in gradient
        .iter()
        .enumerate()
        .filter(|(place, _)| !fixed.contains(place))
    {
        let wanted = slope(estimation, values, place, step);
        // One unit of relative change of the value is what matters.
        let scale = 1.0 / values[place].abs().max(1e-2);
        let error = (got - wanted).abs();
        assert!(
            error <= tolerance * wanted.abs().max(scale),
            "value {place} of {}: {got:e} against {wanted:e}",
            gradient.len()
        );
    }
}

fn with_gaps(recording: &Recording) -> Recording {
    let mut measurements: Vec<f64> = (0..recording.times().len())
        .flat_map(|row| recording.measured(row).to_vec())
        .collect();
    let width = recording.channel_len();
    for place in (0..measurements.len()).step_by(7) {
        measurements[place] = f64::NAN;
    }
    for row in 20..24 {
        measurements[row * width..(row + 1) * width].fill(f64::NAN);
    }
    recording.with_measurements(measurements).unwrap()
}

#[test]
fn it_is_exact_for_states_irregular_times_and_missing_samples() {
    let model = shipped("cart_pole");
    let mut setup = Setup::new(model, &[Measured::State(2), Measured::State(3)]);
    setup.longest_step = 0.012;
    let mut random = Random::of("irregular");
    let mut t = 0.0;
    let times = (0..120).map(|_| {
        t += random.between(0.004, 0.03);
        t
    });
    let drive = Drive::sines_at(times.collect(), &[2.0]);
    let unseen = [drive.unseen(2)];
    let values = noisy(&Estimation::new(&setup, &unseen).unwrap(), 0.05, 0.003);
    let recordings = [with_gaps(&record(&setup, &values, &drive, &mut random))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut elsewhere = values.clone();
    for (value, factor) in elsewhere
        .iter_mut()
        .zip([1.03, 0.96, 1.02, 1.05, 0.99].iter().cycle())
    {
        *value *= factor;
    }
    assert_gradient(&estimation, &elsewhere, TOLERANCE);
}

#[test]
fn it_is_exact_for_outputs_biases_scales_and_noise_on_rates() {
    let model = shipped("cart_pole");
    let output = |name: &str| Measured::Output(model.info().output_index(name).unwrap());
    let measured = [Measured::State(3), output("x_G"), output("energy")];
    let mut setup = Setup::new(model, &measured);
    setup.disturbances.push(Disturbance::Rate(3));
    let drive = Drive::sines(80, 0.01, &[2.0]);
    let unseen = [drive.unseen(3), drive.unseen(3)];
    let estimation = Estimation::new(&setup, &unseen).unwrap();
    let layout = estimation.layout();
    let mut values = noisy(&estimation, 0.05, 0.01);
    for (channel, value) in [0.02, -0.01, 0.03].into_iter().enumerate() {
        set(&mut values, &layout, Unknown::Bias(channel), value);
        set(
            &mut values,
            &layout,
            Unknown::Scale(channel),
            1.0 + 4.0 * value,
        );
    }
    let mut random = Random::of("outputs and rates");
    let recordings = [0, 1].map(|_| record(&setup, &values, &drive, &mut random));
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    values[0] *= 1.02;
    values[2] *= 0.97;
    assert_gradient(&estimation, &values, TOLERANCE_OF_DIFFERENCES);
}

#[test]
fn it_is_exact_for_outputs_with_formulas() {
    let model = shipped::complete_model("cart_pole");
    let output = |name: &str| Measured::Output(model.info().output_index(name).unwrap());
    let mut setup = Setup::new(model, &[output("x_G"), output("energy")]);
    setup.lagging = vec![0];
    let drive = Drive::sines(80, 0.01, &[2.0]);
    let unseen = [drive.unseen(2)];
    let mut prompt = setup.clone();
    prompt.lagging = Vec::new();
    let truth = noisy(&Estimation::new(&prompt, &unseen).unwrap(), 0.05, 0.01);
    let recordings = [record(&prompt, &truth, &drive, &mut Random::of("formulas"))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = noisy(&estimation, 0.05, 0.01);
    values[1] *= 1.04;
    set(&mut values, &estimation.layout(), Unknown::Lag(0), 0.02);
    assert_gradient(&estimation, &values, TOLERANCE);
}

#[test]
fn it_is_exact_for_outputs_that_read_an_input_that_lags() {
    let model = shipped::complete_model("euc_2dof");
    let power = Measured::Output(model.info().output_index("power").unwrap());
    let mut setup = Setup::new(model, &[Measured::State(0), power]);
    setup.longest_step = 0.005;
    let drive = Drive::sines(40, 0.01, &[2.0]);
    let unseen = [drive.unseen(2)];
    let truth = noisy(&Estimation::new(&setup, &unseen).unwrap(), 0.05, 0.01);
    let recording = record(&setup, &truth, &drive, &mut Random::of("power"));
    let rows = 0..recording.times().len();
    let times = [&[-0.03, -0.01], recording.times()].concat();
    let own = rows.flat_map(|row| recording.inputs(row).to_vec());
    let inputs = [1.0, -0.5].into_iter().chain(own).collect();
    let recording = recording.after(&[-0.03, -0.01], &[1.0, -0.5]);
    setup.lagging = vec![0];
    let recordings = [recording.with_outputs(false, times, inputs)];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = noisy(&estimation, 0.05, 0.01);
    set(&mut values, &estimation.layout(), Unknown::Lag(0), 0.012);
    assert_gradient(&estimation, &values, TOLERANCE);
}

#[test]
fn it_is_exact_for_lags_and_delays() {
    let model = shipped("double_pendulum");
    let mut setup = Setup::new(model, &[Measured::State(2), Measured::State(3)]);
    setup.channels[1] = Channel {
        longest_delay: Some(0.03),
        ..setup.channels[1]
    };
    setup.lagging = vec![1];
    setup.delayed = vec![0, 1];
    setup.longest_step = 0.006;
    let drive = Drive::sines(80, 0.01, &[1.0, 0.5]);
    let unseen = [drive.unseen(2)];
    let mut plain = setup.clone();
    (plain.lagging, plain.delayed) = (Vec::new(), Vec::new());
    let estimation = Estimation::new(&plain, &unseen).unwrap();
    let truth = noisy(&estimation, 0.02, 0.003);
    let recording = record(&plain, &truth, &drive, &mut Random::of("late"));
    let recordings = [recording.after(&[-0.04, -0.015], &[0.3, -0.2, -0.4, 0.5])];

    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let layout = estimation.layout();
    let mut values = noisy(&estimation, 0.02, 0.003);
    set(&mut values, &layout, Unknown::SensorDelay(1), 0.0123);
    set(&mut values, &layout, Unknown::Lag(0), 0.03);
    set(&mut values, &layout, Unknown::InputDelay(0), 0.0137);
    set(&mut values, &layout, Unknown::InputDelay(1), 0.0042);
    assert_gradient(&estimation, &values, TOLERANCE);
}

/// Readings of a setup without its lags and delays.
fn prompt(setup: &Setup<'_>, drive: &Drive, seed: &str) -> [Recording; 1] {
    let measured: Vec<Measured> = setup.channels.iter().map(|c| c.measures).collect();
    let prompt = Setup {
        longest_step: setup.longest_step,
        ..Setup::new(setup.model, &measured)
    };
    let unseen = [drive.unseen(setup.channels.len())];
    let truth = noisy(&Estimation::new(&prompt, &unseen).unwrap(), 0.02, 0.003);
    let recording = record(&prompt, &truth, drive, &mut Random::of(seed));
    [with_gaps(&recording)]
}

#[test]
fn it_is_exact_for_lagging_channels() {
    let model = shipped("double_pendulum");
    let mut setup = Setup::new(model, &[2, 3, 3].map(Measured::State));
    setup.channels[0].lags = true;
    setup.channels[1].longest_delay = Some(0.03);
    setup.channels[2].longest_delay = Some(0.02);
    setup.channels[2].lags = true;
    setup.lagging = vec![1];
    setup.delayed = vec![0];
    setup.disturbances.push(Disturbance::Rate(6));
    setup.longest_step = 0.006;
    assert_eq!(
        [0, 1, 2].map(|c| setup.lag_of_channel(c)),
        [Some(1), None, Some(2)]
    );
    let recordings = prompt(
        &setup,
        &Drive::sines(80, 0.01, &[1.0, 0.5]),
        "lagging channels",
    );
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let layout = estimation.layout();
    let mut values = noisy(&estimation, 0.02, 0.003);
    set(&mut values, &layout, Unknown::SensorDelay(1), 0.0123);
    set(&mut values, &layout, Unknown::SensorDelay(2), 0.0071);
    set(&mut values, &layout, Unknown::InputDelay(0), 0.0137);
    for (lag, tau) in [0.03, 0.02, 0.015].into_iter().enumerate() {
        set(&mut values, &layout, Unknown::Lag(lag), tau);
    }
    set(&mut values, &layout, Unknown::Scale(0), 1.1);
    set(&mut values, &layout, Unknown::Bias(2), 0.01);
    assert_gradient(&estimation, &values, TOLERANCE);
}

/// A cart with a pole, seen by filters of its outputs.
fn filtered_outputs(model: &dyn Model) -> Setup<'_> {
    let output = |name: &str| Measured::Output(model.info().output_index(name).unwrap());
    let measured = [output("x_G"), Measured::State(3), output("energy")];
    let mut setup = Setup::new(model, &measured);
    setup.channels[0].lags = true;
    setup.channels[2].lags = true;
    setup
}

#[test]
fn it_is_exact_for_lagging_channels_that_measure_outputs() {
    let model = shipped::complete_model("cart_pole");
    let mass = model.info().parameter_index("m_pole").unwrap();
    for drifting in [Vec::new(), vec![mass]] {
        let mut setup = filtered_outputs(model);
        setup.lagging = vec![0];
        setup.drifting = drifting;
        let recordings = prompt(&setup, &Drive::sines(80, 0.01, &[2.0]), "filtered");
        let estimation = Estimation::new(&setup, &recordings).unwrap();
        let mut values = noisy(&estimation, 0.05, 0.01);
        values[1] *= 1.04;
        for (lag, tau) in [0.02, 0.03, 0.015].into_iter().enumerate() {
            set(&mut values, &estimation.layout(), Unknown::Lag(lag), tau);
        }
        assert_gradient(&estimation, &values, TOLERANCE);
    }
}

#[test]
fn it_is_exact_for_drifting_parameters() {
    let model = shipped::complete_model("cart_pole");
    let info = model.info();
    let energy = Measured::Output(info.output_index("energy").unwrap());
    let constant = Setup::new(model, &[Measured::State(3), energy]);
    let mut setup = constant.clone();
    setup.drifting = ["m_pole", "l"]
        .map(|name| info.parameter_index(name).unwrap())
        .to_vec();
    setup.lagging = vec![0];
    setup
        .disturbances
        .push(Disturbance::Rate(info.state_len() + 1));
    let drive = Drive::sines(80, 0.01, &[2.0]);
    let unseen = [drive.unseen(2)];
    let truth = noisy(&Estimation::new(&constant, &unseen).unwrap(), 0.05, 0.01);
    let recordings = [record(&constant, &truth, &drive, &mut Random::of("drift"))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = noisy(&estimation, 0.05, 0.01);
    set(&mut values, &estimation.layout(), Unknown::Lag(0), 0.02);
    assert_gradient(&estimation, &values, TOLERANCE);
}

#[test]
fn it_stays_exact_along_chaotic_motions() {
    let model = shipped::complete_model("double_pendulum");
    let setup = Setup::new(model, &[Measured::State(2), Measured::State(3)]);
    let drive = Drive::sines(4000, 0.02, &[0.0, 0.0]);
    let unseen = [drive.unseen(2)];
    let mut values = noisy(&Estimation::new(&setup, &unseen).unwrap(), 0.05, 0.01);
    let layout = Estimation::new(&setup, &unseen).unwrap().layout();
    for state in 2..4 {
        set(
            &mut values,
            &layout,
            Unknown::Initial { run: 0, state },
            2.5,
        );
    }
    let recordings = [record(&setup, &values, &drive, &mut Random::of("chaos"))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    assert_gradient_by_steps(&estimation, &values, TOLERANCE_ALONG_CHAOS, 1e-4);
}

#[test]
fn it_is_exact_for_closed_loops() {
    let model = shipped("four_bar");
    let state = |name: &str| Measured::State(model.info().state_index(name).unwrap());
    let mut setup = Setup::new(model, &[state("theta1"), state("theta3")]);
    setup.disturbances.push(Disturbance::Rate(1));
    let drive = Drive::sines(80, 0.01, &[0.4]);
    let unseen = [drive.unseen(2)];
    let values = noisy(&Estimation::new(&setup, &unseen).unwrap(), 0.05, 0.01);
    let mut random = Random::of("closed");
    let recordings = [with_gaps(&record(&setup, &values, &drive, &mut random))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut elsewhere = values.clone();
    for (value, factor) in elsewhere[..9].iter_mut().zip([1.02, 0.99, 1.01, 1.0]) {
        *value *= factor;
    }
    assert_gradient(&estimation, &elsewhere, TOLERANCE_OF_DIFFERENCES);
    // The filter of a dependent coordinate.
    setup.channels[1].lags = true;
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = noisy(&estimation, 0.05, 0.01);
    set(&mut values, &estimation.layout(), Unknown::Lag(0), 0.02);
    assert_gradient(&estimation, &values, TOLERANCE_OF_DIFFERENCES);
}

//! Lags that are shorter than the rows are apart, and channels that are late.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Direction, Effort, Estimation, Fit, Free, Innovation, Layout, Measured, Recording, Setup,
    Unknown,
};
use appell_models::Shipped;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record, record_with_states};

/// Rows are so far apart in s.
const BETWEEN: f64 = 0.01;
/// A lag in s that is much shorter.
const LAG: f64 = 0.003;
const LEVEL: f64 = 0.02;
const NOISE: f64 = 1e-3;

fn cart_pole() -> &'static dyn Model {
    Shipped::find("cart_pole").unwrap().model
}

/// Cart and pole are seen.
fn seen(model: &dyn Model) -> Setup<'_> {
    Setup::new(model, &[Measured::State(2), Measured::State(3)])
}

fn recorded(setup: &Setup<'_>) -> [Recording; 1] {
    let drive = Drive::sines(300, BETWEEN, &[1.0]);
    let unseen = [drive.unseen(2)];
    let estimation = Estimation::new(setup, &unseen).unwrap();
    let values = noisy(&estimation);
    [record(setup, &values, &drive, &mut Random::of("late"))]
}

fn set(values: &mut [f64], layout: Layout, unknown: Unknown, value: f64) {
    values[layout.place(unknown).unwrap()] = value;
}

fn noisy(estimation: &Estimation<'_>) -> Vec<f64> {
    let (layout, setup) = (estimation.layout(), estimation.setup());
    let mut values = estimation.nominal();
    for index in 0..setup.disturbances.len() {
        set(&mut values, layout, Unknown::Disturbance(index), LEVEL);
    }
    for index in 0..setup.channels.len() {
        set(&mut values, layout, Unknown::Noise(index), NOISE);
    }
    let channels = setup.channels.iter().filter(|channel| channel.lags).count();
    for state in 0..setup.model.info().state_len() + setup.lagging.len() + channels {
        set(&mut values, layout, Unknown::Spread { run: 0, state }, 0.01);
    }
    values
}

#[test]
fn slopes_by_a_lag_that_is_shorter_than_the_rows_are_those_of_differences() {
    let plain = seen(cart_pole());
    let recordings = recorded(&plain);
    let mut setup = plain.clone();
    setup.lagging = vec![0];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = noisy(&estimation);
    set(&mut values, estimation.layout(), Unknown::Lag(0), LAG);
    assert_slopes(&estimation, &values, Unknown::Lag(0));
}

/// Slopes of the whitened innovations against differences. The gains are held, and so do not follow.
fn assert_slopes(estimation: &Estimation<'_>, values: &[f64], unknown: Unknown) {
    let tangent = estimation
        .tangent(values, &[Direction::Value(unknown)], None)
        .unwrap();
    let place = estimation.layout().place(unknown).unwrap();
    let h = 1e-4 * values[place];
    let whitened = |step: f64| -> Vec<f64> {
        let mut moved = values.to_vec();
        moved[place] += step;
        let runs = estimation.innovations(&moved).unwrap();
        runs[0].iter().map(Innovation::whitened).collect()
    };
    let (above, below) = (whitened(h), whitened(-h));
    let differences = above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * h));
    let (mut off, mut size) = (0.0, 0.0);
    for (difference, slope) in differences.zip(tangent.slopes.iter()) {
        off += (difference - slope).powi(2);
        size += difference.powi(2);
    }
    assert!(size > 0.0);
    let off = (off / size).sqrt();
    assert!(off < 0.01, "{unknown:?}: {off}");
}

#[test]
fn slopes_by_lags_of_channels_are_those_of_differences() {
    let model = cart_pole();
    let output = |name: &str| Measured::Output(model.info().output_index(name).unwrap());
    let measured = [Measured::State(2), Measured::State(3), output("x_G")];
    let mut setup = Setup::new(model, &measured);
    let recordings = recorded(&setup);
    setup.channels[0].lags = true;
    setup.channels[2].lags = true;
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = noisy(&estimation);
    let lags = [0, 2].map(|channel| Unknown::Lag(setup.lag_of_channel(channel).unwrap()));
    for lag in lags {
        set(&mut values, estimation.layout(), lag, LAG);
    }
    let length = Unknown::Parameter(model.info().parameter_index("l").unwrap());
    for unknown in [lags[0], lags[1], length] {
        assert_slopes(&estimation, &values, unknown);
    }
}

/// Readings after a filter with the time constant `tau` in s, of readings that are straight between
/// rows.
fn filtered(readings: &[f64], tau: f64) -> Vec<f64> {
    let decay = (-BETWEEN / tau).exp();
    let mut reading = readings[0];
    let steps = readings.windows(2).map(|ends| {
        let behind = tau * (ends[1] - ends[0]) / BETWEEN;
        reading = ends[1] - behind + (reading - ends[0] + behind) * decay;
        reading
    });
    [readings[0]].into_iter().chain(steps).collect()
}

#[test]
fn the_lag_of_a_channel_is_found() {
    const TAU: f64 = 0.05;
    let mut setup = seen(cart_pole());
    let drive = Drive::sines(300, BETWEEN, &[1.0]);
    let unseen = [drive.unseen(2)];
    let truth = noisy(&Estimation::new(&setup, &unseen).unwrap());
    let mut random = Random::of("filtered");
    let (recording, states) = record_with_states(&setup, &truth, &drive, &mut random);
    let angles: Vec<f64> = states.iter().map(|state| state[3]).collect();
    let readings = filtered(&angles, TAU).into_iter().enumerate();
    let measurements = readings.flat_map(|(row, angle)| {
        let angle = angle + NOISE * random.normal();
        [recording.measured(row)[0], angle]
    });
    let recordings = [recording.with_measurements(measurements.collect()).unwrap()];
    setup.channels[1].lags = true;
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let free = [Free::of(Unknown::Lag(0)), Free::of(Unknown::Noise(1))];
    let fit = Fit::of(&estimation, &noisy(&estimation), &free, Effort::default()).unwrap();
    let tau = fit.values[estimation.layout().place(Unknown::Lag(0)).unwrap()];
    assert!((tau / TAU - 1.0).abs() < 0.02, "{tau}");
}

#[test]
fn a_lag_that_is_shorter_than_the_rows_is_as_well_known_as_a_delay() {
    let plain = seen(cart_pole());
    let recordings = recorded(&plain);
    // The coordinate of a lag is its logarithm.
    let deviation = |prepare: fn(&mut Setup<'_>), unknown: Unknown, stretch: f64| -> f64 {
        let mut setup = plain.clone();
        prepare(&mut setup);
        let estimation = Estimation::new(&setup, &recordings).unwrap();
        let mut values = noisy(&estimation);
        set(&mut values, estimation.layout(), unknown, LAG);
        let free = [Free::of(unknown)];
        let information = estimation.information(&values, &free).unwrap();
        stretch / information[(0, 0)].sqrt()
    };
    let lag = deviation(|setup| setup.lagging = vec![0], Unknown::Lag(0), LAG);
    let delay = deviation(|setup| setup.delayed = vec![0], Unknown::InputDelay(0), 1.0);
    assert!((lag / delay - 1.0).abs() < 0.05, "{lag} beside {delay}");
}

#[test]
fn predictions_of_channels_that_are_late_are_those_of_the_same_rows() {
    let plain = seen(cart_pole());
    let recordings = recorded(&plain);
    let mut late = plain.clone();
    late.channels[1].longest_delay = Some(0.05);
    let origins: Vec<usize> = (50..200).step_by(30).collect();
    let told = |setup: &Setup<'_>| -> (Vec<[usize; 3]>, usize) {
        let estimation = Estimation::new(setup, &recordings).unwrap();
        let mut values = noisy(&estimation);
        if setup.channels[1].longest_delay.is_some() {
            let unknown = Unknown::SensorDelay(1);
            set(&mut values, estimation.layout(), unknown, 0.023);
        }
        let predicted = estimation.predictions(&values, 0, 0.5, &origins).unwrap();
        let mut rows: Vec<[usize; 3]> = predicted
            .iter()
            .map(|one| [one.origin, one.channel, one.row])
            .collect();
        rows.sort_unstable();
        let expected = estimation.expected_errors(&values, 0, 0.5, &origins);
        (rows, expected.unwrap().len())
    };
    let (rows, expected) = told(&plain);
    assert_eq!(rows.len(), 2 * origins.len());
    assert_eq!(expected, 2 * origins.len());
    assert_eq!(told(&late), (rows, expected));
}

//! Lags that are shorter than the rows are apart, and channels that are late.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_estimate::{
    Direction, Effort, Estimation, Fit, Free, Innovation, Layout, Measured, Predicted, Recording,
    Setup, Unknown,
};
use appell_models::Shipped;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record};

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
    let unseen = [drive.unseen(setup.channels.len())];
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
    let recordings = recorded(&plain).map(|own| own.after(&[-0.006, -0.002], &[-0.5, 0.7]));
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

/// A recording with filters of those channels of a setup that lag.
fn after_filters(setup: &Setup<'_>, prompt: &Recording, tau: f64) -> Recording {
    let columns = setup.channels.iter().enumerate().map(|(channel, of)| {
        let rows = 0..prompt.times().len();
        let readings: Vec<f64> = rows.map(|row| prompt.measured(row)[channel]).collect();
        if of.lags {
            filtered(&readings, tau)
        } else {
            readings
        }
    });
    let columns: Vec<Vec<f64>> = columns.collect();
    let rows = 0..prompt.times().len();
    let measurements = rows.flat_map(|row| columns.iter().map(move |column| column[row]));
    prompt.with_measurements(measurements.collect()).unwrap()
}

/// The cart, the pole and their centre of mass; the first and the last by filters. Nothing disturbs,
/// nothing is noisy, and the values are true: innovations vanish.
fn through_filters(model: &dyn Model) -> (Setup<'_>, [Recording; 1]) {
    let centre = Measured::Output(model.info().output_index("x_G").unwrap());
    let mut setup = Setup::new(model, &[Measured::State(2), Measured::State(3), centre]);
    let drive = Drive::sines(300, BETWEEN, &[1.0]);
    let unseen = [drive.unseen(3)];
    let exact = Estimation::new(&setup, &unseen).unwrap().nominal();
    let prompt = record(&setup, &exact, &drive, &mut Random::of("exact"));
    setup.channels[0].lags = true;
    setup.channels[2].lags = true;
    let recordings = [after_filters(&setup, &prompt, LAG)];
    (setup, recordings)
}

fn with_lags(estimation: &Estimation<'_>) -> Vec<f64> {
    let mut values = noisy(estimation);
    for lag in [0, 1] {
        set(&mut values, estimation.layout(), Unknown::Lag(lag), LAG);
    }
    values
}

#[test]
fn slopes_by_lags_of_channels_are_those_of_differences() {
    let model = cart_pole();
    // Changes of the gains would multiply innovations.
    let (setup, recordings) = through_filters(model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let values = with_lags(&estimation);
    let lags = [0, 2].map(|channel| Unknown::Lag(setup.lag_of_channel(channel).unwrap()));
    let length = Unknown::Parameter(model.info().parameter_index("l").unwrap());
    for unknown in [lags[0], lags[1], length] {
        assert_slopes(&estimation, &values, unknown);
    }
}

#[test]
fn predictions_of_lagging_channels_are_those_of_their_readings() {
    let (setup, recordings) = through_filters(cart_pole());
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let values = with_lags(&estimation);
    let origins: Vec<usize> = (50..200).step_by(30).collect();
    let predicted = estimation.predictions(&values, 0, 0.1, &origins).unwrap();
    assert_eq!(predicted.len(), 3 * origins.len());
    let worst = |predicted: &[Predicted]| -> f64 {
        let errors = predicted.iter().map(|one| one.residual.abs());
        errors.fold(0.0, f64::max)
    };
    let mut prompt = setup.clone();
    for channel in &mut prompt.channels {
        channel.lags = false;
    }
    let estimation = Estimation::new(&prompt, &recordings).unwrap();
    let unlike = estimation
        .predictions(&noisy(&estimation), 0, 0.1, &origins)
        .unwrap();
    let (lagging, prompt) = (worst(&predicted), worst(&unlike));
    // Readings between the rows are not quite straight.
    assert!(lagging < 0.05 * prompt, "{lagging} m against {prompt} m");
}

#[test]
fn the_lag_of_a_channel_is_found() {
    const TAU: f64 = 0.05;
    // The angle is seen by a prompt sensor too, as which the other one is recorded first.
    let mut setup = Setup::new(cart_pole(), &[2, 3, 3].map(Measured::State));
    let drive = Drive::sines(300, BETWEEN, &[1.0]);
    let unseen = [drive.unseen(3)];
    let mut truth = noisy(&Estimation::new(&setup, &unseen).unwrap());
    let layout = Estimation::new(&setup, &unseen).unwrap().layout();
    set(&mut truth, layout, Unknown::Noise(2), 0.0);
    let mut random = Random::of("filtered");
    let prompt = record(&setup, &truth, &drive, &mut random);
    setup.channels[2].lags = true;
    let exact = after_filters(&setup, &prompt, TAU);
    let rows = 0..exact.times().len();
    let measurements = rows.flat_map(|row| {
        let [cart, angle, late] = [0, 1, 2].map(|channel| exact.measured(row)[channel]);
        [cart, angle, late + NOISE * random.normal()]
    });
    let measurements = measurements.collect();
    let recordings = [exact.with_measurements(measurements).unwrap()];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let free = [Free::of(Unknown::Lag(0)), Free::of(Unknown::Noise(2))];
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

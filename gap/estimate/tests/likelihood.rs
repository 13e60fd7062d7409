//! Filter and likelihood of a linear Gaussian system, against formulas that share nothing with
//! them: the textbook's covariance recursion and the joint distribution of all samples at once.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use crate::oscillator::{Oscillator, drive};
use appell_estimate::{
    Disturbance, Effort, Estimation, Fit, Free, Measured, Recording, Sensitivity, Setup, Unknown,
};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Rounding of some hundred steps.
const ROUNDING: f64 = 1e-10;

const LEVELS: [f64; 2] = [0.3, 0.02];
const NOISE: [f64; 2] = [0.01, 0.05];
const SPREAD: [f64; 2] = [0.2, 0.1];
const INITIAL: [f64; 2] = [0.1, -0.2];

/// The position, seen directly, and the output; a force and a rate of the position disturb.
fn setup(model: &Oscillator) -> Setup<'_> {
    let mut setup = Setup::new(model, &[Measured::State(1), Measured::Output(0)]);
    setup.disturbances = vec![Disturbance::Force(0), Disturbance::Rate(1)];
    setup
}

fn values(estimation: &Estimation<'_>) -> Vec<f64> {
    let (mut values, layout) = (estimation.nominal(), estimation.layout());
    let mut set = |unknown, value| values[layout.place(unknown).unwrap()] = value;
    for i in 0..2 {
        set(Unknown::Disturbance(i), LEVELS[i]);
        set(Unknown::Noise(i), NOISE[i]);
        set(Unknown::Initial { run: 0, state: i }, INITIAL[i]);
        set(Unknown::Spread { run: 0, state: i }, SPREAD[i]);
    }
    set(Unknown::Bias(0), 0.03);
    set(Unknown::Scale(1), 1.1);
    values
}

/// F and the change by the input of one step: the exponential series up to the fourth power, which
/// is what the classical Runge-Kutta method computes for a linear system.
fn discrete(p: &[f64], h: f64) -> (Matrix2<f64>, Vector2<f64>) {
    let [m, c, k] = [p[0], p[1], p[2]];
    let a = Matrix2::new(-c / m, -k / m, 1.0, 0.0) * h;
    let b = Vector2::new(1.0 / m, 0.0) * h;
    let identity = Matrix2::identity();
    let f = identity + a + a * a / 2.0 + a * a * a / 6.0 + a * a * a * a / 24.0;
    let g = identity + a / 2.0 + a * a / 6.0 + a * a * a / 24.0;
    (f, g * b)
}

/// Covariance of half of the noise of a step.
fn half_noise(p: &[f64], h: f64) -> Matrix2<f64> {
    let force = (LEVELS[0] / p[0]).powi(2);
    Matrix2::new(force, 0.0, 0.0, LEVELS[1] * LEVELS[1]) * (h / 2.0)
}

/// Rows of C and offsets of the channels.
const SLOPES: [[f64; 2]; 2] = [[0.0, 1.0], [1.1 * 0.5, 1.1]];
const OFFSETS: [f64; 2] = [0.03, 0.0];

fn recording() -> Recording {
    let (times, inputs) = drive(60);
    let measurements = (0..120).map(|i| match i {
        7 | 30 | 31 | 32 | 33 => f64::NAN,
        _ => 0.3 * (0.37 * f64::from(i)).sin() + 0.1 * (1.9 * f64::from(i)).cos(),
    });
    Recording::new(times, inputs, measurements.collect()).unwrap()
}

/// The recursion of the textbook: covariances, one update with all samples of a row.
fn textbook(p: &[f64], recording: &Recording) -> f64 {
    let mut x = Vector2::from(INITIAL);
    let mut cov = Matrix2::from_diagonal(&Vector2::from(SPREAD).map(|s| s * s));
    let mut sum = 0.0;
    for (row, &t) in recording.times().iter().enumerate() {
        let channels: Vec<usize> = (0..2)
            .filter(|&i| !recording.measured(row)[i].is_nan())
            .collect();
        if !channels.is_empty() {
            let c = DMatrix::from_fn(channels.len(), 2, |i, j| SLOPES[channels[i]][j]);
            let noise = channels.iter().map(|&i| NOISE[i] * NOISE[i]);
            let r = DMatrix::from_diagonal(&DVector::from_iterator(channels.len(), noise));
            let e = DVector::from_fn(channels.len(), |i, _| {
                recording.measured(row)[channels[i]] - OFFSETS[channels[i]]
            }) - &c * x;
            let s = &c * cov * c.transpose() + r;
            let inverse = s.clone().try_inverse().unwrap();
            let gain = cov * c.transpose() * &inverse;
            let tau = std::f64::consts::TAU;
            sum -= 0.5 * ((s * tau).determinant().ln() + e.dot(&(&inverse * &e)));
            x += Vector2::from_iterator((&gain * e).iter().copied());
            let shrunk = (DMatrix::identity(2, 2) - gain * c) * cov;
            cov = Matrix2::from_iterator(shrunk.iter().copied());
        }
        if let Some(next) = recording.times().get(row + 1) {
            let h = next - t;
            let (f, g) = discrete(p, h);
            x = f * x + g * recording.inputs(row)[0];
            cov = f * (cov + half_noise(p, h)) * f.transpose() + half_noise(p, h);
        }
    }
    sum
}

/// Means and covariances of the states at all rows, two numbers a row, without any recursion in the
/// covariance: every state is a sum of the initial one and of all kicks.
fn joint_states(p: &[f64], recording: &Recording) -> (DVector<f64>, DMatrix<f64>) {
    let rows = recording.times().len();
    let sources = 2 + 4 * (rows - 1);
    let mut means = DVector::zeros(2 * rows);
    let mut effects = DMatrix::zeros(2 * rows, sources);
    means.rows_mut(0, 2).copy_from(&Vector2::from(INITIAL));
    effects[(0, 0)] = SPREAD[0];
    effects[(1, 1)] = SPREAD[1];
    for row in 1..rows {
        let h = recording.times()[row] - recording.times()[row - 1];
        let (f, g) = discrete(p, h);
        let before = means.rows(2 * row - 2, 2).into_owned();
        means
            .rows_mut(2 * row, 2)
            .copy_from(&(f * before + g * recording.inputs(row - 1)[0]));
        let mut moved = f * effects.rows(2 * row - 2, 2);
        let kick = half_noise(p, h).map(f64::sqrt);
        let first = 2 + 4 * (row - 1);
        moved.columns_mut(first, 2).copy_from(&(f * kick));
        moved.columns_mut(first + 2, 2).copy_from(&kick);
        effects.rows_mut(2 * row, 2).copy_from(&moved);
    }
    let covariance = &effects * effects.transpose();
    (means, covariance)
}

/// Slopes, residuals and noise of all samples as functions of all states.
fn joint_samples(
    recording: &Recording,
    means: &DVector<f64>,
) -> (DMatrix<f64>, DVector<f64>, DMatrix<f64>) {
    let samples: Vec<(usize, usize)> = (0..recording.times().len())
        .flat_map(|row| [(row, 0), (row, 1)])
        .filter(|&(row, channel)| !recording.measured(row)[channel].is_nan())
        .collect();
    let slopes = DMatrix::from_fn(samples.len(), means.len(), |i, j| {
        let (row, channel) = samples[i];
        if j / 2 == row {
            SLOPES[channel][j % 2]
        } else {
            0.0
        }
    });
    let measured = DVector::from_fn(samples.len(), |i, _| {
        let (row, channel) = samples[i];
        recording.measured(row)[channel] - OFFSETS[channel]
    });
    let noise = samples.iter().map(|&(_, channel)| NOISE[channel].powi(2));
    let noise = DMatrix::from_diagonal(&DVector::from_iterator(samples.len(), noise));
    let residuals = measured - &slopes * means;
    (slopes, residuals, noise)
}

#[test]
fn the_likelihood_is_that_of_the_textbook_and_of_all_samples_at_once() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let setup = setup(&model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let values = values(&estimation);
    let got = estimation.log_likelihood(&values).unwrap();

    let wanted = textbook(&values[..3], &recordings[0]);
    assert!(
        (got - wanted).abs() <= ROUNDING * wanted.abs(),
        "{got} against {wanted}"
    );

    let (means, covariance) = joint_states(&values[..3], &recordings[0]);
    let (slopes, residuals, noise) = joint_samples(&recordings[0], &means);
    let joint = (&slopes * covariance * slopes.transpose() + noise)
        .cholesky()
        .unwrap();
    let log_root: f64 = joint.l().diagonal().iter().map(|entry| entry.ln()).sum();
    let count = residuals.len() as f64;
    let wanted = -0.5
        * (count * std::f64::consts::TAU.ln() + residuals.dot(&joint.solve(&residuals)))
        - log_root;
    assert!(
        (got - wanted).abs() <= ROUNDING * wanted.abs(),
        "{got} against {wanted}"
    );
}

#[test]
fn the_smoother_conditions_all_states_on_all_samples() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let setup = setup(&model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let values = values(&estimation);
    let smoothed = estimation.smoothed(&values, 0).unwrap();

    let (means, covariance) = joint_states(&values[..3], &recordings[0]);
    let (slopes, residuals, noise) = joint_samples(&recordings[0], &means);
    let joint = (&slopes * &covariance * slopes.transpose() + noise)
        .cholesky()
        .unwrap();
    let gain = joint.solve(&(&slopes * &covariance)).transpose();
    let means = means + &gain * residuals;
    let covariance = &covariance - &gain * slopes * &covariance;
    assert_eq!(smoothed.len(), recordings[0].times().len());
    for (row, smoothed) in smoothed.iter().enumerate() {
        for i in 0..2 {
            let error = smoothed.state[i] - means[2 * row + i];
            assert!(
                error.abs() <= ROUNDING,
                "row {row}, state {i}: off by {error:e}"
            );
            for j in 0..2 {
                let wanted = covariance[(2 * row + i, 2 * row + j)];
                let error = smoothed.covariance(i, j) - wanted;
                assert!(
                    error.abs() <= ROUNDING,
                    "row {row}, {i}, {j}: off by {error:e}"
                );
            }
        }
    }
}

#[test]
fn the_information_of_levels_is_that_of_differences_of_the_filter() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let setup = setup(&model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let values = values(&estimation);
    let pairs = (0..2).flat_map(|i| {
        let spread = Unknown::Spread { run: 0, state: i };
        [Unknown::Disturbance(i), Unknown::Noise(i), spread]
    });
    let free: Vec<Free> = pairs.map(Free::of).collect();
    let found = estimation.information(&values, &free).unwrap();
    let sensitivity = Sensitivity::of(&estimation, &values, &free).unwrap();
    let expected = sensitivity.information();
    for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
        let scale = (expected[(i, i)] * expected[(j, j)]).sqrt();
        let error = (found[(i, j)] - expected[(i, j)]).abs();
        assert!(error < 1e-6 * scale, "{i} {j}: {error} of {scale}");
    }
}

#[test]
fn a_step_that_was_not_achieved_widens_a_deviation_to_that_of_the_prior_at_most() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let setup = setup(&model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let free = [
        Free::of(Unknown::Parameter(1)).around(0.4, 0.1),
        Free::of(Unknown::Bias(0)),
    ];
    let mut fit = Fit::of(&estimation, &values(&estimation), &free, Effort::default()).unwrap();
    let optimum = fit.deviation(0).unwrap();
    assert!(0.0 < optimum && optimum < 0.1, "{optimum}");
    fit.promised.fill(5e10);
    let bits = |index| fit.deviation(index).unwrap().to_bits();
    assert_eq!(bits(0), 0.1_f64.to_bits());
    assert_eq!(bits(1), 5e10_f64.to_bits());
}

#[test]
fn what_no_filter_can_run_with_is_refused() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let message = |setup: &Setup<'_>| {
        Estimation::new(setup, &recordings)
            .err()
            .unwrap()
            .to_string()
    };
    let mut wrong = setup(&model);
    wrong.longest_step = 1e-12;
    let refused = message(&wrong);
    assert!(refused.contains("steps of the filter"), "{refused}");
    let wrong = Setup::new(&model, &[Measured::State(5), Measured::State(0)]);
    assert_eq!(message(&wrong), "there is no state 5; the model has 2");
    let mut wrong = setup(&model);
    wrong.lagging = vec![0, 0];
    assert_eq!(message(&wrong), "input 0 is given twice");
    let wrong = Setup::new(&model, &[Measured::State(0)]);
    let refused = message(&wrong);
    assert!(refused.contains("measurements"), "{refused}");

    let setup = setup(&model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let mut values = values(&estimation);
    values[estimation.layout().place(Unknown::Noise(1)).unwrap()] = -1.0;
    let error = estimation.log_likelihood(&values).unwrap_err().to_string();
    assert_eq!(error, "noise of channel 1 is -1; it must be 0 or more");
    assert!(Recording::new(vec![0.0, 0.0], vec![], vec![]).is_err());
    let error = Recording::new(vec![0.0], vec![], vec![]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a recording needs at least two rows; this one has 1"
    );
    assert!(Recording::new(vec![0.0, 1.0], vec![], vec![1.0]).is_err());
    assert!(Recording::new(vec![0.0, 1.0], vec![f64::NAN, 0.0], vec![]).is_err());
}

#[test]
fn the_filter_of_a_channel_starts_at_its_first_reading() {
    let (model, known) = (Oscillator::new(), recording());
    let rows = 0..known.times().len();
    let mut measurements: Vec<f64> = rows.flat_map(|row| known.measured(row).to_vec()).collect();
    measurements[1] = f64::NAN;
    let seen = known.with_measurements(measurements.clone()).unwrap();
    measurements.fill(f64::NAN);
    let recordings = [seen, known.with_measurements(measurements).unwrap()];
    let mut setup = setup(&model);
    setup.channels[1].lags = true;
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let (nominal, layout) = (estimation.nominal(), estimation.layout());
    let first = [0, 1].map(|run| {
        let unknown = Unknown::Initial { run, state: 2 };
        nominal[layout.place(unknown).unwrap()]
    });
    let wanted = [known.measured(1)[1], 0.0];
    assert_eq!(first.map(f64::to_bits), wanted.map(f64::to_bits));
}

#[test]
fn the_delay_that_is_refused_is_named_by_its_channel() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let mut setup = setup(&model);
    setup.channels[1].longest_delay = Some(0.1);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let (mut values, layout) = (values(&estimation), estimation.layout());
    values[layout.place(Unknown::SensorDelay(1)).unwrap()] = 0.2;
    assert_eq!(
        estimation.log_likelihood(&values).unwrap_err().to_string(),
        "delay of channel 1 is 0.2; it must be between 0 and the longest delay of its channel"
    );
}

#[test]
fn a_channel_without_noise_needs_samples_that_are_uncertain() {
    let (model, recordings) = (Oscillator::new(), [recording()]);
    let setup = setup(&model);
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let likelihood = |changes: &[(Unknown, f64)]| {
        let mut values = values(&estimation);
        for &(unknown, value) in changes {
            values[estimation.layout().place(unknown).unwrap()] = value;
        }
        let result = estimation.log_likelihood(&values);
        result.map_err(|error| error.to_string())
    };
    let exact = (Unknown::Noise(0), 0.0);
    let known = (Unknown::Spread { run: 0, state: 1 }, 0.0);
    let [still, steady] = [0, 1].map(|i| (Unknown::Disturbance(i), 0.0));
    let refused: Result<f64, String> = Err(
        "noise of channel 0 is 0; it must be positive where no spread or disturbance makes its \
         samples uncertain"
            .to_owned(),
    );
    assert!(likelihood(&[exact]).unwrap().is_finite());
    assert_eq!(likelihood(&[exact, known]), refused);
    // Two samples determine two states.
    assert_eq!(likelihood(&[exact, still, steady]), refused);
    assert!(likelihood(&[known, still, steady]).unwrap().is_finite());
}

//! Parameters from accelerations.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use crate::oscillator::Oscillator;
#[allow(dead_code, reason = "another test drives it as well")]
use appell_estimate::{BaseParameters, Moment, Regression};
use appell_runtime::model::{At, Model};
use nalgebra::DMatrix;

/// Numbers that look random: the fractional parts of multiples of an irrational number.
fn scatter(i: i32, k: f64) -> f64 {
    (f64::from(i) * k).fract() - 0.5
}

/// Moments of a motion; velocities and positions are measured with noise.
fn moments(model: &Oscillator, noise: f64) -> Vec<Moment> {
    let p = model.info().default_parameters();
    let moment = |i: i32| {
        let t = 0.01 * f64::from(i);
        let (x, u) = (
            [0.8 * (2.1 * t).cos(), 0.5 * (1.3 * t).sin()],
            [3.0 * (0.7 * t).sin()],
        );
        let mut rates = [0.0; 2];
        model.rates(
            At {
                t,
                x: &x,
                u: &u,
                p: &p,
            },
            &mut rates,
        );
        let off = [0.618_034, 0.414_214].map(|k| noise * scatter(i, k));
        Moment {
            t,
            x: vec![x[0] + off[0], x[1] + off[1]],
            accelerations: vec![rates[0]],
            u: u.to_vec(),
        }
    };
    (0..2000).map(moment).collect()
}

#[test]
fn exact_motions_give_exact_parameters() {
    let model = Oscillator::new();
    let truth = model.info().default_parameters();
    let start: Vec<f64> = truth.iter().map(|p| 1.3 * p).collect();
    let regression = Regression::about(&model, &moments(&model, 0.0), &start, &[0, 1, 2]).unwrap();
    let (change, _) = regression.least_squares().unwrap();
    for i in 0..3 {
        assert!(
            (start[i] + change[i] - truth[i]).abs() < 1e-8,
            "parameter {i}"
        );
    }
}

#[test]
fn instruments_correct_what_noise_in_the_regressors_spoils() {
    let model = Oscillator::new();
    let truth = model.info().default_parameters();
    let all = [0, 1, 2];
    let noisy = Regression::about(&model, &moments(&model, 0.3), &truth, &all).unwrap();
    let clean = Regression::about(&model, &moments(&model, 0.0), &truth, &all).unwrap();
    let (pulled, _) = noisy.least_squares().unwrap();
    let (corrected, covariance) = noisy.instrumental(&clean.regressors).unwrap();
    // Noise in the position makes the spring look softer.
    assert!(pulled[2] < -0.2, "{pulled}");
    for i in 0..3 {
        let deviation = covariance[(i, i)].sqrt();
        assert!(
            corrected[i].abs() < 4.0 * deviation,
            "{i}: {} of {deviation}",
            corrected[i]
        );
    }
    assert!(corrected[2].abs() < 0.1 * pulled[2].abs(), "{corrected}");
}

#[test]
fn base_parameters_are_what_the_regressors_can_tell_apart() {
    // The third column is the first twice and the second thrice.
    let columns = DMatrix::from_fn(40, 4, |i, j| {
        let i = i32::try_from(i).unwrap();
        let [a, b, c] = [0.618, 0.414, 0.732].map(|k| scatter(i + 1, k));
        [a, 1e3 * b, 2.0 * a + 3e3 * b, c][j]
    });
    let base = BaseParameters::of(&columns, 1e-8);
    assert_eq!((base.independent.len(), base.dependent.len()), (3, 1));
    let basis = columns.select_columns(&base.independent);
    let off = columns.select_columns(&base.dependent) - basis * &base.combinations;
    assert!(off.amax() < 1e-9, "{off}");
}

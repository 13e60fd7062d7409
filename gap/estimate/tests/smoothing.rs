//! Derivatives of noisy samples, held against exact polynomials and published weights.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::{PI, TAU};

use appell_estimate::smoothing::angle::unwrap;
use appell_estimate::smoothing::noise::{at_standstill, from_differences};
use appell_estimate::smoothing::savitzky_golay::{SavitzkyGolay, weights};
use appell_estimate::smoothing::{Samples, SamplesError, window};

/// Rounding of a fit of a few dozen samples.
const ROUNDING: f64 = 1e-12;

/// Numbers that are the same in every run.
struct Random(u64);

impl Random {
    /// Between 0 and 1.
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Standard normal, by the method of Box and Muller.
    fn normal(&mut self) -> f64 {
        let (u, v) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
    }

    /// Times with steps between half and one and a half of `step`.
    fn times(&mut self, count: usize, step: f64) -> Vec<f64> {
        let mut t = 0.3;
        (0..count)
            .map(|_| {
                t += step * (0.5 + self.uniform());
                t
            })
            .collect()
    }
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let size = expected.abs().max(1.0);
    assert!(
        (found - expected).abs() <= tolerance * size,
        "{what}: {found} instead of {expected}"
    );
}

#[test]
fn weights_on_equal_steps_are_the_published_ones() {
    let grid = |half: i32| -> Vec<f64> { (-half..=half).map(f64::from).collect() };
    // Savitzky and Golay (1964), tables I to VII, with the corrections of Steinier and others (1972);
    // the last one at the first point, P. A. Gorry (1990).
    let published = [
        ([0, 2, 0, 35], vec![-3, 12, 17, 12, -3]),
        ([0, 2, 0, 21], vec![-2, 3, 6, 7, 6, 3, -2]),
        ([0, 2, 1, 10], vec![-2, -1, 0, 1, 2]),
        ([0, 4, 1, 12], vec![1, -8, 0, 8, -1]),
        ([0, 2, 2, 7], vec![2, -1, -2, -1, 2]),
        ([-2, 2, 0, 35], vec![31, 9, -3, -5, 3]),
    ];
    for ([t, degree, order, norm], expected) in published {
        let half = i32::try_from(expected.len() / 2).unwrap();
        let size = |n: i32| usize::try_from(n).unwrap();
        let (t, degree, order) = (f64::from(t), size(degree), size(order));
        let found = weights(&grid(half), t, degree, order).unwrap();
        for (found, expected) in found.iter().zip(&expected) {
            let what = format!("{} points, degree {degree}, order {order}", 2 * half + 1);
            let expected = f64::from(*expected) / f64::from(norm);
            assert_near(*found, expected, ROUNDING, &what);
        }
    }
}

#[test]
fn polynomials_have_exact_derivatives_everywhere_on_uneven_grids() {
    let mut random = Random(7);
    let times = random.times(60, 0.1);
    let cubic = |t: f64| [1.0 - 2.0 * t + t * t * t, 3.0 * t * t - 2.0, 6.0 * t];
    let mut values: Vec<f64> = times.iter().map(|&t| cubic(t)[0]).collect();
    values[0] = f64::NAN;
    values[31] = f64::NAN;
    let samples = Samples::new(&times, &values).unwrap();
    let estimate = SavitzkyGolay::new(3, 11).estimate(samples, 2, 1.0).unwrap();
    for (row, &t) in times.iter().enumerate() {
        for order in 0..3 {
            let what = format!("order {order} at {t}");
            assert_near(
                estimate[row].means[order],
                cubic(t)[order],
                1e3 * ROUNDING,
                &what,
            );
        }
    }
}

#[test]
fn variances_are_sums_of_the_squares_of_the_weights() {
    let mut random = Random(3);
    let times = random.times(15, 0.02);
    let values = [0.0; 15];
    let samples = Samples::new(&times, &values).unwrap();
    let std = 0.3;
    let estimate = SavitzkyGolay::new(3, 15).estimate(samples, 2, std).unwrap();
    for row in [0, 4, 7, 14] {
        for order in 0..3 {
            let weights = weights(&times, times[row], 3, order).unwrap();
            let expected = std * weights.iter().map(|w| w * w).sum::<f64>().sqrt();
            let found = estimate[row].stds[order];
            assert!((found - expected).abs() < 1e-10 * expected);
        }
    }
}

/// Truth, and samples of it with noise.
fn sine(random: &mut Random, times: &[f64], std: f64) -> (Vec<[f64; 3]>, Vec<f64>) {
    let omega = 3.0;
    let truth = |t: f64| {
        let (sin, cos) = (omega * t).sin_cos();
        [sin, omega * cos, -omega * omega * sin]
    };
    let truth: Vec<[f64; 3]> = times.iter().map(|&t| truth(t)).collect();
    let values = truth.iter().map(|y| y[0] + std * random.normal()).collect();
    (truth, values)
}

#[test]
fn the_chosen_window_is_nearly_the_best_one() {
    let mut random = Random(11);
    let times = random.times(600, 0.01);
    for std in [1e-4, 1e-2] {
        for order in [1, 2] {
            let (truth, values) = sine(&mut random, &times, std);
            let samples = Samples::new(&times, &values).unwrap();
            let error = |filter: SavitzkyGolay| {
                let estimate = filter.estimate(samples, order, std).unwrap();
                let squares =
                    (150..450).map(|i| (estimate[i].means[order] - truth[i][order]).powi(2));
                squares.sum::<f64>().sqrt()
            };
            let chosen = error(window::chosen(samples, 3, order, std).unwrap());
            let best = (5..300)
                .step_by(4)
                .map(|count| error(SavitzkyGolay::new(3, count)))
                .fold(f64::INFINITY, f64::min);
            assert!(
                chosen < 1.5 * best,
                "noise {std}, order {order}: {chosen} against {best}"
            );
        }
    }
}

#[test]
fn the_noise_level_is_found_beside_a_motion() {
    let mut random = Random(37);
    let times = random.times(2000, 0.01);
    for std in [1e-5, 1e-3, 0.1] {
        let (_, mut values) = sine(&mut random, &times, std);
        values[700] += 50.0 * std;
        values[900] = f64::NAN;
        let samples = Samples::new(&times, &values).unwrap();
        let found = from_differences(&[samples]).unwrap();
        assert!(found.settled);
        assert_near(found.std / std, 1.0, 0.12, &format!("noise of {std}"));
    }
}

#[test]
fn a_motion_too_fast_for_its_sampling_is_not_taken_for_noise_unsaid() {
    let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.1).collect();
    let values: Vec<f64> = times.iter().map(|t| (25.0 * t).sin()).collect();
    let samples = Samples::new(&times, &values).unwrap();
    let found = from_differences(&[samples]).unwrap();
    assert!(found.std > 0.3 || !found.settled, "{found:?}");
}

#[test]
fn standstill_tells_the_noise_level_and_motion_does_not() {
    let mut random = Random(41);
    let times: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.01).collect();
    let values: Vec<f64> = times
        .iter()
        .map(|&t| 0.01 * random.normal() + if t < 4.0 { 0.0 } else { (t - 4.0).powi(2) })
        .collect();
    let samples = Samples::new(&times, &values).unwrap();
    assert_near(at_standstill(&[samples]).unwrap() / 0.01, 1.0, 0.1, "noise");
    let moving = Samples::new(&times[450..], &values[450..]).unwrap();
    assert_eq!(at_standstill(&[moving]), None);
}

#[test]
fn angles_are_counted_on_through_whole_turns() {
    let mut angles: Vec<f64> = (0..100)
        .map(|i| (f64::from(i) * 0.4 + PI).rem_euclid(TAU) - PI)
        .collect();
    angles[15] = f64::NAN;
    assert_eq!(unwrap(&mut angles), 6);
    for (i, angle) in angles.iter().enumerate().filter(|(i, _)| *i != 15) {
        assert_near(*angle, i as f64 * 0.4, ROUNDING, "the angle");
    }
    let mut still = vec![0.1, 0.2, f64::NAN, 0.1];
    assert_eq!(unwrap(&mut still), 0);
}

#[test]
fn what_cannot_be_smoothed_is_told() {
    let of = |times: &'static [f64], values: &'static [f64]| Samples::new(times, values);
    assert_eq!(
        of(&[0.0, 1.0], &[0.0]).unwrap_err(),
        SamplesError::Lengths {
            times: 2,
            values: 1
        }
    );
    assert_eq!(
        of(&[0.0, 0.0], &[1.0, 2.0]).unwrap_err(),
        SamplesError::TimesNotIncreasing { row: 1, t: 0.0 }
    );
    let few = of(&[0.0, 1.0, 2.0], &[0.0, f64::NAN, 1.0]).unwrap();
    let too_few = SamplesError::TooFew {
        found: 2,
        needed: 3,
    };
    let filter = SavitzkyGolay::new(2, 3);
    assert_eq!(filter.estimate(few, 1, 1.0).unwrap_err(), too_few);
}

//! Derivatives of noisy samples, held against exact polynomials, published weights, and formulations
//! that share nothing with them.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::{PI, TAU};

use appell_estimate::smoothing::angle::unwrap;
use appell_estimate::smoothing::butterworth::ZeroPhase;
use appell_estimate::smoothing::kinematic::Kinematic;
use appell_estimate::smoothing::noise::{at_standstill, from_differences};
use appell_estimate::smoothing::savitzky_golay::{SavitzkyGolay, weights};
use appell_estimate::smoothing::spline::SmoothingSpline;
use appell_estimate::smoothing::{Samples, SamplesError, window};
use nalgebra::{DMatrix, DVector};

/// Rounding of a fit of a few dozen samples.
const ROUNDING: f64 = 1e-12;
/// The batch inverts matrices with a condition of ten thousand, and its variances are small differences.
const BATCH: f64 = 1e-6;

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
    let estimate = SavitzkyGolay::new(3, 11)
        .unwrap()
        .estimate(samples, 2, 1.0)
        .unwrap();
    for (row, &t) in times.iter().enumerate() {
        for order in 0..3 {
            let what = format!("order {order} at {t}");
            assert_near(
                estimate.at(row)[order],
                cubic(t)[order],
                1e3 * ROUNDING,
                &what,
            );
        }
    }
}

#[test]
fn covariances_are_sums_of_the_squares_of_the_weights() {
    let mut random = Random(3);
    let times = random.times(15, 0.02);
    let values = [0.0; 15];
    let samples = Samples::new(&times, &values).unwrap();
    let std = 0.3;
    let estimate = SavitzkyGolay::new(3, 15)
        .unwrap()
        .estimate(samples, 2, std)
        .unwrap();
    for row in [0, 4, 7, 14] {
        let w: Vec<Vec<f64>> = (0..3)
            .map(|order| weights(&times, times[row], 3, order).unwrap())
            .collect();
        for r in 0..3 {
            for s in 0..3 {
                let expected: f64 = w[r].iter().zip(&w[s]).map(|(a, b)| a * b).sum();
                let found = estimate.covariance(row)[3 * r + s];
                let size = estimate.std(row, r) * estimate.std(row, s);
                assert!((found - std * std * expected).abs() < 1e-10 * size);
            }
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
                let squares = (150..450).map(|i| (estimate.at(i)[order] - truth[i][order]).powi(2));
                squares.sum::<f64>().sqrt()
            };
            let chosen = error(window::chosen(samples, 3, order, std).unwrap());
            let best = (5..300)
                .step_by(4)
                .map(|count| error(SavitzkyGolay::new(3, count).unwrap()))
                .fold(f64::INFINITY, f64::min);
            assert!(
                chosen < 1.5 * best,
                "noise {std}, order {order}: {chosen} against {best}"
            );
        }
    }
}

fn power(x: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |y, _| y * x)
}

/// Covariance of the derivatives p and r at s and t of m-fold integrated white noise of intensity one
/// that starts from rest at 0: ∫₀^min (s − u)^(m−1−p)/(m−1−p)! (t − u)^(m−1−r)/(m−1−r)! du.
fn integrated_noise(m: usize, s: f64, p: usize, t: f64, r: usize) -> f64 {
    if s > t {
        return integrated_noise(m, t, r, s, p);
    }
    let (a, b) = (m - 1 - p, m - 1 - r);
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    // (t − u)^b = (v + d)^b with v = s − u.
    let d = t - s;
    let terms = (0..=b).map(|k| {
        let binomial = factorial(b) / (factorial(k) * factorial(b - k));
        binomial * power(d, b - k) * power(s, a + k + 1) / (a + k + 1) as f64
    });
    terms.sum::<f64>() / (factorial(a) * factorial(b))
}

/// The same motion as one Gaussian vector: polynomials with free coefficients plus integrated noise.
struct Batch {
    weights: DMatrix<f64>,
    trend: DMatrix<f64>,
    coefficients: DVector<f64>,
    normal: DMatrix<f64>,
    values: DVector<f64>,
}

impl Batch {
    fn new(m: usize, std: f64, intensity: f64, times: &[f64], values: &[f64]) -> Self {
        let n = times.len();
        let v = DMatrix::from_fn(n, n, |i, j| {
            let noise = if i == j { std * std } else { 0.0 };
            noise + intensity * integrated_noise(m, times[i], 0, times[j], 0)
        });
        let trend = DMatrix::from_fn(n, m, |i, k| power(times[i], k));
        let weights = v.try_inverse().unwrap();
        let normal = (trend.transpose() * &weights * &trend)
            .try_inverse()
            .unwrap();
        let values = DVector::from_column_slice(values);
        let coefficients = &normal * trend.transpose() * &weights * &values;
        Self {
            weights,
            trend,
            coefficients,
            normal,
            values,
        }
    }

    fn log_likelihood(&self) -> f64 {
        let residual = &self.values - &self.trend * &self.coefficients;
        let square = (residual.transpose() * &self.weights * &residual)[0];
        0.5 * (self.weights.determinant().ln() + self.normal.determinant().ln() - square)
    }

    /// Mean and variance of a derivative at a time.
    fn at(&self, m: usize, intensity: f64, times: &[f64], t: f64, order: usize) -> [f64; 2] {
        let c = DVector::from_iterator(
            times.len(),
            times
                .iter()
                .map(|&s| intensity * integrated_noise(m, t, order, s, 0)),
        );
        let falling = |k: usize| (0..order).map(|i| k as f64 - i as f64).product::<f64>();
        let h = DVector::from_fn(m, |k, _| {
            if k < order {
                0.0
            } else {
                falling(k) * power(t, k - order)
            }
        });
        let residual = &self.values - &self.trend * &self.coefficients;
        let mean = h.dot(&self.coefficients) + (c.transpose() * &self.weights * residual)[0];
        let lever = &h - self.trend.transpose() * &self.weights * &c;
        let own = intensity * integrated_noise(m, t, order, t, order);
        let variance = own - (c.transpose() * &self.weights * &c)[0]
            + (lever.transpose() * &self.normal * &lever)[0];
        [mean, variance]
    }
}

#[test]
fn the_kinematic_smoother_is_the_batch_estimate() {
    let mut random = Random(5);
    let times = random.times(40, 0.02);
    let (_, mut values) = sine(&mut random, &times, 0.05);
    // The batch knows only what is there; the smoother also tells about the missing ones.
    let gaps = [3, 17, 18, 39];
    let mut there: (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for (row, value) in values.iter_mut().enumerate() {
        if gaps.contains(&row) {
            *value = f64::NAN;
        } else {
            there.0.push(times[row]);
            there.1.push(*value);
        }
    }
    let samples = Samples::new(&times, &values).unwrap();
    let std = 0.05;
    for m in 1..=3 {
        let mut likelihoods = Vec::new();
        for intensity in [3.0, 400.0] {
            let model = Kinematic::new(m, std, intensity).unwrap();
            let smoothed = model.smooth(samples).unwrap();
            let batch = Batch::new(m, std, intensity, &there.0, &there.1);
            for (row, &t) in times.iter().enumerate() {
                for order in 0..m {
                    let [mean, variance] = batch.at(m, intensity, &there.0, t, order);
                    let what = format!("m = {m}, q = {intensity}, order {order} at row {row}");
                    assert_near(smoothed.estimate.at(row)[order], mean, BATCH, &what);
                    let found = smoothed.estimate.std(row, order);
                    assert_near(found / variance.sqrt(), 1.0, BATCH, &what);
                }
            }
            likelihoods.push(smoothed.log_likelihood - batch.log_likelihood());
        }
        let what = format!("likelihood of m = {m}");
        assert_near(likelihoods[1], likelihoods[0], BATCH, &what);
    }
}

#[test]
fn stated_intervals_hold_as_often_as_they_should() {
    let mut random = Random(17);
    let (step, std, intensity) = (0.02, 0.01, 25.0);
    let (mut inside, mut all) = ([0, 0], 0);
    for _ in 0..60 {
        // White acceleration, exactly sampled.
        let times: Vec<f64> = (0..120).map(|i| f64::from(i) * step).collect();
        let (mut y, mut v) = (1.0, -2.0);
        let mut truth = Vec::new();
        for _ in &times {
            truth.push([y, v]);
            let (a, b) = (random.normal(), random.normal());
            let spread = (intensity * step).sqrt();
            y += step * v + spread * step * (0.5 * a + b / 12f64.sqrt());
            v += spread * a;
        }
        let values: Vec<f64> = truth.iter().map(|x| x[0] + std * random.normal()).collect();
        let samples = Samples::new(&times, &values).unwrap();
        let model = Kinematic::new(2, std, intensity).unwrap();
        let estimate = model.smooth(samples).unwrap().estimate;
        for (row, truth) in truth.iter().enumerate() {
            all += 1;
            for order in 0..2 {
                let off = (estimate.at(row)[order] - truth[order]).abs();
                inside[order] += usize::from(off < 1.959_964 * estimate.std(row, order));
            }
        }
    }
    for count in inside {
        let share = count as f64 / f64::from(all);
        assert!((0.94..0.96).contains(&share), "{share} instead of 0.95");
    }
}

#[test]
fn the_most_likely_motion_has_the_noise_and_the_intensity_that_made_it() {
    let mut random = Random(23);
    let (step, std, intensity) = (0.01, 0.02, 400.0_f64);
    let times: Vec<f64> = (0..4000).map(|i| f64::from(i) * step).collect();
    let (mut y, mut v) = (0.0, 0.0);
    let values: Vec<f64> = times
        .iter()
        .map(|_| {
            let (a, b) = (random.normal(), random.normal());
            let spread = (intensity * step).sqrt();
            y += step * v + spread * step * (0.5 * a + b / 12f64.sqrt());
            v += spread * a;
            y + std * random.normal()
        })
        .collect();
    let samples = Samples::new(&times, &values).unwrap();
    for known in [Some(std), None] {
        let found = Kinematic::most_likely(2, known, samples).unwrap();
        assert_near(found.std() / std, 1.0, 0.05, "noise");
        assert_near(found.intensity() / intensity, 1.0, 0.2, "intensity");
    }
}

#[test]
fn cross_validation_finds_the_noise_and_smooths_nearly_as_well_as_can_be() {
    let mut random = Random(29);
    let times = random.times(500, 0.02);
    let std = 0.05;
    let (truth, values) = sine(&mut random, &times, std);
    let samples = Samples::new(&times, &values).unwrap();
    let spline = SmoothingSpline::cross_validated(3, samples).unwrap();
    assert_near(spline.std / std, 1.0, 0.1, "noise");
    let error = |derivatives: &[f64]| {
        let pairs = derivatives.iter().zip(&truth);
        pairs
            .map(|(found, y)| (found - y[1]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let best = (0..40)
        .map(|i| 0.01 * 1.2f64.powi(i))
        .map(|tau| Kinematic::with_smoothing_time(3, std, tau, samples).unwrap())
        .map(|model| error(&model.smooth(samples).unwrap().estimate.derivative(1)))
        .fold(f64::INFINITY, f64::min);
    let found = error(&spline.estimate.derivative(1));
    assert!(found < 1.5 * best, "{found} against {best}");
}

#[test]
fn the_zero_phase_filter_keeps_the_phase_and_halves_the_power_where_it_says() {
    let (rate, frequency) = (200.0, 6.0);
    for order in 1..=5 {
        let filter = ZeroPhase::new(order, frequency, 1.0 / rate).unwrap();
        for f in [2.0, 6.0, 11.0] {
            let wave = |i: usize| (TAU * f * i as f64 / rate).cos();
            let values: Vec<f64> = (0..2000).map(wave).collect();
            let filtered = filter.apply(&values);
            // Both parts of the response, over whole periods in the middle.
            let part = |quarter: f64| {
                let sum: f64 = (400..1600)
                    .map(|i| filtered[i] * (TAU * f * i as f64 / rate + quarter).cos())
                    .sum();
                sum / 600.0
            };
            let warped = |f: f64| (PI * f / rate).tan();
            let ratio = (warped(f) / warped(frequency)).powi(2 * i32::try_from(order).unwrap());
            let expected = 1.0 / (1.0 + (2f64.sqrt() - 1.0) * ratio);
            assert_near(part(0.0), expected, 1e-5, &format!("order {order}, {f} Hz"));
            assert_near(part(PI / 2.0), 0.0, 1e-5, "phase");
        }
    }
}

#[test]
fn the_zero_phase_filter_leaves_constants_and_treats_both_ends_alike() {
    let filter = ZeroPhase::new(4, 5.0, 0.01).unwrap();
    for value in filter.apply(&[2.5; 50]) {
        assert_near(value, 2.5, ROUNDING, "a constant");
    }
    let mut random = Random(31);
    let values: Vec<f64> = (0..300).map(|_| random.normal()).collect();
    let reversed: Vec<f64> = values.iter().rev().copied().collect();
    let (there, back) = (filter.apply(&values), filter.apply(&reversed));
    for (a, b) in there.iter().zip(back.iter().rev()) {
        assert_near(*a, *b, 1e-6, "forwards and backwards");
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
    let model = Kinematic::new(3, 1.0, 1.0).unwrap();
    assert_eq!(model.smooth(few).unwrap_err(), too_few);
    let filter = SavitzkyGolay::new(2, 3).unwrap();
    assert_eq!(filter.estimate(few, 1, 1.0).unwrap_err(), too_few);
    assert_eq!(
        ZeroPhase::filtered(2, 0.1, few).unwrap_err(),
        SamplesError::Missing { row: 1 }
    );
    let uneven = of(&[0.0, 1.0, 3.0], &[0.0, 1.0, 2.0]).unwrap();
    assert!(matches!(
        ZeroPhase::filtered(2, 0.1, uneven).unwrap_err(),
        SamplesError::NotUniform { .. }
    ));
    assert!(Kinematic::new(2, f64::NAN, 1.0).is_err());
    assert!(SavitzkyGolay::new(9, 30).is_err());
    assert!(ZeroPhase::new(2, 60.0, 0.01).is_err());
}

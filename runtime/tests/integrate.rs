//! Integrators against closed forms and against the crate `ivp`.

// A failed integration fails the test.
#![allow(clippy::unwrap_used)]

use appell_runtime::Lanes;
use appell_runtime::integrate::{
    Cause, Dop853, Dopri5, EmbeddedPair, Ending, Failure, IntegrationError, NoObserver, Options,
    Outcome, Rk4, Solver, Statistics, Step, Watch,
};
use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::ControlFlow;

fn oscillator(_: f64, x: &[f64], rates: &mut [f64]) {
    rates[0] = x[1];
    rates[1] = -x[0];
}

/// Restricted three-body problem in the rotating frame (Hairer, Nørsett and Wanner, section II.0).
fn arenstorf(_: f64, x: &[f64], rates: &mut [f64]) {
    let mu = 0.012_277_471;
    let mu_1 = 1.0 - mu;
    let d_1 = ((x[0] + mu).powi(2) + x[1] * x[1]).powf(1.5);
    let d_2 = ((x[0] - mu_1).powi(2) + x[1] * x[1]).powf(1.5);
    rates[0] = x[2];
    rates[1] = x[3];
    rates[2] = x[0] + 2.0 * x[3] - mu_1 * (x[0] + mu) / d_1 - mu * (x[0] - mu_1) / d_2;
    rates[3] = x[1] - 2.0 * x[2] - mu_1 * x[1] / d_1 - mu * x[1] / d_2;
}

const ARENSTORF_PERIOD: f64 = 17.065_216_560_157_963;
const ARENSTORF_START: [f64; 4] = [0.994, 0.0, 0.0, -2.001_585_106_379_082_5];

fn integrate<P: EmbeddedPair>(
    f: impl FnMut(f64, &[f64], &mut [f64]),
    span: [f64; 2],
    x: &mut [f64],
    tolerance: f64,
) -> Outcome {
    let options = Options::with_tolerances(tolerance, tolerance);
    Solver::<P>::new()
        .integrate(f, span, x, &options, &mut Watch::default(), &mut NoObserver)
        .unwrap()
}

fn failure(error: IntegrationError) -> Failure {
    match error {
        IntegrationError::Failure(failure) => failure,
        IntegrationError::InvalidArgument { .. } => panic!("{error}"),
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// The error of one period of the oscillator in `count` steps of equal length.
fn oscillator_error(count: u32, integrate: impl Fn(f64, &mut [f64])) -> f64 {
    let mut x = [1.0, 0.0];
    integrate(TAU / f64::from(count), &mut x);
    distance(&x, &[1.0, 0.0])
}

fn fixed_step_error<P: EmbeddedPair>(count: u32) -> f64 {
    oscillator_error(count, |h, x| {
        let options = Options {
            first_step: Some(h),
            max_step: h,
            // Every step is accepted: only `max_step` limits it.
            ..Options::with_tolerances(1e3, 1e3)
        };
        Solver::<P>::new()
            .integrate(
                oscillator,
                [0.0, TAU],
                x,
                &options,
                &mut Watch::default(),
                &mut NoObserver,
            )
            .unwrap();
    })
}

fn observed_order(error_of: impl Fn(u32) -> f64, count: u32) -> f64 {
    (error_of(count) / error_of(2 * count)).log2()
}

/// Observed orders differ from the asymptotic ones by the next power of the step.
const ORDER_TOLERANCE: f64 = 0.15;

#[test]
fn each_method_converges_with_its_order() {
    let dopri5 = observed_order(fixed_step_error::<Dopri5>, 40);
    assert!((dopri5 - 5.0).abs() < ORDER_TOLERANCE, "{dopri5}");
    let dop853 = observed_order(fixed_step_error::<Dop853>, 10);
    assert!((dop853 - 8.0).abs() < 2.0 * ORDER_TOLERANCE, "{dop853}");
    let rk4 = |count| {
        oscillator_error(count, |h, x| {
            Rk4::new()
                .integrate(
                    oscillator,
                    [0.0, TAU],
                    x,
                    h,
                    &mut Watch::default(),
                    &mut NoObserver,
                )
                .unwrap();
        })
    };
    let rk4 = observed_order(rk4, 80);
    assert!((rk4 - 4.0).abs() < ORDER_TOLERANCE, "{rk4}");
}

/// Largest error of the interpolant inside the first step of length h, over the exact solution.
fn interpolation_error<P: EmbeddedPair>(h: f64) -> f64 {
    let mut largest: f64 = 0.0;
    let mut x = [1.0, 0.0];
    let options = Options {
        first_step: Some(h),
        max_step: h,
        ..Options::with_tolerances(1e3, 1e3)
    };
    let mut observer = |step: &Step<'_>| {
        let interior = step.interior.unwrap();
        for part in 1..20 {
            let t = step.t_old + (step.t - step.t_old) * f64::from(part) / 20.0;
            largest = largest.max(distance(
                &[interior.component(t, 0), interior.component(t, 1)],
                &[t.cos(), -t.sin()],
            ));
        }
        ControlFlow::Break(())
    };
    Solver::<P>::new()
        .integrate(
            oscillator,
            [0.0, TAU],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut observer,
        )
        .unwrap();
    largest
}

#[test]
fn interpolants_have_their_orders() {
    // A local error of order p + 1 for an interpolant of order p.
    let dopri5 = (interpolation_error::<Dopri5>(0.2) / interpolation_error::<Dopri5>(0.1)).log2();
    assert!((dopri5 - 5.0).abs() < 2.0 * ORDER_TOLERANCE, "{dopri5}");
    let dop853 = (interpolation_error::<Dop853>(1.0) / interpolation_error::<Dop853>(0.5)).log2();
    assert!((dop853 - 8.0).abs() < 3.0 * ORDER_TOLERANCE, "{dop853}");
}

/// Accepted steps carry 1e-12 each; the interpolant adds about as much.
const DENSE_TOLERANCE: f64 = 1e-11;

#[test]
fn dense_output_is_as_accurate_as_the_steps() {
    let mut x = [1.0, 0.0];
    let mut largest: f64 = 0.0;
    let mut observer = |step: &Step<'_>| {
        let interior = step.interior.unwrap();
        for part in 0..=50 {
            let t = step.t_old + (step.t - step.t_old) * f64::from(part) / 50.0;
            let mut x = [0.0; 2];
            interior.state(t, &mut x);
            largest = largest.max(distance(&x, &[t.cos(), -t.sin()]));
        }
        ControlFlow::Continue(())
    };
    let options = Options::with_tolerances(1e-12, 1e-12);
    Solver::<Dop853>::new()
        .integrate(
            oscillator,
            [0.0, TAU],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut observer,
        )
        .unwrap();
    assert!(largest < DENSE_TOLERANCE, "{largest:e}");
}

#[test]
fn the_arenstorf_orbit_closes() {
    // The orbit multiplies errors by some hundreds; velocities at the perigee by more.
    let mut x = ARENSTORF_START;
    let outcome = integrate::<Dop853>(arenstorf, [0.0, ARENSTORF_PERIOD], &mut x, 1e-13);
    assert!(distance(&x[..2], &ARENSTORF_START[..2]) < 1e-10, "{x:?}");
    assert!(distance(&x, &ARENSTORF_START) < 1e-8, "{x:?}");
    assert_eq!(
        outcome.statistics,
        Statistics {
            steps: 390,
            rejected: 34,
            evaluations: 5056
        }
    );
    let mut x = ARENSTORF_START;
    let outcome = integrate::<Dopri5>(arenstorf, [0.0, ARENSTORF_PERIOD], &mut x, 1e-10);
    assert!(distance(&x, &ARENSTORF_START) < 1e-4);
    assert_eq!(
        outcome.statistics,
        Statistics {
            steps: 841,
            rejected: 2,
            evaluations: 5060
        }
    );
}

struct Function<F>(F);

impl<F: Fn(f64, &[f64], &mut [f64])> ivp::prelude::FirstOrderSystem for Function<F> {
    fn derivative(&self, t: f64, x: &[f64], rates: &mut [f64]) {
        (self.0)(t, x, rates);
    }
}

#[test]
fn both_pairs_agree_with_the_crate_ivp() {
    let span = [0.0, 0.8 * ARENSTORF_PERIOD];
    let oracle = |method| {
        let system = Function(arenstorf);
        let solution = ivp::prelude::Ivp::first_order(&system, span[0], span[1], &ARENSTORF_START)
            .method(method)
            .rtol(1e-12)
            .atol(1e-12)
            .solve()
            .unwrap();
        solution.y.last().unwrap().clone()
    };
    // The same formulas with the same control: the steps differ by rounding only, which the
    // orbit amplifies.
    let same_steps = 1e-9;
    let mut x = ARENSTORF_START;
    integrate::<Dop853>(arenstorf, span, &mut x, 1e-12);
    let gap = distance(&x, &oracle(ivp::prelude::Method::DOP853));
    assert!(gap < same_steps, "{gap:e}");
    let mut x = ARENSTORF_START;
    integrate::<Dopri5>(arenstorf, span, &mut x, 1e-12);
    let gap = distance(&x, &oracle(ivp::prelude::Method::DOPRI5));
    assert!(gap < same_steps, "{gap:e}");
}

#[test]
fn a_pendulum_keeps_its_energy_for_a_minute() {
    let pendulum = |_: f64, x: &[f64], rates: &mut [f64]| {
        rates[0] = x[1];
        rates[1] = -9.81 * x[0].sin();
    };
    let energy = |x: &[f64]| 0.5 * x[1] * x[1] - 9.81 * x[0].cos();
    let start = [2.5, 0.0];
    let mut x = start;
    integrate::<Dop853>(pendulum, [0.0, 60.0], &mut x, 1e-12);
    let drift = (energy(&x) - energy(&start)).abs();
    // Some 600 steps of 1e-12 on energies near 10.
    assert!(drift < 1e-9, "{drift:e}");
}

#[test]
fn a_singular_motion_ends_in_a_typed_error() {
    // ẋ = x² from 1 is 1/(1 − t).
    let blow_up = |_: f64, x: &[f64], rates: &mut [f64]| rates[0] = x[0] * x[0];
    let options = Options::default();
    let mut x = [1.0];
    let error = Solver::<Dop853>::new()
        .integrate(
            blow_up,
            [0.0, 2.0],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut NoObserver,
        )
        .unwrap_err();
    let failed = failure(error);
    assert!(
        matches!(failed.cause, Cause::StepTooSmall { .. }),
        "{failed}"
    );
    assert!((failed.t - 1.0).abs() < 1e-6, "{failed}");
    assert_eq!(failed.state[0].to_bits(), x[0].to_bits());
    // What it cost is known although it failed.
    assert!(failed.statistics.steps > 100 && failed.statistics.evaluations > 1200);

    // ẋ = −1/√(1 − 2t)… as a function of t alone: no rates after t = 0.5.
    let no_rates = |t: f64, _: &[f64], rates: &mut [f64]| rates[0] = (0.5 - t).sqrt();
    let mut x = [1.0];
    let error = Solver::<Dopri5>::new()
        .integrate(
            no_rates,
            [0.0, 2.0],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut NoObserver,
        )
        .unwrap_err();
    let failed = failure(error);
    assert_eq!(failed.cause, Cause::NonFinite { component: 0 });
    assert!((failed.t - 0.5).abs() < 1e-9, "{failed}");
    let error = Rk4::new()
        .integrate(
            no_rates,
            [0.0, 2.0],
            &mut x,
            0.1,
            &mut Watch::default(),
            &mut NoObserver,
        )
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "at t = 0.5 s, x = [1.470497]: state 0 or its rate is not finite"
    );
}

#[test]
fn the_limit_on_steps_and_bad_arguments_are_typed_errors() {
    let mut x = [1.0, 0.0];
    let options = Options {
        max_steps: 10,
        ..Options::default()
    };
    let mut run = |span, options: &Options| {
        Solver::<Dop853>::new()
            .integrate(
                oscillator,
                span,
                &mut x,
                options,
                &mut Watch::default(),
                &mut NoObserver,
            )
            .unwrap_err()
    };
    let error = run([0.0, 1e6], &options);
    let failed = failure(error);
    assert_eq!(failed.cause, Cause::TooManySteps { steps: 10 });
    let statistics = failed.statistics;
    assert_eq!(statistics.steps + statistics.rejected, 10);
    let error = run([1.0, 0.0], &options);
    assert_eq!(error.to_string(), "end of the interval cannot be 0");
    let error = run([0.0, f64::NAN], &options);
    assert_eq!(error.to_string(), "end of the interval cannot be NaN");
    let error = run([0.0, 1.0], &Options::with_tolerances(-1.0, 0.0));
    assert_eq!(error.to_string(), "rtol cannot be -1");
}

#[test]
fn a_start_that_is_no_number_is_a_typed_error() {
    let mut x = [0.0, f64::NAN];
    let options = Options::default();
    let error = Solver::<Dop853>::new()
        .integrate(
            oscillator,
            [0.0, 1.0],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut NoObserver,
        )
        .unwrap_err();
    assert_eq!(failure(error).cause, Cause::NonFinite { component: 1 });
}

#[test]
fn a_state_at_rest_needs_no_absolute_tolerance() {
    let mut x = [0.0, 0.0];
    let outcome = Solver::<Dop853>::new()
        .integrate(
            oscillator,
            [0.0, 9.0],
            &mut x,
            &Options::with_tolerances(1e-9, 0.0),
            &mut Watch::default(),
            &mut NoObserver,
        )
        .unwrap();
    assert_eq!(outcome.ending, Ending::Finished);
}

#[test]
fn an_observer_can_stop_and_an_empty_interval_is_no_step() {
    let mut x = [1.0, 0.0];
    let options = Options {
        max_step: 0.1,
        ..Options::default()
    };
    let mut observer = |step: &Step<'_>| {
        if step.t > FRAC_PI_2 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let mut solver = Solver::<Dopri5>::new();
    let outcome = solver
        .integrate(
            oscillator,
            [0.0, 9.0],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut observer,
        )
        .unwrap();
    assert_eq!(outcome.ending, Ending::Stopped);
    assert!((outcome.t - 1.6).abs() < 0.1);
    assert!((x[0] - outcome.t.cos()).abs() < 1e-8);
    let before = x;
    let outcome = solver
        .integrate(
            oscillator,
            [2.0, 2.0],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut observer,
        )
        .unwrap();
    assert_eq!(
        (outcome.ending, outcome.statistics.steps),
        (Ending::Finished, 0)
    );
    assert_eq!(x.map(f64::to_bits), before.map(f64::to_bits));
}

#[test]
fn evaluations_are_counted_truly() {
    let count = Cell::new(0);
    let counted = |t: f64, x: &[f64], rates: &mut [f64]| {
        count.set(count.get() + 1);
        oscillator(t, x, rates);
    };
    let mut x = [1.0, 0.0];
    let outcome = integrate::<Dop853>(counted, [0.0, 100.0], &mut x, 1e-9);
    assert_eq!(outcome.statistics.evaluations, count.get());
    assert_eq!(
        outcome.statistics,
        Statistics {
            steps: 212,
            rejected: 0,
            evaluations: 2546
        }
    );
    count.set(0);
    let mut x = [1.0, 0.0];
    let outcome = integrate::<Dopri5>(counted, [0.0, 100.0], &mut x, 1e-6);
    assert_eq!(outcome.statistics.evaluations, count.get());
    assert_eq!(
        outcome.statistics,
        Statistics {
            steps: 388,
            rejected: 0,
            evaluations: 2330
        }
    );
}

#[test]
fn an_ensemble_in_lanes_follows_its_own_motions() {
    // Eight oscillators, each with its frequency: state i of lane k at x[8 i + k].
    let frequencies = Lanes::standard(std::array::from_fn::<f64, 8, _>(|lane| {
        1.0 + 0.1 * lane as f64
    }));
    let mut x: Vec<f64> = [1.0; 8].into_iter().chain([0.0; 8]).collect();
    let together = |_: f64, x: &[f64], rates: &mut [f64]| {
        let (x, _) = x.as_chunks::<8>();
        let (rates, _) = rates.as_chunks_mut::<8>();
        rates[0] = x[1];
        rates[1] = (-(frequencies * frequencies * Lanes::standard(x[0]))).0;
    };
    integrate::<Dop853>(together, [0.0, 20.0], &mut x, 1e-10);
    for lane in 0..8 {
        let exact = (20.0 * frequencies.0[lane]).cos();
        // The tolerance per step times some hundred steps and the growth of phase errors.
        assert!(
            (x[lane] - exact).abs() < 1e-7,
            "{lane}: {} {exact}",
            x[lane]
        );
    }
}

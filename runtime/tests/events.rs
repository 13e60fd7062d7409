//! Events, switching times and ranges.

// A failed integration fails the test.
#![allow(clippy::unwrap_used)]

use appell_runtime::integrate::{
    Cause, Direction, Dop853, Dopri5, EmbeddedPair, Ending, Event, Failure, IntegrationError,
    NoObserver, Options, Range, Rk4, Solver, Step, Switches, Watch,
};
use std::f64::consts::PI;
use std::ops::ControlFlow;

fn oscillator(_: f64, x: &[f64], rates: &mut [f64]) {
    rates[0] = x[1];
    rates[1] = -x[0];
}

/// Free fall under 1 m/s²: height, velocity.
fn free_fall(_: f64, x: &[f64], rates: &mut [f64]) {
    rates[0] = x[1];
    rates[1] = -1.0;
}

/// ẋ = 1, so that x measures time.
fn clock(_: f64, _: &[f64], rates: &mut [f64]) {
    rates[0] = 1.0;
}

/// Times of a linear or quadratic motion are found to the spacing of `f64`.
const EVENT_TOLERANCE: f64 = 1e-13;

#[test]
fn a_bouncing_ball_hits_the_ground_on_time() {
    let mut x = [1.0, 0.0];
    let (mut t, mut speed) = (0.0, 2f64.sqrt());
    let mut solver = Solver::<Dop853>::new();
    let mut exact = 2f64.sqrt();
    for _ in 0..8 {
        let events = vec![Event::terminal(Direction::Falling, |_, x: &[f64]| x[0])];
        let mut watch = Watch {
            events,
            ..Watch::default()
        };
        let outcome = solver
            .integrate(
                free_fall,
                [t, 100.0],
                &mut x,
                &Options::default(),
                &mut watch,
                &mut NoObserver,
            )
            .unwrap();
        assert_eq!(outcome.ending, Ending::Event(0));
        assert!(
            (outcome.t - exact).abs() < EVENT_TOLERANCE * 10.0,
            "{} {exact}",
            outcome.t
        );
        t = outcome.t;
        speed *= 0.8;
        exact += 2.0 * speed;
        x[1] *= -0.8;
    }
}

#[test]
fn an_event_in_the_first_step_is_found() {
    let mut x = [0.0];
    let events = vec![Event::new(Direction::Rising, |_, x: &[f64]| x[0] - 1e-3)];
    let mut watch = Watch {
        events,
        ..Watch::default()
    };
    let options = Options {
        first_step: Some(1.0),
        ..Options::default()
    };
    let outcome = Solver::<Dop853>::new()
        .integrate(
            clock,
            [0.0, 5.0],
            &mut x,
            &options,
            &mut watch,
            &mut NoObserver,
        )
        .unwrap();
    assert_eq!(outcome.hits.len(), 1);
    assert!((outcome.hits[0].t - 1e-3).abs() < EVENT_TOLERANCE);
}

#[test]
fn two_events_in_one_step_come_in_the_order_of_time() {
    let mut x = [0.0];
    let events = vec![
        Event::new(Direction::Either, |_, x: &[f64]| x[0] - 0.75),
        Event::new(Direction::Either, |_, x: &[f64]| {
            (x[0] - 0.25) * (x[0] - 0.5)
        }),
        Event::terminal(Direction::Falling, |_, x: &[f64]| 0.875 - x[0]),
        Event::new(Direction::Rising, |_, x: &[f64]| 0.875 - x[0]),
    ];
    let mut watch = Watch {
        events,
        ..Watch::default()
    };
    let options = Options {
        first_step: Some(1.1),
        ..Options::default()
    };
    let outcome = Solver::<Dopri5>::new()
        .integrate(
            clock,
            [0.0, 1.0],
            &mut x,
            &options,
            &mut watch,
            &mut NoObserver,
        )
        .unwrap();
    assert_eq!(outcome.statistics.steps, 1);
    let order: Vec<usize> = outcome.hits.iter().map(|hit| hit.event).collect();
    assert_eq!(order, [1, 1, 0, 2]);
    for (hit, t) in outcome.hits.iter().zip([0.25, 0.5, 0.75, 0.875]) {
        assert!((hit.t - t).abs() < EVENT_TOLERANCE, "{} {t}", hit.t);
        assert!((hit.state[0] - t).abs() < EVENT_TOLERANCE);
    }
    assert_eq!(outcome.ending, Ending::Event(2));
    assert!((x[0] - 0.875).abs() < EVENT_TOLERANCE);
}

#[test]
fn a_zero_at_the_start_is_no_crossing() {
    let mut x = [0.0, 1.0];
    let events = vec![Event::terminal(Direction::Either, |_, x: &[f64]| x[0])];
    let mut watch = Watch {
        events,
        ..Watch::default()
    };
    let outcome = Solver::<Dop853>::new()
        .integrate(
            oscillator,
            [0.0, 9.0],
            &mut x,
            &Options::default(),
            &mut watch,
            &mut NoObserver,
        )
        .unwrap();
    // The tolerance of the motion, not that of the root.
    assert!((outcome.t - PI).abs() < 1e-8, "{}", outcome.t);
}

#[test]
fn steps_end_exactly_at_switching_times() {
    let force = |t: f64, _: &[f64], rates: &mut [f64]| {
        rates[0] = if t < 0.3 {
            1.0
        } else if t < 0.7 {
            -2.0
        } else {
            5.0
        };
    };
    let switching_times = [0.7, 0.3, 2.0, -1.0];
    let mut ends = Vec::new();
    let mut observer = |step: &Step<'_>| {
        ends.push(step.t);
        ControlFlow::Continue(())
    };
    let exact = 0.3 - 0.8 + 1.5;
    let options = Options::default();
    let mut watch = Watch {
        switching_times: &switching_times,
        ..Watch::default()
    };
    let mut x = [0.0];
    let outcome = Solver::<Dop853>::new()
        .integrate(
            force,
            [0.0, 1.0],
            &mut x,
            &options,
            &mut watch,
            &mut observer,
        )
        .unwrap();
    // A polynomial of degree 1 is integrated exactly by every method.
    assert!((x[0] - exact).abs() < 1e-14, "{}", x[0]);
    assert_eq!(outcome.statistics.rejected, 0);
    for t in [0.3, 0.7, 1.0] {
        assert!(ends.contains(&t), "{ends:?}");
    }
    let mut x = [0.0];
    Rk4::new()
        .integrate(force, [0.0, 1.0], &mut x, 0.25, &mut watch, &mut NoObserver)
        .unwrap();
    assert!((x[0] - exact).abs() < 1e-14, "{}", x[0]);
}

/// Runs into a limit of state 0.
fn leave<P: EmbeddedPair>(
    f: impl FnMut(f64, &[f64], &mut [f64]),
    x: &mut [f64],
    limits: [f64; 2],
    first_step: f64,
) -> Failure {
    let ranges = [Range {
        component: 0,
        limits,
    }];
    let mut watch = Watch {
        ranges: &ranges,
        ..Watch::default()
    };
    let options = Options {
        first_step: Some(first_step),
        ..Options::default()
    };
    let (watch, observer) = (&mut watch, &mut NoObserver);
    let result = Solver::<P>::new().integrate(f, [0.0, 9.0], x, &options, watch, observer);
    let Err(IntegrationError::Failure(failure)) = result else {
        panic!("{result:?}")
    };
    let range = limits;
    let cause = Cause::OutOfRange {
        component: 0,
        range,
    };
    assert_eq!(failure.cause, cause);
    failure
}

#[test]
fn leaving_a_range_is_a_typed_error_at_the_limit() {
    let mut x = [1.0, 0.0];
    let failure = leave::<Dop853>(free_fall, &mut x, [0.5, f64::INFINITY], 0.3);
    assert!((failure.t - 1.0).abs() < EVENT_TOLERANCE);
    assert!((failure.state[0] - 0.5).abs() < EVENT_TOLERANCE);
    assert_eq!(failure.state, x);
}

#[test]
fn leaving_a_range_within_a_step_is_found_although_the_state_comes_back() {
    // A throw of 1 m/s from −0.1 m: up to 0.4 m at 1 s, below again after 2 s, all in one step.
    let exact = 1.0 - 0.2f64.sqrt();
    for failure in [
        leave::<Dop853>(free_fall, &mut [-0.1, 1.0], [-1e9, 0.3], 2.2),
        leave::<Dopri5>(free_fall, &mut [-0.1, 1.0], [-1e9, 0.3], 2.2),
    ] {
        assert_eq!(failure.statistics.steps, 1);
        assert!((failure.t - exact).abs() < EVENT_TOLERANCE, "{failure}");
        assert!((failure.state[0] - 0.3).abs() < EVENT_TOLERANCE);
    }
    // It also turns where it does not reach the limit; then there is nothing to find.
    let failure = leave::<Dop853>(free_fall, &mut [-0.1, 1.0], [-5.0, 0.5], 2.2);
    assert!(
        (failure.t - (1.0 + 10.8f64.sqrt())).abs() < EVENT_TOLERANCE,
        "{failure}"
    );
}

#[test]
fn ranges_that_are_not_reached_cost_no_evaluations() {
    let evaluations = |limits| {
        let ranges = [Range {
            component: 0,
            limits,
        }];
        let mut watch = Watch {
            ranges: &ranges,
            ..Watch::default()
        };
        let options = Options::default();
        Solver::<Dop853>::new()
            .integrate(
                oscillator,
                [0.0, 60.0],
                &mut [1.0, 0.0],
                &options,
                &mut watch,
                &mut NoObserver,
            )
            .unwrap()
            .statistics
            .evaluations
    };
    assert_eq!(evaluations([-1.1, 1.1]), evaluations([-1e9, 1e9]));
    // Close to the limit the interpolant decides: three evaluations in a step that turns.
    let close = evaluations([-1.001, 1.001]) - evaluations([-1e9, 1e9]);
    assert!(close > 0 && close <= 3 * 20, "{close}");
}

#[test]
fn a_range_of_no_state_is_refused() {
    let ranges = [Range {
        component: 2,
        limits: [0.0, 1.0],
    }];
    let mut watch = Watch {
        ranges: &ranges,
        ..Watch::default()
    };
    let (watch, observer) = (&mut watch, &mut NoObserver);
    let error = Rk4::new()
        .integrate(
            oscillator,
            [0.0, 1.0],
            &mut [1.0, 0.0],
            0.1,
            watch,
            observer,
        )
        .unwrap_err();
    assert_eq!(error.to_string(), "state of a range cannot be 2");
}

#[test]
fn steps_end_where_switches_change() {
    // A square wave of period 1 s and its integral, a triangle: 0.5 at odd halves of a second.
    let above = |t: f64| t - t.floor() < 0.5;
    let wave = |t: f64, _: &[f64], rates: &mut [f64]| rates[0] = if above(t) { 1.0 } else { -1.0 };
    let watch = || Watch {
        switches: Some(Switches::of_time(1, move |t, values| {
            values[0] = f64::from(u8::from(above(t)));
        })),
        ..Watch::default()
    };
    let mut ends = Vec::new();
    let mut observer = |step: &Step<'_>| {
        ends.push(step.t);
        ControlFlow::Continue(())
    };
    let options = Options {
        max_step: 1.9,
        ..Options::default()
    };
    let mut x = [0.0];
    let outcome = Solver::<Dop853>::new()
        .integrate(
            wave,
            [0.0, 9.5],
            &mut x,
            &options,
            &mut watch(),
            &mut observer,
        )
        .unwrap();
    assert!((x[0] - 0.5).abs() < 1e-14, "{}", x[0]);
    assert_eq!(outcome.statistics.rejected, 0);
    for half in 1..=19 {
        assert!(ends.contains(&(0.5 * f64::from(half))), "{half}: {ends:?}");
    }
    let mut x = [0.0];
    Rk4::new()
        .integrate(wave, [0.0, 9.5], &mut x, 0.4, &mut watch(), &mut NoObserver)
        .unwrap();
    assert!((x[0] - 0.5).abs() < 1e-14, "{}", x[0]);
}

/// All of a hundred short visits beyond a limit are found in one step, which no error shortens; where a step is a hundred
/// periods long and nine samples say nothing, `longest` says how long a visit is at least.
#[test]
fn every_crossing_in_a_long_step_is_found() {
    for longest in [f64::INFINITY, 0.1] {
        let mut x = [0.0];
        let mut watch = Watch {
            events: vec![Event {
                longest,
                ..Event::new(Direction::Rising, |_, x: &[f64]| {
                    (2.0 * PI * x[0]).sin() - 0.99
                })
            }],
            ..Watch::default()
        };
        let options = Options {
            first_step: Some(101.0),
            ..Options::default()
        };
        let outcome = Solver::<Dop853>::new()
            .integrate(
                clock,
                [0.0, 100.0],
                &mut x,
                &options,
                &mut watch,
                &mut NoObserver,
            )
            .unwrap();
        assert_eq!(outcome.statistics.steps, 1);
        assert_eq!(outcome.hits.len(), 100);
        let first = 0.99_f64.asin() / (2.0 * PI);
        for (hit, period) in outcome.hits.iter().zip(0..100) {
            let t = first + f64::from(period);
            // 2 π x has the rounding of 600.
            assert!((hit.t - t).abs() < 1e-11, "{} {t}", hit.t);
        }
    }
}

/// A jump of the function itself, and a touch from below that does not cross.
#[test]
fn jumps_cross_and_touches_do_not() {
    let mut x = [0.0];
    let mut watch = Watch {
        events: vec![
            Event::new(
                Direction::Rising,
                |t, _: &[f64]| if t < 0.3 { -1.0 } else { 1.0 },
            ),
            Event::new(Direction::Rising, |t, _: &[f64]| -(t - 0.7).powi(2) - 1e-12),
            Event::new(Direction::Rising, |t, _: &[f64]| 1e-12 - (t - 0.7).powi(2)),
        ],
        ..Watch::default()
    };
    let outcome = Solver::<Dopri5>::new()
        .integrate(
            clock,
            [0.0, 1.0],
            &mut x,
            &Options::default(),
            &mut watch,
            &mut NoObserver,
        )
        .unwrap();
    let found: Vec<usize> = outcome.hits.iter().map(|hit| hit.event).collect();
    assert_eq!(found, [0, 2]);
    assert!((outcome.hits[0].t - 0.3).abs() < EVENT_TOLERANCE);
    assert!((outcome.hits[1].t - 0.699_999).abs() < 1e-9);
}

//! Eight motions at once: each is, bit for bit, the motion alone.

// A failed integration fails the test.
#![allow(clippy::unwrap_used)]

use appell_runtime::integrate::{
    BlockMotion, BlockSolver, Cause, Direction, Dop853, Dopri5, EmbeddedPair, Ending, Event,
    IntegrationError, Options, Outcome, Places, Range, Solver, Step, Switches, Watch,
};
use appell_runtime::lanes::LANES;
use std::ops::ControlFlow;

/// A driven pendulum with a frequency of its own, whose torque jumps at its switching time, beside a
/// state that grows without bound in the last.
fn pendulum(lane: usize, t: f64, x: &[f64], rates: &mut [f64]) {
    let w = 1.0 + 0.3 * lane as f64;
    let torque = if t < switching_time(lane) { 0.5 } else { -0.8 };
    let bump = 10.0 * f64::max(0.0, 1e-3 - (x[0] - BUMP).abs());
    rates[0] = x[1];
    rates[1] = torque + bump - w * w * x[0].sin() - 0.05 * x[1];
    rates[2] = if lane == 7 {
        1.0 + x[2] * x[2]
    } else {
        (t * w).cos() * x[0]
    };
}

/// Where a narrow bump of the torque is.
const BUMP: f64 = 0.15;

fn switching_time(lane: usize) -> f64 {
    2.0 + 0.37 * lane as f64
}

fn start(lane: usize) -> Vec<f64> {
    vec![0.2 + 0.1 * lane as f64, -0.1, 0.0]
}

fn span(lane: usize) -> [f64; 2] {
    [0.25 * lane as f64, 6.0 + 0.5 * lane as f64]
}

fn watch(lane: usize) -> Watch<'static> {
    let mut switches = Switches::of_time(1, move |t, on| {
        on[0] = f64::from(t >= switching_time(lane));
    });
    switches.counts.crossings = 2;
    switches.crossings = Box::new(|_, x, signs| {
        signs[0] = x[0] - BUMP;
        signs[1] = 1e-3 - signs[0].abs();
    });
    let mut watch = Watch {
        switches: Some(switches),
        ..Watch::default()
    };
    watch
        .events
        .push(Event::new(Direction::Either, |_, x: &[f64]| x[0] - 0.05));
    if lane == 3 {
        watch
            .events
            .push(Event::terminal(Direction::Rising, |t, _: &[f64]| t - 4.4));
    }
    if lane == 5 {
        watch.ranges = &[Range {
            component: 1,
            limits: [-2.0, 0.3],
        }];
    }
    watch
}

/// Times and states as bits, so that what is not a number equals itself.
type Seen = Vec<Vec<u64>>;
type Ended = (Result<Outcome, IntegrationError>, Vec<f64>, Seen);

/// Keeps the ends of the steps and their middles.
fn see(seen: &mut Seen) -> impl FnMut(&Step<'_>) -> ControlFlow<()> {
    |step| {
        let mut middle = step.x.to_vec();
        step.interior
            .unwrap()
            .state(f64::midpoint(step.t_old, step.t), &mut middle);
        for (t, x) in [(step.t_old, &middle[..]), (step.t, step.x)] {
            seen.push([&[t], x].concat().into_iter().map(f64::to_bits).collect());
        }
        ControlFlow::Continue(())
    }
}

fn alone<P: EmbeddedPair>(lane: usize, options: &Options) -> Ended {
    let (mut x, mut seen) = (start(lane), Seen::new());
    let f = |t: f64, x: &[f64], rates: &mut [f64]| pendulum(lane, t, x, rates);
    let mut solver = Solver::<P>::new();
    let result = solver.integrate(
        f,
        span(lane),
        &mut x,
        options,
        &mut watch(lane),
        &mut see(&mut seen),
    );
    (result, x, seen)
}

fn together<P: EmbeddedPair>(members: &[usize], options: &Options) -> Vec<Ended> {
    let mut seen = vec![Seen::new(); members.len()];
    let watched = members.iter().zip(&mut seen);
    let mut motions: Vec<_> = watched
        .map(|(&lane, seen)| BlockMotion {
            span: span(lane),
            x: start(lane),
            parameters: &[],
            watch: watch(lane),
            observer: see(seen),
        })
        .collect();
    let f = |which: &[usize; LANES], at: Places<'_>, rates: &mut [[f64; LANES]]| {
        for (l, &motion) in which.iter().enumerate() {
            let (lane, t) = (members[motion], at.t);
            let state: Vec<f64> = at.x.iter().map(|x| x[l]).collect();
            let mut own = vec![0.0; rates.len()];
            pendulum(lane, t[l], &state, &mut own);
            for (rate, own) in rates.iter_mut().zip(own) {
                rate[l] = own;
            }
        }
    };
    let results = BlockSolver::<P>::new().integrate(f, &mut motions, options);
    let states: Vec<Vec<f64>> = motions.into_iter().map(|motion| motion.x).collect();
    let ended = results.into_iter().zip(states).zip(seen);
    ended.map(|((result, x), seen)| (result, x, seen)).collect()
}

fn agree<P: EmbeddedPair>(options: &Options) {
    let all: Vec<Ended> = (0..LANES).map(|lane| alone::<P>(lane, options)).collect();
    for members in [
        vec![0, 1, 2, 3, 4, 5, 6, 7],
        vec![7, 2],
        vec![5],
        vec![3, 0, 6],
        // More than there are lanes: the next one begins where one ends.
        vec![
            0, 1, 2, 3, 4, 5, 6, 7, 7, 3, 5, 0, 2, 5, 5, 5, 3, 1, 6, 7, 4,
        ],
    ] {
        for (found, &lane) in together::<P>(&members, options).iter().zip(&members) {
            // All numbers, and all of the statistics.
            assert!(*found == all[lane], "{lane} among {members:?}");
        }
    }
}

#[test]
fn a_motion_in_a_block_has_the_bits_of_the_motion_alone() {
    for options in [
        Options::with_tolerances(1e-9, 1e-9),
        Options {
            first_step: Some(0.7),
            max_step: 0.9,
            ..Options::with_tolerances(1e-6, 1e-7)
        },
        Options {
            max_steps: 20,
            ..Options::default()
        },
    ] {
        agree::<Dop853>(&options);
        agree::<Dopri5>(&options);
    }
}

#[test]
fn each_motion_ends_in_its_own_way() {
    let options = Options::with_tolerances(1e-9, 1e-9);
    let ended = together::<Dop853>(&[0, 3, 5, 7], &options);
    let cause = |ended: &Ended| match &ended.0 {
        Err(IntegrationError::Failure(failure)) => failure.cause,
        other => panic!("{other:?}"),
    };
    assert_eq!(ended[0].0.as_ref().unwrap().ending, Ending::Finished);
    assert_eq!(ended[1].0.as_ref().unwrap().ending, Ending::Event(1));
    assert!(matches!(
        cause(&ended[2]),
        Cause::OutOfRange { component: 1, .. }
    ));
    assert!(matches!(
        cause(&ended[3]),
        Cause::StepTooSmall { .. } | Cause::NonFinite { component: 2 }
    ));
}

#[test]
fn a_block_refuses_what_a_motion_refuses() {
    let options = Options::with_tolerances(0.0, 0.0);
    let refused = together::<Dopri5>(&[0, 1], &options);
    assert!(refused.iter().all(|(result, ..)| {
        matches!(
            result,
            Err(IntegrationError::InvalidArgument { what: "atol", .. })
        )
    }));
}

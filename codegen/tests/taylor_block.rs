//! Taylor series of eight motions at once: each is, bit for bit, the motion alone.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::ops::ControlFlow;

use appell_codegen::compile;
use appell_codegen::jit::{JitSeriesInLanes, Target};
use appell_codegen::program::FunctionKind;
use appell_codegen::schedule::schedule;
use appell_codegen::taylor::{InterpretedSeries, Lengths, SeriesProgram, expand};
use appell_runtime::integrate::{
    BlockMotion, BlockTaylor, Direction, Event, Expanded, ExpandedTogether, IntegrationError,
    Options, Outcome, Range, Step, Taylor, Watch,
};
use appell_runtime::lanes::{AtLanes, LANES, place_by_place};
use appell_runtime::series::{Series, SeriesInLanes, Shape, Start, Started, Sweep, Swept};

/// A mass on a spring with friction that turns with the velocity, under a force that another parameter switches.
const SPEC: &str = r#"
[mechanism]
name = "mass"
title = "mass"
[parameters]
m = { value = 1, unit = "kg", at_least = 0 }
k = { value = 4, unit = "N/m", at_least = 0 }
c = { value = 0.3, unit = "N*s^2/m^2", at_least = 0 }
t_1 = { value = 1, unit = "s" }
[coordinates]
x = { unit = "m" }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0] }
[bodies.mass]
centre = "P"
mass = "m"
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
[loads]
force = { kind = "generalized", velocity = "v", force = "if(t < t_1, 1[N], -2[N])*sin(3[1/s]*t) - k*x - c*v*abs(v)" }
"#;

/// A series evaluated at one place after the other.
struct PlaceByPlace<'a>(&'a InterpretedSeries);

impl SeriesInLanes for PlaceByPlace<'_> {
    fn shape(&self) -> &Shape {
        self.0.shape()
    }

    fn start(&self, at: AtLanes<'_>, to: [&mut [[f64; LANES]]; 3]) {
        place_by_place(at, to, |t, [x, u, p], [next, kept, guards]| {
            let to = Started { next, kept, guards };
            self.0.start(Start { t, x, u, p }, to);
        });
    }

    fn sweep(&self, at: AtLanes<'_>, sums: &[[f64; LANES]], to: [&mut [[f64; LANES]]; 4]) {
        let mut lanes = 0..;
        place_by_place(at, to, |k, [x, u, kept], [next, left, right, guards]| {
            let lane = lanes.next().unwrap();
            let sums: Vec<f64> = sums.iter().map(|sum| sum[lane]).collect();
            let sums = &sums;
            let from = Sweep {
                k,
                x,
                u,
                kept,
                sums,
            };
            let to = Swept {
                next,
                left,
                right,
                guards,
            };
            self.0.sweep(from, to);
        });
    }
}

fn program() -> SeriesProgram {
    let program = compile("mass.toml", SPEC, &FunctionKind::STANDARD)
        .unwrap_or_else(|report| panic!("{}", report.plain()));
    let rates = program.function(FunctionKind::Rates).unwrap();
    expand(&schedule(&program, rates), Lengths::from(&program.info))
}

fn start(motion: usize) -> [f64; 2] {
    [0.4 - 0.1 * motion as f64, 0.2 * motion as f64]
}

fn parameters(motion: usize) -> [f64; 4] {
    let part = motion as f64;
    [1.0 + 0.1 * part, 4.0 - 0.2 * part, 0.3, 0.7 + 0.31 * part]
}

fn span(motion: usize) -> [f64; 2] {
    [0.1 * motion as f64, 3.0 + 0.3 * motion as f64]
}

fn watch(motion: usize) -> Watch<'static> {
    let mut watch = Watch {
        switching_times: &[1.3, 2.0],
        ..Watch::default()
    };
    watch
        .events
        .push(Event::new(Direction::Either, |_, x: &[f64]| x[1]));
    if motion == 3 {
        watch
            .events
            .push(Event::terminal(Direction::Rising, |t, _: &[f64]| t - 2.2));
    }
    if motion == 5 {
        watch.ranges = &[Range {
            component: 0,
            limits: [-9.0, 0.6],
        }];
    }
    watch
}

type Seen = Vec<Vec<u64>>;
type Ended = (Result<Outcome, IntegrationError>, Vec<f64>, Seen);

fn see(seen: &mut Seen) -> impl FnMut(&Step<'_>) -> ControlFlow<()> {
    |step| {
        let mut middle = step.x.to_vec();
        let within = step.interior.unwrap();
        within.state(f64::midpoint(step.t_old, step.t), &mut middle);
        for (t, x) in [(step.t_old, &middle[..]), (step.t, step.x)] {
            seen.push([&[t], x].concat().into_iter().map(f64::to_bits).collect());
        }
        ControlFlow::Continue(())
    }
}

fn alone(series: &dyn Series, motion: usize, options: &Options) -> Ended {
    let equations = Expanded {
        series,
        parameters: &parameters(motion),
        inputs: Box::new(|_, _, _| {}),
    };
    let (mut x, mut seen) = (start(motion), Seen::new());
    let result = Taylor::new().integrate(
        &equations,
        span(motion),
        &mut x,
        options,
        &mut watch(motion),
        &mut see(&mut seen),
    );
    (result, x.to_vec(), seen)
}

fn together(series: &dyn SeriesInLanes, members: &[usize], options: &Options) -> Vec<Ended> {
    let given: Vec<[f64; 4]> = members.iter().map(|&motion| parameters(motion)).collect();
    let mut seen = vec![Seen::new(); members.len()];
    let all = members.iter().zip(&given).zip(&mut seen);
    let mut motions: Vec<_> = all
        .map(|((&motion, parameters), seen)| BlockMotion {
            span: span(motion),
            x: start(motion).to_vec(),
            parameters,
            watch: watch(motion),
            observer: see(seen),
        })
        .collect();
    let equations = ExpandedTogether {
        series,
        inputs: None,
    };
    let results = BlockTaylor::new().integrate(&equations, &mut motions, options);
    let states: Vec<Vec<f64>> = motions.into_iter().map(|motion| motion.x).collect();
    let ended = results.into_iter().zip(states).zip(seen);
    ended.map(|((result, x), seen)| (result, x, seen)).collect()
}

#[test]
fn a_motion_in_a_block_has_the_bits_of_the_motion_alone() {
    let series = InterpretedSeries(program());
    let compiled = JitSeriesInLanes::new(program(), Target::default()).unwrap();
    let places = PlaceByPlace(&series);
    let in_lanes: [&dyn SeriesInLanes; 2] = [&places, &compiled];
    for options in [
        Options::with_tolerances(1e-9, 1e-9),
        Options {
            first_step: Some(0.9),
            max_step: 0.7,
            ..Options::with_tolerances(1e-12, 1e-12)
        },
        Options {
            max_steps: 7,
            ..Options::default()
        },
    ] {
        let all: Vec<Ended> = (0..LANES)
            .map(|motion| alone(&series, motion, &options))
            .collect();
        for members in [
            vec![0, 1, 2, 3, 4, 5, 6, 7],
            vec![6],
            vec![5, 3, 0, 1, 2, 7, 4, 4, 5, 5, 6, 3, 0, 1, 7],
        ] {
            for lanes in in_lanes {
                for (found, &motion) in together(lanes, &members, &options).iter().zip(&members) {
                    // All numbers, and all of the statistics.
                    assert!(
                        *found == all[motion],
                        "{motion} among {members:?}: {:?} {:?}",
                        found.0,
                        all[motion].0
                    );
                }
            }
        }
    }
}

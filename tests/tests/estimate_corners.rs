//! Steps of a filter that meet corners, and levels that go along with inertia.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_estimate::{Effort, Estimation, Fit, Free, Layout, Measured, Recording, Setup, Unknown};
use appell_models::Shipped;
use appell_runtime::model::Model;
use appell_test_kit::Random;
use appell_tests::recorded::{Drive, record};

/// A carriage that sticks: friction would stop it within half a millisecond.
const STICKING: &str = r#"
[mechanism]
name  = "sticking"
title = "A carriage with dry friction"
[parameters]
m = { value = 1, unit = "kg" }
c = { value = 2, unit = "N" }
[coordinates]
x = { unit = "m" }
[inputs]
F = { unit = "N" }
[points]
G = { from = "O", in = "ground", at = ["x", 0, 0] }
[bodies.carriage]
centre = "G"
mass   = "m"
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
[loads]
push = { kind = "generalized", coordinate = "x", force = "F" }
dry  = { kind = "generalized", coordinate = "x", force = "-c*smooth_sign(dot(x), 0.001 [m/s])" }
"#;

/// Rows are so far apart in s.
const BETWEEN: f64 = 0.01;
/// Steps of a filter that sees all of the corner.
const FINE: f64 = 1e-4;

fn sticking() -> JitModel {
    let program = appell_codegen::compile("sticking.toml", STICKING, &FunctionKind::ALL).unwrap();
    JitModel::new(&program).unwrap()
}

fn set(values: &mut [f64], layout: Layout, unknown: Unknown, value: f64) {
    values[layout.place(unknown).unwrap()] = value;
}

fn with_levels(setup: &Setup<'_>, recordings: &[Recording], level: f64, noise: f64) -> Vec<f64> {
    let estimation = Estimation::new(setup, recordings).unwrap();
    let mut values = estimation.nominal();
    let layout = estimation.layout();
    for index in 0..setup.disturbances.len() {
        set(&mut values, layout, Unknown::Disturbance(index), level);
    }
    for index in 0..setup.channels.len() {
        set(&mut values, layout, Unknown::Noise(index), noise);
    }
    for state in 0..setup.model.info().state_len() {
        for run in 0..recordings.len() {
            set(&mut values, layout, Unknown::Spread { run, state }, 0.01);
        }
    }
    values
}

/// A setup whose steps end at the rows, one with fine steps, and a recording by the fine one.
fn seen(model: &dyn Model) -> ([Setup<'_>; 2], Vec<f64>, [Recording; 1]) {
    let coarse = Setup {
        has_corners: true,
        ..Setup::new(model, &[Measured::State(1)])
    };
    let fine = Setup {
        longest_step: FINE,
        ..coarse.clone()
    };
    let drive = Drive::sines(400, BETWEEN, &[2.0]);
    let values = with_levels(&fine, &[drive.unseen(1)], 0.02, 1e-3);
    let recording = record(&fine, &values, &drive, &mut Random::of("sticking"));
    ([coarse, fine], values, [recording])
}

#[test]
fn a_filter_with_long_steps_follows_friction_that_sticks() {
    let model = sticking();
    let (setups, values, recordings) = seen(&model);
    let [coarse, fine] = setups.each_ref().map(|setup| {
        let estimation = Estimation::new(setup, &recordings).unwrap();
        estimation.log_likelihood(&values).unwrap()
    });
    // A hundredth of what tells two hypotheses apart, of a log-likelihood of some thousand.
    assert!((coarse - fine).abs() < 0.03, "{coarse} beside {fine}");
}

#[test]
fn predictions_with_long_steps_are_those_with_short_ones() {
    let model = sticking();
    let (setups, values, recordings) = seen(&model);
    let [coarse, fine] = setups.each_ref().map(|setup| {
        let estimation = Estimation::new(setup, &recordings).unwrap();
        estimation
            .predictions(&values, 0, 1.0, &[50, 150, 250])
            .unwrap()
    });
    assert_eq!(coarse.len(), 3);
    for (coarse, fine) in coarse.iter().zip(&fine) {
        let off = (coarse.residual - fine.residual).abs();
        assert!(off < 1e-4, "{off} m after a second");
    }
}

#[test]
fn the_gradient_is_that_of_the_steps_that_were_taken() {
    let model = sticking();
    let (setups, mut values, recordings) = seen(&model);
    let estimation = Estimation::new(&setups[0], &recordings).unwrap();
    let layout = estimation.layout();
    for place in [0, 1] {
        values[place] *= 1.01;
    }
    let (_, gradient) = estimation.gradient(&values).unwrap();
    let unknowns = [
        Unknown::Parameter(0),
        Unknown::Parameter(1),
        Unknown::Noise(0),
        Unknown::Disturbance(0),
    ];
    for unknown in unknowns {
        let place = layout.place(unknown).unwrap();
        let h = 1e-6 * values[place];
        let at = |step: f64| {
            let mut moved = values.clone();
            moved[place] += step;
            estimation.log_likelihood(&moved).unwrap()
        };
        let slope = (at(h) - at(-h)) / (2.0 * h);
        let error = (gradient[place] - slope).abs() * values[place];
        let size = (slope * values[place]).abs().max(1.0);
        assert!(
            error < 1e-3 * size,
            "{unknown:?}: {} beside {slope}",
            gradient[place]
        );
    }
}

#[test]
fn states_that_are_smoothed_over_long_steps_are_those_over_short_ones() {
    let model = sticking();
    let (setups, values, recordings) = seen(&model);
    let [coarse, fine] = setups.each_ref().map(|setup| {
        let estimation = Estimation::new(setup, &recordings).unwrap();
        estimation.smoothed(&values, 0).unwrap()
    });
    assert_eq!(coarse.len(), fine.len());
    for (coarse, fine) in coarse.iter().zip(&fine) {
        let off = (0..2).map(|i| (coarse.state[i] - fine.state[i]).abs() / fine.deviation(i));
        let off = off.fold(0.0, f64::max);
        assert!(off < 0.05, "{off} deviations at {} s", coarse.t);
    }
}

#[test]
#[cfg_attr(
    not(target_os = "linux"),
    ignore = "asks Linux how much memory was used"
)]
fn steps_in_many_parts_do_not_fill_the_memory() {
    const ROWS: usize = 10_000;
    // In a process of its own, where no other test takes memory meanwhile.
    const ALONE: &str = "APPELL_TEST_ALONE";
    if std::env::var_os(ALONE).is_none() {
        let name = "estimate_corners::steps_in_many_parts_do_not_fill_the_memory";
        let mut alone = std::process::Command::new(std::env::current_exe().unwrap());
        let output = alone
            .args([name, "--exact"])
            .env(ALONE, "1")
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(said.contains("1 passed"), "{said}");
        return;
    }
    // Their parts on one tape are 100 MB.
    let most_used = || -> f64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.unwrap().trim().trim_end_matches(" kB");
        kilobytes.parse::<f64>().unwrap() / 1000.0
    };
    let model = sticking();
    let setup = Setup {
        has_corners: true,
        most_memory: 1 << 23,
        ..Setup::new(&model, &[Measured::State(1)])
    };
    let drive = Drive::sines(ROWS, BETWEEN, &[2.0]);
    let recordings = [drive.unseen(1)];
    let values = with_levels(&setup, &recordings, 0.02, 1e-3);
    let recordings = [record(&setup, &values, &drive, &mut Random::of("sticks"))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let before = most_used();
    let (_, taken_again) = estimation.gradient(&values).unwrap();
    let taken = most_used() - before;
    assert!(taken < 30.0, "{taken} MB");
    let setup = Setup {
        most_memory: usize::MAX,
        ..setup
    };
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let (_, kept) = estimation.gradient(&values).unwrap();
    assert_eq!(taken_again, kept);
}

#[test]
fn masses_that_only_a_tolerance_tells_do_not_hold_a_fit_up() {
    // A pendulum that swings freely: only the ratio of inertia and weight shows, and the disturbance
    // per inertia.
    let model = Shipped::find("pendulum").unwrap().model;
    let setup = Setup::new(model, &[Measured::State(1)]);
    let drive = Drive::sines(600, BETWEEN, &[0.0]);
    let mut truth = with_levels(&setup, &[drive.unseen(1)], 0.01, 1e-3);
    let layout = Estimation::new(&setup, &[drive.unseen(1)])
        .unwrap()
        .layout();
    set(
        &mut truth,
        layout,
        Unknown::Initial { run: 0, state: 1 },
        1.0,
    );
    let recordings = [record(&setup, &truth, &drive, &mut Random::of("swings"))];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let info = model.info();
    let mass = info.parameter_index("m").unwrap();
    let mut free: Vec<Free> = (0..info.parameter_len())
        .filter(|&index| truth[index] != 0.0)
        .map(|index| Free::of(Unknown::Parameter(index)).around(truth[index], 0.3 * truth[index]))
        .collect();
    free.extend([Unknown::Disturbance(0), Unknown::Noise(0)].map(Free::of));
    let mut start = truth.clone();
    start[mass] *= 2.5;
    set(&mut start, layout, Unknown::Disturbance(0), 0.1);
    let effort = Effort {
        gain: 0.02,
        steps: 60,
        ..Effort::default()
    };
    let fit = Fit::quick(&estimation, &start, &free, effort).unwrap();
    assert!(fit.steps <= 30, "{} steps", fit.steps);
    assert!(fit.is_optimum());
    // A search that has to end before is worth what it reached, and its values are told as less certain.
    let short = Effort { steps: 1, ..effort };
    let ended = Fit::quick(&estimation, &start, &free, short).unwrap();
    assert!(!ended.is_optimum() && ended.gain > 1.0);
    assert!(ended.log_posterior < fit.log_posterior);
    let known = ended.covariance().unwrap();
    for (i, promised) in ended.promised.iter().enumerate() {
        let deviation = ended.deviation(i).unwrap();
        assert!(deviation >= promised.abs() && deviation >= known[(i, i)].sqrt());
    }
    let best = Fit::of(&estimation, &truth, &free, Effort::default()).unwrap();
    let lost = best.log_posterior - fit.log_posterior;
    assert!(lost < 0.05, "{lost} below the optimum");
}

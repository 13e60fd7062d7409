//! A push that nobody recorded, and statements of a data set that its recordings contradict.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::Folder;
use crate::signs::SPEC;
use appell_gap::diagnose::{GapVerdict, Options, Report, diagnose};
use appell_test_kit::Random;

const STEP: f64 = 0.01;
const ROWS: u32 = 800;
const NOISE: f64 = 1e-4;
/// Steps of the simulation in a row.
const PARTS: u32 = 50;

/// The true rig.
pub(crate) struct Rig {
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) friction: f64,
    /// A force in N and its times in s.
    pub(crate) push: (f64, [f64; 2]),
    /// Rows for which a command is held; or it runs on smoothly.
    pub(crate) held: Option<u32>,
    /// Standard deviation in N of a gust with a correlation time of half a second.
    pub(crate) gust: f64,
    /// Whether a digital controller commands the force by the recorded positions.
    pub(crate) is_controlled: bool,
}

pub(crate) const RIGHT: Rig = Rig {
    mass: 1.0,
    stiffness: 20.0,
    damping: 0.5,
    friction: 0.0,
    push: (0.0, [0.0; 2]),
    held: Some(20),
    gust: 0.0,
    is_controlled: false,
};

pub(crate) fn run(rig: &Rig, seed: u64) -> String {
    let mut dice = Random::new(seed);
    let waves: Vec<[f64; 2]> = (1..=6)
        .map(|k| [1.7 * f64::from(k), dice.between(0.0, 6.3)])
        .collect();
    let smooth = |t: f64| -> f64 {
        let waves = waves.iter().map(|[rate, phase]| (rate * t + phase).sin());
        2.0 * waves.sum::<f64>()
    };
    let mut text = "t,y,u\n".to_owned();
    let (mut y, mut v, mut level, mut gust) = (0.0, 0.0, 0.0, 0.0);
    let (mut before, mut rate, mut goal) = (0.0, 0.0, 0.0);
    let h = STEP / f64::from(PARTS);
    for row in 0..ROWS {
        let t = f64::from(row) * STEP;
        let noise: f64 = (0..3).map(|_| dice.between(-1.0, 1.0)).sum();
        let reading = y + NOISE * noise;
        match rig.held {
            _ if rig.is_controlled => {
                if row % 100 == 0 {
                    goal = dice.between(-0.3, 0.3);
                }
                rate += 0.3 * ((reading - before) / STEP - rate);
                before = reading;
                level = 60.0 * (goal - reading) - 8.0 * rate;
            }
            Some(rows) if row % rows == 0 => level = dice.between(-6.0, 6.0),
            Some(_) => {}
            None => level = smooth(t),
        }
        let kick: f64 = (0..3).map(|_| dice.between(-1.0, 1.0)).sum();
        let keeps = (-STEP / 0.5_f64).exp();
        gust = keeps * gust + rig.gust * (1.0 - keeps * keeps).sqrt() * kick;
        writeln!(text, "{t:.3},{reading:.7},{level:.6}").unwrap();
        for part in 0..PARTS {
            let t = t + (f64::from(part) + 0.5) * h;
            let is_held = rig.is_controlled || rig.held.is_some();
            let force = gust + if is_held { level } else { smooth(t) };
            let (push, [from, to]) = rig.push;
            let push = if (from..to).contains(&t) { push } else { 0.0 };
            let dry = rig.friction * (v / 1e-3_f64).tanh();
            v += h * (force + push - dry - rig.stiffness * y - rig.damping * v) / rig.mass;
            y += h * v;
        }
    }
    text
}

/// A diagnosis of three runs, the first of another rig.
fn diagnosed(first: &Rig, others: &Rig, stds: [f64; 3]) -> Report {
    diagnosed_from(1, first, others, stds)
}

/// The same with random numbers from a seed on.
fn diagnosed_from(seed: u64, first: &Rig, others: &Rig, stds: [f64; 3]) -> Report {
    let folder = Folder::new();
    folder.write("oscillator.toml", SPEC);
    let [m, k, c] = stds;
    folder.write(
        "recording.toml",
        format!(
            "mechanism = \"oscillator.toml\"\n[parameters]\nm = {{ value = 1, unit = \"kg\", std = {m} }}\n\
             k = {{ value = 20, unit = \"N/m\", std = {k} }}\nc = {{ value = 0.5, unit = \"N*s/m\", std = {c} }}\n\
             [channels]\ny = {{ measures = \"y\", unit = \"m\", noise_std = {NOISE} }}\n\
             u = {{ input = \"u\", unit = \"N\" }}\n[runs]\nfit = [\"a.csv\", \"b.csv\"]\ntest = [\"c.csv\"]\n"
        ),
    );
    folder.write("a.csv", run(first, seed));
    folder.write("b.csv", run(others, seed + 1));
    folder.write("c.csv", run(others, seed + 2));
    let set = folder.read().unwrap();
    let effects = appell_gap::effects::shipped().unwrap();
    diagnose(&set, &effects, &Options::default(), |_| ()).unwrap()
}

#[test]
fn a_push_is_a_window_and_the_friction_of_the_other_rows_is_found() {
    let rig = Rig {
        friction: 0.4,
        ..RIGHT
    };
    let pushed = Rig {
        push: (25.0, [5.0, 5.2]),
        ..rig
    };
    let report = diagnosed(&pushed, &rig, [0.01, 0.2, 0.05]);
    let events: Vec<_> = (report.place.windows.iter())
        .filter(|window| window.unexplained.is_some())
        .collect();
    let [event] = events[..] else {
        panic!("{events:?}");
    };
    assert_eq!(event.run, "a.csv");
    // Predictions are made five times in half a second; then the filter has to find the state again.
    assert!((event.from - 5.0).abs() < 0.15, "{event:?}");
    assert!(event.to < 6.0, "{event:?}");
    assert_eq!(report.which[0].effects, ["coulomb_friction@y"]);
    let force = &report.which[0].parameters[0];
    assert!(
        (force.value - 0.4).abs() < 4.0 * force.std + 0.01,
        "{force:?}"
    );
}

#[test]
fn no_window_is_an_event_where_nothing_happened() {
    let rig = Rig {
        friction: 0.4,
        ..RIGHT
    };
    let report = diagnosed(&rig, &rig, [0.01, 0.2, 0.05]);
    let events = report
        .place
        .windows
        .iter()
        .filter(|w| w.unexplained.is_some());
    assert_eq!(events.count(), 0);
    assert_eq!(report.tolerances, None);
    assert_eq!(report.interpolated, []);
}

#[test]
fn tolerances_that_are_too_small_are_reported_with_their_factor() {
    let rig = Rig {
        mass: 1.03,
        stiffness: 19.2,
        damping: 0.56,
        ..RIGHT
    };
    let report = diagnosed(&rig, &rig, [0.01, 0.2, 0.02]);
    let found = report.tolerances.unwrap();
    assert!((2.0..=5.0).contains(&found.factor), "{found:?}");
}

#[test]
fn a_smooth_command_that_is_read_as_held_fits_better_along_lines() {
    let rig = Rig {
        held: None,
        friction: 0.4,
        ..RIGHT
    };
    let report = diagnosed(&rig, &rig, [0.01, 0.2, 0.05]);
    let [found] = &report.interpolated[..] else {
        panic!("{:?}", report.interpolated);
    };
    assert_eq!(found.input, "u");
}

/// A controller answers a gust that lasts: its command is correlated with the force that lacks, and seems to act too
/// weakly, too late or on something else.
#[test]
fn gusts_in_a_closed_loop_are_process_noise() {
    let rig = Rig {
        gust: 0.14,
        is_controlled: true,
        ..RIGHT
    };
    for seed in [20, 40] {
        let report = diagnosed_from(seed, &rig, &rig, [0.01, 0.2, 0.05]);
        assert_eq!(report.verdict, GapVerdict::NoGap, "{:?}", report.which);
    }
}

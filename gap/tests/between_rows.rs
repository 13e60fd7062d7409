//! How inputs run between rows where recordings do not say.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::Folder;
use appell_gap::diagnose::{Options, Report, diagnose};
use appell_spec::mechanism::Interpolation;
use appell_test_kit::Random;

pub(crate) const SPEC: &str = r#"
[mechanism]
name = "oscillator"
title = "mass on a spring"

[parameters]
m = { value = 1, unit = "kg" }
k = { value = 40, unit = "N/m" }
c = { value = 0.5, unit = "N*s/m" }

[coordinates]
y = { unit = "m" }

[inputs]
u = { unit = "N" }

[points]
P = { from = "O", in = "ground", at = ["y", 0, 0] }

[bodies]
mass = { centre = "P", mass = "m" }

[pseudo_velocities]
v = { value = "dot(y)", unit = "m/s" }

[loads]
drive  = { kind = "generalized", coordinate = "y", force = "u" }
spring = { kind = "generalized", coordinate = "y", force = "-k*y - c*v" }
"#;

const RECORDED: &str = r#"
mechanism = "oscillator.toml"
[parameters]
m = { value = 1, unit = "kg", std = 0.02 }
k = { value = 40, unit = "N/m", std = 0.8 }
c = { value = 0.5, unit = "N s/m", std = 0.05 }
[channels]
y = { measures = "y", unit = "m" }
u = { input = "u", unit = "N" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

/// Nine rows to a period of the fastest input, which is also that of the free oscillation.
const STEP: f64 = 0.11;
const FASTEST: f64 = std::f64::consts::TAU / (9.0 * STEP);
const HARDENING: f64 = 12.0;
/// Steps of the simulation in a row.
const PARTS: u32 = 20;

/// The motion of a hardening spring with an input that is held from row to row or not.
pub(crate) fn run(seed: u64, step: f64, is_held: bool) -> String {
    let mut dice = Random::new(seed);
    let waves: Vec<[f64; 2]> = (1..=20)
        .map(|k| [FASTEST * f64::from(k) / 20.0, dice.between(0.0, 6.3)])
        .collect();
    let force = |t: f64| -> f64 {
        let waves = waves.iter().map(|[rate, phase]| (rate * t + phase).sin());
        1.5 * waves.sum::<f64>()
    };
    let input = |t: f64| {
        // Within a row.
        let row = (t / step + 1e-9).floor() * step;
        force(if is_held { row } else { t })
    };
    let rates = |u: f64, [y, v]: [f64; 2]| [v, u - 40.0 * y - 0.5 * v - HARDENING * y.powi(3)];
    let h = step / f64::from(PARTS);
    let mut x = [0.0, 0.0];
    let mut table = "t,y,u\n".to_owned();
    for row in 0..250 {
        let t = f64::from(row) * step;
        writeln!(
            table,
            "{t:.3},{:.6},{:.6}",
            x[0] + 2e-4 * dice.normal(),
            force(t)
        )
        .unwrap();
        for part in 0..PARTS {
            let t = t + f64::from(part) * h;
            let near = |by: f64, [dy, dv]: [f64; 2]| [x[0] + by * dy, x[1] + by * dv];
            let end = input(t + (1.0 - 1e-6) * h);
            let one = rates(input(t), x);
            let two = rates(input(t + 0.5 * h), near(0.5 * h, one));
            let three = rates(input(t + 0.5 * h), near(0.5 * h, two));
            let four = rates(end, near(h, three));
            for i in 0..2 {
                x[i] += h / 6.0 * (one[i] + 2.0 * (two[i] + three[i]) + four[i]);
            }
        }
    }
    table
}

fn report(is_held: bool) -> Report {
    let folder = Folder::new();
    folder
        .write("oscillator.toml", SPEC)
        .write("recording.toml", RECORDED);
    for (seed, name) in [(1, "a.csv"), (2, "b.csv"), (3, "c.csv")] {
        folder.write(name, run(seed, STEP, is_held));
    }
    let mut effects = appell_gap::effects::shipped().unwrap();
    let few = ["spring", "actuator_delay"];
    effects.retain(|effect| few.contains(&effect.name.as_str()));
    let set = folder.read().unwrap();
    diagnose(&set, &effects, &Options::default(), |_| ()).unwrap()
}

#[test]
fn a_smooth_input_whose_rows_nobody_says_how_to_join_hides_no_cubic_spring() {
    let report = report(false);
    let joined = report.joined.as_ref().unwrap();
    assert_eq!(joined.interpolation, Interpolation::Cubic, "{joined:?}");
    let named = |name: &str| report.which[0].effects.iter().any(|own| own.contains(name));
    assert!(!named("delay"), "{:?}", report.which[0]);
    assert_eq!(report.law.as_ref().unwrap().forms[0].text, "y^3");
    assert!(report.how_far.as_ref().unwrap().closed > 0.95);
}

#[test]
fn an_input_that_was_held_stays_so() {
    let report = report(true);
    assert!(report.joined.is_none(), "{:?}", report.joined);
}

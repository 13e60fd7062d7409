//! Dry friction beside a damping that hardly matters.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::Folder;
use appell_gap::diagnose::{Options, diagnose};
use appell_test_kit::Random;

const NOISE: f64 = 3e-4;
const RECORDED: &str = r#"mechanism = "pendulum"
[parameters]
m = { value = 0.14,   unit = "kg",     std = 0.0015 }
l = { value = 0.135,  unit = "m",      std = 0.001 }
I = { value = 0.0004, unit = "kg m^2", std = 0.00002 }
g = { value = 9.81,   unit = "m/s^2",  std = 0.002 }
[channels]
theta = { measures = "theta", unit = "rad", noise_std = 3e-4 }
[runs]
fit = ["a.csv"]
test = ["b.csv"]
"#;

/// A swing from an angle, with dry friction of 4e-3 N m and a damping of 2e-5 N m s.
fn swing(begin: f64, seed: u64) -> String {
    let (gravity, inertia) = (0.14 * 9.81 * 0.148, 0.003_12);
    let step = 2e-4;
    let mut dice = Random::new(seed);
    let mut text = "t,theta\n".to_owned();
    let (mut angle, mut rate) = (begin, 0.0_f64);
    for row in 0..500 {
        let read = angle + NOISE * dice.normal();
        writeln!(text, "{:.2},{read:.7}", 0.01 * f64::from(row)).unwrap();
        for _ in 0..50 {
            let friction = 4e-3 * (rate / 1e-3).tanh() + 2e-5 * rate;
            rate -= step * (gravity * angle.sin() + friction) / inertia;
            angle += step * rate;
        }
    }
    text
}

#[test]
fn a_second_effect_without_which_held_out_runs_are_predicted_as_well_is_no_cause() {
    let folder = Folder::new();
    folder.write("recording.toml", RECORDED);
    folder.write("a.csv", swing(-0.6, 1));
    folder.write("b.csv", swing(0.55, 2));
    let set = folder.read().unwrap();
    let effects = appell_gap::effects::shipped().unwrap();
    let report = diagnose(&set, &effects, &Options::default(), |_| ()).unwrap();
    assert_eq!(report.which[0].effects, ["coulomb_friction@theta"]);
    let whole: f64 = report.which.iter().map(|one| one.probability).sum();
    assert!((whole - 1.0).abs() < 1e-9, "{whole}");
    // What led is still reported.
    let beside = report.which.iter().filter(|one| one.effects.len() > 1);
    let most = beside.map(|one| one.log_bayes_factor.unwrap());
    let own = report.which[0].log_bayes_factor.unwrap();
    assert!(most.fold(f64::NEG_INFINITY, f64::max) > own);
}

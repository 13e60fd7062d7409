//! Signs of channels that the motion contradicts.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;

use crate::common::Folder;
use appell_gap::effects::EffectModel;
use appell_gap::units::doubts;
use appell_test_kit::Random;

/// A mass on a spring.
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

/// Nine rows to a period of the fastest input, which is also that of the free oscillation.
const STEP: f64 = 0.11;
const FASTEST: f64 = std::f64::consts::TAU / (9.0 * STEP);
const HARDENING: f64 = 12.0;
/// Steps of the simulation in a row.
const PARTS: u32 = 20;

/// The motion of a hardening spring with an input that is held from row to row or not.
fn run(seed: u64, step: f64, is_held: bool) -> String {
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

/// What is asked about a driven oscillator, some of whose columns have the other sign.
fn asked(reversed: [bool; 2], lines: [&str; 2]) -> Vec<String> {
    let sign = |is: bool| if is { -1.0 } else { 1.0 };
    let table = run(7, 0.02, true);
    let mut rows = table.lines();
    let mut text = format!("{}\n", rows.next().unwrap());
    for row in rows {
        let mut numbers = row.split(',').map(|cell| cell.parse::<f64>().unwrap());
        let [t, y, u] = [(); 3].map(|()| numbers.next().unwrap());
        let [y, u] = [sign(reversed[0]) * y, sign(reversed[1]) * u];
        writeln!(text, "{t},{y},{u}").unwrap();
    }
    let [of_y, of_u] = lines;
    let folder = Folder::new();
    folder
        .write("oscillator.toml", SPEC)
        .write("a.csv", text)
        .write(
            "recording.toml",
            format!(
                "mechanism = \"oscillator.toml\"\n[channels]\n{of_y}\n{of_u}\n[runs]\nfit = [\"a.csv\"]\n"
            ),
        );
    let set = folder.read().unwrap();
    let model = EffectModel::new(&set.spec, Vec::new()).unwrap();
    let doubts = doubts(&set, model.with(&[]));
    doubts.into_iter().map(|doubt| doubt.message).collect()
}

const PLAIN: [&str; 2] = [
    "y = { measures = \"y\", unit = \"m\" }",
    "u = { input = \"u\", unit = \"N\" }",
];

#[test]
fn a_reversed_channel_and_a_reversed_input_are_asked_about() {
    assert!(asked([false, false], PLAIN).is_empty());
    for reversed in [[true, false], [false, true]] {
        let asked = asked(reversed, PLAIN);
        assert_eq!(asked.len(), 1, "{asked:?}");
        // Either of them would do.
        assert!(
            asked[0].contains("`y`") && asked[0].contains("`u`"),
            "{asked:?}"
        );
        assert!(asked[0].contains("reversed = true"), "{asked:?}");
    }
}

#[test]
fn a_sign_that_is_stated_or_that_no_motion_tells_is_not_asked_about() {
    let stated = [
        PLAIN[0],
        "u = { input = \"u\", unit = \"N\", reversed = true }",
    ];
    assert!(asked([false, true], stated).is_empty());
    let vouched = [
        "y = { measures = \"y\", unit = \"m\", reversed = false }",
        "u = { input = \"u\", unit = \"N\", reversed = false }",
    ];
    assert!(asked([false, true], vouched).is_empty());
    // The whole rig as in a mirror.
    assert!(asked([true, true], PLAIN).is_empty());
    // Nothing but the motion is known, and that has a mirror image.
    let unknown = [PLAIN[0], "u = { unit = \"N\" }"];
    assert!(asked([true, false], unknown).is_empty());
}

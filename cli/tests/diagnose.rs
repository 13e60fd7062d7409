//! `appell diagnose` finds what a simulated rig has and its model lacks, and finds nothing where there
//! is nothing.

mod support;

use std::fmt::Write as _;

use support::Folder;

const DESCRIPTION: &str = r#"
mechanism   = "carriage"
description = "simulated rig"
[parameters]
m = { value = 1.0, unit = "kg", std = 0.02 }
[channels]
x = { measures = "x", unit = "m", noise_std = 1e-3 }
F = { input = "F", unit = "N" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

/// Steps of the simulation in a row of the recording.
const STEPS: u32 = 10;

/// Noise of variance 1: the sum of twelve uniform numbers (P. L'Ecuyer's 64-bit congruences).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A carriage of 1 kg with viscous friction, pushed by held forces, seen with noise of 1 mm.
fn run(friction: f64, noise: &mut Noise) -> String {
    let mut text = "t,x,F\n".to_owned();
    let (mut x, mut v) = (0.0, 0.0);
    let h = 0.01 / f64::from(STEPS);
    for row in 0..800 {
        let t = f64::from(row) / 100.0;
        let force = 2.0 * (3.0 * t).sin() + 1.5 * (7.1 * t).cos();
        let _ = writeln!(text, "{t},{},{force}", x + 1e-3 * noise.next());
        for _ in 0..STEPS {
            // The middle of the step, so that the error is of its third order.
            let half = v + 0.5 * h * (force - friction * v);
            x += h * half;
            v += h * (force - friction * half);
        }
    }
    text
}

fn data_set(friction: f64) -> Folder {
    let folder = Folder::new();
    folder.write("recording.toml", DESCRIPTION);
    let mut noise = Noise(7);
    for name in ["a.csv", "b.csv", "c.csv"] {
        folder.write(name, &run(friction, &mut noise));
    }
    folder
}

fn report(folder: &Folder) -> serde_json::Value {
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    folder.json("report.json")
}

#[test]
fn friction_is_found_with_its_value_and_closes_the_gap() {
    let report = report(&data_set(0.4));
    let top = &report["which"][0];
    assert_eq!(
        top["effects"],
        serde_json::json!(["viscous_friction@x"]),
        "{report:#}"
    );
    let parameter = &top["parameters"][0];
    let (value, std) = (parameter["value"].as_f64(), parameter["std"].as_f64());
    let off = (value.expect("a value") - 0.4) / std.expect("a deviation");
    // Four standard deviations: an event of 1 in 16 000.
    assert!(off.abs() < 4.0, "{parameter}");
    assert_eq!(report["where"]["domain"], "force");
    assert_eq!(report["where"]["equations"][0]["name"], "v");
    let closed = report["how_far"]["closed"].as_f64().expect("a number");
    assert!(closed > 0.9, "{closed}");
}

#[test]
fn nothing_is_found_where_nothing_is_missing() {
    let report = report(&data_set(0.0));
    assert_eq!(report["verdict"], "no_gap", "{report:#}");
    assert_eq!(report["where"]["domain"], "none");
}

#[test]
fn two_runs_of_the_program_write_the_same_bytes() {
    let folder = data_set(0.4);
    let bytes = || {
        folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
        folder.read("report.json")
    };
    assert_eq!(bytes(), bytes());
}

#[test]
fn a_user_adds_an_effect_without_code() {
    let folder = data_set(0.4);
    let effect = r#"
[effect]
family = "force"
site   = "coordinate"
about  = "friction with the cube of the rate at {site}"
[parameters]
"{effect}_coefficient" = { value = 0, unit = "{force}*s^3/({unit})^3", at_least = 0 }
[loads]
"{effect}" = { kind = "generalized", coordinate = "{site}", force = "-{effect}_coefficient*dot({site})^3" }
"#;
    folder.write("cubic_friction.toml", effect);
    let asked = [
        "diagnose",
        "--data",
        ".",
        "--effects",
        "cubic_friction.toml",
    ];
    folder.done(&[&asked[..], &["--json", "report.json"]].concat());
    let report = folder.read("report.json");
    assert!(report.contains("cubic_friction@x"), "{report}");
}

#[test]
fn an_effect_that_cannot_be_read_is_bad_data() {
    let folder = data_set(0.4);
    folder.write("own.toml", "[effect]\nfamily = \"force\"\n");
    let ended = folder.run(&["diagnose", "--data", ".", "--effects", "own.toml"]);
    assert_eq!(ended.status, 3, "{}", ended.stderr);
    let told = "own: `site` is missing";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
}

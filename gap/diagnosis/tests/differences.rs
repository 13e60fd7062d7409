//! Runs that differ from the others by what is known of them.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use crate::common::Folder;
use crate::events::{RIGHT, Rig, run};
use crate::signs::SPEC;
use appell_gap::diagnose::{Options, Report, diagnose};

const STATED: &str = r#"
mechanism = "oscillator.toml"
[parameters]
m = { value = 1, unit = "kg", std = 0.01 }
k = { value = 20, unit = "N/m", std = 0.2 }
c = { value = 0.5, unit = "N*s/m", std = 0.02 }
[channels]
y = { measures = "y", unit = "m", noise_std = 1e-4 }
u = { input = "u", unit = "N" }
[runs]
fit = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;
const KNOWN: &str = r#"
[run."b.csv"]
payload = { on = "mass", mass = 0.6 }
[run."c.csv".parameters]
m = { value = 1600, unit = "g" }
"#;

/// Of runs with a weight on the mass in the second and the third.
fn report(friction: f64, known: &str) -> Report {
    let folder = Folder::new();
    let rig = |mass| Rig {
        mass,
        friction,
        ..RIGHT
    };
    folder
        .write("oscillator.toml", SPEC)
        .write("recording.toml", format!("{STATED}{known}"))
        .write("a.csv", run(&rig(1.0), 1))
        .write("b.csv", run(&rig(1.6), 2))
        .write("c.csv", run(&rig(1.6), 3));
    let set = folder.read().unwrap();
    let effects = appell_gap::effects::shipped().unwrap();
    diagnose(&set, &effects, &Options::default(), |_| ()).unwrap()
}

#[test]
fn a_known_weight_is_no_gap_and_an_unknown_one_is() {
    let nominal = |known: &str| report(0.0, known).how_far.unwrap().nominal;
    let (known, unknown) = (nominal(KNOWN), nominal(""));
    assert!(known < 1.3 && unknown > 20.0, "{known} {unknown}");
}

#[test]
fn friction_beside_a_known_weight_is_found() {
    let report = report(0.4, KNOWN);
    assert_eq!(report.which[0].effects, ["coulomb_friction@y"]);
    let force = &report.which[0].parameters[0];
    assert!(
        (force.value - 0.4).abs() < 4.0 * force.std + 0.01,
        "{force:?}"
    );
    assert!(
        report.how_far.as_ref().unwrap().closed > 0.95,
        "{:?}",
        report.how_far
    );
}

#[test]
fn a_run_that_is_not_there_and_a_body_that_is_not_there_are_told_with_their_lines() {
    let folder = Folder::new();
    folder
        .write("oscillator.toml", SPEC)
        .write("a.csv", run(&RIGHT, 1))
        .write("b.csv", run(&RIGHT, 2))
        .write("c.csv", run(&RIGHT, 3));
    for (known, message) in [
        (
            "[run.\"d.csv\".parameters]\nm = { value = 2, unit = \"kg\" }",
            "there is no run `d.csv`",
        ),
        (
            "[run.\"b.csv\"]\npayload = { on = \"mast\", mass = 1 }",
            "the spec has no body `mast`",
        ),
        (
            "[run.\"b.csv\"]\npayload = { on = \"mass\", mass = -1 }",
            "a payload of -1 kg",
        ),
        (
            "[run.\"b.csv\"]\npayload = { on = \"mass\" }",
            "the key `mass` is missing",
        ),
        (
            "[run.\"b.csv\"]\npayload = { on = \"mass\", mass = 1, at = [0, 1] }",
            "expected three numbers in m",
        ),
        (
            "[run.\"b.csv\".parameters]\nM = { value = 2, unit = \"kg\" }",
            "the spec has no parameter `M`",
        ),
        (
            "[run.\"b.csv\".parameters]\nm = { value = 2, unit = \"s\" }",
            "`m` is a mass, `s` is a time",
        ),
        ("[run]\n\"b.csv\" = 3", "expected a table"),
    ] {
        folder.write("recording.toml", format!("{STATED}{known}\n"));
        let error = folder.read().unwrap_err().to_string();
        assert!(error.contains(message), "{known}: {error}");
        assert!(error.contains("recording.toml:"), "{error}");
    }
}

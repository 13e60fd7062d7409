//! `appell diagnose --alternative`: another spec of the same thing is a hypothesis like an effect.

use crate::rig;
use crate::support::{Folder, number, repository};

/// The carriage with a friction that no effect of the library has, and one more place.
fn other(folder: &Folder, replaced: &[(&str, &str)]) {
    let path = repository("generated/mechanisms/carriage.toml");
    let mut spec = std::fs::read_to_string(path).expect("a shipped spec");
    let friction = [
        ("name   = \"carriage\"", "name   = \"other\""),
        (
            "[coordinates]\n",
            "c = { value = 0.15, unit = \"N*s^3/m^3\", about = \"friction by the cube of the velocity\" }\n\n[coordinates]\n",
        ),
        (
            "[outputs]\n",
            "rub = { kind = \"generalized\", coordinate = \"x\", force = \"-c*dot(x)^3\", about = \"friction\" }\n\n[outputs]\n",
        ),
    ];
    for (from, to) in friction.iter().chain(replaced) {
        assert!(spec.contains(from), "{from}");
        spec = spec.replacen(from, to, 1);
    }
    folder.write("other.toml", &spec);
}

const ASKED: [&str; 7] = [
    "diagnose",
    "--data",
    ".",
    "--alternative",
    "other.toml",
    "--json",
    "report.json",
];

#[test]
fn an_alternative_that_is_right_wins_and_closes_the_gap() {
    let folder = rig::Rig::new(|v| 0.15 * v * v * v).folder;
    other(&folder, &[]);
    folder.done(&[&ASKED[..], &["--html", "page.html"]].concat());
    let report = folder.json("report.json");
    let top = &report["which"][0];
    assert_eq!(
        top["effects"],
        serde_json::json!(["alternative:other"]),
        "{report:#}"
    );
    assert!(number(top, "probability") > 0.99, "{top}");
    assert_eq!(report["verdict"], "explained");
    let closed = number(&report, "how_far/closed");
    assert!(closed > 0.98, "{closed}");
    let sum: f64 = report["which"]
        .as_array()
        .expect("hypotheses")
        .iter()
        .map(|one| number(one, "probability"))
        .sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    assert!(folder.read("page.html").contains("alternative:other"));
    let apply = ["apply", "carriage", "--report", "report.json"];
    folder.fails(2, &apply, &["is another model, `other`: use its spec"]);
}

#[test]
fn an_alternative_that_is_wrong_loses_to_the_nominal_model() {
    let folder = rig::viscous(0.0);
    other(&folder, &[]);
    folder.done(&ASKED);
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "no_gap", "{report:#}");
}

#[test]
fn an_alternative_needs_the_channels_of_the_model() {
    let folder = rig::viscous(0.0);
    let renamed = [
        ("x = { unit = \"m\"", "s = { unit = \"m\""),
        ("at = [\"x\", 0, 0]", "at = [\"s\", 0, 0]"),
        ("value = \"dot(x)\"", "value = \"dot(s)\""),
        (
            "coordinate = \"x\", force = \"-c*dot(x)^3\"",
            "coordinate = \"s\", force = \"-c*dot(s)^3\"",
        ),
    ];
    other(&folder, &renamed);
    let told = ["`other`", "no quantity"];
    folder.fails(3, &ASKED, &told);
}

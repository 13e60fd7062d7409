//! `appell motion` and `appell inverse`: from captures to recordings, and to what no one measured.

use std::fmt::Write as _;

use crate::support::{Folder, number, repository};

/// A pole on a cart that is pushed to and fro, without noise.
const PUSHED: &[&str] = &[
    "simulate",
    "cart_pole",
    "--input",
    "F=3*sin(4*t)",
    "--initial",
    "theta=0.4",
    "--t-end-s",
    "6",
    "--dt-s",
    "0.01",
    "--csv",
    "pushed.csv",
];

/// The coordinates of the simulated motion, as a recording of them.
fn recorded() -> Folder {
    let folder = Folder::new();
    folder.done(PUSHED);
    let text = folder.read("pushed.csv");
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let heading: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let column = |name: &str| {
        let own = heading
            .iter()
            .position(|own| own.split_whitespace().next() == Some(name));
        own.expect("a column")
    };
    let wanted = ["t", "x", "theta"].map(column);
    let mut table = "t,x,theta\n".to_owned();
    for line in lines {
        let values: Vec<&str> = line.split(',').collect();
        let [t, x, theta] = wanted.map(|at| values[at]);
        let _ = writeln!(table, "{t},{x},{theta}");
    }
    folder.write("run.csv", &table);
    folder.write(
        "recording.toml",
        "mechanism = \"cart_pole\"\n[channels]\nx = { measures = \"x\", unit = \"m\" }\n\
         theta = { measures = \"theta\", unit = \"rad\" }\n[runs]\nfit = [\"run.csv\"]\n",
    );
    folder
}

#[test]
fn the_force_that_nobody_measured_and_an_inertia_are_found() {
    let folder = recorded();
    let told = folder.done(&[
        "inverse",
        "cart_pole",
        "--data",
        ".",
        "--free",
        "I",
        "--json",
        "found.json",
        "--plot",
        "force.svg",
    ]);
    assert!(
        told.stdout.contains("1 input-free relation"),
        "{}",
        told.stdout
    );
    let found = folder.json("found.json");
    let inertia = number(&found, "estimates/0/value");
    assert!((inertia - 0.006).abs() < 1e-7, "{inertia}");
    assert_eq!(found["estimates"][0]["told"], true);
    let times = found["runs"][0]["t"].as_array().expect("times");
    for (place, t) in times.iter().enumerate() {
        let t = t.as_f64().expect("a time");
        let force = number(&found, &format!("runs/0/values/0/{place}"));
        assert!(
            (force - 3.0 * (4.0 * t).sin()).abs() < 1e-3,
            "{force} at {t} s"
        );
    }
    assert!(folder.read("force.svg").contains("F, run.csv"));
}

#[test]
fn what_motions_cannot_tell_has_no_end() {
    // The mass of the cart stands in no equation but that of the force.
    let folder = recorded();
    let asked = ["inverse", "cart_pole", "--data", ".", "--free", "m_cart"];
    folder.fails(4, &asked, &["do not determine"]);
    let asked = ["inverse", "cart_pole", "--data", ".", "--free", "mass"];
    folder.fails(2, &asked, &["no parameter `mass`", "m_cart"]);
    let asked = ["inverse", "cart_pole", "--data", ".", "--bias", "phi"];
    folder.fails(2, &asked, &["no column `phi`", "theta"]);
}

#[test]
fn a_capture_becomes_a_data_set() {
    let folder = Folder::new();
    let skeleton = repository("docs/examples/euc/skeleton.toml");
    let bodies = [
        "H", "CHR", "CHL", "UAR", "UAL", "LAR", "LAL", "HR", "HL", "TR", "TL", "LR", "LL", "E",
    ];
    let mut text = "t".to_owned();
    for body in bodies {
        for column in ["X", "Y", "Z", "yaw", "tilt", "pitch"] {
            let _ = write!(text, ",{body}.{column}");
        }
    }
    text.push('\n');
    for row in 0..400 {
        let t = f64::from(row) / 120.0;
        let _ = write!(text, "{t}");
        for (place, _) in bodies.iter().enumerate() {
            let height = 550.0 + 80.0 * (13 - place) as f64;
            let _ = write!(
                text,
                ",{},{},{height},0,0,0",
                1500.0 * t,
                10.0 * (3.0 * t).sin()
            );
        }
        text.push('\n');
    }
    folder.write("ride.csv", &text);
    let told = folder.done(&["motion", &skeleton, "ride.csv", "--out", "rides"]);
    assert!(told.stdout.contains("14 bodies"), "{}", told.stdout);
    let read = folder.done(&["recording", "rides", "--json", "-"]);
    let read: serde_json::Value = serde_json::from_str(&read.stdout).expect("JSON");
    assert_eq!(read["runs"].as_array().expect("runs").len(), 1);
    let table = folder.read("rides/ride.csv");
    let last: Vec<f64> = (table.lines().last().expect("a row").split(','))
        .map(|cell| cell.parse().expect("a number"))
        .collect();
    // x along the way, from its first frame on.
    assert!((last[1] - 1.5 * 399.0 / 120.0).abs() < 1e-9, "{}", last[1]);
    folder.write("bad.toml", "mechanism = 1\n[bodies]\n");
    folder.fails(
        3,
        &["motion", "bad.toml", "ride.csv"],
        &["bad.toml:1", "[columns]"],
    );
}

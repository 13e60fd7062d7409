//! The questions of the steering paper, asked of other mechanisms by the same commands.

use serde_json::Value;

use crate::support::{Folder, assert_close, number};

/// The digits that Meijaard, Papadopoulos, Ruina and Schwab (2007) publish.
const WEAVE: f64 = 4.292_382_536_341;
const CAPSIZE: f64 = 6.024_262_015_388;

#[test]
fn the_bicycle_has_its_weave_and_capsize_speeds_and_a_plot_of_its_eigenvalues() {
    let folder = Folder::new();
    let told = folder.done(&[
        "stability",
        "bicycle",
        "--along",
        "speed=0.5..10",
        "--plot",
        "eigenvalues.svg",
        "--json",
        "speed.json",
    ]);
    for text in [
        "4.2923825363",
        "6.0242620153",
        "asymptotically stable beyond",
    ] {
        assert!(told.stdout.contains(text), "{text} in {}", told.stdout);
    }
    let speed = folder.json("speed.json");
    let specials = speed["branches"][0]["specials"].as_array().expect("a list");
    let of = |kind: &str| {
        let special = specials.iter().find(|special| special["kind"] == kind);
        number(special.expect(kind), "value")
    };
    assert_close(of("oscillation"), WEAVE, 1e-12, "weave");
    assert_close(of("real_zero"), CAPSIZE, 1e-12, "capsize");
    let plot = folder.read("eigenvalues.svg");
    for text in [
        "branch 1: re 1",
        "branch 1: im 1",
        "speed = 4.2923825",
        "[1/s]",
    ] {
        assert!(plot.contains(text), "`{text}` is missing in the plot");
    }
}

#[test]
fn an_electric_unicycle_falls_over_in_pitch_and_a_regulator_catches_it() {
    let folder = Folder::new();
    let modes = [
        "stability",
        "euc_3dof",
        "--fix",
        "v=0",
        "--json",
        "modes.json",
    ];
    let told = folder.done(&modes);
    assert!(told.stdout.contains("unstable"), "{}", told.stdout);
    let modes = folder.json("modes.json");
    let fastest = number(&modes, "motions/0/eigenvalues/0/0");
    assert!(fastest > 4.0, "{fastest}");
    folder.done(&[
        "control",
        "euc_3dof",
        "--lqr",
        "Q=1,R=0.01",
        "--write",
        "law.toml",
        "--json",
        "law.json",
    ]);
    let poles = &folder.json("law.json")["law"]["poles"];
    let poles = poles.as_array().expect("poles");
    assert!(
        poles.iter().all(|pole| number(pole, "0") < 0.0),
        "{poles:?}"
    );
    let leaning = ["--initial", "phi=8deg", "--initial", "gamma=-3deg"];
    let ends = simulated(&folder, "euc_3dof", &leaning, "30");
    for state in ["gamma", "phi", "gamma_dot", "phi_dot", "v"] {
        assert_close(number(&ends, state), 0.0, 1e-4, state);
    }
}

#[test]
fn a_unicycle_with_a_flywheel_survives_a_push_by_a_law_from_the_command_line() {
    let folder = Folder::new();
    let designed = folder.done(&[
        "control",
        "unicycle_lateral_flywheel",
        "--outputs",
        "omega_1,omega_2,omega_b,nu_s,theta,gamma",
        "--lqr",
        "Q=1,0.1,1,1e-4,1,1,R=1",
        "--write",
        "law.toml",
        "--attraction",
        "omega_1=-0.3..0.3/4,omega_b=-1..1/4",
        "--for-s",
        "40",
        "--plot",
        "region.svg",
        "--json",
        "law.json",
    ]);
    assert!(
        designed
            .stdout
            .contains("of 25 disturbed motions 25 settle"),
        "{}",
        designed.stdout
    );
    assert!(folder.read("region.svg").contains("settles"));
    assert_close(
        number(&folder.json("law.json"), "attraction/safe_part"),
        1.0,
        1e-12,
        "safe part",
    );
    // A push from the side and one from behind.
    let pushed = ["--initial", "omega_1=0.1", "--initial", "omega_b=0.3"];
    let ends = simulated(&folder, "unicycle_lateral_flywheel", &pushed, "40");
    for state in ["omega_1", "omega_2", "omega_b", "theta", "gamma"] {
        assert_close(number(&ends, state), 0.0, 1e-6, state);
    }
    // Without the law it falls.
    let fallen = folder.fails(
        4,
        &[&["simulate", "unicycle_lateral_flywheel"], &pushed[..]].concat(),
        &["leaves its range"],
    );
    assert!(fallen.stdout.contains("theta"), "{}", fallen.stdout);
}

/// The state at the end of a motion under the law.
fn simulated(folder: &Folder, model: &str, from: &[&str], until: &str) -> Value {
    let law = [
        "simulate",
        model,
        "--feedback",
        "law.toml",
        "--t-end-s",
        until,
    ];
    folder.done(&[&law, from, &["--json", "motion.json"]].concat());
    let motion = folder.json("motion.json");
    assert!(motion["failure"].is_null(), "{motion}");
    motion["final_state"].clone()
}

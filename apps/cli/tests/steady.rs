//! Steady motions and their stability from the command line.

use crate::support::{Folder, assert_close, number};

#[test]
fn a_turning_motion_is_told_with_its_circle_and_its_contact() {
    let folder = Folder::new();
    let told = folder.done(&[
        "steady",
        "unicycle",
        "--fix",
        "theta=10deg",
        "--fix",
        "psi_dot=2",
        "--json",
        "turn.json",
    ]);
    for text in [
        "1 steady motion",
        "radius of the path of x_G, y_G",
        "friction demand P",
        "unstable",
    ] {
        assert!(
            told.stdout.contains(text),
            "`{text}` is missing in\n{}",
            told.stdout
        );
    }
    let turn = folder.json("turn.json");
    assert_close(number(&turn, "motions/0/state/r"), -0.083_747, 1e-5, "r");
    assert_close(
        number(&turn, "motions/0/rates/psi_dot"),
        2.0,
        1e-12,
        "psi_dot",
    );
    assert_close(
        number(&turn, "motions/0/paths/x_G, y_G/turn_rate"),
        2.0,
        1e-10,
        "turn rate",
    );
    assert_eq!(
        turn["motions"][0]["eigenvalues"].as_array().map(Vec::len),
        Some(4)
    );
}

#[test]
fn questions_without_an_answer_are_refused_with_a_remedy() {
    let folder = Folder::new();
    let steady = |status: i32, more: &[&str], says: &[&str]| {
        folder.fails(status, &[&["steady", "unicycle"], more].concat(), says);
    };
    steady(
        2,
        &["--fix", "theta=0.1"],
        &["prescribe 1 more of", "psi_dot"],
    );
    steady(2, &["--fix", "psi=1"], &["`psi` is ignorable", "psi_dot"]);
    steady(2, &["--fix", "tetha=1"], &["did you mean `theta`?"]);
    steady(2, &["--fix", "theta=1kg"], &["error[unit-mismatch]"]);
    steady(
        2,
        &["--fix", "theta=1", "--fix", "theta=2"],
        &["given twice"],
    );
    steady(2, &["--free", "theta"], &["cannot be left free"]);
    steady(2, &["--along", "speed=1"], &["NAME=FROM..TO"]);
    steady(
        2,
        &["--along", "speed=1..1", "--fix", "psi_dot=0"],
        &["two different numbers"],
    );
    steady(2, &["--require", "z_A"], &["NAME>=VALUE"]);
    let moves = [
        "--along",
        "psi_dot=1..2",
        "--fix",
        "theta=0.1",
        "--require",
        "x_P>=0",
    ];
    steady(2, &moves, &["`x_P` is not constant"]);
    steady(
        4,
        &["--fix", "theta=0.1", "--fix", "psi_dot=0"],
        &["no steady motion", "free an input"],
    );
    let chart = ["stability", "rolling_wheel", "--chart", "theta=-1..1"];
    folder.fails(2, &chart, &["X=FROM..TO,Y=FROM..TO"]);
    let chart = [
        "stability",
        "rolling_wheel",
        "--chart",
        "theta=-1..1,psi_dot=1..8",
        "--grid",
        "1x9",
    ];
    folder.fails(2, &chart, &["1 × 9"]);
}

#[test]
fn the_critical_speed_is_told_with_all_its_digits() {
    let folder = Folder::new();
    let told = folder.done(&[
        "stability",
        "unicycle",
        "--fix",
        "psi_dot=0",
        "--along",
        "speed=0.1..3",
        "--csv",
        "speed.csv",
        "--plot",
        "speed.svg",
        "--json",
        "speed.json",
    ]);
    assert!(told.stdout.contains("1.2130539971493"), "{}", told.stdout);
    assert!(
        told.stdout
            .contains("a real eigenvalue passes through zero"),
        "{}",
        told.stdout
    );
    assert!(folder.read("speed.svg").contains("re 4"));
    let header = folder.read("speed.csv");
    let header = header.lines().nth(2).expect("a header");
    assert!(header.starts_with("branch,omega_1"), "{header}");
    assert!(header.ends_with("re_4,im_4,verdict,feasible"), "{header}");
    let json = folder.json("speed.json");
    assert_eq!(json["branches"][0]["specials"][0]["kind"], "real_zero");
}

#[test]
fn a_chart_has_cells_and_a_boundary_that_turns_back() {
    let folder = Folder::new();
    let told = folder.done(&[
        "stability",
        "rolling_wheel",
        "--chart",
        "theta=-60deg..60deg,psi_dot=0.5..8",
        "--grid",
        "30x20",
        "--plot",
        "chart.svg",
        "--csv",
        "chart.csv",
        "--json",
        "chart.json",
    ]);
    assert!(
        told.stdout.contains("600 steady motions"),
        "{}",
        told.stdout
    );
    // 18.62 degrees in the unit of the spec.
    assert!(
        told.stdout
            .contains("turns back at theta = 0.3250426280127"),
        "{}",
        told.stdout
    );
    assert!(folder.read("chart.svg").contains("class=\"curve\""));
    assert_eq!(folder.read("chart.csv").lines().count(), 603);
    assert_eq!(
        folder.json("chart.json")["cells"].as_array().map(Vec::len),
        Some(600)
    );
}

#[test]
fn zero_eigenvalues_are_told_only_where_there_are_some() {
    let told = Folder::new().done(&["stability", "pendulum"]).stdout;
    assert!(told.contains("eigenvalues"), "{told}");
    assert!(!told.contains("zero eigenvalue"), "{told}");
}

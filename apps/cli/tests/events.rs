//! Events of simulations: contacts that are lost or slip, ranges that are left.

use serde_json::Value;

use crate::support::{Folder, assert_close, number, repository};

/// Four digits of the table of manoeuvres.
const TABLE: f64 = 5e-5;
/// The root of an event on the solution between the steps, at the standard tolerances.
const PLACE: f64 = 1e-7;

fn right(name: &str) -> String {
    repository(&format!("codegen/tests/audit/right/{name}.toml"))
}

fn kinds(summary: &Value) -> Vec<&str> {
    let events = summary["events"].as_array().expect("a list");
    events
        .iter()
        .filter_map(|event| event["kind"].as_str())
        .collect()
}

#[test]
fn a_ball_that_leaves_its_surface_is_told_and_the_motion_goes_on() {
    let folder = Folder::new();
    let run = [
        "simulate",
        "ball_on_ball",
        "--t-end-s",
        "1.5",
        "--json",
        "a.json",
    ];
    let told = folder.done(&run).stdout;
    assert!(
        told.contains("the contact `P` slips: its friction demand is 0.400000"),
        "{told}"
    );
    assert!(told.contains("the contact `P` is lost"), "{told}");
    let summary = folder.json("a.json");
    assert_eq!(kinds(&summary), ["slip", "contact_lost"]);
    assert_eq!(summary["events"][1]["where"]["contact"], "P");
    let theta = number(&summary, "events/1/state/theta");
    assert_close(theta.cos(), 10.0 / 17.0 * 0.05_f64.cos(), PLACE, "10/17");
    assert_close(number(&summary, "t_end_s"), 1.5, PLACE, "end");
}

#[test]
fn a_motion_stops_at_an_event_where_that_is_asked_for() {
    let folder = Folder::new();
    let run = [
        "simulate",
        "ball_on_ball",
        "--on-event",
        "stop",
        "--json",
        "a.json",
        "--csv",
        "a.csv",
    ];
    folder.fails(
        4,
        &run,
        &[
            "error: at t = 0.97",
            "the contact `P` slips",
            "state: omega =",
        ],
    );
    let summary = folder.json("a.json");
    assert_eq!(kinds(&summary), ["slip"]);
    let t = number(&summary, "events/0/t_s");
    assert_close(number(&summary, "t_end_s"), t, PLACE, "end");
    assert!(folder.read("a.csv").lines().count() > 5);
}

#[test]
fn friction_on_the_command_line_replaces_that_of_the_spec() {
    let folder = Folder::new();
    let model = right("wheel_down_a_slope");
    // tan(0.2)/3 = 0.0676.
    for (friction, expected) in [("0.06", vec!["slip"]), ("0.07", vec![])] {
        let run = [
            "simulate",
            &model,
            "--friction",
            friction,
            "--t-end-s",
            "1",
            "--json",
            "a.json",
        ];
        folder.done(&run);
        let summary = folder.json("a.json");
        assert_eq!(kinds(&summary), expected, "{friction}");
    }
    folder.fails(
        2,
        &["simulate", &model, "--friction", "-1"],
        &["must be a non-negative number"],
    );
    folder.fails(
        2,
        &["simulate", "pendulum", "--friction", "1"],
        &["no rolling contact"],
    );
}

/// A range ends the motion, or is told, or is not looked at.
#[test]
fn a_range_that_is_left_stops_warns_or_is_ignored() {
    let folder = Folder::new();
    let run = |flags: &[&str]| {
        let start = [
            "simulate",
            "rolling_wheel",
            "--initial",
            "theta=0.3",
            "--t-end-s",
            "3",
            "--json",
            "a.json",
        ];
        let outcome = folder.run(&[&start[..], flags].concat());
        (outcome.status, folder.json("a.json"))
    };
    let (status, summary) = run(&[]);
    assert_eq!(status, 4);
    let t_left = number(&summary, "t_end_s");
    let (status, summary) = run(&["--on-event", "warn"]);
    assert_eq!(status, 0);
    // Before it lies flat, the falling wheel lifts off.
    assert_eq!(kinds(&summary)[..2], ["contact_lost", "out_of_range"]);
    assert_eq!(summary["events"][1]["where"]["state"], "theta");
    assert_close(number(&summary, "events/1/t_s"), t_left, PLACE, "time");
    assert_close(number(&summary, "events/1/value"), 1.5, PLACE, "limit");
    let (status, summary) = run(&["--ignore-ranges"]);
    assert_eq!(status, 0);
    assert!(!kinds(&summary).contains(&"out_of_range"));
}

/// The friction demand of the manoeuvres, computed by other programs.
#[test]
fn manoeuvres_ask_for_the_friction_of_the_table() {
    let folder = Folder::new();
    for (law, expected) in [
        ("lane_change_1_m_s", 0.0522),
        ("lane_change_5_m_s", 0.1954),
        ("right_turn_1_m_s", 0.0494),
        ("right_turn_5_m_s", 0.2490),
    ] {
        let law = repository(&format!("docs/examples/feedback/{law}.toml"));
        folder.done(&[
            "simulate",
            "unicycle",
            "--feedback",
            &law,
            "--reactions",
            "--json",
            "a.json",
        ]);
        let demand = number(&folder.json("a.json"), "extrema/friction_demand_P/max");
        assert!((demand - expected).abs() < TABLE, "{law}: {demand}");
    }
}

#[test]
fn contacts_and_condition_numbers_are_columns_with_units() {
    let folder = Folder::new();
    let model = right("wheel_down_a_slope");
    folder.done(&[
        "simulate",
        &model,
        "--reactions",
        "--conditions",
        "--t-end-s",
        "1",
        "--csv",
        "a.csv",
    ]);
    let text = folder.read("a.csv");
    let header: Vec<&str> = text
        .lines()
        .find(|line| line.starts_with("t,"))
        .expect("a header")
        .split(',')
        .collect();
    let units = text
        .lines()
        .find_map(|line| line.strip_prefix("# units: "))
        .expect("units");
    let units: Vec<&str> = units.split(", ").collect();
    for (name, unit) in [
        ("normal_force_P", "N"),
        ("tangential_force_P", "N"),
        ("friction_demand_P", "1"),
        ("condition_mass_matrix", "1"),
    ] {
        let column = header.iter().position(|column| *column == name);
        assert_eq!(column.map(|column| units[column]), Some(unit), "{name}");
    }
}

#[test]
fn evaluate_tells_contacts_and_condition_numbers() {
    let folder = Folder::new();
    folder.write("in.json", r#"{"cases": [{"state": {"omega": 0, "x": 0, "phi": 0}, "parameters": {"alpha": 0.5, "mu": 0.3}}]}"#);
    let model = right("wheel_down_a_slope");
    folder.done(&[
        "evaluate", &model, "--cases", "in.json", "--json", "out.json",
    ]);
    let case = &folder.json("out.json")["cases"][0];
    let contact = |key: &str| number(case, &format!("contacts/P/{key}"));
    assert_close(contact("normal_force"), 98.1 * 0.5_f64.cos(), 1e-12, "N");
    assert_close(
        contact("friction_demand"),
        0.5_f64.tan() / 3.0,
        1e-12,
        "demand",
    );
    assert_close(contact("friction"), 0.3, 1e-12, "friction");
    assert_close(
        number(case, "conditions/mass_matrix"),
        1.0,
        1e-12,
        "condition",
    );
}

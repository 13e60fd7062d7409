//! `appell evaluate`: the exchange format, the engines, the mistakes.

use serde_json::json;

use crate::support::{Folder, assert_close, number, repository};

/// Rounding of a handful of operations.
const ROUNDING: f64 = 1e-14;

const UNICYCLE: &str = r#"{"cases": [
  {"parameters": {"m": 10.0, "m0": 5.0, "R": 0.3, "g": 9.81},
   "state": {"theta": 0.1, "psi": 0.0, "phi": 0.0, "x_G": 0.0, "y_G": 0.0, "r": 0.02,
             "omega_1": 0.0, "omega_2": 3.3, "omega_3": 0.1, "sigma": 0.0},
   "inputs": {"u": 1.5}},
  {"state": {"theta": -0.4, "psi": 2.0, "phi": 1.0, "x_G": 3.0, "y_G": -1.0, "r": -0.3,
             "omega_1": 0.3, "omega_2": -4.0, "omega_3": 1.1, "sigma": 0.7}}
]}"#;

#[test]
fn the_pendulum_obeys_its_textbook_equation() {
    let folder = Folder::new();
    folder.write(
        "in.json",
        r#"{"cases": [{"parameters": {"l": 0.7}, "state": {"omega": 2.0, "theta": 0.6}, "inputs": {"tau": 0.3}}]}"#,
    );
    folder.done(&[
        "evaluate", "pendulum", "--cases", "in.json", "--json", "out.json",
    ]);
    let out = folder.json("out.json");
    assert_eq!(out["state_order"], json!(["omega", "theta"]));
    assert_eq!(out["input_order"], json!(["tau"]));
    assert_eq!(out["speed_order"], json!(["omega"]));
    assert_eq!(out["parameter_order"], json!(["m", "l", "I", "g"]));
    let case = &out["cases"][0];
    let (m, l, inertia, g, tau) = (1.0, 0.7, 0.02, 9.81, 0.3);
    let (sin, cos) = 0.6_f64.sin_cos();
    let about_pivot = inertia + m * l * l;
    let acceleration = (tau - m * g * l * sin) / about_pivot;
    for (path, expected) in [
        ("rates/omega", acceleration),
        ("rates/theta", 2.0),
        ("mass_matrix/0/0", about_pivot),
        ("bias/0", 0.0),
        ("generalized_forces/0", tau - m * g * l * sin),
        ("A/0/0", 0.0),
        ("A/0/1", -m * g * l * cos / about_pivot),
        ("A/1/0", 1.0),
        ("B/0/0", 1.0 / about_pivot),
        ("P/0/3", -m * l * sin / about_pivot),
        ("kinetic_energy", about_pivot * 2.0),
        ("power", tau * 2.0),
        ("outputs/x_G", l * sin),
    ] {
        assert_close(number(case, path), expected, ROUNDING, path);
    }
}

#[test]
fn inverse_dynamics_is_what_a_motion_takes_beyond_its_loads() {
    let folder = Folder::new();
    let case = r#"{"cases": [{"state": {"omega": 0, "theta": 0}, "accelerations": {"omega": 2}}]}"#;
    folder.write("in.json", case);
    folder.done(&[
        "evaluate", "pendulum", "--cases", "in.json", "--json", "out.json",
    ]);
    let out = folder.json("out.json");
    let case = &out["cases"][0];
    let about_pivot = number(case, "mass_matrix/0/0");
    let demand = number(case, "inverse_dynamics/0");
    assert_close(demand, 2.0 * about_pivot, ROUNDING, "demand");
}

#[test]
fn reactions_carry_the_name_of_the_contact() {
    let folder = Folder::new();
    folder.write("in.json", UNICYCLE);
    folder.done(&[
        "evaluate", "unicycle", "--cases", "in.json", "--json", "out.json",
    ]);
    let out = folder.json("out.json");
    let case = &out["cases"][0];
    assert_eq!(
        case["constraint_forces"]["P"].as_array().map(Vec::len),
        Some(3)
    );
    // The ground carries the weight up to the acceleration of the bodies.
    let up = number(case, "constraint_forces/P/2");
    assert!((100.0..200.0).contains(&up), "{up}");
    for row in 0..2 {
        assert_close(
            number(case, &format!("constraint_residual/{row}")),
            0.0,
            ROUNDING,
            "residual",
        );
    }
}

#[test]
fn the_three_engines_give_the_same_bits() {
    let folder = Folder::new();
    folder.write("in.json", UNICYCLE);
    for engine in ["jit", "emitted", "interpreter"] {
        let out = format!("{engine}.json");
        folder.done(&[
            "evaluate", "unicycle", "--cases", "in.json", "--json", &out, "--engine", engine,
        ]);
    }
    assert_eq!(folder.read("jit.json"), folder.read("emitted.json"));
    assert_eq!(folder.read("jit.json"), folder.read("interpreter.json"));
}

#[test]
fn what_is_left_out_has_the_values_of_the_spec() {
    let folder = Folder::new();
    let state = r#""state": {"omega": 2.0, "theta": 0.6}"#;
    folder.write(
        "in.json",
        &format!(
            r#"{{"cases": [{{{state}}}, {{{state}, "parameters": {{"m": 1, "l": 0.5, "I": 0.02, "g": 9.81}}, "inputs": {{"tau": 0}}}}]}}"#
        ),
    );
    let out = folder
        .done(&["evaluate", "pendulum", "--cases", "in.json"])
        .stdout;
    let out: serde_json::Value = serde_json::from_str(&out).expect("JSON on standard output");
    assert_eq!(out["cases"][0], out["cases"][1]);
}

#[test]
fn a_spec_file_works_at_once() {
    let folder = Folder::new();
    folder.done(&["new", "mine"]);
    folder.write(
        "in.json",
        r#"{"cases": [{"state": {"v": 0, "omega": 0, "x": 0.1, "theta": 0.2}}]}"#,
    );
    folder.done(&[
        "evaluate",
        "mine.toml",
        "--cases",
        "in.json",
        "--json",
        "out.json",
    ]);
    assert!(number(&folder.json("out.json"), "cases/0/rates/v").is_finite());
    folder.fails(
        2,
        &[
            "evaluate",
            "mine.toml",
            "--cases",
            "in.json",
            "--engine",
            "emitted",
        ],
        &["--engine: emitted code", "machine code"],
    );
}

#[test]
fn all_mistakes_of_a_file_are_told_with_their_places() {
    let folder = Folder::new();
    folder.write(
        "in.json",
        r#"{"cases": [
  {"state": {"omega": 1, "thta": 2}, "parameters": {"mm": 1}},
  {"state": {"omega": "fast", "theta": 0}, "input": {}},
  {"parameters": {}}
]}"#,
    );
    let outcome = folder.fails(
        3,
        &[
            "evaluate", "pendulum", "--cases", "in.json", "--json", "out.json",
        ],
        &[
            "the state lacks theta",
            "there is no state `thta`",
            "did you mean `theta`?",
            "there is no parameter `mm`",
            "this is not a finite number",
            "unknown key `input`",
            "the key `state` is missing",
            "in.json:2:34",
            "in.json:3:23",
        ],
    );
    assert!(outcome.stdout.is_empty());
    assert_eq!(folder.files(), ["in.json"]);
}

#[test]
fn the_wanted_quantities_are_those_of_all() {
    let folder = Folder::new();
    let cases = r#""cases": [{"state": {"omega": 2.0, "theta": 0.6}, "inputs": {"tau": 0.3}}]"#;
    folder.write("all.json", &format!("{{{cases}}}"));
    let wanted = r#""quantities": ["rates", "A", "potential_energy"]"#;
    folder.write("some.json", &format!("{{{cases}, {wanted}}}"));
    let case = |file: &str| {
        let arguments = [
            "evaluate", "pendulum", "--cases", file, "--json", "out.json",
        ];
        folder.done(&arguments);
        folder.json("out.json")["cases"][0].clone()
    };
    let (all, some) = (case("all.json"), case("some.json"));
    let keys: Vec<&String> = some.as_object().expect("an object").keys().collect();
    assert_eq!(keys, ["rates", "A", "potential_energy"]);
    for key in keys {
        assert_eq!(some[key], all[key]);
    }
    folder.write(
        "wrong.json",
        &format!("{{{cases}, \"quantities\": [\"rates\",\n\"Jacobian\", 3]}}"),
    );
    let told = [
        "there is no quantity `Jacobian`",
        "wrong.json:2:1",
        "wrong.json:2:13",
    ];
    folder.fails(3, &["evaluate", "pendulum", "--cases", "wrong.json"], &told);
}

#[test]
fn a_key_stands_there_once() {
    let folder = Folder::new();
    folder.write(
        "in.json",
        r#"{"cases": [
  {"state": {"omega": 1, "theta": 2, "omega": 3}, "t": 0, "t": 1}
], "cases": []}"#,
    );
    folder.fails(
        3,
        &["evaluate", "pendulum", "--cases", "in.json"],
        &[
            "the key `omega` is given twice",
            "in.json:2:47",
            "the key `t` is given twice",
            "in.json:2:64",
            "the key `cases` is given twice",
            "in.json:3:13",
        ],
    );
}

#[test]
fn places_in_json_count_from_one() {
    let folder = Folder::new();
    for (text, place) in [
        ("", "in.json:1:1"),
        ("[1]", "in.json:1:1"),
        ("  3", "in.json:1:3"),
        ("{\"cases\": [\n", "in.json:1:12"),
        ("{\"cases\": [\n]\n,}", "in.json:3:2"),
        ("{\"cases\": []} []", "in.json:1:15"),
        ("{}", "in.json:1:1"),
    ] {
        folder.write("in.json", text);
        folder.fails(3, &["evaluate", "pendulum", "--cases", "in.json"], &[place]);
    }
}

#[test]
fn the_example_of_the_documentation_is_true() {
    let folder = Folder::new();
    let page = repository("docs/command-line.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let block = |name: &str| {
        let start = page
            .split_once(&format!("```json {name}\n"))
            .expect("a block")
            .1;
        start.split_once("```").expect("its end").0.to_owned()
    };
    folder.write("cases.json", &block("cases"));
    folder.done(&[
        "evaluate",
        "pendulum",
        "--cases",
        "cases.json",
        "--json",
        "answer.json",
    ]);
    let told = serde_json::from_str(&block("answer")).expect("JSON");
    assert_same(&folder.json("answer.json"), &told);
}

/// Fails where two JSON values differ by more than rounding.
fn assert_same(found: &serde_json::Value, expected: &serde_json::Value) {
    use serde_json::Value;
    match (found, expected) {
        (Value::Object(found), Value::Object(expected)) => {
            let keys =
                |map: &serde_json::Map<String, Value>| map.keys().cloned().collect::<Vec<_>>();
            assert_eq!(keys(found), keys(expected));
            found
                .iter()
                .for_each(|(key, found)| assert_same(found, &expected[key]));
        }
        (Value::Array(found), Value::Array(expected)) => {
            assert_eq!(found.len(), expected.len());
            found
                .iter()
                .zip(expected)
                .for_each(|(a, b)| assert_same(a, b));
        }
        (Value::Number(_), Value::Number(_)) => {
            assert_close(
                found.as_f64().expect("a number"),
                expected.as_f64().expect("a number"),
                ROUNDING,
                "a number",
            );
        }
        _ => assert_eq!(found, expected),
    }
}

#[test]
fn broken_json_is_shown() {
    let folder = Folder::new();
    folder.write("in.json", "{\"cases\": [\n  {\"state\": }\n]}");
    folder.fails(
        3,
        &["evaluate", "pendulum", "--cases", "in.json"],
        &["in.json:2:13", "{\"state\": }"],
    );
    folder.write("in.json", "");
    folder.fails(
        3,
        &["evaluate", "pendulum", "--cases", "in.json"],
        &["in.json:1"],
    );
    folder.write("in.json", "{\"cases\": 3}");
    folder.fails(
        3,
        &["evaluate", "pendulum", "--cases", "in.json"],
        &["a list of cases"],
    );
    folder.fails(
        3,
        &["evaluate", "pendulum", "--cases", "no.json"],
        &["cannot read no.json"],
    );
}

#[test]
fn a_state_without_accelerations_fails_with_its_numbers() {
    let folder = Folder::new();
    folder.write(
        "in.json",
        r#"{"cases": [{"state": {"omega": 1, "theta": 2}},
                      {"state": {"omega": 1.5, "theta": 2}, "parameters": {"m": 0, "I": 0}}]}"#,
    );
    folder.fails(
        4,
        &[
            "evaluate", "pendulum", "--cases", "in.json", "--json", "out.json",
        ],
        &["case 1", "omega = 1.5", "theta = 2"],
    );
    let out = folder.json("out.json");
    assert!(out["cases"][0]["rates"]["omega"].is_number());
    assert!(out["cases"][1]["rates"]["omega"].is_null());
}

#[test]
fn degrees_and_pi_in_expressions_are_numbers() {
    let folder = Folder::new();
    folder.write(
        "tilted.toml",
        r#"[mechanism]
name = "tilted"
title = "A pendulum on a stand that is not upright"
[parameters]
m = { value = 1, unit = "kg" }
g = { value = 9.81, unit = "m/s^2" }
l = { value = 1, unit = "m" }
[coordinates]
a = { unit = "deg" }
[frames]
f = { parent = "ground", about_axis = "y", by = "a + 5[deg]" }
[points]
P = { from = "O", in = "f", at = [0, 0, "-l*pi"] }
[bodies]
b = { centre = "P", mass = "m" }
[pseudo_velocities]
w = { value = "dot(a)", unit = "rad/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
"#,
    );
    folder.write("in.json", r#"{"cases": [{"state": {"w": 0, "a": 0.1}}]}"#);
    folder.done(&[
        "evaluate",
        "tilted.toml",
        "--cases",
        "in.json",
        "--json",
        "out.json",
    ]);
    let expected = -9.81 / std::f64::consts::PI * (0.1 + 5.0_f64.to_radians()).sin();
    let out = folder.json("out.json");
    assert_close(number(&out, "cases/0/rates/w"), expected, ROUNDING, "w");
}

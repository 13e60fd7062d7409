//! Equations in other languages: what `derive` writes runs there, with the values of `evaluate`.

use std::process::Command;

use serde_json::Value;

use crate::support::{Folder, assert_close};

/// A state off the initial one.
const CASES: &str = r#"{"cases": [{"state": {"v": 0.4, "omega": -0.7, "x": 0.1, "theta": 0.3}, "inputs": {"F": 1.5}}]}"#;

fn rates(folder: &Folder) -> [f64; 4] {
    folder.done(&["new", "mine"]);
    folder.write("cases.json", CASES);
    folder.done(&[
        "evaluate",
        "mine.toml",
        "--cases",
        "cases.json",
        "--json",
        "values.json",
    ]);
    let rates = &folder.json("values.json")["cases"][0]["rates"];
    ["v", "omega", "x", "theta"].map(|name| rates[name].as_f64().expect("a rate"))
}

fn run(folder: &Folder, program: &str, arguments: &[&str]) -> String {
    let told = Command::new(program)
        .args(arguments)
        .current_dir(folder.path("."))
        .output();
    let told = told.expect("the program runs");
    let errors = String::from_utf8_lossy(&told.stderr);
    assert!(told.status.success(), "{program} {arguments:?}\n{errors}");
    String::from_utf8(told.stdout).expect("text")
}

#[test]
fn the_python_module_has_the_rates_of_the_model_and_their_names() {
    let folder = Folder::new();
    let expected = rates(&folder);
    folder.done(&["derive", "mine.toml", "--out", "mine.py"]);
    let script = "import json, math, mine\nx = dict(v=0.4, omega=-0.7, x=0.1, theta=0.3)\n\
                  x = [x[name] for name in mine.STATES]\n\
                  print(json.dumps(mine.rates(math, 0.0, x, [1.5], mine.DEFAULT_PARAMETERS)))\n";
    let told = run(&folder, "python3", &["-c", script]);
    let found: Vec<f64> = serde_json::from_str(&told).expect("JSON");
    for (found, expected) in found.iter().zip(expected) {
        assert_close(*found, expected, 1e-14, "a rate");
    }
}

#[test]
fn the_c_source_has_the_rates_of_the_model_and_a_step() {
    let folder = Folder::new();
    let expected = rates(&folder);
    let other = ["derive", "mine.toml", "--out", "other.c"];
    folder.fails(2, &other, &["--out mine.c"]);
    folder.fails(2, &["derive", "mine.toml", "--float"], &["need --format c"]);
    folder.done(&["derive", "mine.toml", "--integrator", "--out", "mine.c"]);
    folder.write(
        "main.c",
        "#include <stdio.h>\n#include \"mine.h\"\nint main(void) {\n    MineState x = {0.4, -0.7, 0.1, 0.3};\n    \
         MineInputs u = {1.5};\n    MineRates r;\n    mine_rates(0, &mine_default_parameters, &x, &u, &r);\n    \
         printf(\"[%.17g, %.17g, %.17g, %.17g\", r.v_dot, r.omega_dot, r.x_dot, r.theta_dot);\n    \
         mine_step(0, 1e-3, &mine_default_parameters, &x, &u);\n    printf(\", %.17g]\\n\", x.x);\n    \
         return 0;\n}\n",
    );
    run(
        &folder,
        "cc",
        &[
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-pedantic",
            "-Werror",
            "main.c",
            "mine.c",
            "-o",
            "run",
            "-lm",
        ],
    );
    let told = run(&folder, "./run", &[]);
    let found: Value = serde_json::from_str(&told).expect("JSON");
    let found: Vec<f64> = (0..5)
        .map(|k| found[k].as_f64().expect("a number"))
        .collect();
    for (found, expected) in found.iter().zip(expected) {
        assert_close(*found, expected, 1e-14, "a rate");
    }
    // x + v dt + a dt²/2
    let moved = 0.1 + 1e-3 * expected[2] + 0.5e-6 * expected[0];
    assert_close(found[4], moved, 1e-7, "a step");
}

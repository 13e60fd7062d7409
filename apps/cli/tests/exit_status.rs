//! Every command ends with the status that the documentation gives.

use crate::support::Folder;

/// A folder with one file of each kind, right and wrong.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("wrong.toml", "[mechanism]\nname = 3\n");
    folder.write(
        "case.json",
        r#"{"cases": [{"state": {"omega": 0, "theta": 1}}]}"#,
    );
    folder.write(
        "singular.json",
        r#"{"cases": [{"state": {"omega": 1, "theta": 2}, "parameters": {"m": 0, "I": 0}}]}"#,
    );
    folder.write("wrong.json", r#"{"cases": [{"state": {}}]}"#);
    let law = "input = 'u'\nstates = ['r']\ngains = [1]\n[initial]\ntheta = ";
    folder.write("law.toml", &format!("{law}0.1\n"));
    folder.write("far.toml", &format!("{law}7\n"));
    folder.write(
        "zero.toml",
        "input = 'u'\nstates = ['r']\ngains = [1]\noffset = '1/0*t'\n",
    );
    folder.write("wrong.csv", "t,F\n0,x\n");
    folder
}

#[test]
fn zero_is_done() {
    let folder = folder();
    for command in [
        &["list"][..],
        &["new", "mine"],
        &["check", "pendulum"],
        &["derive", "pendulum", "--stage", "kinematics"],
        &["evaluate", "pendulum", "--cases", "case.json"],
        &[
            "simulate",
            "unicycle",
            "--feedback",
            "law.toml",
            "--t-end-s",
            "0.01",
        ],
        &["schema"],
        &["completions", "zsh"],
        &["--help"],
        &["--version"],
    ] {
        folder.done(command);
    }
}

#[test]
fn two_is_a_wrong_command_line() {
    let folder = folder();
    folder.done(&["new", "mine"]);
    for command in [
        &[][..],
        &["list", "--all"],
        &["new", "mine"],
        &["new", "1st"],
        &["check", "unknown"],
        &["derive", "unknown"],
        &["derive", "pendulum", "--stage", "last"],
        &["evaluate", "unknown", "--cases", "case.json"],
        &["simulate", "unknown"],
        &["simulate", "pendulum", "--set", "l=1kg"],
        &["simulate", "pendulum", "--set", "l=1/0"],
        &["simulate", "pendulum", "--input", "tau=1/0"],
        &["simulate", "pendulum", "--max-steps", "many"],
        &["simulate", "unicycle", "--initial", "theta=7"],
        &["schema", "unicycle"],
        &["completions", "cmd"],
    ] {
        folder.fails(2, command, &[]);
    }
}

#[test]
fn three_is_a_wrong_file() {
    let folder = folder();
    for command in [
        &["check", "wrong.toml"][..],
        &["check", "missing.toml"],
        &["derive", "wrong.toml"],
        &["evaluate", "wrong.toml", "--cases", "case.json"],
        &["evaluate", "pendulum", "--cases", "wrong.json"],
        &["simulate", "wrong.toml"],
        &["simulate", "unicycle", "--feedback", "wrong.toml"],
        &["simulate", "unicycle", "--feedback", "far.toml"],
        &["simulate", "unicycle", "--feedback", "zero.toml"],
        &["simulate", "carriage", "--inputs", "wrong.csv"],
        &["list", "--json", "wrong.csv/list.json"],
        &["schema", "--out", "wrong.csv/schema.json"],
        &["demo", "--out", "wrong.csv"],
    ] {
        folder.fails(3, command, &[]);
    }
}

#[test]
fn four_is_a_computation_that_failed() {
    let folder = folder();
    for command in [
        &["evaluate", "pendulum", "--cases", "singular.json"][..],
        &[
            "simulate",
            "pendulum",
            "--initial",
            "theta=1",
            "--max-steps",
            "3",
        ],
        &["simulate", "rolling_wheel", "--initial", "theta=0.3"],
    ] {
        folder.fails(4, command, &[]);
    }
}

#[test]
fn of_several_failures_all_are_told_and_the_largest_counts() {
    let folder = folder();
    let command = [
        "check",
        "wrong.toml",
        "missing.toml",
        "unknown",
        "pendulum",
        "--json",
        "out.json",
    ];
    let says = [
        "error[",
        "--> wrong.toml:",
        "cannot read missing.toml",
        "no file `unknown`",
    ];
    let outcome = folder.fails(3, &command, &says);
    assert!(outcome.stdout.contains("pendulum"), "{}", outcome.stdout);
    let specs = folder.json("out.json")["specs"].clone();
    let ok: Vec<bool> = (0..4).map(|i| specs[i]["ok"] == true).collect();
    assert_eq!(ok, [false, false, false, true]);
}

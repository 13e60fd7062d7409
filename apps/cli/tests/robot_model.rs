//! A robot file in the place of a spec, with the names that it has.

use crate::rig;
use crate::robot_gap::{DESCRIPTION, ROBOT};
use crate::support::{Folder, assert_close, number};

#[test]
fn a_robot_file_is_simulated_with_its_names() {
    let folder = Folder::new();
    folder.write("robot.xml", ROBOT);
    let simulate = |rest: &[&str]| {
        let asked = [
            "simulate",
            "robot.xml",
            "--t-end-s",
            "1",
            "--input",
            "F=2",
            "--json",
            "motion.json",
        ];
        let outcome = folder.done(&[&asked[..], rest].concat());
        let motion = folder.json("motion.json");
        (number(&motion, "final_state/x"), outcome.stderr)
    };
    // x = F t^2/2m.
    assert_close(simulate(&[]).0, 1.0, 1e-9, "x");
    assert_close(simulate(&["--set", "cart.mass=4"]).0, 0.25, 1e-9, "x");
    // What the file has none of may be set too: the carriage slides at (2 - 0.5)/1 m/s2.
    let (x, _) = simulate(&["--set", "x.frictionloss=0.5"]);
    assert_close(x, 0.75, 1e-3, "x");
    let wrong = ["simulate", "robot.xml", "--set", "cart.mas=4"];
    folder.fails(2, &wrong, &["cart.mas", "did you mean `cart.mass`?"]);

    // What the equations lack is said.
    let servo = "<position name=\"F\" joint=\"x\" kp=\"9\" kv=\"6\" timeconst=\"0.02\"/>";
    let with_servo = ROBOT.replace("<motor name=\"F\" joint=\"x\"/>", servo);
    folder.write("robot.xml", &with_servo);
    let (_, remarks) = simulate(&[]);
    assert!(remarks.contains("filter of 0.02 s"), "{remarks}");
}

#[test]
fn a_robot_file_is_a_mechanism_of_other_commands() {
    let folder = Folder::new();
    folder.write("robot.xml", ROBOT);
    folder.done(&["check", "robot.xml"]);
    folder.done(&["derive", "robot.xml"]);
    let study = r#"
[study]
model = "robot.xml"
cases = 3
[motion]
t_end_s = 1
[motion.input]
F = "2"
[vary]
"cart.mass" = { grid = [1, 2, 4] }
[keep]
reached = { end = "x" }
"#;
    folder.write("study.toml", study);
    folder.done(&["ensemble", "study.toml", "--out", "motions"]);
    let statistics = folder.json("motions/statistics.json");
    for (key, expected) in [("min", 0.25), ("max", 1.0), ("mean", 1.75 / 3.0)] {
        let found = number(&statistics, &format!("kept/reached/{key}"));
        assert_close(found, expected, 1e-6, key);
    }
    let wrong = study.replace("cart.mass", "cart.mas");
    folder.write("study.toml", &wrong);
    let asked = ["ensemble", "study.toml", "--out", "others"];
    folder.fails(3, &asked, &["did you mean `cart.mass`?"]);
}

#[test]
fn numbers_of_a_robot_file_are_identified() {
    let folder = rig::dry(0.0);
    folder.write("robot.xml", ROBOT);
    folder.write("recording.toml", DESCRIPTION);
    let asked = ["identify", "--data", ".", "--free", "cart.mass", "--json"];
    let told = folder.done(&[&asked[..], &["found.json"]].concat()).stdout;
    assert!(told.contains("cart.mass"), "{told}");
    let found = folder.json("found.json");
    assert_eq!(found["parameters"][0]["name"], "cart.mass");
    assert_close(number(&found, "parameters/0/value"), 1.0, 0.02, "mass");
}

#[test]
fn a_motion_beside_a_recorded_run_is_told_where_that_begins() {
    let folder = rig::dry(0.0);
    folder.write("robot.xml", ROBOT);
    folder.write("recording.toml", DESCRIPTION);
    let simulate = |start: &str| {
        let start = format!("x={start}");
        let asked = [
            "simulate",
            "robot.xml",
            "--t-end-s",
            "1",
            "--initial",
            &start,
            "--inputs",
            "recording.toml:a.csv",
        ];
        folder.done(&asked).stderr
    };
    let remarks = simulate("3");
    let (_, begins) = remarks
        .split_once("the run begins at x = ")
        .expect("a remark");
    let (begins, _) = begins.split_once(' ').expect("a number");
    assert!(!simulate(begins).contains("begins at"));
}

#[test]
fn a_robot_file_before_its_logs_asks_what_is_wanted() {
    let folder = rig::dry(0.0);
    folder.write("robot.xml", ROBOT);
    let asked = ["recording", "robot.xml", "a.csv"];
    folder.fails(2, &asked, &["--write recording.toml", "--model robot.xml"]);
}

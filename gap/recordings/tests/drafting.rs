//! A description is drafted from recordings of a robot, and accepted.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;

use appell_recordings::{Draft, Drafted, Spec};

use crate::common::Folder;

/// Two joints with position servos.
const ROBOT: &str = r#"<mujoco model="arm">
  <compiler autolimits="true"/>
  <worldbody>
    <body name="upper">
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <joint name="shoulder" axis="0 1 0" range="-120 120" damping="0.1"/>
      <body name="fore" pos="0.3 0 0">
        <inertial pos="0.1 0 0" mass="0.5" diaginertia="0.01 0.01 0.01"/>
        <joint name="elbow" axis="0 1 0" range="-120 120"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="servo_1" joint="shoulder" kp="50"/>
    <position name="servo_2" joint="elbow" kp="30"/>
  </actuator>
</mujoco>
"#;

/// Names of the columns of a log, and what they are multiplied with: time, positions, rates, commands.
struct Form {
    names: [&'static str; 7],
    time: f64,
    position: f64,
    rate: f64,
    command: f64,
}

const PLAIN: Form = Form {
    names: [
        "t",
        "shoulder",
        "elbow",
        "shoulder_vel",
        "elbow_vel",
        "servo_1",
        "servo_2",
    ],
    time: 1.0,
    position: 1.0,
    rate: 1.0,
    command: 1.0,
};

/// Motions that follow their commands after 40 ms, at 200 Hz.
fn log(form: &Form, phase: f64) -> String {
    let mut text = form.names.join(",") + "\n";
    let angle = |joint: f64, t: f64| (2.0 + joint) * 0.25 * ((2.0 + joint) * t + phase).sin();
    let rate = |joint: f64, t: f64| (angle(joint, t + 1e-4) - angle(joint, t - 1e-4)) / 2e-4;
    for row in 0..1200 {
        let t = 0.005 * f64::from(row);
        let noise = |seed: f64| 2e-4 * (f64::from(row * row) * seed).sin();
        let columns = [
            form.time * t,
            form.position * (angle(0.0, t) + noise(1.7)),
            form.position * (angle(1.0, t) + noise(2.3)),
            form.rate * rate(0.0, t),
            form.rate * rate(1.0, t),
            form.command * angle(0.0, t + 0.04),
            form.command * angle(1.0, t + 0.04),
        ];
        let cells = columns.map(|value| format!("{value:.6}"));
        writeln!(text, "{}", cells.join(",")).unwrap();
    }
    text
}

fn rig(form: &Form) -> Folder {
    let folder = Folder::new();
    folder.write("robot.xml", ROBOT);
    for (run, phase) in ["a.csv", "b.csv", "c.csv"].iter().zip([0.0, 1.0, 2.0]) {
        folder.write(run, log(form, phase));
    }
    folder
}

fn draft(folder: &Folder, mechanism: &str) -> Drafted {
    let runs = ["a.csv", "b.csv", "c.csv"].map(|run| (run.to_owned(), folder.path(run)));
    let file = folder.path(mechanism);
    let draft = Draft {
        mechanism: Spec {
            file: file.to_string_lossy().into_owned(),
            text: std::fs::read_to_string(&file).unwrap(),
        },
        named: mechanism.to_owned(),
        runs: &runs,
        rate_hz: None,
    };
    let drafted = draft.write(&folder.path("recording.toml")).unwrap();
    folder.write("recording.toml", &drafted.text);
    drafted
}

/// The line of a column.
fn line<'t>(text: &'t str, column: &str) -> &'t str {
    let start = format!("{column} = ");
    text.lines()
        .find(|line| line.starts_with(&start))
        .unwrap_or("")
}

#[test]
fn columns_units_and_runs_are_found_and_the_draft_is_accepted() {
    let folder = rig(&PLAIN);
    let drafted = draft(&folder, "robot.xml");
    assert_eq!(drafted.questions, Vec::<String>::new(), "{}", drafted.text);
    let text = &drafted.text;
    assert!(line(text, "elbow").contains("measures = \"elbow\", unit = \"rad\", noise_std = "));
    assert!(line(text, "elbow_vel").contains("measures = \"elbow.velocity\", unit = \"rad/s\""));
    assert!(line(text, "servo_2").contains("input = \"servo_2\", unit = \"rad\""));
    assert!(
        line(text, "servo_2").ends_with("# position follows after 40 ms"),
        "{text}"
    );
    assert!(text.contains("# \"*.kp\" = { std = \"2 %\" }"), "{text}");
    assert!(
        text.contains("fit  = [\"a.csv\", \"b.csv\"]\ntest = [\"c.csv\"]"),
        "{text}"
    );
    let set = folder.read().unwrap();
    assert_eq!(set.channels.len(), 6);
}

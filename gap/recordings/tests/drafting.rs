//! A description is drafted from recordings of a robot, and accepted.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;

use appell_recordings::{Draft, Drafted, Frame, Logged, Spec};

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
    let runs =
        ["a.csv", "b.csv", "c.csv"].map(|run| (run.to_owned(), Logged::File(folder.path(run))));
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
    assert!(text.contains("\n\"*.kp\" = { std = \"2 %\" }"), "{text}");
    assert!(
        text.contains("fit  = [\"a.csv\", \"b.csv\"]\ntest = [\"c.csv\"]"),
        "{text}"
    );
    let set = folder.read().unwrap();
    assert_eq!(set.channels.len(), 6);
}

#[test]
fn names_by_number_and_units_of_logs_are_understood() {
    let degrees = 180.0 / std::f64::consts::PI;
    let form = Form {
        names: ["time_ms", "q1", "q2", "dq1", "dq2", "u1", "u2"],
        time: 1e3,
        position: degrees,
        rate: degrees,
        command: 1.0,
    };
    let folder = rig(&form);
    let drafted = draft(&folder, "robot.xml");
    let text = &drafted.text;
    assert_eq!(drafted.questions, Vec::<String>::new(), "{text}");
    assert!(
        line(text, "q2").contains("measures = \"elbow\", unit = \"deg\""),
        "{text}"
    );
    assert!(line(text, "dq1").contains("measures = \"shoulder.velocity\", unit = \"deg/s\""));
    assert!(
        line(text, "u1").contains("input = \"servo_1\", unit = \"rad\""),
        "{text}"
    );
    assert!((folder.read().unwrap().runs[0].sampling.step - 0.005).abs() < 1e-9);
}

#[test]
fn what_the_log_does_not_tell_is_asked() {
    // A rate with the wrong sign, a column of no joint, clock ticks under another name.
    let form = Form {
        names: [
            "tick",
            "shoulder",
            "temperature",
            "shoulder_vel",
            "elbow_vel",
            "servo_1",
            "servo_2",
        ],
        time: 1.0,
        position: 1.0,
        rate: -1.0,
        command: 1.0,
    };
    let folder = rig(&form);
    let drafted = draft(&folder, "robot.xml");
    let text = &drafted.text;
    let asked = drafted.questions.join("\n");
    for expected in [
        "is `tick` the time, in s?",
        "shoulder_vel: it runs against the derivative",
        "temperature: no quantity has a name like these",
        "elbow_vel: no position tells its unit and sign",
    ] {
        assert!(asked.contains(expected), "{expected}: {asked}\n{text}");
    }
    assert!(
        text.contains("tick = { time = true, unit = \"s\" }"),
        "{text}"
    );
    assert!(
        line(text, "shoulder_vel").contains("reversed = true"),
        "{text}"
    );
    assert!(text.contains("# temperature = "), "{text}");
    assert!(folder.read().is_ok());
}

#[test]
fn counts_and_rows_without_a_clock_leave_a_draft_open() {
    let counts = 4096.0 / std::f64::consts::TAU;
    let form = Form {
        names: [
            "n",
            "shoulder",
            "elbow",
            "shoulder_vel",
            "elbow_vel",
            "servo_1",
            "servo_2",
        ],
        time: 0.0,
        position: counts,
        rate: counts,
        command: counts,
    };
    let folder = rig(&form);
    for run in ["a.csv", "b.csv", "c.csv"] {
        let text = std::fs::read_to_string(folder.path(run)).unwrap();
        let whole = |line: &str| {
            let cells = line.split(',').map(|cell| match cell.parse::<f64>() {
                Ok(number) => number.round().to_string(),
                Err(_) => cell.to_owned(),
            });
            cells.collect::<Vec<_>>().join(",") + "\n"
        };
        folder.write(run, text.lines().map(whole).collect::<String>());
    }
    let drafted = draft(&folder, "robot.xml");
    assert!(drafted.set.is_none());
    let asked = drafted.questions.join("\n");
    assert!(
        asked.contains("how many rows are there per second?"),
        "{asked}"
    );
    assert!(asked.contains("counts_per_turn"), "{asked}");
    assert!(
        drafted
            .text
            .contains("# elbow = { measures = \"elbow\", counts_per_turn = 4096")
    );
    assert!(
        drafted.text.contains("# rate      = 100"),
        "{}",
        drafted.text
    );
}

#[test]
fn a_motor_without_a_column_of_its_command_is_asked_for_its_torque() {
    let folder = rig(&Form {
        names: [
            "t",
            "shoulder",
            "elbow",
            "x",
            "y",
            "shoulder_torque",
            "elbow_current",
        ],
        ..PLAIN
    });
    let motors = ROBOT
        .replace("<position", "<motor")
        .replace(" kp=\"50\"", "");
    folder.write("robot.xml", motors.replace(" kp=\"30\"", ""));
    let drafted = draft(&folder, "robot.xml");
    let text = &drafted.text;
    assert!(
        line(text, "shoulder_torque").contains("input = \"servo_1\", unit = \"N*m\""),
        "{text}"
    );
    assert!(
        line(text, "elbow_current").contains("input = \"servo_2\", unit = \"A\""),
        "{text}"
    );
    let asked = drafted.questions.join("\n");
    assert!(
        asked.contains("is `shoulder_torque` commanded, or measured?"),
        "{asked}"
    );
    let set = folder.read().unwrap();
    let current = set
        .channels
        .iter()
        .find(|own| own.column == "elbow_current")
        .unwrap();
    assert!((current.scale() - 1.0).abs() < 1e-15);
}

#[test]
fn a_draft_of_foreign_columns_is_refused() {
    let folder = rig(&Form {
        names: ["t", "a", "b", "c", "d", "e", "f"],
        ..PLAIN
    });
    let runs = [("a.csv".to_owned(), Logged::File(folder.path("a.csv")))];
    let draft = Draft {
        mechanism: Spec {
            file: "robot.xml".to_owned(),
            text: ROBOT.to_owned(),
        },
        named: "robot.xml".to_owned(),
        runs: &runs,
        rate_hz: None,
    };
    let error = draft
        .write(&folder.path("recording.toml"))
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("no column has a name like one of the mechanism, shoulder"),
        "{error}"
    );
}

#[test]
fn frames_are_drafted_as_their_files_are() {
    let folder = rig(&PLAIN);
    let of_files = draft(&folder, "robot.xml");
    let frames = ["a.csv", "b.csv", "c.csv"].map(|name| {
        let (columns, values) = appell_recordings::columns(&folder.path(name)).unwrap();
        Frame {
            name: name.to_owned(),
            columns,
            values,
        }
    });
    let runs = frames
        .each_ref()
        .map(|own| (own.name.clone(), Logged::Frame(own)));
    let of_frames = Draft {
        mechanism: Spec {
            file: folder.path("robot.xml").to_string_lossy().into_owned(),
            text: ROBOT.to_owned(),
        },
        named: "robot.xml".to_owned(),
        runs: &runs,
        rate_hz: None,
    };
    let of_frames = of_frames.write(&folder.path("recording.toml")).unwrap();
    assert_eq!(of_frames.text, of_files.text);
    assert_eq!(of_frames.questions, of_files.questions);
}

#[test]
fn episodes_of_one_file_are_drafted_as_runs() {
    let folder = rig(&PLAIN);
    let mut all = String::new();
    for (episode, run) in ["a.csv", "b.csv", "c.csv"].iter().enumerate() {
        let text = std::fs::read_to_string(folder.path(run)).unwrap();
        let mut lines = text.lines();
        let header = lines.next().unwrap();
        if episode == 0 {
            writeln!(all, "episode_index,{header}").unwrap();
        }
        for line in lines {
            writeln!(all, "{episode},{line}").unwrap();
        }
    }
    folder.write("all.csv", all);
    let runs = [("all.csv".to_owned(), Logged::File(folder.path("all.csv")))];
    let draft = Draft {
        mechanism: Spec {
            file: folder.path("robot.xml").to_string_lossy().into_owned(),
            text: ROBOT.to_owned(),
        },
        named: "robot.xml".to_owned(),
        runs: &runs,
        rate_hz: None,
    };
    let drafted = draft.write(&folder.path("recording.toml")).unwrap();
    let text = &drafted.text;
    assert_eq!(drafted.questions, Vec::<String>::new(), "{text}");
    assert!(
        text.contains("fit  = [\"all.csv#0-1\"]\ntest = [\"all.csv#2\"]"),
        "{text}"
    );
    folder.write("recording.toml", text);
    assert_eq!(folder.read().unwrap().runs.len(), 3);
}

#[test]
fn torques_by_number_are_the_inputs_of_a_urdf() {
    let robot = r#"<robot name="arm"><link name="base"/>
      <link name="upper"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <link name="fore"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
        <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/></joint>
      <joint name="elbow" type="continuous"><parent link="upper"/><child link="fore"/>
        <origin xyz="0.3 0 0"/><axis xyz="0 1 0"/></joint></robot>"#;
    let form = Form {
        names: ["t", "q1", "q2", "dq1", "dq2", "tau1", "tau2"],
        ..PLAIN
    };
    let folder = rig(&form);
    folder.write("robot.urdf", robot);
    let text = draft(&folder, "robot.urdf").text;
    for (column, joint) in [("tau1", "shoulder"), ("tau2", "elbow")] {
        let line = line(&text, column);
        assert!(line.contains(&format!("input = \"tau_{joint}\"")), "{text}");
    }
}

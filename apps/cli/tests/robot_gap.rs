//! From a robot file and recordings to a corrected robot file.

use std::fmt::Write as _;

use serde_json::Value;

use crate::rig::{self, Noise};
use crate::support::Folder;

/// The carriage of the rig as a robot file.
pub(crate) const ROBOT: &str = r#"<!-- A carriage on a rail. -->
<mujoco model="carriage">
  <worldbody>
    <body name="cart">
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <joint name="x" type="slide" axis="1 0 0"/>  <!-- the rail -->
    </body>
  </worldbody>
  <actuator>
    <motor name="F" joint="x"/>
  </actuator>
</mujoco>
"#;

pub(crate) const DESCRIPTION: &str = r#"
mechanism   = "robot.xml"
description = "simulated rig"
[parameters]
"*.mass" = { std = "2 %" }
[channels]
x = { measures = "x", unit = "m", noise_std = 1e-3 }
F = { input = "F", unit = "N" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;

/// A rig with dry friction that its robot file lacks.
fn rig() -> Folder {
    let folder = rig::dry(0.4);
    folder.write("robot.xml", ROBOT);
    folder.write("recording.toml", DESCRIPTION);
    folder
}

/// The number after a text.
fn number_after(text: &str, before: &str) -> f64 {
    let (_, rest) = text.split_once(before).expect("the text");
    let end = rest.find(|c: char| !(c.is_ascii_digit() || ".e-".contains(c)));
    let number = &rest[..end.expect("an end")];
    number.parse().expect("a number")
}

const APPLY: [&str; 6] = [
    "apply",
    "robot.xml",
    "--report",
    "report.json",
    "-o",
    "better.xml",
];

#[test]
fn friction_is_found_from_a_robot_file_and_written_into_it() {
    let folder = rig();
    let asked = ["diagnose", "--data", ".", "--json", "report.json"];
    let told = folder.done(&asked).stdout;
    assert!(
        told.contains("appell apply ./robot.xml") || told.contains("appell apply robot.xml"),
        "{told}"
    );
    let report: Value = serde_json::from_str(&folder.read("report.json")).expect("JSON");
    assert_eq!(report["which"][0]["effects"][0], "coulomb_friction@x");
    let fitted = &report["which"][0]["changes"]["parameters"][0];
    assert_eq!(fitted["name"], "cart.mass");

    let told = folder.done(&APPLY).stdout;
    assert!(told.contains("frictionloss"), "{told}");
    let better = folder.read("better.xml");
    let friction = number_after(&better, "frictionloss=\"");
    assert!((friction - 0.4).abs() < 0.02, "{better}");
    let mass = number_after(&better, "mass=\"");
    assert!((mass - 1.0).abs() < 0.02, "{better}");
    // All else stays as it is.
    let mut restored = better.clone();
    for (name, value) in [("frictionloss", friction), ("mass", mass)] {
        let start = better.find(&format!("{name}=\"")).expect("the attribute");
        let length = name.len() + 3 + better[start + name.len() + 2..].find('"').expect("an end");
        let written = &better[start..start + length];
        assert!(written.contains(&value.to_string()), "{written}");
        let before = if name == "mass" { "mass=\"1\"" } else { "" };
        restored = restored.replace(written, before);
    }
    assert_eq!(restored.replace(" />", "/>"), ROBOT);

    folder.write(
        "recording.toml",
        &DESCRIPTION.replace("robot.xml", "better.xml"),
    );
    folder.done(&["diagnose", "--data", ".", "--json", "again.json"]);
    let mut again: Value = serde_json::from_str(&folder.read("again.json")).expect("JSON");
    let far = &again["how_far"];
    let [nominal, floor] =
        ["nominal", "noise_floor"].map(|key| far[key].as_f64().expect("an error"));
    assert!(nominal < 1.1 * floor, "{far}");

    // Without a gap the file stays as it is.
    let nominal = again["which"].as_array().expect("hypotheses").iter();
    let nominal = nominal.filter(|own| own["effects"] == serde_json::json!([]));
    let nominal: Vec<Value> = nominal.cloned().collect();
    again["verdict"] = "no_gap".into();
    again["which"] = nominal.clone().into();
    folder.write("again.json", &again.to_string());
    let apply = [
        "apply",
        "better.xml",
        "--report",
        "again.json",
        "-o",
        "same.xml",
    ];
    let told = folder.done(&apply).stdout;
    assert!(told.contains("no gap"), "{told}");
    assert_eq!(folder.read("same.xml"), better);

    // What no effect explains is a comment, beside the numbers that were fitted.
    let mut which = vec![serde_json::json!({ "effects": ["unknown"], "probability": 0.9 })];
    which.extend(nominal);
    assert_eq!(which.len(), 2);
    again["verdict"] = "unexplained".into();
    again["which"] = which.into();
    folder.write("again.json", &again.to_string());
    folder.done(&apply);
    let written = folder.read("same.xml");
    assert!(
        written.contains("<!-- appell: not in MJCF: unknown"),
        "{written}"
    );
}

#[test]
fn numbers_within_their_tolerances_are_written_where_they_close_the_errors() {
    let folder = rig::dry(0.0);
    folder.write("robot.xml", &ROBOT.replace("mass=\"1\"", "mass=\"1.1\""));
    folder.write("recording.toml", &DESCRIPTION.replace("2 %", "6 %"));
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report: Value = serde_json::from_str(&folder.read("report.json")).expect("JSON");
    assert_eq!(report["verdict"], "no_gap");
    let report = ["--report", "report.json", "-o", "better.xml"];
    folder.done(&[&["apply", "robot.xml"], &report[..]].concat());
    let mass = number_after(&folder.read("better.xml"), "mass=\"");
    assert!((mass - 1.0).abs() < 0.02, "{mass}");
}

#[test]
fn an_unknown_number_or_joint_of_a_robot_is_named_with_its_line() {
    let folder = rig();
    for (right, wrong, message) in [
        (
            "\"*.mass\"",
            "\"cart.weight\"",
            "the robot has no number `cart.weight`",
        ),
        ("measures = \"x\"", "measures = \"x.speed\"", "x.velocity"),
        ("\"2 %\"", "\"2 m\"", "a share of the value"),
    ] {
        folder.write("recording.toml", &DESCRIPTION.replace(right, wrong));
        folder.fails(3, &["recording", "."], &["recording.toml:", message]);
    }
}

#[test]
fn what_differs_in_a_run_of_a_robot_has_the_names_of_its_file() {
    let folder = rig();
    let differs = "[run.\"b.csv\"]\npayload = { on = \"cart\", mass = 0.5, at = [0, 0, 0.1] }\n\
                   parameters = { \"cart.mass\" = { value = 1.2 }, \"x.damping\" = { value = 0.1 } }\n";
    folder.write("recording.toml", &format!("{DESCRIPTION}{differs}"));
    let told = folder.done(&["recording", "."]).stdout;
    for line in [
        "in b.csv: payload_on_cart_mass differs by +0.500 kg from the other runs",
        "in b.csv: x.damping differs by +0.1",
        "in b.csv: cart.mass differs by +0.2",
    ] {
        assert!(told.contains(line), "{told}");
    }
    // A motion with the commands of that run has the numbers of the model.
    let motion = [
        "simulate",
        "robot.xml",
        "--t-end-s",
        "1",
        "--inputs",
        "recording.toml:b.csv",
    ];
    let told = folder.done(&motion).stderr;
    let line = "in the run cart.mass differs by +0.200 kg from the other runs, which the motion leaves out";
    assert!(told.contains(line), "{told}");
    let wrong = differs.replace("on = \"cart\"", "on = \"card\"");
    folder.write("recording.toml", &format!("{DESCRIPTION}{wrong}"));
    folder.fails(
        3,
        &["recording", "."],
        &["recording.toml:", "no body `card`", "cart"],
    );
}

#[test]
fn an_actuator_may_have_the_name_of_its_joint() {
    let folder = rig();
    folder.write("robot.xml", &ROBOT.replace("name=\"F\"", "name=\"x\""));
    folder.write(
        "recording.toml",
        &DESCRIPTION.replace("input = \"F\"", "input = \"x\""),
    );
    let asked = ["diagnose", "--data", ".", "--json", "report.json"];
    folder.done(&asked);
    let report = folder.read("report.json");
    assert!(report.contains("coulomb_friction@x"), "{report}");
    assert!(
        !report.contains("@ctrl_x") && !report.contains("\"ctrl_x\""),
        "{report}"
    );
}

#[test]
fn what_mjcf_cannot_express_stands_in_a_comment() {
    let folder = rig();
    let report = r#"{ "schema": "gap-report/1", "mechanism": "carriage", "which": [{
        "effects": ["sensor_scale@x"], "probability": 1.0,
        "parameters": [{ "name": "sensor_scale@x.scale", "value": 1.021, "std": 0.001, "unit": "1" }],
        "changes": { "items": "", "inputs": [], "parameters": [], "beside": [] } }] }"#;
    folder.write("report.json", report);
    let told = folder.done(&APPLY).stdout;
    let line = "not in MJCF: sensor_scale@x = 1.02100: multiply its readings by 0.979432";
    assert!(told.contains(line), "{told}");
    let better = folder.read("better.xml");
    assert!(
        better.contains(&format!("<!-- appell: {line} -->")),
        "{better}"
    );

    let shown = [
        "apply",
        "robot.xml",
        "--report",
        "report.json",
        "-o",
        "new.xml",
    ];
    let shown = folder.done(&[&shown[..], &["--dry-run", "--json", "edits.json"]].concat());
    let head = "--- robot.xml\n+++ new.xml\n@@ -1,3 +1,4 @@\n+<!-- appell: not in MJCF";
    assert!(shown.stdout.starts_with(head), "{}", shown.stdout);
    let edits: Value = serde_json::from_str(&folder.read("edits.json")).expect("JSON");
    assert_eq!(edits["remarks"][0], line);
    assert_eq!(edits["diff"], shown.stdout);
    assert!(!folder.path("new.xml").exists());

    let nothing = report
        .replace("[\"sensor_scale@x\"]", "[]")
        .replace("sensor_scale@x.scale", "a");
    folder.write("report.json", &nothing);
    folder.done(&APPLY);
    assert_eq!(folder.read("better.xml"), ROBOT);
}

/// Two links whose servos close their loops over the encoders.
const LINKS: &str = r#"<mujoco model="two_links">
  <worldbody>
    <body name="upper">
      <inertial pos="0.1 0 0" mass="0.4" diaginertia="0.0004 0.002 0.002"/>
      <joint name="shoulder" axis="0 1 0" armature="0.005" damping="0.05"/>
      <body name="fore" pos="0.25 0 0">
        <inertial pos="0.1 0 0" mass="0.3" diaginertia="0.0003 0.001 0.001"/>
        <joint name="elbow" axis="0 1 0" armature="0.005" damping="0.05"/>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="shoulder_servo" joint="shoulder" kp="20" kv="0.8"/>
    <position name="elbow_servo" joint="elbow" kp="12" kv="0.5"/>
  </actuator>
</mujoco>
"#;

/// Number of rows of a motion for one of its recording, every 10 ms.
const FINE: usize = 5;

/// Diagnoses runs of the links as a file says they are; returns the first hypothesis.
fn diagnosed_links(folder: &Folder, truth: &str) -> Value {
    let report = report_on_links(folder, truth, 0);
    report["which"][0].clone()
}

/// The same with readings of the elbow that are late by a number of rows of the motion; returns the report.
fn report_on_links(folder: &Folder, truth: &str, late: usize) -> Value {
    folder.write("robot.xml", LINKS);
    let description = r#"
mechanism = "robot.xml"
[parameters]
"*.mass" = { std = "3 %" }
"*.com" = { std = 1e-4, unit = "m" }
"*.kp" = { std = "2 %" }
"*.kv" = { std = "5 %" }
"*.damping" = { std = "15 %" }
[channels]
shoulder = { measures = "shoulder", unit = "rad", noise_std = 2e-4 }
elbow_pos = { measures = "elbow", unit = "rad", noise_std = 2e-4 }
elbow_vel = { measures = "elbow.velocity", unit = "rad/s", noise_std = 2e-3 }
shoulder_cmd = { input = "shoulder_servo", unit = "rad" }
elbow_cmd = { input = "elbow_servo", unit = "rad" }
[runs]
fit  = ["a.csv", "b.csv"]
test = ["c.csv"]
"#;
    folder.write("recording.toml", description);
    let mut noise = Noise::seeded(7);
    for (phase, name) in [(0.0, "a.csv"), (1.0, "b.csv"), (2.0, "c.csv")] {
        folder.write(name, &run_of_links(folder, truth, phase, late, &mut noise));
    }
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    serde_json::from_str(&folder.read("report.json")).expect("JSON")
}

/// A run of the links whose commands are sums of sines with a phase; readings of the elbow are late by some rows of the
/// motion.
fn run_of_links(
    folder: &Folder,
    truth: &str,
    phase: f64,
    late: usize,
    noise: &mut Noise,
) -> String {
    let command = |t: f64| {
        let slow = [(1.1 * t + phase).sin(), (1.7 * t).sin()];
        let fast = [(3.7 * t).sin(), (4.3 * t + phase).cos()];
        let of =
            |mean: f64, large: f64, joint: usize| mean + large * slow[joint] + 0.3 * fast[joint];
        [of(0.4, 0.6, 0), of(0.7, 0.7, 1)]
    };
    let mut commands = "t,shoulder_servo,elbow_servo\n".to_owned();
    for row in 0..600 {
        let t = 0.01 * f64::from(row);
        let [shoulder, elbow] = command(t);
        let _ = writeln!(commands, "{t},{shoulder},{elbow}");
    }
    folder.write("commands.csv", &commands);
    let [shoulder, elbow] = command(0.0);
    let starts = [format!("shoulder={shoulder}"), format!("elbow={elbow}")];
    let asked = "--t-end-s 5.99 --dt-s 0.002 --inputs commands.csv --csv motion.csv";
    let mut asked: Vec<&str> = asked.split(' ').collect();
    asked.splice(0..0, ["simulate", truth]);
    asked.extend(["--initial", &starts[0], "--initial", &starts[1]]);
    folder.done(&asked);
    let motion = folder.read("motion.csv");
    let mut motion = motion.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = motion.next().expect("a heading").split(',').collect();
    let rows: Vec<Vec<&str>> = motion.map(|line| line.split(',').collect()).collect();
    let mut run = "t,shoulder,elbow_pos,elbow_vel,shoulder_cmd,elbow_cmd\n".to_owned();
    for row in (0..rows.len()).step_by(FINE).filter(|row| *row >= late) {
        let mut reading = |name: &str, row: usize, deviation: f64| {
            let column = names.iter().position(|own| *own == name).expect("a column");
            let value: f64 = rows[row][column].parse().expect("a number");
            value + deviation * noise.next()
        };
        let shoulder = reading("shoulder", row, 2e-4);
        let elbow = reading("elbow", row - late, 2e-4);
        let rate = reading("v_elbow", row - late, 2e-3);
        let t: f64 = rows[row][0].parse().expect("a time");
        let [first, second] = command(t);
        let _ = writeln!(run, "{t},{shoulder},{elbow},{rate},{first},{second}");
    }
    run
}

#[test]
fn a_delay_of_an_encoder_is_one_effect_on_its_position_and_its_rate() {
    let folder = Folder::new();
    folder.write("true.xml", LINKS);
    let report = report_on_links(&folder, "true.xml", 7);
    // A servo closes its loop over the encoder itself: a command that is late by as much moves this joint alike.
    let leading = &report["tied"][0];
    let delay = serde_json::json!("sensor_delay@elbow");
    let alone = report["which"][0]["effects"] == serde_json::json!([delay]);
    let tied = leading.as_array().into_iter().flatten();
    assert!(
        alone || tied.into_iter().any(|own| *own == delay),
        "{report:#}"
    );
    let which = report["which"].as_array().expect("hypotheses").iter();
    let mut which = which.filter(|own| own["effects"] == serde_json::json!([delay]));
    let own = which.next().expect("the delay of the encoder");
    for (place, name) in ["elbow_pos", "elbow_vel"].into_iter().enumerate() {
        let value = &own["parameters"][place];
        assert_eq!(value["name"], format!("sensor_delay@elbow.{name}_delay"));
        let delay = value["value"].as_f64().expect("a number");
        assert!((delay - 0.014).abs() < 0.002, "{value}");
    }
}

#[test]
fn the_offset_of_an_encoder_within_the_loop_of_its_servo_is_found() {
    let folder = Folder::new();
    let offset = r#"<joint name="elbow" ref="1.7188734""#;
    folder.write("true.xml", &LINKS.replace(r#"<joint name="elbow""#, offset));
    let first = diagnosed_links(&folder, "true.xml");
    assert_eq!(
        first["effects"],
        serde_json::json!(["sensor_bias@elbow_pos"])
    );
    let bias = first["parameters"][0]["value"].as_f64().expect("a number");
    assert!((bias - 0.03).abs() < 0.006, "{first}");
    // The coordinate is what the encoder shows: in the file the joint has another zero.
    folder.done(&APPLY);
    let zero = number_after(&folder.read("better.xml"), "ref=\"");
    assert!((zero - bias.to_degrees()).abs() < 1e-3, "{zero}");
}

#[test]
fn the_scale_of_an_encoder_within_the_loop_of_its_servo_is_found() {
    let folder = Folder::new();
    folder.write("robot.xml", LINKS);
    folder.done(&["import", "robot.xml", "--actuators", "-o", "plain.toml"]);
    let turned = folder.read("plain.toml");
    let turned = turned.replace("by = \"elbow\"", "by = \"elbow/1.04\"");
    folder.write("true.toml", &turned);
    let first = diagnosed_links(&folder, "true.toml");
    assert_eq!(
        first["effects"],
        serde_json::json!(["sensor_scale@elbow_pos"])
    );
    let size = first["parameters"][0]["value"].as_f64().expect("a number");
    assert!((size - 0.04).abs() < 0.006, "{first}");
    folder.done(&APPLY);
    let better = folder.read("better.xml");
    let factor = number_after(&better, "multiply its readings by ");
    assert!((factor - 1.0 / (1.0 + size)).abs() < 1e-4, "{better}");
}

/// The carriage as a URDF.
const URDF: &str = r#"<robot name="carriage">
  <link name="rail"/>
  <link name="cart">
    <inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="x" type="prismatic">
    <parent link="rail"/><child link="cart"/>
    <limit lower="-9" upper="9" effort="50" velocity="9"/>
  </joint>
</robot>
"#;

#[test]
fn friction_is_found_from_a_urdf_and_written_into_it() {
    let folder = rig();
    folder.write("robot.urdf", URDF);
    let description = DESCRIPTION
        .replace("robot.xml", "robot.urdf")
        .replace("input = \"F\"", "input = \"force_x\"")
        .replace(
            "[parameters]",
            "[parameters]\n\"x.friction\" = { std = 0.01 }",
        );
    folder.write("recording.toml", &description);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report: Value = serde_json::from_str(&folder.read("report.json")).expect("JSON");
    assert_eq!(report["robot"], "URDF");
    assert_eq!(report["which"][0]["effects"][0], "coulomb_friction@x");
    let apply = |file: &'static str| {
        [
            "apply",
            file,
            "--report",
            "report.json",
            "-o",
            "better.urdf",
        ]
    };
    folder.done(&apply("robot.urdf"));
    let better = folder.read("better.urdf");
    let friction = number_after(&better, "<dynamics friction=\"");
    assert!((friction - 0.4).abs() < 0.03, "{better}");
    folder.fails(3, &apply("robot.xml"), &["about a file of URDF"]);
}

#[test]
fn a_locked_joint_needs_no_channel() {
    let folder = rig();
    let wrist = r#"<body name="tool"><joint name="wrist"/><geom size="0.01" mass="0.1"/></body>
    </body>"#;
    folder.write("robot.xml", &ROBOT.replace("</body>", wrist));
    let locked =
        |rest: &str| DESCRIPTION.replace("description =", &format!("{rest}\ndescription ="));
    folder.write(
        "recording.toml",
        &locked("lock = [\"wrist\"]\nbase = \"fixed\""),
    );
    folder.done(&["recording", "."]);
    for (wrong, message) in [
        ("lock = [\"wrst\"]", "there is no joint `wrst`"),
        ("base = \"free\"", "`free` is no kind of base"),
    ] {
        folder.write("recording.toml", &locked(wrong));
        folder.fails(3, &["recording", "."], &[message]);
    }
}

#[test]
fn the_torque_of_a_joint_without_an_actuator_may_be_recorded() {
    let folder = rig();
    let tool = r#"<body name="tool"><joint name="wrist"/><geom size="0.01" mass="0.1"/></body>
    </body>"#;
    folder.write("robot.xml", &ROBOT.replace("</body>", tool));
    for run in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(run);
        let lines = text.lines().enumerate();
        let longer = lines.map(|(row, line)| match row {
            0 => format!("{line},effort\n"),
            _ => format!("{line},0\n"),
        });
        folder.write(run, &longer.collect::<String>());
    }
    let effort = |name: &str| {
        let line = format!("effort = {{ measures = \"{name}\", unit = \"N*m\", noise_std = 0.1 }}");
        DESCRIPTION.replace("[runs]", &format!("{line}\n[runs]"))
    };
    folder.write("recording.toml", &effort("wrist.torque"));
    folder.done(&["recording", "."]);
    folder.write("recording.toml", &effort("wirst.torque"));
    folder.fails(3, &["recording", "."], &["wirst.torque"]);
}

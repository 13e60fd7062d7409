//! One orientation in all the ways in which files write it gives one spec.

use appell_robots::{Options, import};

/// The frame of a link that is turned in its parent by what `orientation` says.
fn frame(angle: &str, orientation: &str) -> String {
    let text = format!(
        r#"<mujoco model="m"><compiler angle="{angle}" {}/><worldbody><body name="b" {}>
           <joint name="q" axis="0 0 1"/><inertial mass="1" pos="0.1 0 0" diaginertia="1 1 1"/></body></worldbody></mujoco>"#,
        orientation.split('|').nth(1).unwrap_or_default(),
        orientation.split('|').next().unwrap_or_default(),
    );
    let robot = import("m.xml", &text, &Options::default()).unwrap();
    let line = robot
        .spec
        .lines()
        .find(|line| line.starts_with("b ") && line.contains("parent"));
    line.unwrap().to_owned()
}

#[test]
fn a_right_angle_is_the_same_in_all_ways() {
    let expected = r#"b = { parent = "ground", turns = [{ about_axis = "x", by = "pi/2" }, { about_axis = "z", by = "q" }] }"#;
    for (unit, orientation) in [
        ("degree", r#"euler="90 0 0""#),
        ("degree", r#"euler="0 0 90"|eulerseq="zyx""#),
        ("degree", r#"euler="90 0 0"|eulerseq="XYZ""#),
        ("radian", r#"euler="1.5707963267948966 0 0""#),
        ("degree", r#"quat="1 1 0 0""#),
        ("degree", r#"quat="0.707107 0.707107 0 0""#),
        ("degree", r#"axisangle="2 0 0 90""#),
        ("degree", r#"xyaxes="1 0 0 0.5 0 1""#),
        ("degree", r#"zaxis="0 -1 0""#),
    ] {
        assert_eq!(frame(unit, orientation), expected, "{orientation}");
    }
}

#[test]
fn euler_angles_follow_their_sequence() {
    // Turning along about x then y is turning about the axes that stay in the other order.
    let along = frame("degree", r#"euler="30 40 0"|eulerseq="xyz""#);
    let staying = frame("degree", r#"euler="40 30 0"|eulerseq="YXZ""#);
    assert_eq!(along, staying);
    assert_ne!(along, frame("degree", r#"euler="30 40 0"|eulerseq="XYZ""#));
}

//! Joints are the items that one would write by hand.

use std::fmt::Write as _;

use appell_spec::{Mechanism, expanded, load};

const HEAD: &str = r#"
[mechanism]
name = "arm"
title = "a joint"
[parameters]
m = { value = 2, unit = "kg" }
I = { value = 0.1, unit = "kg*m^2" }
l = { value = 0.5, unit = "m" }
a = { value = 0.3, unit = "rad" }
b = { value = 2, unit = "1" }
"#;

const BODY: &str = r#"
[bodies]
arm = { frame = "arm", centre = "arm", mass = "m", inertia = { in = "arm", diagonal = ["I", "I", "I"] } }
"#;

/// A joint, and what stands for it.
const PAIRS: &[(&str, &str)] = &[
    (
        r#"
[joints]
arm = { kind = "revolute", at = ["l", 0, 0], axis = "-y", offset = "a - 1", range = [-1, 1.5], initial = 0.2, about = "shoulder" }
"#,
        r#"
[coordinates]
q_arm = { unit = "rad", about = "shoulder", range = [-1, 1.5], initial = 0.2 }
[frames]
arm = { parent = "ground", about_axis = "-y", by = "a - 1 + q_arm", about = "shoulder" }
[points]
arm = { from = "O", in = "ground", at = ["l", 0, 0] }
[pseudo_velocities]
omega_arm = { value = "dot(q_arm)", unit = "rad/s" }
"#,
    ),
    (
        r#"
[points]
P = { from = "O", in = "ground", at = ["q", 0, 0] }
[frames]
base = { parent = "ground", about_axis = "z", by = "a" }
[joints]
arm = { kind = "prismatic", parent = "base", from = "P", at = [0, 0, "l - 1 [m]"], axis = "-z", offset = "2*l", coordinate = "q", speed = "u" }
"#,
        r#"
[coordinates]
q = { unit = "m", about = "displacement of joint arm" }
[frames]
base = { parent = "ground", about_axis = "z", by = "a" }
arm = { parent = "base", about_axis = "z", by = 0 }
[points]
P = { from = "O", in = "ground", at = ["q", 0, 0] }
arm = { from = "P", in = "base", at = [0, 0, "l - 1 [m] - (2*l + q)"] }
[pseudo_velocities]
u = { value = "dot(q)", unit = "m/s" }
"#,
    ),
    (
        r#"
[joints]
arm = { kind = "prismatic", at = ["l", 0, 0], axis = ["b", 0, "-b/2"], turns = [{ about_axis = "-x", by = "a" }, { about_axis = "z", by = "30 [deg]" }] }
"#,
        r#"
[coordinates]
q_arm = { unit = "m", about = "displacement of joint arm" }
[frames]
arm = { parent = "ground", turns = [{ about_axis = "-x", by = "a" }, { about_axis = "z", by = "30 [deg]" }] }
[points]
guide_arm = { from = "O", in = "ground", at = ["l", 0, 0] }
arm = { from = "guide_arm", in = "arm", at = ["q_arm*b/sqrt(b^2 + (-b/2)^2)", 0, "q_arm*(-b/2)/sqrt(b^2 + (-b/2)^2)"] }
[pseudo_velocities]
v_arm = { value = "dot(q_arm)", unit = "m/s" }
"#,
    ),
    (
        r#"
[joints.arm]
kind = "cylindrical"
at = [0, "l", "10 [mm]"]
axis = [0.6, 0.8, 0]
initial = [0.1, 0.2]
about = "bush"
"#,
        r#"
[coordinates]
q_arm = { unit = "rad", about = "bush: angle", initial = 0.1 }
s_arm = { unit = "m", about = "bush: displacement", initial = 0.2 }
[frames]
arm = { parent = "ground", turns = [{ about_axis = "z", by = "atan2(0.8, 0.6)" }, { about_axis = "x", by = "q_arm" }, { about_axis = "-z", by = "atan2(0.8, 0.6)" }], about = "bush" }
[points]
arm = { from = "O", in = "ground", at = ["s_arm*0.6", "l + s_arm*0.8", "10 [mm]"] }
[pseudo_velocities]
omega_arm = { value = "dot(q_arm)", unit = "rad/s" }
v_arm = { value = "dot(s_arm)", unit = "m/s" }
"#,
    ),
    (
        r#"
[joints]
arm = { kind = "revolute", axis = "x", dependent = true }
[pseudo_velocities]
twice = "2*dot(q_arm)"
"#,
        r#"
[coordinates]
q_arm = { unit = "rad", about = "angle of joint arm" }
[frames]
arm = { parent = "ground", about_axis = "x", by = "q_arm" }
[points]
arm = { from = "O", in = "ground", at = [0, 0, 0] }
[pseudo_velocities]
twice = "2*dot(q_arm)"
"#,
    ),
    (
        r#"
[joints]
arm = { kind = "screw", axis = "z", pitch = "l/10", range = [0, 9] }
"#,
        r#"
[coordinates]
q_arm = { unit = "rad", about = "angle of joint arm", range = [0, 9] }
[frames]
arm = { parent = "ground", about_axis = "z", by = "q_arm" }
[points]
arm = { from = "O", in = "ground", at = [0, 0, "(l/10)*q_arm/(2*pi)"] }
[pseudo_velocities]
omega_arm = { value = "dot(q_arm)", unit = "rad/s" }
"#,
    ),
    (
        r#"
[joints]
arm = { kind = "universal", axis = "x", second_axis = [+1, 0x2, 3], coordinates = ["phi", "psi"], initial = [0.1, -0.2] }
"#,
        r#"
[coordinates]
phi = { unit = "rad", about = "angle of joint arm", initial = 0.1 }
psi = { unit = "rad", about = "angle of joint arm", initial = -0.2 }
[frames.arm]
parent = "ground"
turns = [
    { about_axis = "x", by = "phi" },
    { about_axis = "z", by = "atan2(2, 1)" },
    { about_axis = "-y", by = "atan2(3, hypot(1, 2))" },
    { about_axis = "x", by = "psi" },
    { about_axis = "y", by = "atan2(3, hypot(1, 2))" },
    { about_axis = "-z", by = "atan2(2, 1)" },
]
[points]
arm = { from = "O", in = "ground", at = [0, 0, 0] }
[pseudo_velocities]
omega1_arm = { value = "dot(phi)", unit = "rad/s" }
omega2_arm = { value = "dot(psi)", unit = "rad/s" }
"#,
    ),
    (
        r#"
[joints]
arm = { kind = "planar", axis = "-y", at = ["l", 0, 0], turns = [{ about_axis = "z", by = "a" }], speeds = ["v", "w", "o"] }
"#,
        r#"
[coordinates]
z_arm = { unit = "m", about = "displacement of joint arm" }
x_arm = { unit = "m", about = "displacement of joint arm" }
q_arm = { unit = "rad", about = "angle of joint arm" }
[frames]
mount_arm = { parent = "ground", about_axis = "z", by = "a" }
arm = { parent = "mount_arm", about_axis = "-y", by = "q_arm" }
[points]
guide_arm = { from = "O", in = "ground", at = ["l", 0, 0] }
arm = { from = "guide_arm", in = "mount_arm", at = ["x_arm", 0, "z_arm"] }
[pseudo_velocities]
v = { value = "dot(z_arm)", unit = "m/s" }
w = { value = "dot(x_arm)", unit = "m/s" }
o = { value = "dot(q_arm)", unit = "rad/s" }
"#,
    ),
    (
        r#"
[coordinates]
x = { unit = "m" }
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
[points]
cart = { from = "O", in = "ground", at = ["x", 0, 0] }
[frames]
cart = { parent = "ground", about_axis = "z", by = "x/l" }
[joints]
arm = { kind = "ball", parent = "cart", at = [0, 0, "l"], initial = [0.5, 0.5, 0.5, 0.5] }
"#,
        r#"
[coordinates]
x = { unit = "m" }
e0_arm = { unit = "1", about = "scalar part of the attitude of joint arm", initial = 0.5 }
e1_arm = { unit = "1", about = "vector part of the attitude of joint arm", initial = 0.5 }
e2_arm = { unit = "1", about = "vector part of the attitude of joint arm", initial = 0.5 }
e3_arm = { unit = "1", about = "vector part of the attitude of joint arm", initial = 0.5 }
[frames]
cart = { parent = "ground", about_axis = "z", by = "x/l" }
arm = { parent = "cart", quaternion = ["e0_arm", "e1_arm", "e2_arm", "e3_arm"] }
[points]
cart = { from = "O", in = "ground", at = ["x", 0, 0] }
arm = { from = "cart", in = "cart", at = [0, 0, "l"] }
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
omega_x_arm = { value = "angular_velocity(arm, x, arm) - angular_velocity(cart, x, arm)", unit = "rad/s" }
omega_y_arm = { value = "angular_velocity(arm, y, arm) - angular_velocity(cart, y, arm)", unit = "rad/s" }
omega_z_arm = { value = "angular_velocity(arm, z, arm) - angular_velocity(cart, z, arm)", unit = "rad/s" }
"#,
    ),
    (
        r#"
joints = { arm = { kind = "free", at = [0, 0, "l"] } }
"#,
        r#"
[coordinates]
x_arm = { unit = "m", about = "displacement of joint arm" }
y_arm = { unit = "m", about = "displacement of joint arm" }
z_arm = { unit = "m", about = "displacement of joint arm" }
e0_arm = { unit = "1", about = "scalar part of the attitude of joint arm" }
e1_arm = { unit = "1", about = "vector part of the attitude of joint arm" }
e2_arm = { unit = "1", about = "vector part of the attitude of joint arm" }
e3_arm = { unit = "1", about = "vector part of the attitude of joint arm" }
[frames]
arm = { parent = "ground", quaternion = ["e0_arm", "e1_arm", "e2_arm", "e3_arm"] }
[points]
arm = { from = "O", in = "ground", at = ["x_arm", "y_arm", "l + z_arm"] }
[pseudo_velocities]
v_x_arm = { value = "dot(x_arm)", unit = "m/s" }
v_y_arm = { value = "dot(y_arm)", unit = "m/s" }
v_z_arm = { value = "dot(z_arm)", unit = "m/s" }
omega_x_arm = { value = "angular_velocity(arm, x, arm)", unit = "rad/s" }
omega_y_arm = { value = "angular_velocity(arm, y, arm)", unit = "rad/s" }
omega_z_arm = { value = "angular_velocity(arm, z, arm)", unit = "rad/s" }
"#,
    ),
    (
        r#"
[coordinates.x]
unit = "m"
[points.P]
from = "O"
in = "ground"
at = ["x", 0, 0]
[pseudo_velocities.v]
value = "dot(x)"
[joints]
arm = { kind = "fixed", from = "P", at = [0, 0, "l"], turns = [{ about_axis = "x", by = "a" }] }
tip = { kind = "revolute", parent = "arm", axis = [0, 0, "-2"] }
"#,
        r#"
[coordinates]
x = { unit = "m" }
q_tip = { unit = "rad", about = "angle of joint tip" }
[frames]
arm = { parent = "ground", about_axis = "x", by = "a" }
tip = { parent = "arm", about_axis = "-z", by = "q_tip" }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0] }
arm = { from = "P", in = "ground", at = [0, 0, "l"] }
tip = { from = "arm", in = "arm", at = [0, 0, 0] }
[pseudo_velocities]
v = "dot(x)"
omega_tip = { value = "dot(q_tip)", unit = "rad/s" }
"#,
    ),
];

/// A spec around joints; where they are one inline table, it stands first.
fn whole(part: &str) -> String {
    if part.starts_with("\njoints") {
        format!("{part}{HEAD}{BODY}")
    } else {
        format!("{HEAD}{part}{BODY}")
    }
}

fn read(text: &str) -> Mechanism {
    match load("arm.toml", text) {
        Ok(checked) => checked.mechanism,
        Err(report) => panic!("{report}\n{text}"),
    }
}

/// All that a mechanism is but for the places of its items in the text.
fn without_places(mechanism: &Mechanism) -> String {
    let mut rest = String::new();
    let whole = format!("{mechanism:#?}");
    for line in whole.lines() {
        let is_place = ["span:", "line:"]
            .iter()
            .any(|word| line.trim_start().starts_with(word));
        if !is_place {
            let _ = writeln!(rest, "{line}");
        }
    }
    assert!(rest.contains("coordinates: "), "{rest}");
    rest
}

#[test]
fn a_joint_is_what_one_writes_by_hand() {
    for (joints, by_hand) in PAIRS {
        let [made, written] = [joints, by_hand].map(|part| without_places(&read(&whole(part))));
        assert!(made == written, "{joints}\n{made}\n{written}");
    }
}

#[test]
fn what_is_written_out_is_the_same_mechanism() {
    for (joints, _) in PAIRS {
        let text = whole(joints);
        let out = expanded("arm.toml", &text).unwrap_or_else(|report| panic!("{report}"));
        assert!(!out.contains("joints"), "{out}");
        let [before, after] = [&text, &out].map(|text| without_places(&read(text)));
        assert!(before == after, "{out}\n{before}\n{after}");
        assert_eq!(expanded("arm.toml", &out).ok(), Some(out));
    }
}

#[test]
fn each_kind_is_among_them() {
    let section = appell_spec::language::SECTIONS
        .iter()
        .find(|s| s.name == "joints");
    let Some(appell_spec::language::Shape::Kinds(kinds)) = section.map(|s| &s.shape) else {
        panic!("there are no kinds of joints")
    };
    for kind in *kinds {
        let written = format!("kind = \"{}\"", kind.word);
        assert!(
            PAIRS.iter().any(|(joints, _)| joints.contains(&written)),
            "{}",
            kind.word
        );
    }
}

#[test]
fn comments_and_all_other_words_stay() {
    let text = include_str!("joints/crane.toml");
    let out = expanded("crane.toml", text).unwrap_or_else(|report| panic!("{report}"));
    insta::assert_snapshot!("written_out", out);
    for (line, comment) in text
        .lines()
        .enumerate()
        .filter_map(|(i, l)| Some((i, l.split_once('#')?.1)))
    {
        assert!(out.contains(comment), "line {line}: {comment}");
    }
}

#[test]
fn findings_of_what_is_made_point_at_the_joint() {
    let text = whole(
        "\n[joints]\narm = { kind = \"revolute\", axis = [\"c\", 0, 1], at = [0, \"l + a\", 0] }\n",
    );
    let report = load("arm.toml", &text).expect_err("two errors");
    let places: Vec<&str> = report
        .diagnostics()
        .iter()
        .filter_map(|finding| text.get(finding.labels.first()?.0.clone()))
        .collect();
    assert_eq!(places, ["c", "a"], "{report}");
    assert!(
        report
            .diagnostics()
            .iter()
            .all(|finding| finding.help.is_some()),
        "{report}"
    );
}

/// What is left of a spec is refused or read, and then its joints can be written out.
#[test]
fn damaged_joints_do_not_panic() {
    for (joints, _) in PAIRS {
        let text = whole(joints);
        let start = text.find("joints").expect("the section");
        let end = start + joints.len().min(text.len() - start);
        for at in start..end {
            let mut damaged = text.clone();
            damaged.remove(at);
            if load("arm.toml", &damaged).is_ok() {
                let out = expanded("arm.toml", &damaged).expect("a spec");
                assert!(load("arm.toml", &out).is_ok(), "{damaged}\n{out}");
            }
            let _ = load("arm.toml", &text[..at]);
        }
    }
}

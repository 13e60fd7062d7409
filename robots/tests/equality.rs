//! Equations between coordinates and between bodies. The values are those of `MuJoCo` 4.0.

use appell_robots::{Failure, Options, import};

fn spec(text: &str) -> String {
    let imported = import("robot.xml", text, &Options::default());
    let told = imported.map_err(|failure| match failure {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    });
    told.unwrap().spec
}

/// Two hinges, or two slides, and a tendon of the second with a factor.
fn tendon(joint: &str, tendon: &str, equality: &str) -> String {
    format!(
        r#"<mujoco><compiler angle="radian"/><worldbody>
<body name="a"><joint name="c" axis="0 1 0" {joint}/><geom size="0.1" pos="0 0 0.2"/></body>
<body name="b" pos="1 0 0"><joint name="k" axis="0 1 0" {joint}/><geom size="0.1" pos="0 0 0.2"/></body></worldbody>
<tendon><fixed name="T1"><joint joint="c" coef="1"/></fixed>
<fixed name="T2" {tendon}><joint joint="k" coef="2"/></fixed></tendon>
<equality>{equality}</equality></mujoco>"#
    )
}

#[test]
fn powers_are_those_of_the_whole_length() {
    let coupled = r#"<tendon tendon1="T1" tendon2="T2" polycoef="0.1 0.5 1 0 0"/>"#;
    let of_both = spec(&tendon("", "", coupled));
    assert!(
        of_both.contains("zero = \"c - (0.1 + 0.5*(2*k) + (2*k)^2)\""),
        "{of_both}"
    );
    let slides = spec(&tendon("type=\"slide\"", "", coupled));
    assert!(slides.contains("(2*k)^2"), "{slides}");
    let resists = spec(&tendon(
        "",
        "damping=\"1 2 3\" stiffness=\"4 5 6\" springlength=\"0\"",
        "",
    ));
    for term in [
        "3 [N*m*s^3]*(2*dot(k))^3",
        "2 [N*m*s^2]*(2*dot(k))*abs(2*dot(k))",
        "5 [N*m]*(2*k)^2",
        "6 [N*m]*(2*k)^3",
    ] {
        assert!(resists.contains(term), "{term}\n{resists}");
    }
    let back = spec(
        &tendon("", "stiffness=\"4 5 6\" springlength=\"0\"", "")
            .replace("coef=\"2\"", "coef=\"-1\""),
    );
    assert!(back.contains("(-k)^2"), "{back}");
}

/// A body on two slides and a hinge, and one on a hinge, all in a plane.
fn planar(equality: &str) -> String {
    format!(
        r#"<mujoco><compiler angle="radian"/><worldbody>
<body name="p" pos="1 0 0"><joint name="p1" type="slide" axis="1 0 0"/><joint name="p2" type="slide" axis="0 1 0"/>
  <joint name="p3" axis="0 0 1"/><geom type="box" size="0.1 0.1 0.3" pos="0.1 0 0"/><site name="A" pos="0.1 0.2 0"/></body>
<body name="pp" pos="1.3 0 0"><joint name="pp1" axis="0 0 1"/><geom size="0.1" pos="0.1 0 0"/><site name="B" pos="-0.05 0 0"/></body>
</worldbody><equality>{equality}</equality></mujoco>"#
    )
}

#[test]
fn a_weld_that_lets_turn_has_its_point_in_the_second_body() {
    // The origin of the second body.
    let plain = spec(&planar(r#"<weld body1="pp" body2="p" torquescale="0"/>"#));
    for words in [
        "weld_1_1 = { from = \"pp\", in = \"pp\", at = [\"-0.3 [m]\", 0, 0] }",
        "position(weld_1_1, x) - position(p, x)",
    ] {
        assert!(plain.contains(words), "{words}\n{plain}");
    }
    let anchored = spec(&planar(
        r#"<weld body1="pp" body2="p" torquescale="0" anchor="0.1 0.2 0"/>"#,
    ));
    for words in [
        "weld_1_1 = { from = \"pp\", in = \"pp\", at = [\"-0.2 [m]\", \"0.2 [m]\", 0] }",
        "weld_1_2 = { from = \"p\", in = \"p\", at = [\"0.1 [m]\", \"0.2 [m]\", 0] }",
    ] {
        assert!(anchored.contains(words), "{words}\n{anchored}");
    }
    let to_world = spec(&planar(
        r#"<weld body1="pp" torquescale="0" anchor="1 0.2 0"/>"#,
    ));
    for words in [
        "weld_1_1 = { from = \"pp\", in = \"pp\", at = [\"-0.3 [m]\", \"0.2 [m]\", 0] }",
        "weld_1_2 = { from = \"O\", in = \"ground\", at = [\"1 [m]\", \"0.2 [m]\", 0] }",
    ] {
        assert!(to_world.contains(words), "{words}\n{to_world}");
    }
}

//! Equations between coordinates and between bodies. The values are those of `MuJoCo` 4.0.

use appell_robots::{Failure, Options, import};

fn told(text: &str) -> Result<String, String> {
    match import("robot.xml", text, &Options::default()) {
        Ok(robot) => Ok(robot.spec),
        Err(Failure::File(report)) => Err(report.plain()),
        Err(Failure::Unknown { name, .. } | Failure::Lock(name)) => Err(name),
    }
}

fn spec(text: &str) -> String {
    told(text).unwrap()
}

/// Names of the speeds, and of the coordinates that follow.
fn freedoms(spec: &str) -> (Vec<&str>, Vec<&str>) {
    let speeds = spec.lines().filter(|line| line.starts_with("v_"));
    let speeds = speeds.filter_map(|line| line.split_whitespace().next());
    let followers = spec.split("dependent = \"").skip(1);
    (
        speeds.collect(),
        followers
            .filter_map(|rest| rest.split('"').next())
            .collect(),
    )
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

#[test]
fn loops_are_counted_where_they_close() {
    // In the file the sites are neither at one place nor turned alike; in a plane three equations say all.
    let sites = planar(r#"<weld site1="A" site2="B"/>"#)
        .replace("pos=\"0.1 0.2 0\"", "pos=\"0.1 0.2 0\" euler=\"0 0 0.4\"");
    let of_sites = spec(&sites);
    assert_eq!(freedoms(&of_sites).0.len(), 1, "{of_sites}");
    assert_eq!(freedoms(&of_sites).1.len(), 3, "{of_sites}");
    // A loop to the world in which one row of the weld says nothing where it is closed.
    let chain = r#"<mujoco><worldbody><body name="p" pos="1 0 0"><joint name="p1" type="slide" axis="1 0 0"/>
<joint name="p2" type="slide" axis="0 1 0"/><joint name="p3" axis="0 0 1"/><geom type="box" size="0.1 0.1 0.3" pos="0.1 0 0"/>
<body name="pp" pos="0.3 0 0"><joint name="pp1" axis="0 0 1"/><joint name="pp2" axis="0 1 0"/><geom size="0.1" pos="0.1 0 0"/>
</body></body></worldbody><equality><weld body1="pp"/></equality></mujoco>"#;
    let welded = spec(chain);
    assert!(
        welded.contains("z) - position(weld_1_2_2, z)\", dependent = \"pp2\""),
        "{welded}"
    );
    assert_eq!(freedoms(&welded).0.len(), 1, "{welded}");
}

#[test]
fn motions_begin_where_loops_close() {
    // The sites can only meet with the slides elsewhere than in the file, which the followers do by themselves.
    let near = spec(&planar(r#"<connect site1="A" site2="B"/>"#));
    assert!(!near.contains("initial"), "{near}");
    // A rod of 0.5 m whose hinge is 0.8 m from the slide's line: it meets nowhere for this value of the slide.
    let rod = |line: f64| {
        format!(
            r#"<mujoco><worldbody><body name="rod"><joint name="h" axis="0 1 0" armature="1"/><geom size="0.1" pos="0.5 0 0"/>
<site name="a" pos="0.5 0 0"/></body><body name="cart" pos="1 0 {line}"><joint name="s" type="slide" axis="1 0 0"/>
<geom size="0.1"/><site name="b"/></body></worldbody><actuator><motor joint="h"/></actuator>
<equality><connect site1="a" site2="b"/></equality></mujoco>"#
        )
    };
    let turned = spec(&rod(0.3));
    assert_eq!(freedoms(&turned).1.len(), 2, "{turned}");
    let wrong = told(&rod(0.8)).unwrap_err();
    for words in [
        "robot.xml:4:",
        "`connect_1` cannot hold near",
        "residual is 0.3",
        "without couplings",
    ] {
        assert!(wrong.contains(words), "{words}\n{wrong}");
    }
    // What no joint moves has to hold as it is.
    let still = planar(r#"<weld site1="A" site2="B"/>"#)
        .replace("<site name=\"B\"", "<site name=\"B\" euler=\"0.3 0 0\"");
    assert!(
        told(&still)
            .unwrap_err()
            .contains("`weld_1` cannot hold near")
    );
}

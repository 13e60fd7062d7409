//! Actuators as inputs, and numbers of the file as parameters.

use appell_robots::{ActuatorName, Failure, Imported, Letters, Options, import};

/// An arm of three links, with actuators.
fn file(actuators: &str) -> String {
    format!(
        r#"<mujoco model="arm"><compiler angle="radian"/>
      <default><default class="servo"><position kp="20" kv="1" forcerange="-3 3"/></default></default>
      <worldbody><body name="upper">
        <inertial pos="0.1 0 0" mass="2" diaginertia="0.01 0.02 0.03"/>
        <joint name="shoulder" axis="0 1 0" damping="0.1" pos="0.02 0 0" range="-1 2"/>
        <body name="fore" pos="0.4 0 0">
          <inertial pos="0.1 0 0.05" mass="1" diaginertia="0.02 0.02 0.03"/>
          <joint name="elbow" axis="0 0.6 0.8" armature="0.3"/>
          <body name="hand" pos="0 0 0.2">
            <inertial pos="0 0 0" mass="0.2" diaginertia="0.001 0.001 0.001"/>
            <joint name="wrist" actuatorfrcrange="-5 5"/><site name="tip"/>
          </body></body></body></worldbody>
      <tendon><fixed name="sum"><joint joint="elbow" coef="3"/><joint joint="wrist" coef="1"/></fixed></tendon>
      <actuator>
        {actuators}
      </actuator></mujoco>"#
    )
}

fn arm(letters: Letters) -> Imported {
    let actuators = r#"<position name="s" class="servo" joint="shoulder" timeconst="0.02" ctrlrange="-1 1"/>
        <motor name="elbow" joint="elbow" gear="9" ctrlrange="-4 4"/>"#;
    let options = Options {
        actuators: true,
        letters,
        ..Options::default()
    };
    import("arm.xml", &file(actuators), &options).unwrap()
}

#[test]
fn actuators_are_inputs_with_their_laws() {
    let arm = arm(Letters::None);
    for line in [
        "s          = { unit = \"rad\"",
        "ctrl_elbow = { unit = \"N*m\"",
        "force = \"min(max(20 [N*m]*(min(max(s, -1), 1) - shoulder) - 1 [N*m*s]*dot(shoulder), -3 [N*m]), 3 [N*m])\"",
        "force = \"9*min(max(ctrl_elbow, -4 [N*m]), 4 [N*m])\"",
        "torque_elbow    = { value = \"force(ctrl_elbow)\"",
        "# - s lags by 0.02 s",
    ] {
        assert!(arm.spec.contains(line), "{line}\n{}", arm.spec);
    }
    assert!(!arm.spec.contains("tau_"), "{}", arm.spec);
    let [servo, motor] = arm.dictionary.actuators.as_slice() else {
        panic!("{:?}", arm.dictionary);
    };
    let expected = ActuatorName {
        name: "s".to_owned(),
        input: "s".to_owned(),
        load: "s".to_owned(),
        joint: Some("shoulder".to_owned()),
        lag: 0.02,
        delay: 0.0,
        is_servo: true,
        gear: 1.0,
        gain: 20.0,
        bias: 0.0,
        follows_motion: true,
    };
    assert_eq!(*servo, expected);
    assert_eq!(motor.input, "ctrl_elbow");
    assert!(!motor.is_servo);
}

fn chosen(patterns: &[&str]) -> Imported {
    arm(Letters::Matching(
        patterns.iter().map(|one| (*one).to_owned()).collect(),
    ))
}

#[test]
fn numbers_of_the_file_are_parameters_by_name_and_pattern() {
    let arm = chosen(&[
        "*.mass",
        "fore.com",
        "upper.com.x",
        "upper.inertia",
        "*.damping",
        "elbow.frictionloss",
        "elbow.stiffness",
        "shoulder.ref",
        "*.kp",
        "*.kv",
        "*.gear",
        "*.timeconst",
        "elbow.bias",
        "*.forcerange",
        "gravity",
    ]);
    let entries = arm.dictionary.entries.iter();
    let entries: Vec<String> = entries
        .map(|one| {
            let factor = if one.relative { " factor" } else { "" };
            let name = format!("{}.{}", one.element, one.attribute);
            format!("{name} {} {}{factor}", one.parameter, one.value)
        })
        .collect();
    insta::assert_snapshot!(entries.join("\n"), @r"
    option.gravity g 9.81
    shoulder.ref ref_shoulder 0
    upper.com.x cx_upper 0.1
    upper.mass m_upper 2
    upper.inertia inertia_upper 1 factor
    shoulder.damping damping_shoulder 0.1
    fore.com.x cx_fore 0.1
    fore.com.y cy_fore 0
    fore.com.z cz_fore 0.05
    fore.mass m_fore 1
    elbow.stiffness stiffness_elbow 0
    elbow.frictionloss friction_elbow 0
    hand.mass m_hand 0.2
    s.kp kp_s 20
    s.kv kv_s 1
    s.forcerange forcerange_s 3
    s.timeconst  0.02
    elbow.gear gear_ctrl_elbow 9
    elbow.bias bias_ctrl_elbow 0
    ");
    for line in [
        "by = \"shoulder - ref_shoulder\"",
        "at = [\"cx_upper - 0.02 [m]\", 0, 0]",
        "at = [\"cx_fore\", \"0.8*cy_fore - 0.6*cz_fore\", \"0.6*cy_fore + 0.8*cz_fore\"]",
        "diagonal = [\"0.01 [kg*m^2]*inertia_upper\"",
        "value = 0, unit = \"N*m\", about = \"dry friction of joint elbow\"",
        "-forcerange_s), forcerange_s)",
    ] {
        assert!(arm.spec.contains(line), "{line}\n{}", arm.spec);
    }
}

#[test]
fn names_of_nothing_are_refused() {
    for (pattern, help) in [
        ("*.dampng", ""),
        ("elbow.dampng", "elbow.damping"),
        ("elbows.damping", "elbow.damping"),
        ("fore", ""),
    ] {
        let options = Options {
            letters: Letters::Matching(vec![pattern.to_owned()]),
            ..Options::default()
        };
        match import("arm.xml", &file(""), &options) {
            Err(Failure::Unknown { name, help: found }) => {
                assert_eq!(name, pattern);
                assert!(found.contains(help), "{found}");
            }
            other => panic!("{pattern}: {other:?}"),
        }
    }
    // A pattern of an attribute that no element has is none of nothing.
    let options = Options {
        letters: Letters::read("*.kp, *.com"),
        ..Options::default()
    };
    let spec = import("arm.xml", &file(""), &options).unwrap().spec;
    assert!(spec.contains("cx_fore"), "{spec}");
}

/// The loads of an arm with other actuators, and what is left out with an effect.
fn loads(actuators: &str) -> (String, Vec<String>) {
    let options = Options {
        actuators: true,
        ..Options::default()
    };
    let arm = import("arm.xml", &file(actuators), &options).unwrap();
    let (_, loads) = arm.spec.split_once("[loads]").unwrap();
    let acting = arm.left_out.iter().filter(|one| one.effect.is_some());
    let acting = acting.map(|one| format!("{} {:?}", one.what, one.lines));
    (loads.to_owned(), acting.collect())
}

#[test]
fn laws_are_those_of_mujoco() {
    for (actuators, force) in [
        (
            r#"<velocity name="a" joint="elbow" kv="2" gear="3" forcerange="-1 2"/>"#,
            "3*min(max(2 [N*m*s]*(a - 3*dot(elbow)), -1 [N*m]), 2 [N*m])",
        ),
        (
            r#"<general name="a" joint="elbow" gainprm="3" biastype="affine" biasprm="0.5 -2 -0.3"/>"#,
            "3*a - 2 [N*m]*elbow - 0.3 [N*m*s]*dot(elbow) + 0.5 [N*m]",
        ),
        (
            r#"<general name="a" joint="elbow" gaintype="affine" gainprm="3 2 1"/>"#,
            "(3 [N*m] + 2 [N*m]*elbow + 1 [N*m*s]*dot(elbow))*a",
        ),
        (
            r#"<damper name="a" joint="elbow" kv="2" ctrlrange="0 1"/>"#,
            "-2 [N*m*s]*min(max(a, 0), 1)*dot(elbow)",
        ),
        (
            r#"<cylinder name="a" joint="elbow" area="2" bias="1 0 -3"/>"#,
            "2*a - 3 [N*m*s]*dot(elbow) + 1 [N*m]",
        ),
        (
            r#"<dcmotor name="a" joint="elbow" motorconst="0.1 0.4" resistance="2" saturation="3"/>"#,
            "min(max(0.1*a - 0.02 [N*m*s]*dot(elbow), -3 [N*m]), 3 [N*m])",
        ),
        (
            r#"<motor name="a" jointinparent="elbow" ctrllimited="false" ctrlrange="-1 1"/>"#,
            "\"a\"",
        ),
        // Of MuJoCo: kv = 1.893275709255942.
        (
            r#"<position name="a" joint="shoulder" kp="20" dampratio="0.5" gear="2" inheritrange="0.8" armature="0.1"/>"#,
            "2*(20 [N*m]*(min(max(a, -0.7), 1.7) - 2*shoulder) - 1.8932757092559",
        ),
        // The sum of two forces is bounded by their joint.
        (
            r#"<motor name="a" joint="wrist"/><motor name="b" joint="wrist" gear="2"/>"#,
            "min(max(force(a) + force(b), -5 [N*m]), 5 [N*m]) - (force(a) + force(b))",
        ),
        (
            r#"<motor name="a" joint="wrist" gear="2"/>"#,
            "min(max(2*a, -5 [N*m]), 5 [N*m])",
        ),
        (
            r#"<motor name="a" tendon="sum" gear="2"/>"#,
            "velocity = \"3*dot(elbow) + dot(wrist)\", force = \"2*a\"",
        ),
    ] {
        let (loads, acting) = loads(actuators);
        assert!(loads.contains(force), "{actuators}\n{loads}");
        assert!(acting.is_empty(), "{acting:?}");
    }
}

#[test]
fn actuators_of_other_laws_are_left_out_with_their_lines() {
    for (actuators, expected) in [
        (
            r#"<intvelocity name="a" joint="elbow" kp="2"/>"#,
            Some("actuator/intvelocity"),
        ),
        (
            r#"<dcmotor name="a" joint="elbow" motorconst="0.1" resistance="2" cogging="1 2 3"/>"#,
            Some("actuator/dcmotor"),
        ),
        (r#"<motor name="a" site="tip"/>"#, Some("actuator/motor")),
        (
            r#"<general name="a" joint="elbow" dyntype="user"/>"#,
            Some("actuator/general"),
        ),
    ] {
        let (loads, acting) = loads(actuators);
        assert!(!loads.contains("actuator a"), "{loads}");
        let expected: Vec<String> = expected
            .map(|what| format!("{what} [15]"))
            .into_iter()
            .collect();
        assert_eq!(acting, expected);
    }
}

#[test]
fn attributes_that_an_actuator_does_not_have_are_refused() {
    let options = Options {
        actuators: true,
        ..Options::default()
    };
    let text = file(r#"<position name="a" joint="elbow" kpp="3"/>"#);
    match import("arm.xml", &text, &options) {
        Err(Failure::File(report)) => {
            let message = report.plain();
            assert!(
                message.contains("`position` has no attribute `kpp`"),
                "{message}"
            );
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn of_several_transmissions_the_last_one_holds_as_in_mujoco() {
    let options = Options {
        actuators: true,
        ..Options::default()
    };
    let text = file(r#"<motor name="m" tendon="sum" joint="shoulder"/>"#);
    let arm = import("arm.xml", &text, &options).unwrap();
    assert_eq!(arm.dictionary.actuators[0].joint, None);
}

#[test]
fn a_position_servo_has_no_constant_force_whatever_its_class_says() {
    let options = Options {
        actuators: true,
        ..Options::default()
    };
    let text = file(r#"<position name="p" class="servo" joint="shoulder"/>"#);
    let text = text.replace(
        r#"<position kp="20" kv="1""#,
        r#"<general biastype="affine" biasprm="7 0 0"/><position kp="20" kv="1""#,
    );
    let arm = import("arm.xml", &text, &options).unwrap();
    let law = "min(max(20 [N*m]*(p - shoulder) - 1 [N*m*s]*dot(shoulder), -3 [N*m]), 3 [N*m])";
    assert!(arm.spec.contains(law), "{}", arm.spec);
}

//! Changes of MJCF files: the bytes that they touch, and the numbers that they make.

use appell_robots::{Amount, Change, Corrected, Failure, Number, Options, corrected, import};

const LEG: &str = r#"<?xml version="1.0"?>
<mujoco model="leg">
  <!-- of a test bench -->
  <option timestep="0.0005"/>
  <default>
    <joint axis="0 1 0" damping="0.5"/>
    <default class="servo"><position kp="50" kv="2" forcerange="-20 20"/></default>
  </default>
  <worldbody>
    <body name="thigh" pos="0 0 0.6">
      <inertial pos="0 0 -0.1" mass="1.3" diaginertia="0.006 0.005 0.002"/>
      <joint name="hip"   range="-90 90" armature='0.01' /> <!-- quick -->
      <body name="shank" pos="0 0 -0.2">
        <joint name="knee" frictionloss="0.1"/>
        <geom type="box" size="0.01 0.02 0.1" pos="0 0 -0.1" mass="0.3"/>
        <body name="foot" pos="0 0 -0.2">
          <inertial pos="0 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position class="servo" name="hip_servo" joint="hip"/>
    <motor name="knee_motor" joint="knee" gear="9" ctrlrange="-4 4"/>
    <general joint="knee" gainprm="3" biastype="affine" biasprm="0 -3 -0.2"/>
  </actuator>
  <keyframe><key qpos="0.1 0.2" qvel="1 2" ctrl="7 8 9"/></keyframe>
</mujoco>
"#;

fn none(_: &str) -> Result<Vec<u8>, String> {
    Err("only this text is read".to_owned())
}

fn change(text: &str, changes: &[Change]) -> Result<Corrected, String> {
    corrected("robot.xml", text, changes, &[], &none).map_err(|failure| match failure {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    })
}

/// Demands that changes of the leg replace parts of its text, and nothing else.
fn replaces(changes: &[Change], parts: &[(&str, &str)]) {
    let mut expected = LEG.to_owned();
    for (before, after) in parts {
        assert_eq!(expected.matches(before).count(), 1, "{before}");
        expected = expected.replace(before, after);
    }
    let text = change(LEG, changes).unwrap().text;
    assert_eq!(text, expected, "{changes:?}");
}

fn joint(joint: &str, attribute: Number, amount: Amount) -> Change {
    Change::number(joint, attribute, amount)
}

#[test]
fn without_changes_the_bytes_stay() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/robots");
    let mut count = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|end| end == "xml") {
            let text = std::fs::read_to_string(&path).unwrap();
            let same = change(&text, &[]).unwrap();
            assert_eq!((same.text, same.edits), (text, Vec::new()), "{path:?}");
            count += 1;
        }
    }
    assert!(count > 5);
    let windows = LEG.replace('\n', "\r\n");
    assert_eq!(change(&windows, &[]).unwrap().text, windows);
    let nothing = [
        joint("hip", Number::Damping, Amount::Add(0.0)),
        joint("hip", Number::Armature, Amount::Times(1.0)),
        Change::number("shank", Number::Mass, Amount::Times(1.0)),
        Change::Gravity([0.0, 0.0, -9.81]),
        Change::number("hip_servo", Number::Kp, Amount::To(50.0)),
    ];
    replaces(&nothing, &[]);
}

#[test]
fn numbers_of_joints_are_written_at_the_joint() {
    let twice = [
        joint("hip", Number::Damping, Amount::Times(2.0)),
        joint("hip", Number::Damping, Amount::Add(0.1)),
        joint("hip", Number::Armature, Amount::To(0.02)),
    ];
    let hip = "armature='0.01' />";
    replaces(&twice, &[(hip, "armature='0.02' damping=\"1.1\" />")]);
    // Springs of one joint add up; positions are in degrees in this file.
    let spring = |stiffness, relaxed_at| Change::Spring {
        joint: "hip".to_owned(),
        stiffness,
        relaxed_at,
    };
    let springs = [spring(1.0, 0.0), spring(1.0, 1.0)];
    let spring = "armature='0.01' stiffness=\"2\" springref=\"28.6478897565\" />";
    replaces(&springs, &[(hip, spring)]);
    let reading = Change::number(
        "hip",
        Number::Reading,
        Amount::Add(-std::f64::consts::PI / 180.0),
    );
    let moved = [
        (hip, "armature='0.01' ref=\"-1\" />"),
        ("range=\"-90 90\"", "range=\"-91 89\""),
    ];
    replaces(&[reading], &moved);
    let below = joint("knee", Number::Frictionloss, Amount::Add(-0.2));
    let better = change(LEG, &[below]).unwrap();
    assert!(better.text.contains(r#"name="knee" frictionloss="0"/>"#));
    assert!(
        better
            .edits
            .iter()
            .any(|said| said.contains("would be -0.1"))
    );
}

#[test]
fn inertias_are_changed_in_their_own_axes() {
    let thigh = "thigh".to_owned();
    let changes = [
        Change::number(thigh.clone(), Number::Mass, Amount::To(1.5)),
        Change::Centre {
            body: thigh.clone(),
            amounts: [Amount::Add(0.01), Amount::Add(0.0), Amount::Times(2.0)],
        },
        Change::number(thigh, Number::Inertia, Amount::Times(1.5)),
    ];
    let before = r#"<inertial pos="0 0 -0.1" mass="1.3" diaginertia="0.006 0.005 0.002"/>"#;
    let after = r#"<inertial pos="0.01 0 -0.2" mass="1.5" diaginertia="0.009 0.0075 0.003"/>"#;
    replaces(&changes, &[(before, after)]);
}

#[test]
fn bodies_that_are_fixed_together_have_one_inertia() {
    // Shank 0.3 kg at 0.1 m, foot 0.1 kg at 0.2 m: 0.4 kg at 0.125 m.
    let heavier = Change::number("shank", Number::Mass, Amount::Times(2.0));
    let better = change(LEG, &[heavier]).unwrap();
    let after = import("leg.xml", &better.text, &Options::default()).unwrap();
    assert!(after.spec.contains("mass = \"0.8 [kg]\""), "{}", after.spec);
    let inertial = "<inertial pos=\"0 0 -0.114285714286\" mass=\"0.7\" ";
    assert!(better.text.contains(inertial), "{}", better.text);
    let told = "shank together with foot, fixed to it: mass 0.8 (was 0.4)";
    assert!(
        better.edits.iter().any(|edit| edit == told),
        "{:?}",
        better.edits
    );
    // More than is left to the shank is taken from the foot as well.
    let lighter = Change::number("shank", Number::Mass, Amount::Times(0.2));
    let better = change(LEG, &[lighter]).unwrap();
    assert!(better.text.contains("mass=\"0.08\""), "{}", better.text);
    let emptied = r#"<inertial pos="0 0 0" mass="0" diaginertia="0 0 0"/>"#;
    assert!(better.text.contains(emptied), "{}", better.text);
}

#[test]
fn a_payload_is_a_body_of_its_own() {
    let payload = |body: &str| Change::Payload {
        body: body.to_owned(),
        mass: 0.4,
        at: [0.0, 0.01, -0.05],
    };
    let body = |name: &str| {
        let inertial = "<inertial pos=\"0 0 0\" mass=\"0.4\" diaginertia=\"0 0 0\"/>";
        format!("<body name=\"{name}\" pos=\"0 0.01 -0.05\">{inertial}</body>")
    };
    let foot = "          <inertial pos=\"0 0 0\" mass=\"0.1\" diaginertia=\"1e-4 1e-4 1e-4\"/>\n";
    let both = format!(
        "{foot}          {}\n          {}\n",
        body("payload"),
        body("payload_2")
    );
    replaces(&[payload("foot"), payload("foot")], &[(foot, &both)]);
    // A body without contents gets some.
    let text = LEG.replace(
        "<body name=\"foot\"",
        "<body name=\"toe\"/>\n        <body name=\"foot\"",
    );
    let better = change(&text, &[payload("toe")]).unwrap();
    let toe = format!(
        "<body name=\"toe\">\n          {}\n        </body>",
        body("payload")
    );
    assert_eq!(better.text, text.replace("<body name=\"toe\"/>", &toe));
}

#[test]
fn gains_are_those_of_the_actuator_and_not_of_its_class() {
    let (servo, unnamed) = ("hip_servo".to_owned(), "general_knee".to_owned());
    let kp = |actuator: &String| Change::number(actuator.clone(), Number::Kp, Amount::Times(1.2));
    let kv = |actuator: &String| Change::number(actuator.clone(), Number::Kv, Amount::Add(0.5));
    replaces(
        &[kp(&servo), kv(&servo), kp(&unnamed), kv(&unnamed)],
        &[
            ("joint=\"hip\"/>", "joint=\"hip\" kp=\"60\" kv=\"2.5\"/>"),
            ("gainprm=\"3\"", "gainprm=\"3.6\""),
            ("biasprm=\"0 -3 -0.2\"", "biasprm=\"0 -3.6 -0.7\""),
        ],
    );
    let gain = |actuator: &str| Change::number(actuator, Number::Gain, Amount::Times(2.0));
    replaces(
        &[gain("hip_servo"), gain("knee_motor"), gain("general_knee")],
        &[
            (
                "joint=\"hip\"/>",
                "joint=\"hip\" forcerange=\"-40 40\" kp=\"100\" kv=\"4\"/>",
            ),
            ("gear=\"9\"", "gear=\"18\""),
            ("gainprm=\"3\"", "gainprm=\"6\""),
            ("biasprm=\"0 -3 -0.2\"", "biasprm=\"0 -6 -0.4\""),
        ],
    );
}

#[test]
fn what_follows_from_the_inertias_of_the_file_stays_where_these_change() {
    // 2 kg m² about the axis: kv = 2 · 0.5 · √(18 · 2) = 6; the spring has 2/0.5² = 8, its damper 2 · 2/0.5 = 8.
    let text = r#"<mujoco><worldbody><body name="arm">
      <inertial pos="0 0 1" mass="1" diaginertia="1 1 1"/>
      <joint name="elbow" axis="0 1 0" springdamper="0.5 1"/>
    </body></worldbody><actuator>
      <position name="servo" joint="elbow" kp="18" dampratio="0.5"/>
    </actuator></mujoco>"#;
    let stiffer = Change::number("servo", Number::Kp, Amount::To(20.0));
    let servo = text.replace("kp=\"18\" dampratio=\"0.5\"", "kp=\"20\" kv=\"6\"");
    assert_eq!(change(text, &[stiffer]).unwrap().text, servo);
    let heavier = Change::number("arm", Number::Inertia, Amount::Times(2.0));
    let expected = text
        .replace("\"1 1 1\"", "\"2 2 2\"")
        .replace(
            " springdamper=\"0.5 1\"/>",
            " stiffness=\"8\" damping=\"8\"/>",
        )
        .replace(" dampratio=\"0.5\"", " kv=\"6\"");
    assert_eq!(change(text, &[heavier]).unwrap().text, expected);
}

#[test]
fn scaled_masses_and_those_of_geoms_become_inertials() {
    let text = r#"<mujoco>
  <compiler inertiafromgeom="true" settotalmass="3"/>
  <worldbody><body name="arm"><joint axis="0 1 0"/><geom size="0.1" mass="1"/>
    <body name="hand" pos="0 0 1"><joint axis="0 1 0"/><geom size="0.1" mass="0.5"/></body>
  </body></worldbody>
</mujoco>"#;
    let heavier = Change::number("hand", Number::Mass, Amount::Add(1.0));
    let better = change(text, &[heavier]).unwrap().text;
    let compiler = "<compiler inertiafromgeom=\"auto\" settotalmass=\"4\"/>";
    assert!(better.contains(compiler), "{better}");
    // The hand has half of the mass now: as much as the arm, which keeps its geom.
    let hand = "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"0.002 0.002 0.002\"/>";
    assert!(better.contains(hand), "{better}");
}

#[test]
fn what_a_shortcut_cannot_say_is_said_by_a_general_actuator() {
    let bias = |actuator: &str| Change::number(actuator, Number::Bias, Amount::Add(0.3));
    let lag = |actuator: &str| Change::number(actuator, Number::Lag, Amount::To(0.02));
    replaces(
        &[bias("hip_servo"), lag("knee_motor"), bias("general_knee")],
        &[
            (
                "<position class=\"servo\" name=\"hip_servo\" joint=\"hip\"/>",
                "<general class=\"servo\" name=\"hip_servo\" joint=\"hip\" biastype=\"affine\" gainprm=\"50\" \
                 biasprm=\"0.3 -50 -2\"/>",
            ),
            (
                "<motor name=\"knee_motor\" joint=\"knee\" gear=\"9\" ctrlrange=\"-4 4\"/>",
                "<general name=\"knee_motor\" joint=\"knee\" gear=\"9\" ctrlrange=\"-4 4\" dyntype=\"filterexact\" \
                 dynprm=\"0.02\" gainprm=\"1\"/>",
            ),
            ("biasprm=\"0 -3 -0.2\"", "biasprm=\"0.3 -3 -0.2\""),
            // The new filter of the motor has its command as state.
            ("ctrl=\"7 8 9\"", "ctrl=\"7 8 9\""),
        ],
    );
    replaces(
        &[lag("hip_servo")],
        &[("joint=\"hip\"/>", "joint=\"hip\" timeconst=\"0.02\"/>")],
    );
}

#[test]
fn delays_are_whole_steps_where_these_are_near() {
    let delay = |seconds| Change::number("hip_servo", Number::Delay, Amount::To(seconds));
    for (seconds, written) in [
        (0.0201, "delay=\"0.02\" nsample=\"40\""),
        (0.0012, "delay=\"0.0012\" nsample=\"3\" interp=\"linear\""),
    ] {
        let after = format!("joint=\"hip\" {written}/>");
        replaces(&[delay(seconds)], &[("joint=\"hip\"/>", &after)]);
    }
    let limit = Change::ForceLimit {
        actuator: "hip_servo".to_owned(),
        range: [-8.0, 8.0],
    };
    let after = "joint=\"hip\" forcerange=\"-8 8\"/>";
    replaces(&[limit], &[("joint=\"hip\"/>", after)]);
}

#[test]
fn limits_of_forces_are_those_of_the_file_and_the_new_ones() {
    let limit = |range| Change::ForceLimit {
        actuator: "hip_servo".to_owned(),
        range,
    };
    let times = Change::number("hip_servo", Number::ForceRange, Amount::Times(0.5));
    for (change, range) in [
        (limit([-8.0, 30.0]), "-8 20"),
        (limit([-30.0, 5.0]), "-20 5"),
        (times, "-10 10"),
    ] {
        let after = format!("joint=\"hip\" forcerange=\"{range}\"/>");
        replaces(&[change], &[("joint=\"hip\"/>", &after)]);
    }
    replaces(&[limit([-25.0, 25.0])], &[]);
}

#[test]
fn what_actuators_add_to_a_joint_counts() {
    // 0.01 kg m² of the joint, and 3² · 0.004 of the motor.
    let geared = "gear=\"9\" ctrlrange=\"-4 4\"";
    let text = LEG
        .replace(
            "joint=\"knee\" gear=\"9\"",
            "joint=\"hip\" gear=\"3\" armature=\"0.004\"",
        )
        .replace(geared, "");
    let armature = |amount| joint("hip", Number::Armature, amount);
    let after = |amount| change(&text, &[armature(amount)]).unwrap().text;
    let more = text.replace("armature='0.01'", "armature='0.014'");
    assert_eq!(after(Amount::To(0.05)), more);
    let less = text
        .replace("armature='0.01'", "armature='0'")
        .replace("armature=\"0.004\"", "armature=\"0.002\"");
    assert_eq!(after(Amount::To(0.018)), less);
    // A larger gear leaves the inertia as it is.
    let gear = Change::number("knee_motor", Number::Gear, Amount::To(6.0));
    let geared = text.replace(
        "gear=\"3\" armature=\"0.004\"",
        "gear=\"6\" armature=\"0.001\"",
    );
    assert_eq!(change(&text, &[gear]).unwrap().text, geared);
}

#[test]
fn a_reading_moves_without_the_bounds_of_commands() {
    let text = LEG.replace("joint=\"hip\"/>", "joint=\"hip\" inheritrange=\"0.5\"/>");
    let reading = Change::number(
        "hip",
        Number::Reading,
        Amount::Add(std::f64::consts::PI / 180.0),
    );
    let expected = text
        .replace("range=\"-90 90\"", "range=\"-89 91\"")
        .replace("armature='0.01' />", "armature='0.01' ref=\"1\" />")
        .replace(
            " inheritrange=\"0.5\"/>",
            " ctrlrange=\"-0.785398163397 0.785398163397\"/>",
        );
    assert_eq!(change(&text, &[reading]).unwrap().text, expected);
}

#[test]
fn backlash_is_a_second_joint_with_its_state_in_keyframes() {
    let play = Change::number(
        "hip",
        Number::Play,
        Amount::Add(2.0 * std::f64::consts::PI / 180.0),
    );
    let hip = "armature='0.01' /> <!-- quick -->";
    let second = "armature='0.01' />\n      <joint name=\"hip_play\" range=\"-1 1\" solreflimit=\"0.002 1\" \
                  damping=\"0\"/> <!-- quick -->";
    replaces(
        &[play],
        &[
            (hip, second),
            ("qpos=\"0.1 0.2\"", "qpos=\"0.1 0 0.2\""),
            ("qvel=\"1 2\"", "qvel=\"1 0 2\""),
        ],
    );
}

#[test]
fn gravity_is_an_option() {
    let tilted = Change::Gravity([0.1, 0.0, -9.8]);
    let option = "<option timestep=\"0.0005\"";
    let with = "<option timestep=\"0.0005\" gravity=\"0.1 0 -9.8\"";
    replaces(std::slice::from_ref(&tilted), &[(option, with)]);
    let text = LEG.replace("  <option timestep=\"0.0005\"/>\n", "");
    let better = change(&text, &[tilted]).unwrap();
    let first = "<mujoco model=\"leg\">\n  <option gravity=\"0.1 0 -9.8\"/>\n";
    assert!(better.text.contains(first), "{}", better.text);
}

#[test]
fn remarks_are_comments_at_the_head() {
    let remarks = ["not in MJCF: sensor_scale@hip -- 0.02".to_owned()];
    let text = |file: &str| {
        corrected("leg.xml", file, &[], &remarks, &none)
            .unwrap()
            .text
    };
    let comment = "<!-- appell: not in MJCF: sensor_scale@hip - - 0.02 -->";
    let declared = "<?xml version=\"1.0\"?>";
    assert_eq!(
        text(LEG),
        LEG.replace(declared, &format!("{declared}\n{comment}"))
    );
    let bare = LEG.strip_prefix(declared).unwrap().trim_start();
    assert_eq!(text(bare), format!("{comment}\n{bare}"));
}

#[test]
fn what_cannot_be_changed_is_refused_with_its_place() {
    let mass = |body: &str| Change::number(body, Number::Mass, Amount::To(1.0));
    let refusal = |text: &str, change: Change| self::change(text, &[change]).unwrap_err();
    let unknown = refusal(LEG, mass("shanc"));
    assert!(unknown.contains("there is no body `shanc`"), "{unknown}");
    assert!(unknown.contains("shank"), "{unknown}");
    let kp = Change::number("knee_motor", Number::Kp, Amount::To(2.0));
    let gain = refusal(LEG, kp);
    assert!(gain.contains("`motor` `knee_motor` has no `kp`"), "{gain}");
    let other = refusal("<sdf/>", mass("b"));
    assert!(other.contains("neither MJCF nor URDF"), "{other}");
    let copies = LEG.replace(
        "<joint name=\"knee\"",
        "<replicate count=\"2\"><body name=\"toe\"><joint name=\"toe\"/><geom size=\"0.01\"/></body></replicate>\
         <joint name=\"knee\"",
    );
    let copy = joint("toe1", Number::Damping, Amount::To(1.0));
    let copy = refusal(&copies, copy);
    assert!(copy.contains("is a copy of `replicate`"), "{copy}");
}

#[test]
fn an_included_file_stays_and_its_includer_changes() {
    let shank = r#"<mujocoinclude><body name="shank" pos="0 0 -0.2"><joint name="knee" axis="0 1 0"/>
      <geom size="0.1"/></body></mujocoinclude>"#;
    let whole = r#"<mujoco><worldbody>
      <body name="thigh"><joint name="hip" axis="0 1 0"/><geom size="0.1"/><include file="shank.xml"/></body>
    </worldbody></mujoco>"#;
    let others = |path: &str| match path {
        "shank.xml" => Ok(shank.as_bytes().to_vec()),
        _ => Err("not here".to_owned()),
    };
    let damped = |name| joint(name, Number::Damping, Amount::To(0.5));
    let hip = corrected("leg.xml", whole, &[damped("hip")], &[], &others).unwrap();
    let expected = whole.replace("\"0 1 0\"/>", "\"0 1 0\" damping=\"0.5\"/>");
    assert_eq!(hip.text, expected);
    let Err(Failure::File(report)) = corrected("leg.xml", whole, &[damped("knee")], &[], &others)
    else {
        panic!("the knee is in another file");
    };
    let report = report.plain();
    assert!(
        report.contains("`joint` `knee` is in `shank.xml`"),
        "{report}"
    );
}

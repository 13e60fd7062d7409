//! What MJCF has that changes the motion, and joints made rigid. The values are those of `MuJoCo` 4.0.

use appell_robots::{Failure, Imported, Lock, Options, Without, import};

fn told(text: &str, options: &Options) -> Result<Imported, String> {
    import("robot.xml", text, options).map_err(|failure| match failure {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    })
}

fn read(text: &str) -> Imported {
    told(text, &Options::default()).unwrap()
}

/// A bar on a hinge with a spring and a damper.
fn bar(option: &str) -> String {
    format!(
        r#"<mujoco>{option}<worldbody><body name="bar" gravcomp="0.5">
  <joint name="h" axis="0 1 0" damping="0.5" stiffness="3" frictionloss="0.1" range="-90 90"/>
  <geom type="box" size="0.2 0.02 0.02" pos="0.2 0 0" mass="0.6"/></body></worldbody></mujoco>"#
    )
}

#[test]
fn flags_switch_forces_off() {
    let loads = [
        "weight ",
        "carried_bar",
        "damping_h",
        "spring_h",
        "friction_h",
        "range = ",
    ];
    for (flags, off) in [
        ("contact=\"enable\"", &[][..]),
        ("gravity=\"disable\"", &[0, 1]),
        ("spring=\"disable\"", &[3]),
        ("damper=\"disable\"", &[2]),
        ("spring=\"disable\" damper=\"disable\"", &[1, 2, 3]),
        ("frictionloss=\"disable\"", &[4]),
        ("limit=\"disable\"", &[5]),
        ("constraint=\"disable\"", &[4, 5]),
        ("spring=\"enable\" island=\"disable\"", &[]),
    ] {
        let spec = read(&bar(&format!("<option><flag {flags}/></option>"))).spec;
        for (index, load) in loads.iter().enumerate() {
            assert_eq!(
                spec.contains(load),
                !off.contains(&index),
                "{flags}: {load}\n{spec}"
            );
        }
    }
}

#[test]
fn what_changes_the_motion_is_listed_with_its_line() {
    let listed = |text: &str| -> Vec<(String, Vec<usize>)> {
        let all = read(text)
            .left_out
            .into_iter()
            .filter(|one| one.effect.is_some());
        all.map(|one| (one.what, one.lines)).collect()
    };
    for (option, what) in [
        (
            "<option density=\"1.2\" timestep=\"0.001\"/>",
            Some("option/density"),
        ),
        ("<option viscosity=\"1e-5\"/>", Some("option/viscosity")),
        ("<option wind=\"0 1 0\"/>", Some("option/wind")),
        ("<option wind=\"0 0 0\" density=\"0\"/>", None),
        ("<compiler alignfree=\"true\"/>", Some("compiler/alignfree")),
        ("<compiler alignfree=\"false\"/>", None),
    ] {
        let expected: Vec<_> = what
            .map(|what| (what.to_owned(), vec![1]))
            .into_iter()
            .collect();
        assert_eq!(listed(&bar(option)), expected, "{option}");
    }
    let tendon = |more: &str| {
        format!("<mujoco><worldbody><body><joint name=\"h\"/><geom size=\"0.1\" pos=\"1 0 0\"/><site name=\"s\"/></body></worldbody>
<tendon><spatial {more}><site site=\"s\"/></spatial></tendon></mujoco>")
    };
    assert_eq!(
        listed(&tendon("stiffness=\"3\"")),
        [("tendon/spatial".to_owned(), vec![2])]
    );
    assert_eq!(listed(&tendon("width=\"3\"")), []);
}

#[test]
fn what_is_no_mjcf_is_refused_with_a_remedy() {
    for (from, to, words) in [
        (
            "damping",
            "dampin",
            [
                "`joint` has no attribute `dampin`",
                "did you mean `damping`?",
            ],
        ),
        (
            "<geom",
            "<geon",
            ["`body` holds no element `geon`", "did you mean `geom`?"],
        ),
        (
            "<worldbody>",
            "<worldbody><attach prefix=\"a\"/>",
            ["`attach` changes the tree", "s.to_xml()"],
        ),
    ] {
        let wrong = told(&bar("").replace(from, to), &Options::default()).unwrap_err();
        for words in words {
            assert!(wrong.contains(words), "{wrong}");
        }
    }
}

#[test]
fn a_spring_with_a_time_constant_has_its_stiffness() {
    let text = bar("").replace("stiffness=\"3\"", "springdamper=\"0.1 1\"");
    let spec = read(&text).spec;
    for number in ["damping = \"0.6416 [N*m*s]\"", "stiffness = \"3.208"] {
        assert!(spec.contains(number), "{spec}");
    }
}

#[test]
fn a_locked_joint_has_no_coordinate_and_keeps_its_place() {
    let text = r#"<mujoco><worldbody><body name="a" pos="0 0 1"><joint name="h" axis="0 1 0" ref="90" pos="0 0 0.1"/>
  <geom size="0.1" pos="0.2 0 0"/><body name="b" pos="0.4 0 0"><joint name="k" axis="0 1 0"/><geom size="0.1" pos="0.2 0 0"/>
  <site name="s"/></body></body></worldbody>
  <tendon><fixed name="t" stiffness="2"><joint joint="h" coef="2"/><joint joint="k" coef="1"/></fixed></tendon></mujoco>"#;
    let locked = |locks: &[&str]| {
        let lock = locks
            .iter()
            .map(|lock| lock.parse::<Lock>().unwrap())
            .collect();
        told(
            text,
            &Options {
                lock,
                ..Options::default()
            },
        )
    };
    let robot = locked(&["h=0"]).unwrap();
    assert_eq!((robot.joints, robot.bodies), (1, 1));
    // Ninety degrees back about a point 0.1 m above the origin.
    assert!(
        robot.spec.contains("at = [\"0.1 [m]\", 0, \"1.5 [m]\"]"),
        "{}",
        robot.spec
    );
    // The tendon is relaxed at the springs' references, which are zero, and h is there.
    assert!(
        robot.spec.contains("force = \"-2 [N*m]*k\""),
        "{}",
        robot.spec
    );
    let as_drawn = locked(&["h"]).unwrap().spec;
    assert!(
        as_drawn.contains("at = [\"0.4 [m]\", 0, \"1 [m]\"]"),
        "{as_drawn}"
    );
    assert!(
        as_drawn.contains("force = \"-2 [N*m]*(k + pi)\""),
        "{as_drawn}"
    );
    for (locks, words) in [
        (&["g"][..], "there is no joint `g`"),
        (&["h", "h=1"], "locked twice"),
        (&["h", "k"], "no joint that moves"),
    ] {
        let wrong = locked(locks).unwrap_err();
        assert!(wrong.contains(words), "{wrong}");
    }
    assert!(
        "h=fast"
            .parse::<Lock>()
            .unwrap_err()
            .contains("`fast` is not a number")
    );
    assert!("=1".parse::<Lock>().unwrap_err().contains("JOINT=VALUE"));
}

#[test]
fn joints_that_follow_others_need_no_mass() {
    let text = r#"<robot name="hand"><link name="base"/>
  <link name="a"><inertial><origin xyz="0.1 0 0"/><mass value="1"/><inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="b"/>
  <joint name="j" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
  <joint name="k" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><mimic joint="j"/></joint></robot>"#;
    let robot = import("hand.urdf", text, &Options::default()).unwrap();
    assert_eq!(robot.joints, 2);
    let free = Options {
        without: vec![Without::Couplings],
        ..Options::default()
    };
    let Err(Failure::File(report)) = import("hand.urdf", text, &free) else {
        panic!("a joint without inertia");
    };
    assert!(
        report
            .plain()
            .contains("`b` moves by joint `k` but has no inertia"),
        "{}",
        report.plain()
    );
}

#[test]
fn copies_are_written_out_with_what_names_them() {
    let bodies = |inner: &str| {
        format!("<mujoco><worldbody>{inner}</worldbody>
<equality><joint name=\"held\" joint1=\"q\" polycoef=\"0.1\"/></equality><actuator><motor joint=\"q\" gear=\"2\" armature=\"0.1\"/></actuator></mujoco>")
    };
    let body = |name: &str, more: &str| {
        format!(
            "<body name=\"b{name}\"{more}><joint name=\"q{name}\" axis=\"0 1 0\"/><geom size=\"0.1\" pos=\"0 0 0.2\"/></body>"
        )
    };
    let robot = read(&bodies(&format!(
        "<replicate count=\"2\" sep=\"_\" offset=\"0.5 0 0\" euler=\"0 0 90\">{}</replicate>",
        body("", "")
    )));
    let by_hand = bodies(&(body("_0", "") + &body("_1", " pos=\"0.5 0 0\" euler=\"0 0 90\"")))
        .replace("<joint name=\"held\" joint1=\"q\" polycoef=\"0.1\"/>", "<joint name=\"held_0\" joint1=\"q_0\" polycoef=\"0.1\"/><joint name=\"held_1\" joint1=\"q_1\" polycoef=\"0.1\"/>")
        .replace("<motor joint=\"q\" gear=\"2\" armature=\"0.1\"/>", "<motor joint=\"q_0\" gear=\"2\" armature=\"0.1\"/><motor joint=\"q_1\" gear=\"2\" armature=\"0.1\"/>");
    assert_eq!(robot.spec, read(&by_hand).spec);
    // Copies of copies, the inner ending first.
    let inner = format!(
        "<replicate count=\"2\" sep=\"-\" offset=\"0 1 0\">\n{}</replicate>",
        body("", "")
    );
    let outer = format!(
        "<mujoco><worldbody><replicate count=\"11\" offset=\"1 0 0\">{inner}</replicate></worldbody></mujoco>"
    );
    let robot = read(&outer);
    assert_eq!(robot.joints, 22);
    assert!(robot.spec.contains("\nq_110 "), "{}", robot.spec);
    assert!(
        robot
            .left_out
            .iter()
            .all(|one| one.lines.iter().all(|line| *line == 2)),
        "{:?}",
        robot.left_out
    );
    for (attributes, words) in [
        ("", "between 1 and 65536"),
        ("count=\"1e9\"", "between 1 and 65536"),
        ("count=\"65536\"", "copies make the file larger"),
        ("count=\"2\" euler=\"0 0\"", "`euler` has 2 of 3 numbers"),
    ] {
        let text = format!(
            "<mujoco><worldbody><replicate {attributes}>{}</replicate></worldbody></mujoco>",
            body("", "").repeat(3)
        );
        let wrong = told(&text, &Options::default()).unwrap_err();
        assert!(wrong.contains(words) && wrong.contains("1:"), "{wrong}");
    }
}

//! `appell import`: its files, what it says, and its failures.

use crate::support::Folder;

#[test]
fn an_imported_arm_goes_through_the_other_commands() {
    let folder = Folder::new();
    folder.done(&["sample", "robot", "robot"]);
    let told = folder.done(&["import", "robot/arm.urdf"]);
    assert!(
        told.stdout.contains("wrote arm.toml: 4 bodies, 4 joints"),
        "{}",
        told.stdout
    );
    assert!(
        told.stderr.contains("transmission: line"),
        "{}",
        told.stderr
    );
    folder.done(&["check", "arm.toml"]);
    folder.done(&["draw", "arm.toml"]);
    let free = [
        "import",
        "robot/arm.urdf",
        "-o",
        "free.toml",
        "--without",
        "limits",
    ];
    folder.done(&free);
    let simulated = [
        "simulate",
        "free.toml",
        "--t-end-s",
        "0.2",
        "--csv",
        "arm.csv",
    ];
    folder.done(&simulated);
    assert!(folder.read("arm.csv").contains("z_of_gripper"));
    // The same file again is no reason to ask; another one is.
    folder.done(&["import", "robot/arm.urdf"]);
    folder.fails(
        2,
        &["import", "robot/arm.urdf", "--parameters", "all"],
        &["arm.toml", "-o"],
    );
}

#[test]
fn numbers_become_letters_by_name() {
    let folder = Folder::new();
    folder.done(&["sample", "robot", "robot"]);
    let told = folder.done(&[
        "import",
        "robot/arm.xml",
        "-o",
        "-",
        "--parameters",
        "m_turret,elbow",
    ]);
    for line in ["m_turret ", "stiffness_elbow ", "damping_elbow "] {
        assert!(
            told.stdout.contains(&format!("\n{line}")),
            "{line}: {}",
            told.stdout
        );
    }
    assert!(!told.stdout.contains("m_slide"), "{}", told.stdout);
    let says = "wrote the spec to standard output:";
    assert!(
        told.stderr.contains(says) && !told.stderr.contains("check -"),
        "{}",
        told.stderr
    );
    let wrong = [
        "import",
        "robot/arm.xml",
        "-o",
        "-",
        "--parameters",
        "m_turet",
    ];
    folder.fails(2, &wrong, &["--parameters", "did you mean `m_turret`"]);
}

#[test]
fn a_file_that_is_wrong_is_told_where() {
    let folder = Folder::new();
    let bad = "<robot name=\"r\">\n  <link name=\"a\"/>\n  <joint name=\"j\" type=\"sliding\"/>\n</robot>";
    folder.write("bad.urdf", bad);
    folder.fails(
        3,
        &["import", "bad.urdf"],
        &["bad.urdf:3:25", "sliding", "bad.urdf:3:3"],
    );
    folder.fails(3, &["import", "absent.urdf"], &["absent.urdf"]);
    folder.fails(2, &["import", "bad.urdf", "-o", "bad.svg"], &["bad.toml"]);
    folder.fails(
        2,
        &["import", "bad.urdf", "--without", "dampng"],
        &["did you mean `damping`"],
    );
}

#[test]
fn the_robot_files_of_a_folder_are_listed() {
    let folder = Folder::new();
    folder.done(&["sample", "robot", "robot"]);
    for within in ["robot/deeper", "none"] {
        std::fs::create_dir(folder.path(within)).expect("a folder");
    }
    folder.write("robot/deeper/bad.urdf", "<robot><link/></robot>");
    folder.write("robot/deeper/empty.urdf", "");
    folder.write("robot/deeper/other.xml", "<svg/>");
    folder.write("robot/deeper/part.xml", "<mujocoinclude/>");
    folder.write(
        "robot/deeper/scene.xml",
        "<mujoco model=\"scene\"><include file=\"../arm.xml\"/></mujoco>",
    );
    let told = folder.done(&["list", "--robots", "robot", "--json", "robots.json"]);
    let list = folder.json("robots.json");
    let robots = list["robots"].as_array().expect("a list");
    let told_of = |robot: &serde_json::Value| {
        let file = robot["file"].as_str().expect("a file").to_owned();
        let joints = robot["joints"].as_u64();
        (file, joints)
    };
    let listed: Vec<_> = robots.iter().map(told_of).collect();
    let expected = [
        ("robot/arm.urdf", Some(4)),
        ("robot/arm.xml", Some(4)),
        ("robot/deeper/bad.urdf", None),
        ("robot/deeper/empty.urdf", None),
        ("robot/deeper/scene.xml", Some(4)),
    ];
    let expected = expected.map(|(file, joints)| (file.to_owned(), joints));
    assert_eq!(listed, expected);
    assert_eq!(robots[2]["findings"][0]["line"], 1);
    let line = |file: &str| {
        let mut lines = told.stdout.lines();
        lines
            .find(|line| line.contains(file))
            .unwrap_or_default()
            .to_owned()
    };
    assert!(line("deeper/bad.urdf").contains("a `link` without a name"));
    assert!(line("deeper/scene.xml").contains("MJCF"));
    folder.fails(3, &["list", "--robots", "absent"], &["absent"]);
    folder.write("none/readme.txt", "");
    folder.fails(3, &["list", "--robots", "none"], &["`.urdf`"]);
}

#[test]
fn nearly_right_angles_are_right_if_asked_for() {
    let folder = Folder::new();
    folder.done(&["sample", "robot", "robot"]);
    let rough = folder
        .read("robot/arm.urdf")
        .replace("1.5707963267948966", "1.5708");
    folder.write("rough.urdf", &rough);
    let told = folder.done(&["import", "rough.urdf", "-o", "rough.toml"]);
    assert!(told.stderr.contains("`--snap`"), "{}", told.stderr);
    assert!(folder.read("rough.toml").contains("by = 1.5708"));
    let told = folder.done(&["import", "rough.urdf", "-o", "rough.toml", "--snap"]);
    assert!(!told.stderr.contains("--snap"), "{}", told.stderr);
    assert!(folder.read("rough.toml").contains("pi/2"));
}

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
    let bad =
        "<robot name=\"r\">\n  <link name=\"a\"/>\n  <joint name=\"j\" type=\"planar\"/>\n</robot>";
    folder.write("bad.urdf", bad);
    folder.fails(
        3,
        &["import", "bad.urdf"],
        &["bad.urdf:3:25", "planar", "bad.urdf:3:3"],
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

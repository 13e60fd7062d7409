//! MJCF files that include others.

use std::path::Path;

use appell_robots::{Failure, Imported, Options, import, import_with};

/// A file of the folder beside.
fn beside(name: &str) -> Option<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/included");
    std::fs::read(folder.join(name)).ok()
}

fn scene() -> String {
    String::from_utf8(beside("scene.xml").unwrap()).unwrap()
}

/// A robot whose other files are as given, or as in the folder.
fn with(text: &str, others: &[(&str, &str)]) -> Result<Imported, String> {
    let read = |name: &str| {
        let given = others.iter().find(|(own, _)| *own == name);
        let found = given.map_or_else(|| beside(name), |(_, text)| Some(text.as_bytes().to_vec()));
        found.ok_or_else(|| "it does not exist".to_owned())
    };
    import_with("scene.xml", text, &Options::default(), &read).map_err(|failure| match failure {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    })
}

/// The spec without its first lines, which name the file.
fn below_head(robot: &Imported) -> &str {
    robot.spec.split_once("\n[").unwrap().1
}

#[test]
fn an_included_file_stands_where_it_is_included() {
    let arm = String::from_utf8(beside("parts/arm.xml").unwrap()).unwrap();
    let wrist = String::from_utf8(beside("parts/wrist.xml").unwrap()).unwrap();
    let within = |text: &str, tag: &str| {
        let (_, inside) = text.split_once(&format!("<{tag}")).unwrap();
        let (_, inside) = inside.split_once('>').unwrap();
        let (inside, _) = inside.rsplit_once("</").unwrap();
        inside.to_owned()
    };
    let by_hand = scene()
        .replace(
            "<include file=\"parts/arm.xml\"/>",
            &within(&arm, "mujoco model"),
        )
        .replace(
            "<include file=\"parts/wrist.xml\"/>",
            &within(&wrist, "mujocoinclude"),
        );
    let whole = import("scene.xml", &by_hand, &Options::default()).unwrap();
    let included = with(&scene(), &[]).unwrap();
    assert_eq!(below_head(&included), below_head(&whole));
    assert_eq!(included.joints, 2);
}

#[test]
fn a_path_may_begin_at_the_file_that_names_it() {
    let nested = r#"<mujoco><include file="hand.xml"/></mujoco>"#;
    let hand = r#"<mujoco><worldbody><body name="hand"><joint axis="0 1 0"/><geom size="0.1"/></body></worldbody></mujoco>"#;
    let joints = |at: &str| {
        let others = [("parts/arm.xml", nested), (at, hand)];
        let first = r#"<mujoco><include file="parts/arm.xml"/></mujoco>"#;
        with(first, &others).unwrap().joints
    };
    // As MuJoCo 4.0 finds them.
    assert_eq!(joints("parts/hand.xml"), 1);
    assert_eq!(joints("hand.xml"), 1);
}

#[test]
fn what_is_left_out_is_told_with_its_file() {
    let robot = with(&scene(), &[]).unwrap();
    let told: Vec<_> = (robot.left_out.iter())
        .map(|one| (&*one.what, &*one.file, &*one.lines))
        .collect();
    assert_eq!(
        told,
        [
            ("contacts of geoms", "scene.xml", &[5][..]),
            ("contacts of geoms", "parts/wrist.xml", &[2][..]),
            ("light", "parts/arm.xml", &[7][..]),
            ("light", "scene.xml", &[4][..]),
        ]
    );
}

#[test]
fn a_warning_names_its_file() {
    let heavy = r#"<mujocoinclude>
  <body name="wrist"><joint axis="0 1 0"/>
    <inertial pos="0 0 0" mass="1" diaginertia="1 1 9"/></body>
</mujocoinclude>"#;
    let robot = with(&scene(), &[("parts/wrist.xml", heavy)]).unwrap();
    let files: Vec<_> = robot
        .warnings
        .iter()
        .map(appell_spec::Report::file)
        .collect();
    assert_eq!(files, ["parts/wrist.xml"]);
    let told = robot.warnings[0].plain();
    assert!(told.contains("parts/wrist.xml:3:5"), "{told}");
}

#[test]
fn errors_name_the_file_and_the_remedy() {
    let part = |wrist: &str| with(&scene(), &[("parts/wrist.xml", wrist)]).unwrap_err();
    for (told, words) in [
        (
            part("<mujocoinclude>\n<body name=\"w\"><joint range=\"a b\"/></body></mujocoinclude>"),
            ["parts/wrist.xml:2:30", "`a` is not a number"],
        ),
        (
            part("<mujocoinclude><body></mujocoinclude>"),
            ["parts/wrist.xml:1:", "</body>"],
        ),
        (
            part("<mujocoinclude><include file=\"scene.xml\"/></mujocoinclude>"),
            ["parts/wrist.xml:1:31", "`scene.xml` is included twice"],
        ),
        (
            part("<m><include file=\"parts/arm.xml\"/></m>"),
            ["parts/wrist.xml:1:19", "`parts/arm.xml` is included twice"],
        ),
        (
            with(&scene().replace("arm.xml", "leg.xml"), &[]).unwrap_err(),
            ["scene.xml:2:18", "`parts/leg.xml` cannot be read"],
        ),
        (
            with("<mujoco><include/></mujoco>", &[]).unwrap_err(),
            ["scene.xml:1:9", "write `<include file=\"…\"/>`"],
        ),
    ] {
        for words in words {
            assert!(told.contains(words), "{told}");
        }
    }
}

#[test]
fn files_that_never_end_are_refused() {
    let next = |name: &str| {
        let next = format!("<mujoco><include file=\"{name}+\"/></mujoco>");
        Ok(next.into_bytes())
    };
    let first = "<mujoco><include file=\"a\"/></mujoco>";
    let Err(Failure::File(report)) = import_with("a.xml", first, &Options::default(), &next) else {
        panic!("an endless file was read");
    };
    assert!(report.plain().contains("more than 16 deep"), "{report}");
    let large = |_: &str| {
        let text = format!("<mujoco><!--{}--></mujoco>", " ".repeat(1 << 24));
        Ok(text.into_bytes())
    };
    let Err(Failure::File(report)) = import_with("a.xml", first, &Options::default(), &large)
    else {
        panic!("a file beyond the limit was read");
    };
    assert!(report.plain().contains("MiB together"), "{report}");
}

#[test]
fn an_include_within_another_is_nothing() {
    let nested = scene().replace(
        "<include file=\"parts/arm.xml\"/>",
        "<include file=\"parts/arm.xml\"><include file=\"parts/wrist.xml\"/></include>",
    );
    assert_eq!(with(&nested, &[]).unwrap().joints, 2);
}

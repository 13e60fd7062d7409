//! What masses of MJCF are made of. The values are those of `MuJoCo` 4.0.

use appell_robots::{Failure, Imported, Options, import};

fn told(text: &str) -> Result<Imported, String> {
    import("robot.xml", text, &Options::default()).map_err(|failure| match failure {
        Failure::File(report) => report.plain(),
        Failure::Unknown { name, .. } | Failure::Lock(name) => name,
    })
}

/// A body on a hinge, and what it holds.
fn hinged(before: &str, held: &str) -> String {
    format!(
        r#"<mujoco><compiler angle="radian"/>{before}<worldbody>
  <body name="z"><joint name="zj" axis="0 1 0"/>{held}</body></worldbody></mujoco>"#
    )
}

/// The line of a spec about the body `z`, or the point of its centre of mass.
fn lines(text: &str) -> String {
    let spec = told(text).unwrap().spec;
    let of_body = |line: &&str| line.starts_with("z = {") && line.contains("mass");
    let lines = spec
        .lines()
        .filter(|line| of_body(line) || line.starts_with("G_z"));
    lines.collect::<Vec<_>>().join("\n")
}

const INERTIAL: &str = r#"<inertial pos="0.1 0.2 0.3" mass="2" diaginertia="0.1 0.11 0.13"/>"#;
const OTHER: &str = r#"<inertial mass="3" diaginertia="0.1 0.1 0.1"/>"#;
const CLASSES: &str = r#"<default><default class="c"><geom mass="2"/><joint axis="0 0 1"/></default>
  <default class="d"><geom mass="5"/></default></default>"#;

#[test]
fn an_inertial_in_a_frame_is_that_of_the_body() {
    let in_frame = hinged(
        "",
        &format!(r#"<geom size="0.1"/><frame euler="1 0 0" pos="0.2 0 0">{INERTIAL}</frame>"#),
    );
    let told = lines(&in_frame);
    for number in [
        "mass = \"2 [kg]\"",
        "\"0.3 [m]\", \"-0.144380",
        "\"0.330384",
    ] {
        assert!(told.contains(number), "{number}: {told}");
    }
    // The last one of the file holds, wherever it stands.
    let frame = format!("<frame><frame>{OTHER}</frame></frame>");
    for held in [
        format!("{INERTIAL}{frame}"),
        format!("<frame>{INERTIAL}</frame>{OTHER}"),
    ] {
        assert!(lines(&hinged("", &held)).contains("mass = \"3 [kg]\""));
    }
    assert!(
        lines(&hinged("", &format!("{OTHER}<frame>{INERTIAL}</frame>")))
            .contains("mass = \"2 [kg]\"")
    );
}

#[test]
fn frames_and_copies_hand_their_class_down() {
    for (held, mass) in [
        (
            r#"<frame childclass="c"><frame><geom size="0.1"/></frame></frame>"#,
            2.0,
        ),
        (
            r#"<frame childclass="c"><frame childclass="d"><geom size="0.1"/></frame><geom size="0.1"/></frame>"#,
            7.0,
        ),
        (
            r#"<replicate count="3" childclass="c"><geom size="0.1"/></replicate>"#,
            6.0,
        ),
        (
            r#"<frame childclass="d"><replicate count="2"><geom size="0.1"/></replicate></frame>"#,
            10.0,
        ),
    ] {
        let told = lines(&hinged(CLASSES, held));
        assert!(
            told.contains(&format!("mass = \"{mass} [kg]\"")),
            "{held}: {told}"
        );
    }
    let body = hinged(
        CLASSES,
        r#"<geom size="0.1"/><frame childclass="c"><body><joint name="k"/><geom size="0.1" pos="1 0 0"/></body></frame>"#,
    );
    let spec = told(&body).unwrap().spec;
    assert!(spec.contains("about_axis = \"z\", by = \"k\""), "{spec}");
}

#[test]
fn the_world_holds_no_joint() {
    let text = hinged("", OTHER).replace("</worldbody>", "<frame><joint/></frame></worldbody>");
    let wrong = told(&text).unwrap_err();
    assert!(wrong.contains("the world holds a `joint`"), "{wrong}");
}

#[test]
fn a_field_of_heights_has_the_mass_of_its_box() {
    let field = |size: &str, geom: &str| {
        let asset = format!(
            r#"<asset><hfield name="h" nrow="2" ncol="3" size="{size}" elevation="0 1 2 0.5 1 3"/></asset>"#
        );
        hinged(
            &asset,
            &format!(r#"<geom type="hfield" hfield="h" {geom}/>"#),
        )
    };
    let told = lines(&field("0.1 0.2 0.3 0.4", ""));
    for number in ["mass = \"44 [kg]\"", "1.6958333", "1.2558333", "0.7333333"] {
        assert!(told.contains(number), "{number}: {told}");
    }
    let told = lines(&field("0.1 0.2 0.3 0.4", "mass=\"2\" pos=\"1 2 3\""));
    for number in [
        "mass = \"2 [kg]\"",
        "\"1 [m]\", \"2 [m]\", \"3 [m]\"",
        "0.0770833",
    ] {
        assert!(told.contains(number), "{number}: {told}");
    }
    let wrong = told_wrong(&field("0.1 0.2", ""));
    assert!(
        wrong.contains("a size, half lengths, height and base,"),
        "{wrong}"
    );
    let wrong = told_wrong(&field("1 1 1 1", "").replace("hfield=\"h\"", "hfield=\"g\""));
    assert!(wrong.contains("there is no `hfield` `g`"), "{wrong}");
}

fn told_wrong(text: &str) -> String {
    told(text).unwrap_err()
}

#[test]
fn a_mass_that_is_not_computed_is_refused_where_it_moves() {
    let kinds = [
        r#"type="hfield" hfield="h" shellinertia="true""#,
        r#"type="box" size="1 1 1" shellinertia="true""#,
        r#"type="plane" size="1 1 1" mass="2""#,
        r#"type="sdf" mesh="m" mass="2""#,
        r#"type="box" mesh="m" mass="2""#,
        r#"type="mesh" mesh="m" mass="2""#,
    ];
    let assets = r#"<asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/><mesh name="m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>"#;
    for kind in kinds {
        let geom = format!("<geom {kind}/>");
        for held in [
            geom.clone(),
            format!("<geom size=\"0.1\"/><body>{geom}</body>"),
        ] {
            let wrong = told_wrong(&hinged(assets, &held));
            assert!(
                wrong.contains("the mass of a geom is not known"),
                "{kind}: {wrong}"
            );
        }
        // What stands on the ground needs none, wherever in the file it is.
        let still = hinged(assets, OTHER).replace(
            "</worldbody>",
            &format!("<body name=\"still\">{geom}</body></worldbody>"),
        );
        told(&still).unwrap();
    }
}

//! What a finding says to write instead.

use appell_spec::{Report, load};

const SPEC: &str = r#"
[mechanism]
name  = "rod"
title = "A rod on a slider"
[parameters]
m = { value = 2, unit = "kg" }
l = { value = 0.5, unit = "m" }
g = { value = 9.81, unit = "m/s^2" }
[coordinates]
x     = { unit = "m" }
delta = { unit = "rad", range = [-1, 1] }
[frames]
arm = { parent = "ground", about_axis = "-y", by = "delta" }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0] }
B = { from = "P", in = "arm", at = [0, 0, "-l"] }
[bodies]
rod = { frame = "arm", centre = "B", mass = "m", inertia = { in = "arm", diagonal = ["m*l^2", "m*l^2", "m*l^2"] } }
[constraints]
along = { kind = "position", zero = "x - l*sin(delta)" }
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
[outputs]
out = { value = "l*cos(delta)", unit = "m" }
held = { value = "reaction(along)", unit = "N" }
"#;

/// What is told of the spec with one text in place of another.
fn told(from: &str, to: &str) -> String {
    assert!(SPEC.contains(from), "{from}");
    let text = SPEC.replace(from, to);
    match load("rod.toml", &text) {
        Ok(checked) => Report::new("rod.toml", text, checked.warnings).plain(),
        Err(report) => report.plain(),
    }
}

#[test]
fn a_finding_says_what_to_write() {
    const OUTPUT: &str = "l*cos(delta)";
    for (from, to, says) in [
        (OUTPUT, "l*delta_dot", "help: write `dot(delta)`"),
        (OUTPUT, "l*stranger", "input, signal or definition"),
        (OUTPUT, "l*sin delta", "help: write `sin(delta)`"),
        (OUTPUT, "l*cos 2", "help: write `cos(2)`"),
        (OUTPUT, "l*0,2", "help: write the decimal point, `0.2`"),
        (OUTPUT, "l*(1 deg)", "`1 [deg]`"),
        (OUTPUT, "l*(2 delta)", "a product is written with `*`"),
        (OUTPUT, "dot(v)", "`acceleration(P, x)`"),
        (OUTPUT, "ddot(x)", "`acceleration(P, x)`"),
        (OUTPUT, "dot(dot(x))", "`acceleration(P, x)`"),
        (OUTPUT, "x_ddot", "`acceleration(P, x)`"),
        (OUTPUT, "l*np.sin(delta)", "write `sin` without `np.`"),
        (OUTPUT, "l*math.log(2)", "write `ln` without `math.`"),
        (
            OUTPUT,
            "l*np.arctan2(delta, 1)",
            "write `atan2` without `np.`",
        ),
        ("\"kg\"", "\"kgm2\"", "did you mean `kg*m^2`?"),
        ("\"kg\"", "\"Nms\"", "did you mean `N*m*s`?"),
        (
            "kind = \"gravity\", down",
            "kind = \"friction\", down",
            "weight = { kind = \"generalized\", coordinate = \"q\", force = \"-F*smooth_sign(dot(q), 0.01 [rad/s])\" }",
        ),
        (
            "kind = \"gravity\", down",
            "kind = \"motor\", down",
            "force = \"tau\"",
        ),
        ("\"m/s^2\"", "\"m/s2\"", "as in `m/s^2`"),
        (
            "x - l*sin(delta)",
            "velocity(B, x) - x",
            "cannot depend on the motion `velocity(B, x)`",
        ),
        (
            "x - l*sin(delta)",
            "velocity(B, x) - x",
            "help: write the coordinates that the motion depends on",
        ),
    ] {
        let told = told(from, to);
        assert!(told.contains(says), "{to}: {says} in\n{told}");
    }
}

#[test]
fn nothing_follows_from_a_constraint_that_cannot_be_read() {
    for zero in [
        "velocity(B, x) - x",
        "x - l*sni(delta)",
        "x - l*stranger",
        "x + l^2",
    ] {
        let told = told("x - l*sin(delta)", zero);
        assert_eq!(told.matches("error[").count(), 1, "{zero}:\n{told}");
    }
}

#[test]
fn degrees_read_as_radians_are_doubted() {
    for (from, to, doubted) in [
        ("by = \"delta\"", "by = \"delta + 180\"", true),
        ("by = \"delta\"", "by = \"-(90 - delta)\"", true),
        ("by = \"delta\"", "by = \"delta + 180 [deg]\"", false),
        ("by = \"delta\"", "by = \"10*delta\"", false),
        ("cos(delta)", "sin(45)", true),
        ("cos(delta)", "cos(delta - 30)", true),
        ("cos(delta)", "cos(pi/2 - 20*delta)", false),
        ("cos(delta)", "exp(-30)", false),
        ("[-1, 1]", "[-60, 60]", true),
        ("[-1, 1]", "[-6.28, 6.28]", false),
        (
            "\"rad\", range = [-1, 1]",
            "\"deg\", range = [-60, 60]",
            false,
        ),
    ] {
        let told = told(from, to);
        assert_eq!(told.contains("doubtful-unit"), doubted, "{to}:\n{told}");
    }
}

#[test]
fn a_reserved_name_is_told_once() {
    for name in ["t", "pi", "sin", "dot"] {
        let text = SPEC
            .replace("\"x\"", &format!("\"{name}\""))
            .replace("dot(x)", &format!("dot({name})"));
        let text = text
            .replace("x     =", &format!("{name} ="))
            .replace("x - l", &format!("{name} - l"));
        let report = load("rod.toml", &text)
            .expect_err("a reserved name")
            .plain();
        assert_eq!(report.matches("error[").count(), 1, "{report}");
        assert!(report.contains("error[reserved-name]"), "{report}");
    }
}

#[test]
fn a_body_in_a_plane_needs_one_moment_of_inertia() {
    let full = "inertia = { in = \"arm\", diagonal = [\"m*l^2\", \"m*l^2\", \"m*l^2\"] }";
    assert_eq!(told(full, "inertia = \"m*l^2\""), "");
    assert_eq!(told(full, "inertia = \"2 [g*cm^2]\""), "");
    let help = "write `inertia = { in = \"FRAME\", diagonal = [\"I_x\", \"I_y\", \"I_z\"] }`";
    let in_space = SPEC.replace(full, "inertia = \"m*l^2\"").replace(
        "arm = { parent = \"ground\", about_axis = \"-y\", by = \"delta\" }",
        "arm = { parent = \"ground\", turns = [{ about_axis = \"z\", by = \"x/l\" }, { about_axis = \"y\", by = \"delta\" }] }",
    );
    let report = load("rod.toml", &in_space)
        .expect_err("three moments are missing")
        .plain();
    assert!(report.contains(help), "{report}");
    let mismatch = told(full, "inertia = \"m*l\"");
    assert!(mismatch.contains("unit-mismatch"), "{mismatch}");
    let unframed = SPEC
        .replace("frame = \"arm\", ", "")
        .replace(full, "inertia = \"m*l^2\"");
    let report = load("rod.toml", &unframed)
        .expect_err("a frame is missing")
        .plain();
    assert!(report.contains("body-without-frame"), "{report}");
}

#[test]
fn an_output_is_an_expression_alone() {
    let mechanism = |text: &str| load("rod.toml", text).expect("a valid spec").mechanism;
    let bare = SPEC.replace(
        "{ value = \"l*cos(delta)\", unit = \"m\" }",
        "\"l*cos(delta)\"",
    );
    assert_ne!(bare, SPEC);
    let (bare, full) = (mechanism(&bare), mechanism(SPEC));
    let unit = |mechanism: &appell_spec::Mechanism| {
        mechanism
            .outputs
            .iter()
            .map(|output| output.label.unit.text.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(unit(&bare), unit(&full));
}

#[test]
fn a_body_without_mass_may_have_a_share_of_an_inertia() {
    const BODY: &str =
        "mass = \"m\", inertia = { in = \"arm\", diagonal = [\"m*l^2\", \"m*l^2\", \"m*l^2\"] }";
    for (body, says) in [
        (
            "mass = 0, inertia = { in = \"arm\", diagonal = [0, \"m*l^2\", 0] }",
            false,
        ),
        (
            "mass = \"0*m\", inertia = { in = \"arm\", diagonal = [\"3*m*l^2\", \"m*l^2\", 0] }",
            false,
        ),
        (
            "mass = \"m\", inertia = { in = \"arm\", diagonal = [0, \"m*l^2\", 0] }",
            true,
        ),
        (
            "mass = 0, inertia = { in = \"arm\", diagonal = [\"m*l^2\", \"-m*l^2\", \"m*l^2\"] }",
            true,
        ),
        (
            "mass = 0, inertia = { in = \"arm\", moments = [\"m*l^2\", \"m*l^2\", 0], products = [0, \"m*l^2\", 0] }",
            true,
        ),
    ] {
        let told = told(BODY, body);
        assert_eq!(told.contains("not-physical"), says, "{body}: {told}");
    }
}

#[test]
fn milliseconds_in_the_place_of_metres_are_told() {
    let told = told("acceleration = \"g\"", "acceleration = \"9.81 [ms^-2]\"");
    assert!(
        told.contains("`ms^-2` has milliseconds in it; write `m/s^2`"),
        "{told}"
    );
}

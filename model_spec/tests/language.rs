//! What the language can say, and that one mistake gives one message.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]
#![expect(clippy::float_cmp, reason = "values are rounded once from the text")]

use appell_spec::expr::{ExprKind, Quantity};
use appell_spec::mechanism::{
    Axis, BodyId, Connection, ConstraintId, ConstraintKind, CoordinateId, FrameId, InputId,
    Interpolation, LoadId, LoadKind, Mechanism, OutputId, ParameterId, PointId, SignalId, SpeedId,
};
use appell_spec::{Code, load};

/// Everything that the language has, at least once.
const RICH: &str = r#"
[outputs]
reach = { value = "hypot(x, y) + stroke", unit = "mm", about = "items may stand in any order" }
bare  = { value = "dot(theta)*I" }

[points]
late  = { from = "early", in = "two", at = ["a*sin(theta)", "0", 0] }
early = { from = "O", in = "ground", at = ["x", "y", "stroke"] }

[frames]
two = { parent = "one", turns = [{ about_axis = "-z", by = "theta/2" }, { about_axis = "x", by = "10 [deg]*t/(1 [s])" }] }
one = { parent = "ground", about_axis = "y", by = "theta", about = "first" }

[mechanism]
name = "rich"
title = "Everything at once"

[parameters]
a   = { value = 250, unit = "mm", at_least = 100, at_most = 300 }
m   = { value = 1500, unit = "g" }
I   = { value = 0.5, unit = "kg*m^2" }
k   = { value = 2, unit = "N/mm" }
k_t = { value = 3, unit = "N*m/rad" }
c   = { value = 4, unit = "N s/m" }
g   = { value = 9.81, unit = "m/s^2" }

[coordinates]
x     = { unit = "m", initial = 0.5 }
y     = { unit = "cm" }
theta = { unit = "deg", range = [-90, 90] }

[inputs]
F = { unit = "kN" }

[signals]
stroke = { t = [0, 1.5, 3], value = [0, 10, 0], unit = "mm", interpolation = "cubic" }
belt   = { t = [0, 1], value = [0, 36], unit = "km/h" }
gate   = { t = [0], value = [1], unit = "1", interpolation = "hold" }

[bodies.frame_and_name_may_agree]
frame = "two"
centre = "late"
mass = "m"
inertia = { in = "two", moments = ["I", "I", "2*I"], products = ["-I/10", 0, 0] }

[bodies]
tensor = { frame = "one", centre = "early", mass = "2*m", inertia = { in = "one", matrix = [["I", "I/9", 0], ["I/9", "I", 0], [0, 0, "I"]] } }
mote   = { centre = "early", mass = "5 [g]" }

[constraints]
roll  = { kind = "rolling", body = "tensor", contact = "late" }
row   = { kind = "velocity", zero = "cos(theta)*dot(x) - a*dot(theta)", equals = "belt" }
blade = { kind = "fixed_velocity", point = "late", body = "tensor", in = "two", direction = [0, 1, "sin(theta)"], equals = "0.1 [m/s]" }

[pseudo_velocities]
omega = "dot(theta)"
v     = { value = "dot(x)*cos(theta) + dot(y)*sin(theta)", unit = "km/h", initial = 36 }
p     = "m*dot(x)"

[loads]
weight = { kind = "gravity", down = "-y", acceleration = "g" }
pull   = { kind = "force", on = "late", body = "tensor", reaction_on = "early", in = "two", vector = ["F*gate", 0, "-c*v"] }
twist  = { kind = "torque", on = "tensor", reaction_on = "frame_and_name_may_agree", in = "one", vector = [0, 0, "k_t*theta"] }
coil   = { kind = "spring", between = ["late", "O"], stiffness = "k", relaxed = "a" }
helix  = { kind = "spring", coordinate = "theta", stiffness = "k_t", relaxed = "5 [deg]" }
oil    = { kind = "damper", between = ["early", "O"], damping = "c*(1 + smooth_abs(F, 1 [N])/(1 [kN]))" }
brake  = { kind = "damper", coordinate = "theta", damping = "c*a^2" }
drag   = { kind = "generalized", coordinate = "x", force = "-c*smooth_sign(dot(x), 1 [mm/s])*abs(v)" }

[initial]
y = 20
omega = 90
"#;

fn rich() -> Mechanism {
    load("rich.toml", RICH)
        .unwrap_or_else(|report| panic!("{report}"))
        .mechanism
}

#[test]
fn values_are_in_si_and_labels_in_the_units_of_the_text() {
    let mechanism = rich();
    let a = &mechanism.parameters[ParameterId::new(0)];
    assert_eq!(
        (a.value, a.at_least, a.at_most),
        (0.25, Some(0.1), Some(0.3))
    );
    assert_eq!(a.label.unit.text, "mm");
    assert_eq!(mechanism.parameters[ParameterId::new(3)].value, 2000.0);
    let initial: Vec<f64> = mechanism.coordinates.iter().map(|c| c.initial).collect();
    assert_eq!(initial, [0.5, 0.2, 0.0]);
    let quarter = std::f64::consts::FRAC_PI_2;
    assert_eq!(
        mechanism.coordinates[CoordinateId::new(2)].range,
        Some([-quarter, quarter])
    );
    assert_eq!(mechanism.pseudo_velocities[SpeedId::new(1)].initial, 10.0);
    assert_eq!(mechanism.pseudo_velocities[SpeedId::new(0)].initial, 90.0);
    let stroke = &mechanism.signals[SignalId::new(0)];
    assert_eq!(stroke.times, [0.0, 1.5, 3.0]);
    assert_eq!(stroke.values, [0.0, 0.01, 0.0]);
    assert_eq!(stroke.interpolation, Interpolation::Cubic);
}

#[test]
fn units_follow_from_definitions() {
    let mechanism = rich();
    let units: Vec<&str> = (mechanism.pseudo_velocities.iter())
        .map(|s| s.label.unit.text.as_str())
        .collect();
    assert_eq!(units, ["rad/s", "km/h", "kg*m/s"]);
    assert_eq!(
        mechanism.outputs[OutputId::new(1)].label.unit.text,
        "kg*m^2/s"
    );
}

#[test]
fn parents_come_first_and_the_text_decides_otherwise() {
    let mechanism = rich();
    let frames: Vec<&str> = mechanism.frames.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(frames, ["ground", "one", "two"]);
    assert_eq!(
        mechanism.frames[FrameId::new(2)].parent,
        Some(FrameId::new(1))
    );
    let turns = &mechanism.frames[FrameId::new(2)].turns;
    assert_eq!((turns[0].axis, turns[0].negative), (Axis::Z, true));
    assert_eq!((turns[1].axis, turns[1].negative), (Axis::X, false));
    let points: Vec<&str> = mechanism.points.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(points, ["O", "early", "late"]);
    assert_eq!(
        mechanism.points[PointId::new(2)].from,
        Some(PointId::new(1))
    );
    assert_eq!(mechanism.points[PointId::new(2)].frame, FrameId::new(2));
}

#[test]
fn constraints_and_loads_refer_to_their_items() {
    let mechanism = rich();
    let ConstraintKind::Rolling {
        body,
        contact,
        on: None,
        normal: None,
        friction: None,
        creep: None,
    } = mechanism.constraints[ConstraintId::new(0)].kind
    else {
        panic!("{:?}", mechanism.constraints[ConstraintId::new(0)]);
    };
    assert_eq!((body.index(), contact.index()), (1, 2));
    let LoadKind::Gravity { down, .. } = mechanism.loads[LoadId::new(0)].kind else {
        panic!("{:?}", mechanism.loads[LoadId::new(0)]);
    };
    assert_eq!(down, [0, -1, 0]);
    let LoadKind::SpringDamper {
        between: Connection::Points(a, b),
        ..
    } = mechanism.loads[LoadId::new(3)].kind
    else {
        panic!("{:?}", mechanism.loads[LoadId::new(3)]);
    };
    assert_eq!((a.index(), b.index()), (2, 0));
    let LoadKind::Force {
        on,
        body: Some(body),
        reaction_on: Some(reaction_on),
        frame,
        vector,
    } = &mechanism.loads[LoadId::new(1)].kind
    else {
        panic!("{:?}", mechanism.loads[LoadId::new(1)]);
    };
    assert_eq!((on.index(), body.index()), (2, 1));
    assert_eq!((reaction_on.index(), frame.index()), (1, 2));
    let mut seen = Vec::new();
    for component in vector {
        component.visit(&mut |q| seen.push(q));
    }
    assert_eq!(
        seen,
        [
            Quantity::Input(InputId::new(0)),
            Quantity::Signal(SignalId::new(2)),
            Quantity::Parameter(ParameterId::new(5)),
            Quantity::PseudoVelocity(SpeedId::new(1))
        ]
    );
}

#[test]
fn constraints_know_their_word_and_their_rows() {
    let constraints = rich().constraints.into_iter();
    let found: Vec<_> = constraints
        .map(|c| (c.kind.word(), c.kind.rows()))
        .collect();
    let expected = [("rolling", 3), ("velocity", 1), ("fixed_velocity", 1)];
    assert_eq!(found, expected);
}

#[test]
fn products_of_inertia_stand_in_the_tensor_with_their_sign() {
    let mechanism = rich();
    let inertia = mechanism.bodies[BodyId::new(0)].inertia.as_ref().unwrap();
    assert_eq!(inertia.matrix[0][1], inertia.matrix[1][0]);
    let ExprKind::Negate(_) = inertia.matrix[0][1].kind else {
        panic!("{:?}", inertia.matrix[0][1]);
    };
}

/// The codes that a change of the rich spec gives.
fn codes_after(changes: &[(&str, &str)]) -> Vec<Code> {
    let mut text = RICH.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    load("rich.toml", &text).map_or_else(
        |report| report.diagnostics().iter().map(|d| d.code).collect(),
        |_| Vec::new(),
    )
}

#[test]
fn one_mistake_gives_one_message_however_often_it_is_used() {
    for (from, to, code) in [
        // Quantities whose definition fails poison their uses silently.
        (
            "a   = { value = 250, unit = \"mm\"",
            "a   = { value = 250, unit = \"milli\"",
            Code::UnknownUnit,
        ),
        (
            "m   = { value = 1500, unit",
            "m   = { value = 1500, units",
            Code::UnknownKey,
        ),
        (
            "theta = { unit = \"deg\"",
            "theta = { unit = 5",
            Code::WrongType,
        ),
        ("theta = { unit", "theeta = { unit", Code::UnknownName),
        ("F = { unit = \"kN\" }", "F = 3", Code::WrongType),
        // So do items.
        (
            "early = { from = \"O\"",
            "early = { from = \"o\"",
            Code::UnknownReference,
        ),
        ("one = { parent", "1one = { parent", Code::InvalidName),
        (
            "[bodies.frame_and_name_may_agree]",
            "[bodies.\"frame and name may agree\"]",
            Code::InvalidName,
        ),
        (
            "omega = \"dot(theta)\"",
            "omega = \"dot(theta\"",
            Code::ExpressionSyntax,
        ),
        (
            "k   = { value = 2, unit = \"N/mm\" }",
            "k   = { value = 2, unit = \"N\" }",
            Code::UnitMismatch,
        ),
        ("[frames]", "[frame]", Code::UnknownSection),
        ("kind = \"rolling\"", "kind = \"roling\"", Code::UnknownWord),
        (
            "I   = { value = 0.5, unit = \"kg*m^2\" }",
            "",
            Code::UnknownName,
        ),
    ] {
        let mut codes = codes_after(&[(from, to)]);
        codes.dedup();
        let expected = vec![code];
        // A missing coordinate is missing in references too.
        let also = [Code::UnknownName, Code::UnknownReference];
        let renamed = to.starts_with("theeta");
        assert!(
            codes == expected || renamed && codes.iter().all(|c| also.contains(c)),
            "{to}: {codes:?}"
        );
    }
}

#[test]
fn broken_toml_does_not_hide_mistakes_elsewhere() {
    let codes = codes_after(&[
        ("[inputs]", "[inputs"),
        ("5 [deg]", "5 [degr]"),
        ("range = [-90, 90]", "range = [90, -90]"),
    ]);
    assert_eq!(
        codes,
        [Code::EmptyRange, Code::TomlSyntax, Code::UnknownUnit]
    );
}

#[test]
fn dimensions_of_connections_follow_from_what_they_connect() {
    for (from, to) in [
        (
            "coordinate = \"theta\", stiffness = \"k_t\"",
            "coordinate = \"theta\", stiffness = \"k\"",
        ),
        ("relaxed = \"5 [deg]\"", "relaxed = \"a\""),
        ("stiffness = \"k\", relaxed", "stiffness = \"k_t\", relaxed"),
        ("damping = \"c*a^2\"", "damping = \"c\""),
        ("coordinate = \"x\", force", "coordinate = \"theta\", force"),
        ("equals = \"belt\"", "equals = \"belt*a\""),
        ("a*dot(theta)\"", "dot(theta)\""),
        ("direction = [0, 1,", "direction = [0, \"a\","),
        ("acceleration = \"g\"", "acceleration = \"g*m\""),
        ("vector = [0, 0, \"k_t*theta\"]", "vector = [0, 0, \"F\"]"),
        ("mass = \"m\"", "mass = \"m*g\""),
        ("hypot(x, y)", "hypot(x, theta)"),
    ] {
        assert_eq!(codes_after(&[(from, to)]), [Code::UnitMismatch], "{to}");
    }
}

#[test]
fn places_refuse_what_they_cannot_depend_on() {
    for (from, to) in [
        ("mass = \"5 [g]\"", "mass = \"5 [g]*cos(theta)\""),
        ("stiffness = \"k\"", "stiffness = \"k*cos(theta)\""),
        ("by = \"theta/2\"", "by = \"omega*t\""),
        ("equals = \"belt\"", "equals = \"v\""),
        ("acceleration = \"g\"", "acceleration = \"g*gate\""),
        ("\"m*dot(x)\"", "\"m*dot(x) + F*t\""),
        ("unit = \"mm\", about = \"items", "about = \"items"),
    ] {
        let codes = codes_after(&[(from, to)]);
        let fine = to.starts_with("about");
        // An input in a linear place is also a term without a rate.
        assert!(
            fine && codes.is_empty() || codes.contains(&Code::NotAllowedHere),
            "{to}: {codes:?}"
        );
    }
}

#[test]
fn line_breaks_of_other_systems_are_read() {
    let text = RICH.replace('\n', "\r\n").replace("9.81", "nan");
    let report = load("rich.toml", &text).unwrap_err();
    assert_eq!(report.diagnostics().len(), 1);
    let shown = report.plain();
    assert!(shown.contains("rich.toml:25:17"), "{report}");
    assert!(shown.contains("unit = \"m/s^2\" }\n"), "{report}");
}

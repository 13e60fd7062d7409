//! Positions and velocities by name are what one would write by hand.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::derived;
use appell_codegen::jit::JitModel;
use appell_codegen::mechanics::assemble::program;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{At, Model};

const SPEC: &str = r#"
[mechanism]
name = "swinging"
title = "A cart with a bob that feels the air"
[parameters]
m = { value = 1, unit = "kg" }
M = { value = 3, unit = "kg" }
l = { value = 0.7, unit = "m" }
c = { value = 0.2, unit = "N*s^2/m^2" }
d = { value = 0.3, unit = "N*m*s" }
[coordinates]
x     = { unit = "m" }
theta = { unit = "rad" }
[inputs]
P = { unit = "N" }
[frames]
rod = { parent = "ground", about_axis = "y", by = "theta" }
[points]
C = { from = "O", in = "ground", at = ["x", 0, 0] }
P = { from = "C", in = "rod", at = [0, 0, "-l"] }
[bodies]
cart = { centre = "C", mass = "M" }
bob  = { centre = "P", mass = "m" }
[pseudo_velocities]
v     = "dot(x)"
omega = "dot(theta)"
[loads]
drag  = { kind = "force", on = "P", in = "rod", vector = ["-c*{speed}*{along}", 0, "-c*{speed}*{up}"] }
hinge = { kind = "generalized", velocity = "{turning}", force = "-d*{turning}" }
push  = { kind = "generalized", velocity = "{level}", force = "P" }
[outputs]
height = { value = "{height}" }
"#;

fn written(words: [(&str, &str); 6]) -> String {
    let mut text = SPEC.to_owned();
    for (word, meaning) in words {
        text = text.replace(&format!("{{{word}}}"), meaning);
    }
    text
}

/// Rates and output at some state.
fn values(text: &str) -> Vec<f64> {
    let derived =
        derived("swinging.toml", text).unwrap_or_else(|report| panic!("{}", report.plain()));
    let program = program(derived.derivation, &derived.mechanism, &FunctionKind::ALL).unwrap();
    let model = JitModel::new(&program).unwrap();
    let p = model.info().default_parameters();
    let (mut rates, mut outputs) = ([0.0; 4], [0.0; 1]);
    let at = At {
        t: 0.0,
        x: &[0.6, -1.7, 0.2, 0.9],
        u: &[1.3],
        p: &p,
    };
    model.rates(at, &mut rates);
    model.outputs(at, &mut outputs);
    rates.iter().chain(&outputs).copied().collect()
}

#[test]
fn names_stand_for_what_one_would_write_by_hand() {
    let by_name = written([
        ("speed", "smooth_abs(speed(P), 1e-3 [m/s])"),
        ("along", "velocity(P, x, rod)"),
        ("up", "velocity(P, z, rod)"),
        ("turning", "angular_velocity(rod, y)"),
        ("level", "velocity(P, x)"),
        ("height", "position(P, z)"),
    ]);
    let (level, up) = ("(v - l*omega*cos(theta))", "(l*omega*sin(theta))");
    let speed = format!("sqrt({level}^2 + {up}^2 + (1e-3 [m/s])^2)");
    let along = format!("(cos(theta)*{level} - sin(theta)*{up})");
    let across = format!("(sin(theta)*{level} + cos(theta)*{up})");
    let by_hand = written([
        ("speed", &speed),
        ("along", &along),
        ("up", &across),
        ("turning", "omega"),
        ("level", level),
        ("height", "-l*cos(theta)"),
    ]);
    let (by_name, by_hand) = (values(&by_name), values(&by_hand));
    for (named, own) in by_name.iter().zip(&by_hand) {
        assert!((named - own).abs() < 1e-12, "{by_name:?} and {by_hand:?}");
    }
}

//! Creep of a rolling contact against a wheel whose contact is free to slide, with the creep law as a
//! force: the two differ by the square of the creep.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::derived;
use appell_codegen::jit::JitModel;
use appell_codegen::mechanics::assemble::program;
use appell_codegen::program::FunctionKind;
use appell_runtime::Simulation;
use appell_runtime::integrate::Options;
use appell_runtime::model::Model;

/// An upright wheel that is driven and steered by torques.
const WHEEL: &str = r#"
[mechanism]
name = "upright"
title = "An upright wheel"
[parameters]
m     = { value = 10, unit = "kg" }
R     = { value = 0.3, unit = "m" }
g     = { value = 9.81, unit = "m/s^2" }
kappa = { value = 0.02, unit = "1", at_least = 0 }
[coordinates]
x   = { unit = "m" }
y   = { unit = "m" }
psi = { unit = "rad" }
phi = { unit = "rad" }
[frames]
yawed = { parent = "ground", about_axis = "z", by = "psi" }
wheel = { parent = "yawed", about_axis = "y", by = "phi" }
[points]
G = { from = "O", in = "ground", at = ["x", "y", "R"] }
P = { from = "G", in = "yawed", at = [0, 0, "-R"] }
[bodies.wheel]
frame   = "wheel"
centre  = "G"
mass    = "m"
inertia = { in = "yawed", diagonal = ["m*R^2/4", "m*R^2/2", "m*R^2/4"] }
"#;

const LOADS: &str = r#"
[loads]
weight = { kind = "gravity", down = "-z", acceleration = "g" }
steer  = { kind = "generalized", coordinate = "psi", force = "0.2 [N*m]*sin(3 [rad/s]*t)" }
drive  = { kind = "generalized", coordinate = "phi", force = "0.5 [N*m]*cos(2 [rad/s]*t)" }
"#;

fn creeping() -> String {
    let rows = r#"
[constraints]
rolling = { kind = "rolling", body = "wheel", contact = "P", longitudinal_creep = "kappa", lateral_creep = "kappa" }
[pseudo_velocities]
omega_2 = { value = "dot(phi)", unit = "rad/s", initial = 10 }
omega_3 = { value = "dot(psi)", unit = "rad/s", initial = 0.5 }
"#;
    [WHEEL, rows, LOADS].concat()
}

/// The contact slides with the law as a force; its inertia is the wheel's.
fn sliding() -> String {
    let rows = r#"
[pseudo_velocities]
omega_2 = { value = "dot(phi)", unit = "rad/s", initial = 10 }
omega_3 = { value = "dot(psi)", unit = "rad/s", initial = 0.5 }
along   = { value = "cos(psi)*dot(x) + sin(psi)*dot(y) - R*dot(phi)", unit = "m/s" }
across  = { value = "cos(psi)*dot(y) - sin(psi)*dot(x)", unit = "m/s" }
"#;
    let law = |s: &str| format!("\"-m*g*({s})/(kappa*R*dot(phi))\"");
    let force = format!(
        "creep = {{ kind = \"force\", on = \"P\", in = \"yawed\", vector = [{}, {}, 0] }}\n\
         moment = {{ kind = \"generalized\", coordinate = \"phi\", force = {} }}\n",
        law("cos(psi)*dot(x) + sin(psi)*dot(y) - R*dot(phi)"),
        law("cos(psi)*dot(y) - sin(psi)*dot(x)"),
        law("-R*(cos(psi)*dot(x) + sin(psi)*dot(y) - R*dot(phi))"),
    );
    [WHEEL, rows, LOADS, &force].concat()
}

/// Positions after two seconds: x, y, psi, phi.
fn end(spec: &str, kappa: f64) -> Vec<f64> {
    let derived =
        derived("upright.toml", spec).unwrap_or_else(|report| panic!("{}", report.plain()));
    let program = program(derived.derivation, &derived.mechanism, &FunctionKind::ALL).unwrap();
    let model = JitModel::new(&program).unwrap();
    let info = model.info();
    let mut simulation = Simulation {
        span: [0.0, 2.0],
        options: Options::with_tolerances(1e-10, 1e-10),
        ..Simulation::new(&model)
    };
    simulation.parameters[info.parameter_index("kappa").unwrap()] = kappa;
    let motion = simulation.run().unwrap();
    let state = motion.last_state();
    ["x", "y", "psi", "phi"]
        .map(|q| state[info.state_index(q).unwrap()])
        .to_vec()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

#[test]
fn creep_is_right_to_first_order() {
    let (creeping, sliding) = (creeping(), sliding());
    let rolls = end(&creeping, 0.0);
    let error = |kappa: f64| {
        let slides = end(&sliding, kappa);
        let error = distance(&end(&creeping, kappa), &slides);
        (error, distance(&rolls, &slides))
    };
    let [(coarse, _), (fine, drift)] = [0.02, 0.01].map(error);
    assert!(drift > 0.01, "the wheel drifts by {drift} m");
    assert!(fine < 0.05 * drift, "{fine} of {drift}");
    let order = (coarse / fine).log2();
    assert!(
        (1.7..=2.3).contains(&order),
        "order {order}: {coarse}, {fine}"
    );
}

#[test]
fn a_contact_without_a_known_normal_cannot_creep() {
    let without_weight = creeping().replace("weight = { kind", "# weight = { kind");
    let report = derived("upright.toml", &without_weight).err().unwrap();
    let told = report.plain();
    assert!(told.contains("creep-not-judged"), "{told}");
    assert!(
        told.contains("the creep of `rolling` cannot be computed"),
        "{told}"
    );
}

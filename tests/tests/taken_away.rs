//! What is taken away: a ring is a disc without a smaller one.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::derived;
use appell_codegen::jit::JitModel;
use appell_codegen::mechanics::assemble::program;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{At, Model};

/// Something that swings about a point of its rim.
fn swinging(bodies: &str) -> String {
    format!(
        r#"
[mechanism]
name = "swing"
title = "A swing"
[parameters]
R = {{ value = 0.3, unit = "m" }}
r = {{ value = 0.1, unit = "m" }}
w = {{ value = 70, unit = "kg/m^2" }}
g = {{ value = 9.81, unit = "m/s^2" }}
[coordinates]
theta = {{ unit = "rad" }}
[frames]
swing = {{ parent = "ground", about_axis = "y", by = "theta" }}
[points]
G = {{ from = "O", in = "swing", at = [0, 0, "-R"] }}
[bodies]
{bodies}
[pseudo_velocities]
omega = "dot(theta)"
[loads]
weight = {{ kind = "gravity", down = "-z", acceleration = "g" }}
"#
    )
}

fn disc(name: &str, radius: &str, more: &str) -> String {
    let mass = format!("pi*w*{radius}^2");
    let inertia = format!("\"{mass}*{radius}^2/4\"");
    format!(
        "{name} = {{ frame = \"swing\", centre = \"G\", mass = \"{mass}\", inertia = {{ in = \"swing\", \
         diagonal = [{inertia}, \"{mass}*{radius}^2/2\", {inertia}] }}{more} }}\n"
    )
}

/// Angular acceleration at some angle.
fn acceleration(bodies: &str) -> f64 {
    let derived = derived("swing.toml", &swinging(bodies)).unwrap();
    assert_eq!(derived.warnings.len(), 0, "nothing to warn of");
    let program = program(derived.derivation, &derived.mechanism, &FunctionKind::ALL).unwrap();
    let model = JitModel::new(&program).unwrap();
    let p = model.info().default_parameters();
    let mut rates = [0.0; 2];
    let (t, x, u) = (0.0, &[0.2, 0.7][..], &[][..]);
    model.rates(At { t, x, u, p: &p }, &mut rates);
    rates[0]
}

#[test]
fn a_ring_is_a_disc_from_which_a_smaller_one_is_taken_away() {
    /// Rounding of a few operations.
    const ROUNDING: f64 = 1e-13;
    let found = acceleration(&(disc("disc", "R", "") + &disc("hole", "r", ", taken_away = true")));
    // About the rim: the masses by Steiner's theorem.
    let (outer, inner, g) = (0.3_f64, 0.1_f64, 9.81);
    let masses = outer.powi(2) - inner.powi(2);
    let inertia = 0.5 * (outer.powi(4) - inner.powi(4)) + masses * outer.powi(2);
    let expected = -masses * g * outer * 0.7_f64.sin() / inertia;
    assert!(
        (found - expected).abs() < ROUNDING * expected.abs(),
        "{found}, {expected}"
    );
}

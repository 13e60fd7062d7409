//! A torsional spring with a damper between two frames, against its torque by hand.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_codegen::compile;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::model::{At, Model};

const SPEC: &str = include_str!("audit/right/torsional_springs.toml");

#[test]
fn the_torque_acts_on_the_relative_angle() {
    let program = compile("torsional_springs.toml", SPEC, &FunctionKind::ALL);
    let program = program.unwrap_or_else(|report| panic!("{}", report.plain()));
    let model = InterpretedModel::new(program);
    let ([q1, q2, q3], [w1, w2, w3]) = ([0.3, -1.1, 0.8], [0.5, 1.3, -0.4]);
    let (k, c, rest) = (3.0, 0.7, 0.2);
    let x = [w1, w2, w3, q1, q2, q3];
    let p: Vec<f64> = model.info().parameters.iter().map(|p| p.value).collect();
    let at = At {
        t: 0.0,
        x: &x,
        u: &[],
        p: &p,
    };
    let (mut mass, mut bias, mut forces) = ([0.0; 9], [0.0; 3], [0.0; 3]);
    model.appell(at, &mut mass, &mut bias, &mut forces);
    // From `a` back to the ground, and on to `b`, whose axis points down.
    let (angle, rate) = (-q1 - q2, -w1 - w2);
    let tension = k * (angle - rest) + c * rate;
    let wanted = [tension, tension, -2.0 * k * q3];
    for (found, wanted) in forces.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-14, "{forces:?}: {wanted}");
    }
    let potential = 0.5 * k * (angle - rest).powi(2) + k * q3.powi(2);
    let energies = model.energies(at);
    assert!((energies.potential - potential).abs() < 1e-14);
    // Only the damper takes energy away.
    assert!((energies.power + c * rate * rate).abs() < 1e-14);
    let mut torque = [0.0];
    model.outputs(at, &mut torque);
    assert!((torque[0] - tension).abs() < 1e-14);
}

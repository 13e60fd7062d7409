//! Inputs that switch or act for a short time, by every integrator.

use appell::{Method, Model, Motion};

const CARRIAGE: &str = r#"
[mechanism]
name = "carriage"
title = "carriage"
[coordinates]
x = { unit = "m" }
[inputs]
F = { unit = "N" }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0] }
[bodies]
b = { centre = "P", mass = "1 [kg]" }
[pseudo_velocities]
v = "dot(x)"
[loads]
f = { kind = "force", on = "P", in = "ground", vector = ["F", 0, 0] }
[outputs]
lean = { value = "acos(x/(1 [m]))", unit = "deg" }
"#;

/// Tolerances of 1e-11 a step, over all steps.
const OVER_ALL_STEPS: f64 = 1e-8;

fn velocity(motion: &Motion) -> f64 {
    let motion = Model::from_spec(CARRIAGE)
        .unwrap()
        .simulate(motion)
        .unwrap();
    *motion.trajectory.column("v").unwrap().last().unwrap()
}

#[test]
fn no_pulse_of_an_input_is_missed_between_long_steps() {
    let period = std::f64::consts::TAU / 7.0;
    let width = 2.0 * f64::acos(0.99) / 7.0;
    let train = |until: f64| 100.0 * width * ((until - period / 4.0) / period).ceil();
    let twice = 10.0 * (6.0 * f64::acos(0.999) + 0.5 * f64::acos(0.999));
    let smooth = 10.0 * (std::f64::consts::PI * 1e-4).sqrt();
    for (force, start, expected) in [
        ("if(sin(7*t)>0.99,100,0)", 0.0, train(20.0)),
        ("if(cos(2*t)>0.999,10,0)", 0.0, twice),
        (
            "if(t*t-100 > 0, if(t*t<101,50,0), 0)",
            0.0,
            50.0 * (101_f64.sqrt() - 10.0),
        ),
        ("10*exp(-(t-13)*(t-13)*10000)", 0.0, smooth),
        ("if(x > 5, if(x < 5.01, 10, 0), 0)", 1.0, 1.2_f64.sqrt()),
    ] {
        for method in [Method::Dop853, Method::Dopri5, Method::Taylor] {
            let motion = Motion {
                method,
                ..Motion::new(20.0).input("F", force).initial("v", start)
            };
            let found = velocity(&motion);
            let off = (found - expected).abs();
            assert!(
                off < OVER_ALL_STEPS,
                "{force} {method:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn a_pulse_that_a_program_computes_is_seen_between_rows() {
    let pulse = |t: f64, _: &[f64], u: &mut [f64]| u[0] = 10.0 * (-(t - 13.0).powi(2) * 1e4).exp();
    let found = velocity(&Motion::new(20.0).drive(&["F"], pulse));
    let expected = 10.0 * (std::f64::consts::PI * 1e-4).sqrt();
    assert!(
        (found - expected).abs() < OVER_ALL_STEPS,
        "{found} {expected}"
    );
}

#[test]
fn outputs_that_are_no_numbers_are_reported_with_their_first_time() {
    let model = Model::from_spec(CARRIAGE).unwrap();
    let motion = Motion::new(2.0).initial("v", 1.0).initial("x", 0.0005);
    let simulated = model.simulate(&motion).unwrap();
    assert!(simulated.failure.is_none());
    let undefined = simulated.undefined.unwrap();
    assert!(
        undefined.contains("`lean`") && undefined.contains("t = 1 s"),
        "{undefined}"
    );
    let fine = model.simulate(&Motion::new(1.0)).unwrap();
    assert_eq!(fine.undefined, None);
}

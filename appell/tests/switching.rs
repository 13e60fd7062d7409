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
        for method in [Method::Dop853, Method::Dopri5] {
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

/// What entering and leaving a hundred pulses leaves of the tolerances.
const OVER_ALL_PULSES: f64 = 1e-6;

#[test]
fn no_pulse_of_the_state_is_missed_between_long_steps() {
    // Each passage of a place where x is fixed does the work F times the width.
    let passed = |work: f64| (1.0 + 2.0 * work).sqrt();
    let bell = (std::f64::consts::PI).sqrt();
    // A mass of 1 kg at 1 m/s; the pulses of the train are met one after the other.
    let width = 2.0 * f64::acos(0.999) / 7.0;
    let mut train = (0.0, 1.0, 0.0);
    for pulse in 0.. {
        let (x, v, t) = train;
        let begin = std::f64::consts::TAU * (f64::from(pulse) + 0.25) / 7.0 - 0.5 * width;
        let next = f64::sqrt(v * v + 200.0 * width);
        let after = t + (begin - x) / v + (next - v) / 100.0;
        if after > 7.0 {
            break;
        }
        train = (begin + width, next, after);
    }
    let pulses = [
        ("if(sin(7[1/m]*x) > 0.999, 100[N], 0[N])", train.1),
        ("if((x - 5[m])^2 < 1e-8[m^2], 1e4[N], 0[N])", passed(2.0)),
        (
            "if(exp(-((x - 5[m])/1e-2[m])^2) > 0.9999, 1e3[N], 0[N])",
            passed(20.0 * f64::sqrt(-f64::ln(0.9999))),
        ),
        (
            "if(1/(1 + ((x - 5[m])/1e-4[m])^2) > 0.5, 1e4[N], 0[N])",
            passed(2.0),
        ),
        ("100[N]*exp(-((x - 5[m])/1e-3[m])^2)", passed(0.1 * bell)),
        (
            "1000[N]*(smooth_sign(x - 5[m], 1e-5[m]) - smooth_sign(x - 5.001[m], 1e-5[m]))",
            passed(2.0),
        ),
    ];
    for (force, expected) in pulses {
        for method in [Method::Dop853, Method::Dopri5] {
            let motion = Motion {
                method,
                ..Motion::new(7.0).input("F", force).initial("v", 1.0)
            };
            let found = velocity(&motion);
            let off = (found - expected).abs();
            assert!(
                off < OVER_ALL_PULSES,
                "{force} {method:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn switches_that_follow_each_other_ever_faster_end_the_motion() {
    for method in [Method::Dop853, Method::Dopri5] {
        let motion = Motion {
            method,
            ..Motion::new(10.0).input("F", "if(sin(1/(5-t)) > 0, 1, 0)")
        };
        let simulated = Model::from_spec(CARRIAGE)
            .unwrap()
            .simulate(&motion)
            .unwrap();
        let steps = simulated.trajectory.statistics.steps;
        assert!(steps < 50_000, "{method:?}: {steps} steps");
        let told = simulated.failure.unwrap();
        assert!(
            told.contains("at t = 4.99") || told.contains("at t = 5"),
            "{told}"
        );
    }
}

#[test]
fn fixed_steps_are_shorter_at_a_pulse() {
    let motion = Motion {
        method: Method::Rk4 { step: 0.02 },
        ..Motion::new(20.0).input("F", "1000*exp(-((t-5)/1e-4)^2)")
    };
    let (found, expected) = (velocity(&motion), 0.1 * std::f64::consts::PI.sqrt());
    // Order 4 on parts of half a value each; longer steps miss the pulse, or count it thirty-fold.
    assert!(
        (found - expected).abs() < 3e-2 * expected,
        "{found} {expected}"
    );
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

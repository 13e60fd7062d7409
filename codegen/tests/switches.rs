//! Relations of time inside a spec: found by the derivation, landed on by the integrators.

// Mechanisms that cannot be derived or simulated fail the test.
#![allow(clippy::unwrap_used)]

use appell_codegen::compile;
use appell_codegen::emit::{Options, emit};
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::program::{FunctionKind, Program};
use appell_runtime::Simulation;
use appell_runtime::model::Model;
use appell_runtime::simulate::Method;

/// A carriage of 1 kg under a force that is switched.
fn carriage(force: &str) -> Program {
    let text = format!(
        "[mechanism]\nname = 'carriage'\ntitle = 'carriage'\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\nt_brake = {{ value = 0.3, unit = 's' }}\n\
         F_0 = {{ value = 2, unit = 'N' }}\nrate = {{ value = 1, unit = '1/s' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\n\
         [points]\nC = {{ from = 'O', in = 'ground', at = ['x', 0, 0] }}\n\
         [bodies]\nb = {{ centre = 'C', mass = 'm' }}\n\
         [pseudo_velocities]\nv = {{ value = 'dot(x)', unit = 'm/s' }}\n\
         [loads]\npush = {{ kind = 'force', on = 'C', in = 'ground', vector = ['{force}', 0, 0] }}\n"
    );
    compile("carriage.toml", &text, &FunctionKind::STANDARD)
        .unwrap_or_else(|report| panic!("{}", report.plain()))
}

/// Velocities of piecewise linear motions are exact up to rounding.
const ROUNDING: f64 = 1e-14;

/// The motion for one second, without a rejected step.
fn assert_exact(model: &dyn Model, velocity: f64, stops: &[f64]) {
    for method in [Method::Dop853, Method::Dopri5, Method::Rk4 { step: 0.4 }] {
        let motion = Simulation {
            method,
            span: [0.0, 1.0],
            ..Simulation::new(model)
        }
        .run()
        .unwrap();
        let found = motion.last_state()[0];
        assert!((found - velocity).abs() < ROUNDING, "{found} {velocity}");
        assert_eq!(motion.statistics.rejected, 0);
        for stop in stops {
            assert!(motion.times().contains(stop), "{:?}", motion.times());
        }
    }
}

#[test]
fn steps_end_exactly_where_a_relation_of_time_and_parameters_changes() {
    for force in [
        "if(t < t_brake, F_0, -F_0)",
        "if(t_brake >= t, F_0, -F_0)",
        "F_0*sign(t_brake - t)",
    ] {
        let program = carriage(force);
        assert_eq!(program.switch_len(), 1, "{force}");
        let model = InterpretedModel::new(program);
        assert_exact(&model, 2.0 * 0.3 - 2.0 * 0.7, &[]);
    }
    let model = InterpretedModel::new(carriage("if(t < t_brake, F_0, -F_0)"));
    assert_exact(&model, -0.8, &[0.3]);
}

#[test]
fn a_square_wave_is_integrated_exactly() {
    // Half a period is half a second: up, then down.
    let model = InterpretedModel::new(carriage("if(sin(2*pi*rate*t) >= 0, F_0, 0*F_0)"));
    assert_exact(&model, 1.0, &[]);
}

#[test]
fn kinks_count_and_repeated_relations_count_once() {
    let both = "if(t < t_brake, F_0, 0*F_0) + if(t < t_brake, 3*F_0, F_0)";
    assert_eq!(carriage(both).switch_len(), 1);
    assert_eq!(carriage("F_0*rate*abs(t - t_brake)").switch_len(), 1);
}

#[test]
fn what_states_decide_is_a_crossing_and_no_switch() {
    let program = carriage("if(x < 0 [m], F_0, -F_0)*(1 + rate*t)");
    assert_eq!(program.switch_len(), 0);
    let kinds: Vec<FunctionKind> = program.functions.iter().map(|f| f.kind).collect();
    assert!(!kinds.contains(&FunctionKind::Switches));
    assert!(kinds.contains(&FunctionKind::Crossings));
    let model = InterpretedModel::new(program);
    let counts = model.switching().unwrap().counts();
    assert_eq!((counts.answers, counts.crossings), (0, 1));
    let smooth = InterpretedModel::new(carriage("F_0*x/(1 [m])"));
    assert!(smooth.switching().is_none());
}

#[test]
fn emitted_code_offers_its_switches() {
    let text = |force| {
        let emitted = emit(&carriage(force), &Options::default()).unwrap();
        emitted.source
    };
    let switched = text("if(t < t_brake, F_0, -F_0)");
    for line in [
        "pub fn switches<T: Real>(",
        "fn switching(&self) -> Option<&dyn model::Switching> {",
        "self::switches(at.t, &parameters(&at), &state(&at), &inputs(&at))",
        "self::time_functions(",
    ] {
        assert!(switched.contains(line), "{line}\n{switched}");
    }
    assert!(!text("F_0").contains("switch"));
    // A spec without outputs has no type for them either.
    assert!(!text("F_0").contains("Outputs<T>"));
}

#[cfg(feature = "jit")]
#[test]
fn machine_code_offers_the_same_switches() {
    let program = carriage("if(t < t_brake, F_0, -F_0)");
    let model = appell_codegen::jit::JitModel::new(&program).unwrap();
    let switching = model.switching().unwrap();
    assert_eq!(switching.counts().answers, 1);
    for (t, expected) in [(0.0, 1.0), (0.3, 0.0), (0.3f64.next_down(), 1.0)] {
        let (x, p) = ([0.0; 2], model.info().default_parameters());
        let at = appell_runtime::model::At {
            t,
            x: &x,
            u: &[],
            p: &p,
        };
        let mut switches = [f64::NAN];
        switching.answers(at, &mut switches);
        assert!((switches[0] - expected).abs() < ROUNDING, "{t}");
    }
    assert_exact(&model, -0.8, &[0.3]);
}

/// The velocity after 20 s from rest, or from 1 m/s.
fn velocity(force: &str, start: f64, method: Method) -> f64 {
    let model = InterpretedModel::new(carriage(force));
    let mut simulation = Simulation {
        method,
        span: [0.0, 20.0],
        ..Simulation::new(&model)
    };
    simulation.initial_state[0] = start;
    simulation.run().unwrap().last_state()[0]
}

const ADAPTIVE: [Method; 2] = [Method::Dop853, Method::Dopri5];

/// Tolerances of 1e-11 a step, over the steps of twenty seconds.
const OVER_ALL_STEPS: f64 = 1e-8;

#[test]
fn no_pulse_of_time_is_missed_between_long_steps() {
    // The integrals, by hand: pulses of arccos(0.99)/7 about each maximum of the sine but the last, which 20 s cut.
    let (width, period) = (2.0 * f64::acos(0.99) / 7.0, std::f64::consts::TAU / 7.0);
    let first = std::f64::consts::FRAC_PI_2 / 7.0;
    let whole = ((20.0 - first - width / 2.0) / period).floor() + 1.0;
    let train = 100.0 * whole * width;
    let nested = 50.0 * (f64::sqrt(101.0) - 10.0);
    let smooth = 10.0 * (std::f64::consts::PI * 1e-4).sqrt();
    for (force, expected) in [
        ("if(sin(7*rate*t) > 0.99, 50*F_0, 0*F_0)", train),
        (
            "if(t*t*rate^2 - 100 > 0, if(t*t*rate^2 < 101, 25*F_0, 0*F_0), 0*F_0)",
            nested,
        ),
        ("max(0, 1 - abs(t*rate - 13)*1e3)*F_0", 2.0e-3),
        ("50*F_0*sign(max(0, sin(7*rate*t) - 0.99))", train),
        ("5*F_0*exp(-(t*rate - 13)^2*1e4)", smooth),
        (
            "if(t < t_brake, 0*F_0, 5*F_0*exp(-(t*rate - 13)^2*1e4))",
            smooth,
        ),
    ] {
        for method in ADAPTIVE {
            let found = velocity(force, 0.0, method);
            let off = (found - expected).abs();
            assert!(
                off < OVER_ALL_STEPS,
                "{force} {method:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn no_place_that_switches_is_passed_over() {
    // A wall of 1 cm with 10 N, from 1 m/s: v² = 1 + 2·10·0.01.
    let wall = "if(x > 5 [m], if(x < 5.01 [m], 5*F_0, 0*F_0), 0*F_0)";
    let bump = "1e3*F_0*max(0, 0.001 - abs(x/(1 [m]) - 5))";
    for (force, expected) in [
        (wall, 1.2_f64.sqrt()),
        (bump, (1.0 + 4.0 * 1e-3_f64).sqrt()),
    ] {
        for method in [Method::Dop853, Method::Dopri5, Method::Rk4 { step: 0.001 }] {
            let found = velocity(force, 1.0, method);
            let off = (found - expected).abs();
            assert!(
                off < OVER_ALL_STEPS,
                "{force} {method:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn bumps_of_any_width_are_felt_wherever_they_are() {
    for (half, centre, sign) in [
        (1e-2, 1.3, ""),
        (1e-2, 18.9, "-"),
        (1e-3, 7.77, ""),
        (1e-3, 5.0, "-"),
        (1e-4, 11.123, "-"),
        (1e-5, 5.0, ""),
    ] {
        let force = format!("{sign}1e3*F_0*max(0, {half} - abs(x/(1 [m]) - {centre}))");
        let work = format!("{sign}2e3").parse::<f64>().unwrap() * half * half;
        let expected = (1.0 + 2.0 * work).sqrt();
        for method in ADAPTIVE {
            let found = velocity(&force, 1.0, method);
            let off = (found - expected).abs();
            assert!(
                off < OVER_ALL_STEPS,
                "{force} {method:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn a_motion_that_is_switched_to_and_fro_ends_with_an_error() {
    let model = InterpretedModel::new(carriage("-F_0*sign(x/(1 [m]) - 1 + v/(1 [m/s]))"));
    for method in ADAPTIVE {
        let error = Simulation {
            method,
            ..Simulation::new(&model)
        }
        .run()
        .unwrap_err();
        let text = error.to_string();
        assert!(
            text.contains("switched to and fro") || text.contains("shrank"),
            "{text}"
        );
    }
}

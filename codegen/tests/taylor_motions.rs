//! Laws of motions by Taylor series: energy, tolerances, events, tables, singular places.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::f64::consts::{FRAC_PI_2, PI};

use appell_codegen::compile;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::Simulation;
use appell_runtime::inputs::TabulatedInputs;
use appell_runtime::integrate::{Cause, Direction, Event, Options};
use appell_runtime::model::{Interpolation, Model, SignalTable};
use appell_runtime::signal::Signal;
use appell_runtime::simulate::{Method, Response, Sampling, SimulationError, Validity};

/// A mass of 1 kg on a line under a force in N, which may use an input `u` in N.
fn mass(force: &str) -> JitModel {
    let text = format!(
        "[mechanism]\nname = 'mass'\ntitle = 'mass'\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\nk = {{ value = 1, unit = 'N/m' }}\n\
         t_end = {{ value = 1, unit = 's' }}\nP = {{ value = 1, unit = 'N*s' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\n[inputs]\nu = {{ unit = 'N' }}\n\
         [points]\nC = {{ from = 'O', in = 'ground', at = ['x', 0, 0] }}\n\
         [bodies]\nb = {{ centre = 'C', mass = 'm' }}\n\
         [pseudo_velocities]\nv = {{ value = 'dot(x)', unit = 'm/s' }}\n\
         [loads]\npush = {{ kind = 'force', on = 'C', in = 'ground', vector = ['{force}', 0, 0] }}\n"
    );
    let program = compile("mass.toml", &text, &FunctionKind::STANDARD)
        .unwrap_or_else(|report| panic!("{}", report.plain()));
    JitModel::new(&program).unwrap()
}

/// x = cos t by Taylor series.
fn oscillation(model: &dyn Model, tolerance: f64, t_end: f64) -> Simulation<'_> {
    Simulation {
        method: Method::Taylor,
        span: [0.0, t_end],
        initial_state: vec![0.0, 1.0],
        options: Options::with_tolerances(tolerance, tolerance),
        ..Simulation::new(model)
    }
}

#[test]
fn the_error_is_proportional_to_the_tolerance() {
    let model = mass("u - k*x");
    let mut steps = Vec::new();
    for digits in 4..=12 {
        let tolerance = 10f64.powi(-digits);
        let motion = oscillation(&model, tolerance, 20.0).run().unwrap();
        let error = (motion.last_state()[1] - 20f64.cos()).abs();
        // Some tolerated errors, one a step; rounding in the end.
        assert!(error < 10.0 * tolerance, "{digits}: {error:e}");
        assert_eq!(motion.statistics.rejected, 0);
        steps.push(motion.statistics.steps);
    }
    // Digits cost orders, not steps: by Runge-Kutta methods of order 8 there would be ten times as many.
    let [first, last] = [steps[0], steps[8]];
    assert!(last < 2 * first, "{steps:?}");
}

#[test]
fn the_polynomial_is_as_exact_as_the_steps() {
    let model = mass("u - k*x");
    let motion = Simulation {
        sampling: Sampling::Every(0.01),
        ..oscillation(&model, 1e-12, 10.0)
    };
    let motion = motion.run().unwrap();
    for (row, t) in motion.times().iter().enumerate() {
        let state = motion.state(row);
        assert!((state[1] - t.cos()).abs() < 1e-11, "{t}: {state:?}");
        assert!((state[0] + t.sin()).abs() < 1e-11, "{t}: {state:?}");
    }
}

#[test]
fn events_are_found_to_twelve_digits() {
    let model = mass("u - k*x");
    let motion = Simulation {
        events: vec![
            Event::new(Direction::Either, |_, x| x[1]),
            Event::terminal(Direction::Rising, |t, x| x[0] - 0.5 + 0.0 * t),
        ],
        ..oscillation(&model, 1e-13, 20.0)
    };
    let motion = motion.run().unwrap();
    let times: Vec<f64> = motion.events.iter().map(|hit| hit.t).collect();
    // x = 0 at π/2, v = −sin t = 1/2 at 7π/6.
    let expected = [FRAC_PI_2, 7.0 * PI / 6.0];
    assert_eq!(times.len(), 2, "{times:?}");
    for (found, expected) in times.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn every_mechanism_keeps_its_energy_where_nothing_does_work() {
    let mut conservative = 0;
    for (name, text) in appell_test_kit::shipped() {
        let program = compile(&name, &text, &FunctionKind::STANDARD).unwrap();
        let model = JitModel::new(&program).unwrap();
        let initial = model.info().initial_state();
        let motion = Simulation {
            method: Method::Taylor,
            span: [0.0, 0.4],
            initial_state: initial.iter().map(|x| x + 0.02).collect(),
            extras: appell_runtime::trajectory::Extras {
                energies: true,
                ..Default::default()
            },
            ..Simulation::new(&model)
        };
        let motion = motion
            .run()
            .unwrap_or_else(|error| panic!("{name}: {error}"));
        let [kinetic, potential, power] = ["kinetic_energy", "potential_energy", "power"]
            .map(|column| motion.column(column).unwrap());
        if power.iter().any(|power| power.abs() > 1e-9) {
            continue;
        }
        conservative += 1;
        let energy = |row: usize| kinetic[row] + potential[row];
        let size = kinetic.iter().fold(1.0, |size: f64, t| size.max(*t));
        for row in 1..kinetic.len() {
            let drift = (energy(row) - energy(0)).abs();
            assert!(drift < 1e-9 * size, "{name}: {drift:e} of {size}");
        }
    }
    assert!(conservative >= 10, "{conservative}");
}

fn table(interpolation: Interpolation) -> Signal {
    let table = SignalTable {
        name: "u".into(),
        times: vec![0.0, 0.3, 0.7, 1.1].into(),
        values: vec![0.5, -1.0, 2.0, 0.25].into(),
        interpolation,
    };
    Signal::new(&table).unwrap()
}

#[test]
fn steps_end_at_the_corners_of_tables() {
    let model = mass("u");
    for (interpolation, velocity) in [
        (
            Interpolation::Hold,
            0.3 * 0.5 - 0.4 + 0.4 * 2.0 + 0.4 * 0.25,
        ),
        (
            Interpolation::Linear,
            0.3 * (0.5 - 1.0) / 2.0 + 0.4 * (2.0 - 1.0) / 2.0 + 0.4 * 2.25 / 2.0 + 0.4 * 0.25,
        ),
    ] {
        let inputs = TabulatedInputs::new(vec![table(interpolation)]);
        let motion = Simulation {
            method: Method::Taylor,
            span: [0.0, 1.5],
            inputs: &inputs,
            ..Simulation::new(&model)
        };
        let motion = motion.run().unwrap();
        assert_eq!(
            motion.times(),
            [0.0, 0.3, 0.7, 1.1, 1.5],
            "{interpolation:?}"
        );
        assert!(
            (motion.last_state()[0] - velocity).abs() < 1e-15,
            "{interpolation:?}"
        );
    }
    // A spline drives an oscillator as by Runge-Kutta steps.
    let model = mass("u - k*x");
    let inputs = TabulatedInputs::new(vec![table(Interpolation::Cubic)]);
    let [taylor, expected] = [Method::Taylor, Method::Dop853].map(|method| {
        let motion = Simulation {
            method,
            inputs: &inputs,
            options: Options::with_tolerances(1e-13, 1e-13),
            ..Simulation::new(&model)
        };
        motion.run().unwrap().last_state().to_vec()
    });
    for (found, expected) in taylor.iter().zip(&expected) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn inputs_that_a_program_computes_have_no_series() {
    let model = mass("u");
    let inputs = |t: f64, _: &[f64], u: &mut [f64]| u[0] = t.sin();
    let motion = Simulation {
        method: Method::Taylor,
        inputs: &inputs,
        ..Simulation::new(&model)
    };
    let error = motion.run().unwrap_err();
    assert!(matches!(error, SimulationError::NoSeries { .. }), "{error}");
    assert!(
        error.to_string().contains("give them as expressions"),
        "{error}"
    );
}

#[test]
fn a_series_that_ends_too_late_is_found_out() {
    // cos t⁵: after the first term come nine orders of zeros, which tell nothing of the radius.
    let model = mass("u + P/t_end*cos(t^5/t_end^5)");
    let [taylor, expected] = [Method::Taylor, Method::Dop853].map(|method| {
        let motion = Simulation {
            method,
            span: [0.0, 2.0],
            initial_state: vec![0.0, 1.0],
            ..Simulation::new(&model)
        };
        motion.run().unwrap()
    });
    for (found, expected) in taylor.last_state().iter().zip(expected.last_state()) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

#[test]
fn a_singular_place_ends_the_motion_with_its_name() {
    // v = −ln(1 − t).
    let model = mass("P/(t_end - t)");
    for method in [Method::Taylor, Method::Dop853] {
        let motion = Simulation {
            method,
            span: [0.0, 2.0],
            ..Simulation::new(&model)
        };
        let Err(SimulationError::Integration { failure, .. }) = motion.run() else {
            panic!("{method:?} went on")
        };
        assert!((failure.t - 1.0).abs() < 1e-6, "{method:?}: {failure}");
        let cause = failure.cause;
        let named = matches!(cause, Cause::NonFinite { .. } | Cause::StepTooSmall { .. });
        assert!(named, "{method:?}: {cause}");
    }
}

#[test]
fn ranges_are_watched_within_the_steps() {
    for (name, text) in appell_test_kit::shipped() {
        let program = compile(&name, &text, &FunctionKind::STANDARD).unwrap();
        let model = JitModel::new(&program).unwrap();
        let run = |method, ranges| {
            let initial_state = model
                .info()
                .initial_state()
                .iter()
                .map(|x| x + 0.1)
                .collect();
            Simulation {
                method,
                span: [0.0, 3.0],
                initial_state,
                validity: Validity {
                    ranges,
                    ..Validity::default()
                },
                ..Simulation::new(&model)
            }
            .run()
        };
        let ends = [Method::Taylor, Method::Dop853].map(|method| run(method, Response::Stop));
        let [
            Err(SimulationError::Integration { failure: a, .. }),
            Err(SimulationError::Integration { failure: b, .. }),
        ] = &ends
        else {
            assert!(ends.iter().all(Result::is_ok), "{name}: {ends:?}");
            continue;
        };
        assert_eq!(a.cause, b.cause, "{name}");
        assert!((a.t - b.t).abs() < 1e-7, "{name}: {} {}", a.t, b.t);
    }
}

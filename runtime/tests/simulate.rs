//! Inputs, signals, sampling and files.

// A failed simulation fails the test.
#![allow(clippy::unwrap_used)]

use crate::common::{HandWritten, in_unit, info, si};
use appell_runtime::inputs::{InputSource, SwitchedInputs, TabulatedInputs};
use appell_runtime::integrate::{Direction, Ending, Event};
use appell_runtime::model::{At, Interpolation, SignalTable};
use appell_runtime::signal::{Signal, SignalError};
use appell_runtime::simulate::{Method, Sampling, Simulation, SimulationError};
use appell_runtime::trajectory::{CsvOptions, Extras, Trajectory};
use std::cell::RefCell;
use std::f64::consts::PI;

/// A cart: v, x; v̇ = F/m + ẅ with a tabulated w.
fn cart_rates(at: At<'_>, rates: &mut [f64]) {
    rates[0] = at.u[0] / at.p[0] + at.u[2];
    rates[1] = at.x[0];
}

fn cart(signal: SignalTable) -> HandWritten {
    let states = vec![in_unit("v", "cm/s", 0.01, 0.0), si("x", "m", 1.0)];
    let inputs = vec![
        si("F", "N", 0.0),
        si("w", "m", 0.0),
        si("w_ddot", "m/s^2", 0.0),
    ];
    let mut info = info("cart", states, 1, inputs, vec![si("m", "kg", 2.0)]);
    info.declared_inputs = 1;
    info.signals = vec![signal].into();
    info.signal_inputs = vec![(0, 0), (0, 2)].into();
    info.outputs = vec![in_unit("speed", "cm/s", 0.01, 0.0)].into();
    HandWritten {
        info,
        rates: cart_rates,
    }
}

fn table(interpolation: Interpolation, times: &[f64], values: &[f64]) -> SignalTable {
    SignalTable {
        name: "w".into(),
        times: times.to_vec().into(),
        values: values.to_vec().into(),
        interpolation,
    }
}

fn no_signal() -> SignalTable {
    table(Interpolation::Hold, &[0.0], &[0.0])
}

/// Piecewise polynomials of low degree are integrated exactly up to rounding.
const ROUNDING: f64 = 1e-13;

#[test]
fn held_inputs_are_integrated_exactly() {
    let model = cart(no_signal());
    let inputs = TabulatedInputs::held(&[0.0, 0.1, 0.7], &[vec![2.0, -6.0, 0.0]]).unwrap();
    // v = 0.1, then 0.1 − 3 · 0.6; x by the areas under v.
    let v = 0.1 - 1.8;
    let x = 1.0 + 0.005 + 0.1 * 0.6 - 1.5 * 0.36 + v * 0.3;
    for method in [Method::Dop853, Method::Dopri5, Method::Rk4 { step: 0.5 }] {
        let trajectory = Simulation {
            inputs: &inputs,
            span: [0.0, 1.0],
            method,
            ..Simulation::new(&model)
        }
        .run()
        .unwrap();
        assert!((trajectory.last_state()[0] - v).abs() < ROUNDING);
        assert!((trajectory.last_state()[1] - x).abs() < ROUNDING);
        assert_eq!(trajectory.statistics.rejected, 0);
        assert!(trajectory.times().contains(&0.1) && trajectory.times().contains(&0.7));
    }
}

#[test]
fn signals_of_the_model_drive_it() {
    let times: Vec<f64> = (0..=20).map(|i| f64::from(i) / 20.0 * PI).collect();
    let values: Vec<f64> = times.iter().map(|t| t.sin()).collect();
    let table = table(Interpolation::Cubic, &times, &values);
    let signal = Signal::new(&table).unwrap();
    let model = cart(table);
    let trajectory = Simulation {
        span: [0.0, 3.0],
        ..Simulation::new(&model)
    }
    .run()
    .unwrap();
    let expected = signal.derivative(3.0, 1) - signal.derivative(0.0, 1);
    assert!((trajectory.last_state()[0] - expected).abs() < ROUNDING);
    assert!((trajectory.inputs(trajectory.len() - 1)[1] - signal.value(3.0)).abs() < ROUNDING);
}

#[test]
fn a_spline_that_ends_steeply_costs_no_rejected_step() {
    // Its first derivative jumps where the signal begins and where it is held.
    let mut model = cart(table(
        Interpolation::Cubic,
        &[0.2, 0.5, 0.6],
        &[0.0, 2.0, 1.0],
    ));
    model.info.signal_inputs = vec![(0, 0), (0, 1)].into();
    for method in [Method::Dop853, Method::Dopri5] {
        let trajectory = Simulation {
            span: [0.0, 1.0],
            method,
            ..Simulation::new(&model)
        }
        .run()
        .unwrap();
        // The integral of the derivative is the signal itself.
        assert!((trajectory.last_state()[0] - 1.0).abs() < ROUNDING);
        let cost = trajectory.statistics;
        assert!(cost.rejected == 0 && cost.steps < 20, "{cost:?}");
        for knot in [0.2, 0.5, 0.6] {
            assert!(trajectory.times().contains(&knot));
        }
    }
}

#[test]
fn a_natural_spline_follows_a_sine_and_its_derivatives() {
    let times: Vec<f64> = (0..=40).map(|i| f64::from(i) / 40.0 * PI).collect();
    let values: Vec<f64> = times.iter().map(|t| t.sin()).collect();
    let signal = Signal::new(&table(Interpolation::Cubic, &times, &values)).unwrap();
    for i in 0..=97 {
        let t = f64::from(i) / 97.0 * PI;
        // Errors of order h⁴, h³, h² of the spacing 0.08.
        assert!((signal.value(t) - t.sin()).abs() < 1e-6);
        assert!((signal.derivative(t, 1) - t.cos()).abs() < 2e-5 || i == 97);
        assert!((signal.derivative(t, 2) + t.sin()).abs() < 1e-3);
    }
    assert!(signal.derivative(1.0, 3).is_nan());
    for (i, &t) in times.iter().enumerate() {
        assert!((signal.value(t) - values[i]).abs() <= f64::EPSILON);
    }
}

#[test]
fn held_and_linear_signals_keep_their_end_values() {
    let held = Signal::new(&table(
        Interpolation::Hold,
        &[1.0, 2.0, 4.0],
        &[5.0, 6.0, 8.0],
    ))
    .unwrap();
    let linear = Signal::new(&table(
        Interpolation::Linear,
        &[1.0, 2.0, 4.0],
        &[5.0, 6.0, 8.0],
    ))
    .unwrap();
    let at = |signal: &Signal, order| {
        [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0]
            .map(|t| signal.derivative(t, order).to_string())
            .join(" ")
    };
    assert_eq!(at(&held, 0), "5 5 5 6 6 8 8");
    assert_eq!(at(&held, 1), "0 0 0 0 0 0 0");
    assert_eq!(at(&linear, 0), "5 5 5.5 6 7 8 8");
    assert_eq!(at(&linear, 1), "0 1 1 1 1 0 0");
    assert_eq!(at(&linear, 2), "0 0 0 0 0 0 0");
}

#[test]
fn tables_that_are_no_functions_of_time_are_refused() {
    let refused = |times: &[f64], values: &[f64]| {
        Signal::new(&table(Interpolation::Cubic, times, values)).unwrap_err()
    };
    assert!(matches!(refused(&[], &[]), SignalError::Empty { .. }));
    assert!(matches!(
        refused(&[0.0], &[]),
        SignalError::Lengths {
            times: 1,
            values: 0,
            ..
        }
    ));
    assert_eq!(
        refused(&[0.0, 0.0], &[1.0, 2.0]).to_string(),
        "signal `w`: time 0 s of row 1 is not later than the row before"
    );
    assert!(matches!(
        refused(&[0.0], &[f64::NAN]),
        SignalError::ValueNotFinite { row: 0, .. }
    ));
    let model = cart(table(Interpolation::Hold, &[], &[]));
    assert!(matches!(
        Simulation::new(&model).run(),
        Err(SimulationError::Signal(_))
    ));
}

#[test]
fn a_uniform_grid_has_every_sample_and_the_end() {
    let model = cart(no_signal());
    let constant = |_: f64, _: &[f64], u: &mut [f64]| u[0] = 4.0;
    let trajectory = Simulation {
        inputs: &constant,
        sampling: Sampling::Every(0.1),
        span: [0.0, 1.0],
        ..Simulation::new(&model)
    }
    .run()
    .unwrap();
    assert_eq!(trajectory.len(), 11);
    for (row, &t) in trajectory.times().iter().enumerate() {
        assert!((t - 0.1 * row as f64).abs() < ROUNDING);
        assert!((trajectory.state(row)[1] - (1.0 + t * t)).abs() < ROUNDING);
    }
    assert_eq!(trajectory.times()[10].to_bits(), 1f64.to_bits());
    assert_eq!(trajectory.ending, Some(Ending::Finished));
}

#[test]
fn a_terminal_event_adds_its_state_to_the_grid() {
    let model = cart(no_signal());
    let constant = |_: f64, _: &[f64], u: &mut [f64]| u[0] = 4.0;
    let trajectory = Simulation {
        inputs: &constant,
        sampling: Sampling::Every(0.5),
        events: vec![Event::terminal(Direction::Rising, |_, x| x[1] - 2.69)],
        ..Simulation::new(&model)
    }
    .run()
    .unwrap();
    assert_eq!(trajectory.ending, Some(Ending::Event(0)));
    assert_eq!(trajectory.len(), 4);
    assert!((trajectory.times()[3] - 1.3).abs() < ROUNDING);
    assert_eq!(trajectory.events.len(), 1);
}

#[test]
fn switching_times_of_a_closure_are_landed_on() {
    let model = cart(no_signal());
    let inputs = SwitchedInputs {
        function: |t: f64, _: &[f64], u: &mut [f64]| u[0] = if t < 0.25 { 8.0 } else { 0.0 },
        switching_times: vec![0.25],
    };
    assert_eq!(inputs.switching_times(), [0.25]);
    let seen = RefCell::new(Vec::new());
    let trajectory = Simulation {
        inputs: &inputs,
        span: [0.0, 1.0],
        progress: Some(Box::new(|t| seen.borrow_mut().push(t))),
        ..Simulation::new(&model)
    }
    .run()
    .unwrap();
    assert!((trajectory.last_state()[0] - 1.0).abs() < ROUNDING);
    assert_eq!(*seen.borrow(), trajectory.times()[1..]);
}

#[test]
fn a_trajectory_is_written_in_the_units_of_the_spec() {
    let model = cart(no_signal());
    let inputs = |_: f64, _: &[f64], u: &mut [f64]| u.copy_from_slice(&[4.0, f64::NAN, 1e-7]);
    let extras = Extras {
        outputs: true,
        energies: true,
        ..Extras::default()
    };
    let (times, states) = (vec![0.0, 0.1], [0.0, 1.0, 0.5, 1e20]);
    let trajectory = Trajectory::evaluate(&model, &[2.0], times, &states, inputs, extras);
    let written = |options| {
        let mut bytes = Vec::new();
        trajectory.write_csv(&mut bytes, options).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    let bare = "\
t,v,x,F,w,w_ddot,speed,kinetic_energy,potential_energy,power
0.0,0.0,1.0,4.0,nan,1e-7,0.0,0.0,0.0,0.0
0.1,50.0,1e20,4.0,nan,1e-7,50.0,0.125,0.0,0.0
";
    assert_eq!(written(CsvOptions { comments: false }), bare);
    let comments = "\
# mechanism: cart
# parameters: m = 2.0 kg
# units: s, cm/s, m, N, m, m/s^2, cm/s, J, J, W
";
    assert_eq!(written(CsvOptions::default()), format!("{comments}{bare}"));
    assert_eq!(trajectory.column_in_unit("v").unwrap()[1].to_string(), "50");
}

#[test]
fn vectors_of_the_wrong_length_are_refused() {
    let model = cart(no_signal());
    let error = Simulation {
        initial_state: vec![0.0],
        ..Simulation::new(&model)
    }
    .run()
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "initial state: 1 numbers given, 2 needed"
    );
    let sampling = Sampling::Every(0.0);
    let error = Simulation {
        sampling,
        ..Simulation::new(&model)
    }
    .run()
    .unwrap_err();
    assert_eq!(error.to_string(), "the sampling interval cannot be 0 s");
}

//! Inputs along straight lines and splines from row to row: the likelihood, its gradient and its tangent.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_estimate::{Direction, Estimation, Measured, Recording, Setup, Unknown};
use appell_runtime::model::Interpolation;

/// Two forces on a carriage with a spring that hardens, and an accelerometer that feels them at once.
const CARRIAGE: &str = r#"
[mechanism]
name  = "carriage_on_lines"
title = "A carriage on a spring"
[parameters]
m = { value = 1.3, unit = "kg" }
c = { value = 0.7, unit = "N*s/m" }
k = { value = 20, unit = "N/m" }
h = { value = 300, unit = "N/m^3" }
[coordinates]
x = { unit = "m" }
[inputs]
F = { unit = "N" }
B = { unit = "N" }
[points]
G = { from = "O", in = "ground", at = ["x", 0, 0] }
[bodies.carriage]
centre = "G"
mass   = "m"
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s" }
[loads]
push = { kind = "generalized", coordinate = "x", force = "F + B" }
spring = { kind = "generalized", coordinate = "x", force = "-k*x - h*x*x*x - c*dot(x)" }
[outputs]
felt = { value = "(F + B - k*x - h*x*x*x - c*v)/m", unit = "m/s^2" }
"#;

/// Differences of order four of sums of some hundred terms.
const TOLERANCE: f64 = 1e-6;

const RUNNING_ON: [Interpolation; 2] = [Interpolation::Linear, Interpolation::Cubic];

fn carriage() -> JitModel {
    let program = appell_codegen::compile("carriage.toml", CARRIAGE, &FunctionKind::ALL).unwrap();
    JitModel::new(&program).unwrap()
}

/// Rows `step` s apart; what is measured there is smooth, not what the model does.
fn recording(rows: u32, step: f64, channels: usize, between: Interpolation) -> Recording {
    let times: Vec<f64> = (0..rows).map(|row| step * f64::from(row)).collect();
    let inputs = times.iter();
    let inputs = inputs.flat_map(|t| [(9.0 * t).sin(), 0.6 * (13.0 * t).cos()]);
    let measured = times.iter();
    let measured = measured.flat_map(|t| {
        let seen = [0.05 * (5.0 * t).sin(), 0.3 * (7.0 * t).cos(), 0.2 * t.sin()];
        seen[..channels].to_vec()
    });
    let (inputs, measured) = (inputs.collect(), measured.collect());
    let recording = Recording::new(times, inputs, measured).unwrap();
    recording.interpolated(&[between; 2]).unwrap()
}

fn values(estimation: &Estimation<'_>, sizes: &[(Unknown, f64)]) -> Vec<f64> {
    let (layout, setup) = (estimation.layout(), estimation.setup());
    let mut values = estimation.nominal();
    let mut set = |unknown, value| values[layout.place(unknown).unwrap()] = value;
    for index in 0..setup.disturbances.len() {
        set(Unknown::Disturbance(index), 0.05);
    }
    for index in 0..setup.channels.len() {
        set(Unknown::Noise(index), 0.02);
    }
    let states = setup.model.info().state_len() + setup.lagging.len();
    for state in 0..states {
        set(Unknown::Spread { run: 0, state }, 0.1);
    }
    for (unknown, value) in sizes {
        set(*unknown, *value);
    }
    values
}

#[test]
fn the_gradient_is_exact_in_delays_of_inputs_and_channels() {
    for between in RUNNING_ON {
        exact_in_delays(between);
    }
}

fn exact_in_delays(between: Interpolation) {
    let model = carriage();
    let seen = [Measured::State(1), Measured::Output(0), Measured::Output(0)];
    let mut setup = Setup::new(&model, &seen);
    setup.channels[1].longest_delay = Some(0.03);
    setup.lagging = vec![1];
    setup.delayed = vec![0, 1];
    setup.longest_step = 0.006;
    let recordings = [recording(60, 0.01, 3, between)];
    let estimation = Estimation::new(&setup, &recordings).unwrap();
    let layout = estimation.layout();
    let values = values(
        &estimation,
        &[
            (Unknown::SensorDelay(1), 0.0123),
            (Unknown::Lag(0), 0.03),
            (Unknown::InputDelay(0), 0.0137),
            (Unknown::InputDelay(1), 0.0042),
        ],
    );
    let (_, gradient) = estimation.gradient(&values).unwrap();
    for unknown in [
        Unknown::SensorDelay(1),
        Unknown::Lag(0),
        Unknown::InputDelay(0),
        Unknown::InputDelay(1),
        Unknown::Parameter(0),
        Unknown::Parameter(3),
        Unknown::Disturbance(0),
    ] {
        let place = layout.place(unknown).unwrap();
        let h = 1e-4 * values[place].abs().max(1e-2);
        let at = |offset: f64| {
            let mut varied = values.clone();
            varied[place] += offset * h;
            estimation.log_likelihood(&varied).unwrap()
        };
        let wanted = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
        let error = (gradient[place] - wanted).abs();
        let scale = wanted.abs().max(1.0 / values[place].abs());
        assert!(
            error < TOLERANCE * scale,
            "{unknown:?}: {} against {wanted}",
            gradient[place]
        );
    }
}

#[test]
fn the_tangent_knows_what_a_late_input_does() {
    for between in RUNNING_ON {
        known_when_late(between);
    }
}

fn known_when_late(between: Interpolation) {
    let model = carriage();
    let mut setup = Setup::new(&model, &[Measured::State(1), Measured::Output(0)]);
    setup.longest_step = 0.002;
    // Without disturbances and uncertainty of the start the gains are zero, and the tangent is the derivative.
    setup.disturbances.clear();
    let recordings = [recording(40, 0.02, 2, between)];
    let residuals = |delay: f64| {
        let mut setup = setup.clone();
        setup.delayed = vec![0];
        let estimation = Estimation::new(&setup, &recordings).unwrap();
        let spread = |state| (Unknown::Spread { run: 0, state }, 0.0);
        let values = values(
            &estimation,
            &[spread(0), spread(1), (Unknown::InputDelay(0), delay)],
        );
        let innovations = estimation.innovations(&values).unwrap();
        let all = innovations.into_iter().flatten();
        all.map(|one| one.residual).collect::<Vec<f64>>()
    };
    // Differences about a delay that lies between two rows, and keeps to one side of the kinks.
    let [delay, h] = [0.011, 1e-4];
    let mut late = setup.clone();
    late.delayed = vec![0];
    let estimation = Estimation::new(&late, &recordings).unwrap();
    let spread = |state| (Unknown::Spread { run: 0, state }, 0.0);
    let values = values(
        &estimation,
        &[spread(0), spread(1), (Unknown::InputDelay(0), delay)],
    );
    let directions = [Direction::LateInput(0)];
    let tangent = estimation.tangent(&values, &directions, None).unwrap();
    let (above, below) = (residuals(delay + h), residuals(delay - h));
    for (row, (above, below)) in above.into_iter().zip(below).enumerate() {
        let wanted = (above - below) / (2.0 * h) / 0.02;
        let found = tangent.slopes[(0, row)];
        // The tangent takes slopes at the middle of steps.
        assert!(
            (found - wanted).abs() < 0.02,
            "{row}: {found} against {wanted}"
        );
    }
}

#[test]
fn rows_far_apart_do_what_a_fine_table_of_the_curves_does() {
    for between in RUNNING_ON {
        as_a_fine_table(between);
    }
}

fn as_a_fine_table(between: Interpolation) {
    let model = carriage();
    let mut setup = Setup::new(&model, &[Measured::State(1)]);
    // Both take the same steps between their rows.
    setup.longest_step = 2.5e-3;
    let coarse = recording(40, 0.05, 1, between);
    let fine = {
        let parts = 50_u32;
        let times: Vec<f64> = (0..=39 * parts)
            .map(|row| 0.05 / f64::from(parts) * f64::from(row))
            .collect();
        let value = |t: f64, input: usize| {
            let next = coarse.times().partition_point(|own| *own <= t).min(39);
            let row = next - 1;
            let [c0, c1, c2, c3] = coarse.polynomial(row, input);
            let t = t - coarse.times()[row];
            c0 + t * (c1 + t * (c2 + t * c3))
        };
        // Means of the curves, held.
        let half = 0.5 * 0.05 / f64::from(parts);
        let inputs = times.iter();
        let inputs = inputs.flat_map(|t| [value(t + half, 0), value(t + half, 1)]);
        let rows = times.iter().enumerate();
        let measured = rows.map(|(row, _)| {
            let (row, rest) = (row / parts as usize, row % parts as usize);
            if rest == 0 {
                coarse.measured(row)[0]
            } else {
                f64::NAN
            }
        });
        let (inputs, measured) = (inputs.collect(), measured.collect());
        Recording::new(times.clone(), inputs, measured).unwrap()
    };
    let errors = |recording: Recording| {
        let recordings = [recording];
        let estimation = Estimation::new(&setup, &recordings).unwrap();
        let values = values(&estimation, &[]);
        let predicted = estimation.predictions(&values, 0, f64::INFINITY, &[0]);
        let predicted = predicted.unwrap().into_iter();
        predicted.map(|one| one.residual).collect::<Vec<f64>>()
    };
    let (coarse, fine) = (errors(coarse), errors(fine));
    assert_eq!(coarse.len(), fine.len());
    for (coarse, fine) in coarse.iter().zip(&fine) {
        // Squares of the fine step in s, times the frequency: 1e-5 of motions of some centimetres.
        assert!((coarse - fine).abs() < 1e-6, "{coarse} against {fine}");
    }
}

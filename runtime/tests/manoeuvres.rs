//! The simulation alone, on equations written by hand: closed-loop manoeuvres of a steered unicycle
//! against published and recomputed values, and a
//! wheel that falls over. The equations are written by hand from the literature (Vizi, Orosz,
//! Takács and Stépán, *Steering Control of an Autonomous Unicycle*, corrected).

// A failed simulation fails the test.
#![allow(clippy::unwrap_used)]

use crate::common::{HandWritten, info, si};
use appell_runtime::inputs::{InputSource, SwitchedInputs};
use appell_runtime::integrate::{Cause, Options};
use appell_runtime::model::At;
use appell_runtime::simulate::{Method, Sampling, Simulation, SimulationError};
use std::f64::consts::{FRAC_PI_4, PI};

const WHEEL_MASS: f64 = 10.0;
const SLIDER_MASS: f64 = 5.0;
const RADIUS: f64 = 0.3;
const GRAVITY: f64 = 9.81;

/// Rolling without slip, common to wheel and unicycle: ψ̇, φ̇, ẋ, ẏ.
fn rolling(w1: f64, w2: f64, w3: f64, theta: f64, psi: f64) -> [f64; 4] {
    let (sin_psi, cos_psi) = psi.sin_cos();
    let across = w1 * RADIUS * theta.cos();
    [
        w3 / theta.cos(),
        w2 - w3 * theta.tan(),
        across * sin_psi + w2 * RADIUS * cos_psi,
        -across * cos_psi + w2 * RADIUS * sin_psi,
    ]
}

/// State ω₁ ω₂ ω₃ σ, θ r ψ φ x y; input the force between wheel and slider.
fn unicycle_rates(at: At<'_>, rates: &mut [f64]) {
    let &[w1, w2, w3, s, th, r, psi, _, _, _] = at.x else {
        panic!("ten states")
    };
    let (m, m0, radius, g, u) = (WHEEL_MASS, SLIDER_MASS, RADIUS, GRAVITY, at.u[0]);
    let (sin, cos) = th.sin_cos();
    let tan = sin / cos;
    let r2 = radius * radius;
    let d1 = 5.0 * m * r2 + 4.0 * m0 * r * r;
    let d2 = 3.0 * m * r2 + 2.0 * m0 * r2 + 12.0 * m0 * r * r;
    let w1_dot = (4.0 * m0 * radius * r * w1 * w1
        - (m * r2 + 4.0 * m0 * r * r) * tan * w3 * w3
        - 8.0 * m0 * r * w1 * s
        + 2.0 * radius * (3.0 * m * radius + 2.0 * m0 * r * tan) * w2 * w3
        - 4.0 * m0 * g * r * cos
        + 4.0 * m * g * radius * sin
        + 4.0 * radius * u)
        / d1;
    let w2_dot = 2.0
        * (-2.0 * m0 * radius * r * w1 * w2 - (m * r2 + m0 * r2 + 4.0 * m0 * r * r) * w1 * w3
            + 2.0 * m0 * radius * w3 * s)
        / d2;
    let w3_dot = (-2.0 * (3.0 * m + 2.0 * m0) * r2 * w1 * w2
        + (3.0 * m * r2 * tan + 2.0 * m0 * (r2 * tan + 2.0 * radius * r + 6.0 * r * r * tan))
            * w1
            * w3
        - 24.0 * m0 * r * w3 * s)
        / d2;
    let s_dot = radius * w1_dot + r * w1 * w1 - radius * w2 * w3 + r * w3 * w3 - g * sin + u / m0;
    rates[..6].copy_from_slice(&[w1_dot, w2_dot, w3_dot, s_dot, w1, s]);
    rates[6..].copy_from_slice(&rolling(w1, w2, w3, th, psi));
}

fn unicycle(speed: f64) -> HandWritten {
    let states = vec![
        si("omega_1", "rad/s", 0.0),
        si("omega_2", "rad/s", speed / RADIUS),
        si("omega_3", "rad/s", 0.0),
        si("sigma", "m/s", 0.0),
        si("theta", "rad", 0.0),
        si("r", "m", 0.0),
        si("psi", "rad", 0.0),
        si("phi", "rad", 0.0),
        si("x_G", "m", 0.0),
        si("y_G", "m", 0.0),
    ];
    let info = info("unicycle", states, 4, vec![si("u", "N", 0.0)], Vec::new());
    HandWritten {
        info,
        rates: unicycle_rates,
    }
}

/// All poles at −8 1/s.
const POLE: f64 = 8.0;

/// Gains on θ̇, θ, ṙ, r, ψ, y that place six poles for a lane change.
fn lane_change_gains(speed: f64) -> [f64; 6] {
    let (m, m0, r, g, p) = (WHEEL_MASS, SLIDER_MASS, RADIUS, GRAVITY, POLE);
    let f2 = (speed / r).powi(2);
    let (p2, p4, p6) = (p.powi(2), p.powi(4), p.powi(6));
    let q = 12.0 * f2 * r * m + 8.0 * f2 * r * m0 + g * m;
    let d_theta = -5.0
        * r
        * m
        * p
        * (-36.0 * f2 * r * g * m - 24.0 * f2 * r * g * m0
            + 15.0 * r * r * m * p4
            + 12.0 * r * r * m0 * p4
            + 50.0 * r * g * m * p2
            + 40.0 * r * g * m0 * p2
            + 12.0 * g * g * (m + m0))
        / (2.0 * g * q);
    let p_theta = m
        * (-96.0 * f2.powi(3) * r * r * g * (3.0 * m + 2.0 * m0)
            + 600.0 * f2 * f2 * r * r * g * p2 * (3.0 * m + 2.0 * m0)
            + 48.0 * f2 * f2 * r * g * g * (4.0 * m + 3.0 * m0)
            + 10.0 * f2 * r.powi(3) * m * p6
            - 150.0 * f2 * r * r * g * p4 * (5.0 * m + 4.0 * m0)
            - 600.0 * f2 * r * g * g * p2 * (m + m0)
            - 8.0 * f2 * g.powi(3) * (4.0 * m + 5.0 * m0)
            + 5.0 * r * r * g * m * p6)
        / (8.0 * f2 * g * q);
    let d_r = 10.0 * m * m0 * p * (r * p2 + 3.0 * g) * (3.0 * r * p2 + g) / (g * q);
    let p_r = m0
        * (-4.0 * f2 * r * g * g * (3.0 * m + 2.0 * m0)
            + 5.0 * r.powi(3) * m * p6
            + 75.0 * r * r * g * m * p4
            + 75.0 * r * g * g * m * p2
            + 4.0 * g.powi(3) * m)
        / (r * g * q);
    let p_psi = 15.0 * r * r * m * p.powi(5) / (4.0 * f2.sqrt() * g);
    let p_y = 5.0 * r * m * p6 / (8.0 * f2 * g);
    [d_theta, p_theta, d_r, p_r, p_psi, p_y]
}

/// Gains on θ̇, θ, ṙ, r, ψ that place five poles for a turn.
fn turn_gains(speed: f64) -> [f64; 5] {
    let (m, m0, r, g, p) = (WHEEL_MASS, SLIDER_MASS, RADIUS, GRAVITY, POLE);
    let f2 = (speed / r).powi(2);
    let (p2, p4) = (p.powi(2), p.powi(4));
    let q = 12.0 * f2 * r * m + 8.0 * f2 * r * m0 + g * m;
    let d_theta = -5.0
        * r
        * m
        * p
        * (-20.0 * f2 * r * g * (3.0 * m + 2.0 * m0)
            + r * r * p4 * (5.0 * m + 4.0 * m0)
            + 10.0 * r * g * p2 * (5.0 * m + 4.0 * m0)
            + 20.0 * g * g * (m + m0))
        / (4.0 * g * q);
    let p_theta = -m
        * (48.0 * f2 * f2 * r * r * (3.0 * m + 2.0 * m0)
            - 200.0 * f2 * r * r * p2 * (3.0 * m + 2.0 * m0)
            - 24.0 * f2 * r * g * (4.0 * m + 3.0 * m0)
            + 25.0 * r * r * p4 * (5.0 * m + 4.0 * m0)
            + 200.0 * r * g * p2 * (m + m0)
            + 4.0 * g * g * (4.0 * m + 5.0 * m0))
        / (4.0 * q);
    let d_r = 5.0 * m * m0 * p * (r * r * p4 + 10.0 * r * g * p2 + 5.0 * g * g) / (g * q);
    let p_r = m0
        * (-4.0 * f2 * r * g * (3.0 * m + 2.0 * m0)
            + 25.0 * r * r * m * p4
            + 50.0 * r * g * m * p2
            + 4.0 * g * g * m)
        / (r * q);
    let p_psi = 5.0 * r * r * m * p.powi(5) / (8.0 * f2.sqrt() * g);
    [d_theta, p_theta, d_r, p_r, p_psi]
}

/// From 0 to −2 `amplitude` between t = 2 s and t = 7 s along a cosine.
fn cosine_ramp(amplitude: f64, t: f64) -> f64 {
    if t < 2.0 {
        0.0
    } else if t < 7.0 {
        amplitude * ((PI * (t - 2.0) / 5.0).cos() - 1.0)
    } else {
        -2.0 * amplitude
    }
}

const SELECTED: [usize; 6] = [0, 4, 3, 5, 6, 9];

/// u = −K (y − y*), where y* is the ramp for the last selected state and zero for the others.
fn feedback(gains: &[f64], amplitude: f64) -> impl InputSource {
    let selected = &SELECTED[..gains.len()];
    SwitchedInputs {
        function: move |t: f64, x: &[f64], u: &mut [f64]| {
            let sum: f64 = gains.iter().zip(selected).map(|(k, &i)| k * x[i]).sum();
            let last = gains.last().copied().unwrap_or_default();
            u[0] = last * cosine_ramp(amplitude, t) - sum;
        },
        switching_times: vec![2.0, 7.0],
    }
}

/// The published values have 9 to 10 digits; positions reach 50 m.
const FINAL_STATE_TOLERANCE: f64 = 1e-8;

/// Greatest values are taken over samples, not at the peak itself: ü τ²/2 with ü up to 200 N/s²
/// and a distance τ up to 0.1 ms from the peak.
const GREATEST_TOLERANCE: f64 = 1e-6;

fn check(speed: f64, feedback: &dyn InputSource, final_state: [f64; 10], greatest: [f64; 3]) {
    let model = unicycle(speed);
    let trajectory = Simulation {
        inputs: feedback,
        options: Options::with_tolerances(1e-11, 1e-11),
        sampling: Sampling::Every(2e-4),
        ..Simulation::new(&model)
    }
    .run()
    .unwrap();
    assert_eq!(trajectory.len(), 50_001);
    for (i, (found, expected)) in trajectory.last_state().iter().zip(final_state).enumerate() {
        assert!(
            (found - expected).abs() < FINAL_STATE_TOLERANCE,
            "state {i}: {found} {expected}"
        );
    }
    for (name, expected) in ["u", "theta", "r"].into_iter().zip(greatest) {
        let column = trajectory.column(name).unwrap();
        let found = column
            .iter()
            .fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
        assert!(
            (found - expected).abs() < GREATEST_TOLERANCE,
            "{name}: {found} {expected}"
        );
    }
}

#[test]
fn the_lane_change_at_one_metre_per_second_ends_where_published() {
    let final_state = [
        -5.648_912_025e-7,
        3.333_333_980_190_88,
        -5.860_244_171_9e-7,
        -1.511_310_771_2e-6,
        3.966_962_053_82e-5,
        3.583_686_044_91e-5,
        8.811_774_952e-8,
        33.447_439_566_307_2,
        9.187_490_865_058_17,
        -2.500_027_773_198_79,
    ];
    let greatest = [
        3.015_014_597_946_22,
        0.086_765_781_433_263,
        0.017_703_342_729_159,
    ];
    check(
        1.0,
        &feedback(&lane_change_gains(1.0), 1.25),
        final_state,
        greatest,
    );
}

#[test]
fn the_turn_at_five_metres_per_second_ends_where_published() {
    let final_state = [
        1.607_879_339e-8,
        16.666_941_938_815_8,
        1.023_630_871e-7,
        1.779_405_238e-6,
        -2.649_364_233e-5,
        -2.412_063_354e-5,
        -1.570_799_388_968_94,
        167.129_575_936_459,
        28.332_414_442_113_5,
        -27.113_357_277_168_8,
    ];
    let greatest = [
        16.791_198_612_849_6,
        0.034_671_263_181_613,
        0.269_939_263_525_995,
    ];
    check(
        5.0,
        &feedback(&turn_gains(5.0), FRAC_PI_4),
        final_state,
        greatest,
    );
}

/// State ω₁ ω₂ ω₃, θ ψ φ x y of a thin disc.
fn wheel_rates(at: At<'_>, rates: &mut [f64]) {
    let &[w1, w2, w3, th, psi, _, _, _] = at.x else {
        panic!("eight states")
    };
    let tan = th.tan();
    rates[0] = 1.2 * w2 * w3 - 0.2 * w3 * w3 * tan + 0.8 * GRAVITY / RADIUS * th.sin();
    rates[1] = -2.0 / 3.0 * w1 * w3;
    rates[2] = -2.0 * w1 * w2 + w1 * w3 * tan;
    rates[3] = w1;
    rates[4..].copy_from_slice(&rolling(w1, w2, w3, th, psi));
}

fn wheel(tilt: f64, tilt_range: [f64; 2]) -> HandWritten {
    let mut theta = si("theta", "rad", tilt);
    theta.range = tilt_range;
    let states = vec![
        si("omega_1", "rad/s", 0.0),
        si("omega_2", "rad/s", 1.0),
        si("omega_3", "rad/s", 0.0),
        theta,
        si("psi", "rad", 0.0),
        si("phi", "rad", 0.0),
        si("x_G", "m", 0.0),
        si("y_G", "m", 0.0),
    ];
    HandWritten {
        info: info("wheel", states, 3, Vec::new(), Vec::new()),
        rates: wheel_rates,
    }
}

#[test]
fn a_wheel_that_falls_over_ends_in_a_typed_error() {
    let model = wheel(0.1, [-1.0, 1.0]);
    for method in [Method::Dop853, Method::Dopri5, Method::Rk4 { step: 1e-3 }] {
        let error = Simulation {
            method,
            ..Simulation::new(&model)
        }
        .run()
        .unwrap_err();
        let message = error.to_string();
        assert!(
            message.contains("`theta` leaves its range -1 … 1 rad; state: omega_1 ="),
            "{message}"
        );
        let SimulationError::Integration {
            failure,
            trajectory,
        } = error
        else {
            panic!("{message}")
        };
        let Cause::OutOfRange { component, .. } = failure.cause else {
            panic!("{message}")
        };
        let (t, value) = (failure.t, failure.state[component]);
        // Where the interpolant meets the limit, to the spacing of `f64`.
        assert!((value - 1.0).abs() < 1e-12, "{value}");
        assert!(trajectory.statistics.steps > 0);
        assert_eq!(trajectory.statistics, failure.statistics);
        assert!(
            trajectory
                .times()
                .last()
                .is_some_and(|last| (last - t).abs() < 1e-12)
        );
        assert!(
            trajectory
                .column("theta")
                .unwrap()
                .iter()
                .all(|theta| theta.is_finite())
        );
    }
}

#[test]
fn a_wheel_that_falls_without_a_declared_range_never_yields_nan() {
    let model = wheel(0.1, [f64::NEG_INFINITY, f64::INFINITY]);
    let states = match Simulation::new(&model).run() {
        Ok(trajectory) => trajectory,
        Err(SimulationError::Integration { trajectory, .. }) => *trajectory,
        Err(error) => panic!("{error}"),
    };
    assert!(states.last_state().iter().all(|value| value.is_finite()));
}

#[test]
fn a_start_outside_the_range_is_refused() {
    let model = wheel(1.2, [-1.0, 1.0]);
    let error = Simulation::new(&model).run().unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("at t = 0.000000000 s `theta` leaves"),
        "{error}"
    );
}

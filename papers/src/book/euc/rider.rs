//! A rider who keeps an electric unicycle upright, follows a speed and a heading, and sways.

use std::f64::consts::PI;

use appell_analysis::control::lqr::{self, weights};
use appell_analysis::control::operating_point::OperatingPoint;
use appell_analysis::control::reduction::reduce;
use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_runtime::integrate::Options;
use appell_runtime::model::Model;
use appell_runtime::simulate::Sampling;
use appell_runtime::{Simulation, Trajectory};
use nalgebra::{DMatrix, DVector};

use super::capture::Random;
use crate::book::{Result, computation, edited, parameter, rows, shipped, state};

/// Frames a second of the capture.
pub(super) const RATE: f64 = 120.0;
/// The spatial model of the gallery.
pub(super) const SPATIAL: &str = "euc_spatial";
/// Twist torque of the contact patch: a thin wheel with point contact has none, but a rider who
/// twists the upper body uses it.
pub(super) const TWIST: [(&str, &str); 2] = [
    (
        "[frames]",
        "M_z = { unit = \"N*m\", about = \"torque of the ground on the tyre, drawn by the rider's twisting\" }\n\n[frames]",
    ),
    (
        "[outputs]",
        "twist = { kind = \"torque\", on = \"body\", in = \"yawed\", vector = [0, 0, \"M_z\"], about = \"torque of the contact patch\" }\n\n[outputs]",
    ),
];
/// States of the feedback of the rider, with their weights.
const FELT: [(&str, f64); 11] = [
    ("v", 20.0),
    ("omega_1", 10.0),
    ("omega_3", 100.0),
    ("gamma_dot", 1.0),
    ("phi_dot", 1.0),
    ("beta_dot", 1.0),
    ("theta", 100.0),
    ("gamma", 400.0),
    ("phi", 10.0),
    ("beta", 100.0),
    ("psi", 400.0),
];
/// Weights of the torques: motor, ankles, hips, twist.
const EFFORT: [f64; 4] = [0.01, 0.01, 0.01, 0.03];
/// Amplitudes of the sway torques in N m, ankles and hips.
const SWAY: [f64; 2] = [3.0, 2.0];
/// Angular frequencies of sways in rad/s.
const FREQUENCIES: [f64; 4] = [2.0, 3.3, 5.0, 7.5];

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Manoeuvre {
    ConstantSpeed,
    Acceleration,
    Deceleration,
    FigureEight,
}

impl Manoeuvre {
    pub(super) const ALL: [Self; 4] = [
        Self::ConstantSpeed,
        Self::Acceleration,
        Self::Deceleration,
        Self::FigureEight,
    ];

    /// Its name in the paper.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::ConstantSpeed => "constant speed",
            Self::Acceleration => "acceleration",
            Self::Deceleration => "deceleration",
            Self::FigureEight => "figure-eight",
        }
    }

    /// Number of runs: those of table 1, ten decelerations as in figure 6.
    pub(super) const fn runs(self) -> usize {
        match self {
            Self::ConstantSpeed => 7,
            Self::Acceleration => 3,
            Self::Deceleration => 10,
            Self::FigureEight => 2,
        }
    }

    /// Length of a run in s.
    pub(super) const fn length(self) -> f64 {
        match self {
            Self::FigureEight => STRAIGHT + 2.0 * PERIOD,
            _ => 5.0,
        }
    }

    /// The frame after which the commands are smooth: turning begins with a jump, which averaged
    /// torques do not resolve.
    pub(super) const fn steady_from(self) -> usize {
        match self {
            Self::FigureEight => 300,
            _ => 0,
        }
    }

    /// The desired speed in m/s.
    fn speed(self, t: f64) -> f64 {
        let [from, to] = match self {
            Self::ConstantSpeed => [1.5, 1.5],
            Self::Acceleration => [0.6, 2.4],
            Self::Deceleration => [2.4, 0.6],
            Self::FigureEight => [0.95, 0.95],
        };
        let part = ((t - 1.2) / 1.8).clamp(0.0, 1.0);
        from + (to - from) * part * part * (3.0 - 2.0 * part)
    }

    /// The yaw angle at the beginning in rad. The two lobes of an eight lie along the ground's x axis.
    fn heading(self) -> f64 {
        match self {
            Self::FigureEight => 0.5 * PI - LOBE,
            _ => 0.0,
        }
    }

    /// The desired yaw angle in rad with two derivatives: one lobe to the left, one to the right. A lobe ends
    /// where it began because the mean of cos(LOBE (1 − cos τ)) is cos(LOBE) J₀(LOBE), and so for the sine.
    fn turn(self, t: f64) -> [f64; 3] {
        if self != Self::FigureEight || t < STRAIGHT {
            return [0.0; 3];
        }
        let w = 2.0 * PI / PERIOD;
        let (sin, cos) = (w * (t - STRAIGHT)).sin_cos();
        [LOBE * (1.0 - cos), LOBE * w * sin, LOBE * w * w * cos]
    }
}

/// Duration of a figure-eight, and of the straight part before it, in s.
const PERIOD: f64 = 12.0;
const STRAIGHT: f64 = 2.0;
/// The first root of the Bessel function J₀.
const LOBE: f64 = 2.404_825_557_695_773;

/// The spatial unicycle with a rider of this height of the centre of mass above the pedals.
pub(super) struct Rider {
    model: JitModel,
    parameters: Vec<f64>,
}

impl Rider {
    pub(super) fn new(height: f64) -> Result<Self> {
        let shipped = shipped(SPATIAL)?;
        let text = edited(shipped.spec, &TWIST)?;
        let program = appell_codegen::compile(shipped.file, &text, &FunctionKind::STANDARD)?;
        let model = JitModel::new(&program).map_err(computation)?;
        let mut parameters = model.info().default_parameters();
        parameters[parameter(model.info(), "h")?] = height;
        Ok(Self { model, parameters })
    }

    /// A ride; runs of even number go backwards.
    pub(super) fn ride(&self, manoeuvre: Manoeuvre, run: usize) -> Result<Trajectory> {
        let info = self.model.info();
        let mut random = Random::of(&format!("{} {run}", manoeuvre.name()));
        let states = FELT.iter().map(|(name, _)| state(info, name));
        let states: Vec<usize> = states.collect::<Result<_>>()?;
        let back = if run % 2 == 1 { PI } else { 0.0 };
        let heading = manoeuvre.heading() + back;
        let gain = self.gain(&states, manoeuvre.speed(2.0))?;
        let sway = |(k, frequency): (usize, &f64)| {
            let [ankles, hips] = SWAY.map(|amplitude| 1.0 / (k + 1) as f64 * amplitude);
            let w = frequency * random.between(0.8, 1.2);
            [w, ankles, hips, random.between(0.0, 2.0 * PI)]
        };
        let sways: Vec<[f64; 4]> = FREQUENCIES.iter().enumerate().map(sway).collect();
        let gravity = 9.81;
        let law = move |t: f64, x: &[f64], u: &mut [f64]| {
            let [angle, rate, change] = manoeuvre.turn(t);
            let speed = manoeuvre.speed(t);
            let lean = -(speed * rate / gravity).atan();
            let off = DVector::from_fn(states.len(), |i, _| {
                let wanted = match FELT[i].0 {
                    "v" => speed,
                    "omega_3" => rate * lean.cos(),
                    "theta" => lean,
                    "omega_1" => -speed * change / gravity * lean.cos().powi(2),
                    "psi" => heading + angle,
                    _ => 0.0,
                };
                x[states[i]] - wanted
            });
            u.copy_from_slice((-(&gain * off)).as_slice());
            for [w, ankles, hips, start] in &sways {
                u[1] += ankles * (w * t + start).sin();
                u[2] += hips * (1.1 * w * t + 2.0 * start).sin();
            }
        };
        let mut initial_state = info.initial_state();
        initial_state[state(info, "v")?] = manoeuvre.speed(0.0);
        initial_state[state(info, "psi")?] = heading;
        let motion = Simulation {
            parameters: self.parameters.clone(),
            initial_state,
            inputs: &law,
            span: [0.0, manoeuvre.length()],
            options: Options::with_tolerances(1e-10, 1e-10),
            sampling: Sampling::Every(1.0 / RATE),
            ..Simulation::new(&self.model)
        };
        motion.run().map_err(computation)
    }

    /// Linear-quadratic feedback about straight rolling.
    fn gain(&self, states: &[usize], speed: f64) -> Result<DMatrix<f64>> {
        let mut point = OperatingPoint::new(&self.model);
        point.p.clone_from(&self.parameters);
        point.x[states[0]] = speed;
        point.x[state(self.model.info(), "chi")?] = 0.0;
        let inputs: Vec<usize> = (0..EFFORT.len()).collect();
        let equations = point.equations(&inputs).map_err(computation)?;
        let reduced = reduce(&equations.system, &rows(&equations, states)?);
        let system = reduced.map_err(computation)?.system;
        let q = weights(&FELT.map(|(_, weight)| weight));
        let regulator = lqr::continuous(&system, &q, &weights(&EFFORT)).map_err(computation)?;
        Ok(regulator.gain)
    }
}

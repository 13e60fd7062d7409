//! Rides of a planar electric unicycle: manoeuvres under a rider who keeps the balance and sways.

use appell_analysis::control::lqr::{self, weights};
use appell_analysis::control::operating_point::OperatingPoint;
use appell_analysis::control::reduction::reduce;
use appell_codegen::jit::JitModel;
use appell_estimate::inverse::Record;
use appell_recordings::motion_capture::{Axes, Capture, Ride, Skeleton, Track, Vector};
use appell_runtime::Simulation;
use appell_runtime::integrate::Options;
use appell_runtime::model::Model;
use appell_runtime::simulate::Sampling;
use nalgebra::{DMatrix, DVector};

use crate::shipped;
use appell_test_kit::Random;

/// States that the rider feels.
const FELT: [&str; 5] = ["v", "gamma_dot", "phi_dot", "gamma", "phi"];
/// Frames a second.
pub const RATE: f64 = 120.0;
/// Length of a ride in s.
pub const LENGTH: f64 = 6.0;
/// Height of the pivot that is captured above the axle, and of the rider's centre above the axle, in m.
const HEIGHTS: [f64; 2] = [0.45, 0.56];
/// Standard deviations of positions in m and of angles in rad.
const NOISE: [f64; 2] = [2e-4, 0.5 * std::f64::consts::PI / 180.0];

/// What is ridden: speeds in m/s before and after.
#[derive(Debug, Clone, Copy)]
pub struct Manoeuvre {
    /// Its name.
    pub name: &'static str,
    /// Speeds at the beginning and at the end.
    pub speeds: [f64; 2],
}

/// Straight rides.
pub const MANOEUVRES: [Manoeuvre; 3] = [
    Manoeuvre {
        name: "constant speed",
        speeds: [2.0, 2.0],
    },
    Manoeuvre {
        name: "acceleration",
        speeds: [0.5, 3.0],
    },
    Manoeuvre {
        name: "deceleration",
        speeds: [3.0, 0.5],
    },
];

/// The model with formulas for its derivatives.
pub fn planar() -> &'static JitModel {
    shipped::complete_model("euc_3dof")
}

impl Manoeuvre {
    /// The desired speed: a smooth step over two seconds.
    fn speed(self, t: f64) -> f64 {
        let part = ((t - 1.5) / 2.0).clamp(0.0, 1.0);
        let [from, to] = self.speeds;
        from + (to - from) * part * part * (3.0 - 2.0 * part)
    }

    /// x, γ and φ at all frames of a ride, without noise.
    pub fn ride(self, model: &dyn Model, random: &mut Random) -> Record {
        self.long_ride(model, random, LENGTH)
    }

    /// The same for so many seconds.
    pub fn long_ride(self, model: &dyn Model, random: &mut Random, seconds: f64) -> Record {
        let info = model.info();
        let states = FELT.map(|name| info.state_index(name).unwrap());
        let equations = OperatingPoint::new(model).equations(&[0, 1]).unwrap();
        let places = states.map(|state| equations.states.iter().position(|&s| s == state).unwrap());
        let system = reduce(&equations.system, &places).unwrap().system;
        let q = weights(&[4.0, 1.0, 1.0, 40.0, 4.0]);
        let gain = lqr::continuous(&system, &q, &weights(&[0.01, 0.01]))
            .unwrap()
            .gain;
        // The rider sways: some newton metres at frequencies of the body.
        let sway: Vec<[f64; 3]> = (0..4)
            .map(|k| {
                let frequency = 2.0 + 1.5 * f64::from(k) + random.between(-0.5, 0.5);
                [
                    4.0 / (1.0 + f64::from(k)),
                    frequency,
                    random.between(0.0, std::f64::consts::TAU),
                ]
            })
            .collect();
        let rider = move |t: f64, x: &[f64], u: &mut [f64]| {
            let off = DVector::from_fn(states.len(), |i, _| {
                x[states[i]] - if i == 0 { self.speed(t) } else { 0.0 }
            });
            u.copy_from_slice((-(&gain * off)).as_slice());
            u[1] += sway
                .iter()
                .map(|[a, w, start]| a * (w * t + start).sin())
                .sum::<f64>();
        };
        let mut initial_state = info.initial_state();
        initial_state[states[0]] = self.speeds[0];
        let motion = Simulation {
            initial_state,
            inputs: &rider,
            span: [0.0, seconds],
            options: Options::with_tolerances(1e-12, 1e-12),
            sampling: Sampling::Every(1.0 / RATE),
            ..Simulation::new(model)
        };
        let motion = motion.run().unwrap();
        let columns =
            ["x", "gamma", "phi"].map(|name| DVector::from_vec(motion.column(name).unwrap()));
        Record {
            times: motion.times().to_vec(),
            values: DMatrix::from_columns(&columns),
        }
    }
}

/// The same ride as a capture sees it: the noise of the body's angle reaches the axle, whose place is
/// computed from a pivot above it, and with it the rider's angle.
pub fn seen(ride: &Record, random: &mut Random) -> Record {
    let mut values = ride.values.clone();
    for mut row in values.row_iter_mut() {
        let [place, centre] = [0, 1].map(|_| NOISE[0] * random.normal());
        let angle = NOISE[1] * random.normal();
        let axle = place - HEIGHTS[0] * angle;
        row[0] += axle;
        row[1] += angle;
        row[2] += (centre - axle) / HEIGHTS[1];
    }
    Record {
        times: ride.times.clone(),
        values,
    }
}

/// Height of the pivot and of the pedals from the axle, and of the axle above the ground, in m.
const UNICYCLE: [f64; 3] = [0.35, -0.05, 0.2];
/// Height of the highest joint above the pedals, and distance from joint to joint, in m.
const RIDER: [f64; 2] = [1.6, 0.1];

/// The skeleton of the example.
pub fn skeleton() -> Skeleton {
    let text = include_str!("../../docs/examples/euc/skeleton.toml");
    Skeleton::parse("skeleton.toml", text).unwrap()
}

/// The rigid bodies of the skeleton on a ride as cameras see them: joints one above the other along a
/// stiff rider, each away from where it should be by so many metres on each axis, as `markers` tells.
pub fn captured(
    skeleton: &Skeleton,
    ride: &Record,
    (offset, markers): (f64, &mut Random),
    random: &mut Random,
) -> Capture {
    let bodies = skeleton.bodies.iter().enumerate().map(|(place, body)| {
        let away = [0; 3].map(|_| offset * markers.normal());
        let joint = [
            away[0],
            away[1],
            away[2] + RIDER[0] - RIDER[1] * place as f64,
        ];
        let top = [away[0], away[1], away[2] + UNICYCLE[0]];
        let mut track = Track {
            position: [const { Vec::new() }; 3],
            angles: [const { Vec::new() }; 3],
        };
        for row in 0..ride.times.len() {
            let [x, gamma, phi] = [0, 1, 2].map(|k| ride.values[(row, k)]);
            let turned = |pitch: f64, arm: Vector| Axes::turned([0.0, 0.0, pitch]).to_ground(arm);
            let (pitch, arms) = if body == "E" {
                (gamma, [turned(gamma, top), [0.0; 3]])
            } else {
                let pedals = turned(gamma, [0.0, 0.0, UNICYCLE[1]]);
                (phi, [pedals, turned(phi, joint)])
            };
            let axle = [x, 0.0, UNICYCLE[2]];
            for k in 0..3 {
                let place = axle[k] + arms[0][k] + arms[1][k];
                track.position[k].push(place + NOISE[0] * random.normal());
                track.angles[k].push([0.0, 0.0, pitch][k] + NOISE[1] * random.normal());
            }
        }
        track
    });
    Capture {
        bodies: bodies.collect(),
        times: ride.times.clone(),
    }
}

/// The coordinates of the model that a capture shows.
pub fn shown(skeleton: &Skeleton, capture: &Capture) -> Record {
    record_of(&Ride::of(skeleton, capture))
}

/// The coordinates of a ride through the pipeline.
pub fn record_of(ride: &Ride) -> Record {
    let columns = ride.channels.iter();
    let columns: Vec<_> = columns.map(|own| DVector::from_column_slice(own)).collect();
    Record {
        times: ride.times.clone(),
        values: DMatrix::from_columns(&columns),
    }
}

//! Simulated motion capture: rigid bodies of table 2, misplaced markers, noise.

use std::f64::consts::TAU;

use appell_recordings::motion_capture::{Axes, Capture, Skeleton, Track, Vector};
use appell_runtime::Trajectory;
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

use crate::book::{Result, failed};

/// Accuracies of the paper, taken as standard deviations: m and rad.
const POSITION: f64 = 2e-4;
const ANGLE: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// Offsets of pivots in m.
const OFFSET: f64 = 0.005;
/// Height of the captured top of the unicycle above the wheel centre in m, as the skeleton states it.
const TOP: f64 = 0.35;

/// Joints of the rider upright on the pedals: forward, left, up from the middle between the feet, in m.
const JOINTS: [(&str, Vector); 13] = [
    ("H", [0.02, 0.0, 1.70]),
    ("CHR", [0.0, -0.18, 1.40]),
    ("CHL", [0.0, 0.18, 1.40]),
    ("UAR", [-0.02, -0.24, 1.11]),
    ("UAL", [-0.02, 0.24, 1.11]),
    ("LAR", [0.06, -0.25, 0.87]),
    ("LAL", [0.06, 0.25, 0.87]),
    ("HR", [-0.02, -0.09, 0.90]),
    ("HL", [-0.02, 0.09, 0.90]),
    ("TR", [0.03, -0.10, 0.48]),
    ("TL", [0.03, 0.10, 0.48]),
    ("LR", [0.0, -0.10, 0.08]),
    ("LL", [0.0, 0.10, 0.08]),
];

/// Imperfections of a capture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Imperfection {
    /// Factor of the stated noise.
    pub(super) noise: f64,
    /// Factor of the marker offsets.
    pub(super) offsets: f64,
}

/// A rider with the centre of mass vertically above the pedals.
pub(super) struct Captured {
    skeleton: Skeleton,
    /// Joints of the rider, from the pedals.
    joints: Vec<Vector>,
}

impl Captured {
    pub(super) fn new(skeleton: &Skeleton) -> Result<Self> {
        let place = |name: &String| {
            let joint = JOINTS.iter().find(|(own, _)| own == name);
            joint.map_or([0.0; 3], |(_, place)| *place)
        };
        let mut captured = Self {
            skeleton: skeleton.clone(),
            joints: skeleton.bodies.iter().map(place).collect(),
        };
        let [forward, _, _] = captured.centre();
        for joint in &mut captured.joints {
            joint[0] -= forward;
        }
        if skeleton.body("E").is_none() {
            return Err(failed("the skeleton has no vehicle"));
        }
        Ok(captured)
    }

    /// Height of the centre of mass above the pedals in m: the true h.
    pub(super) fn height(&self) -> f64 {
        self.centre()[2]
    }

    fn centre(&self) -> Vector {
        let rider = &self.skeleton.rider;
        let mut centre = [0.0; 3];
        for segment in &rider.segments {
            let [from, to] = segment.ends.each_ref().map(|ends| {
                let joints = ends.iter().map(|&end| self.skeleton.points[end].body);
                joints.fold([0.0; 3], |middle, body| {
                    moved(middle, self.joints[body].map(|k| k / ends.len() as f64))
                })
            });
            let place = [0, 1, 2].map(|k| from[k] + segment.centre * (to[k] - from[k]));
            let share = segment.mass / rider.mass;
            centre = moved(centre, place.map(|k| share * k));
        }
        centre
    }

    /// The captured ride.
    pub(super) fn see(
        &self,
        motion: &Trajectory,
        with: Imperfection,
        random: &mut Random,
    ) -> Capture {
        let column = |name: &str| motion.column(name).unwrap_or_default();
        let names = ["x_C", "y_C", "psi", "theta", "gamma", "phi", "beta"];
        let states = names.map(column);
        let parameter = |name: &str| {
            let info = motion.info();
            info.parameter_index(name)
                .map_or(0.0, |index| info.parameters[index].value)
        };
        // Marker offsets are the same in all rides.
        let mut markers = Random::of("markers");
        let (radius, depth) = (parameter("R"), parameter("l_0"));
        let tracks = self
            .skeleton
            .bodies
            .iter()
            .zip(&self.joints)
            .map(|(name, &joint)| {
                let offset = [0; 3].map(|_| with.offsets * OFFSET * markers.normal());
                let mut track = Track {
                    position: [const { Vec::new() }; 3],
                    angles: [const { Vec::new() }; 3],
                };
                for row in 0..motion.times().len() {
                    let [x, y, psi, theta, gamma, phi, beta] =
                        states.each_ref().map(|column| column[row]);
                    let wheel = [x, y, radius * theta.cos()];
                    let body = Axes::turned([psi, theta, gamma]);
                    let (place, angles) = if name == "E" {
                        let arm = [offset[0], offset[1], offset[2] + TOP];
                        (moved(wheel, body.to_ground(arm)), [psi, theta, gamma])
                    } else {
                        let pedals = moved(wheel, body.to_ground([0.0, 0.0, -depth]));
                        let tilted = Axes::turned([psi, theta, 0.0]);
                        // The rider pitches about the axle, then leans about the x axis of the
                        // body.
                        let leaning = Axes::turned([0.0, beta, 0.0]);
                        let pitched = Axes::turned([0.0, 0.0, phi]);
                        let arm = moved(joint, offset);
                        let arm = tilted.to_ground(pitched.to_ground(leaning.to_ground(arm)));
                        (moved(pedals, arm), [psi, theta + beta, phi])
                    };
                    for k in 0..3 {
                        let noise = with.noise * POSITION * random.normal();
                        track.position[k].push(place[k] + noise);
                        let noise = with.noise * ANGLE * random.normal();
                        track.angles[k].push(angles[k] + noise);
                    }
                }
                track
            });
        Capture {
            bodies: tracks.collect(),
            times: motion.times().to_vec(),
        }
    }
}

fn moved(place: Vector, by: Vector) -> Vector {
    [0, 1, 2].map(|k| place[k] + by[k])
}

/// Random numbers.
pub(super) struct Random(SplitMix64);

impl Random {
    /// A sequence seeded by a text.
    pub(super) fn of(text: &str) -> Self {
        let seed = text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// A uniformly distributed number.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        let part = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * part
    }

    /// A standard normal number (Box and Muller, 1958).
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.between(f64::MIN_POSITIVE, 1.0).ln()).sqrt();
        radius * self.between(0.0, TAU).cos()
    }
}

//! Applied loads: as forces and torques, and as potentials.

use appell_runtime::Real;
use appell_spec::mechanism::{BodyId, Connection, CoordinateId, LoadKind};

use super::Setting;
use super::evaluate::Values;
use super::motion::{Motion, V3, add, apply, dot, scale, subtract};

/// A force or torque at one time, in the ground.
#[derive(Debug, Clone)]
pub enum Applied {
    /// A force on a point, of a body or not, and the opposite force on another point.
    Force {
        /// Components.
        force: V3<f64>,
        /// Body and point.
        on: (Option<BodyId>, usize),
        /// Where the opposite force acts.
        reaction_on: Option<usize>,
    },
    /// A torque on a body, and the opposite one on another.
    Torque {
        /// Components.
        torque: V3<f64>,
        /// Body.
        on: BodyId,
        /// Body that feels the opposite torque.
        reaction_on: Option<BodyId>,
    },
    /// A force along a coordinate.
    Along(CoordinateId, f64),
}

/// Everything that acts, in the motion that the setting has. With `conservative` the loads that
/// have a potential take part.
pub fn applied(
    setting: &Setting<'_>,
    values: &Values<f64>,
    motion: &Motion<f64>,
    conservative: bool,
) -> Vec<Applied> {
    let mechanism = setting.mechanism;
    let mut all = Vec::new();
    for load in &mechanism.loads {
        match &load.kind {
            LoadKind::Gravity { down, acceleration } if conservative => {
                let g = values.of(acceleration);
                for body in &mechanism.bodies {
                    let weight = values.of(&body.mass) * g;
                    let force = down.map(|c| f64::from(c) * weight);
                    all.push(Applied::Force {
                        force,
                        on: (None, body.centre),
                        reaction_on: None,
                    });
                }
            }
            LoadKind::Force {
                on,
                body,
                reaction_on,
                frame,
                vector,
            } => {
                let force = apply(&motion.rotations[*frame], values.of3(vector));
                all.push(Applied::Force {
                    force,
                    on: (*body, *on),
                    reaction_on: *reaction_on,
                });
            }
            LoadKind::Torque {
                on,
                reaction_on,
                frame,
                vector,
            } => {
                let torque = apply(&motion.rotations[*frame], values.of3(vector));
                all.push(Applied::Torque {
                    torque,
                    on: *on,
                    reaction_on: *reaction_on,
                });
            }
            LoadKind::Spring {
                between,
                stiffness,
                relaxed,
            } if conservative => {
                let (k, relaxed) = (values.of(stiffness), values.of(relaxed));
                all.push(tension(values, motion, between, |length, _| {
                    k * (length - relaxed)
                }));
            }
            LoadKind::Damper { between, damping } => {
                let c = values.of(damping);
                all.push(tension(values, motion, between, |_, rate| c * rate));
            }
            LoadKind::Generalized { coordinate, force } => {
                all.push(Applied::Along(*coordinate, values.of(force)));
            }
            LoadKind::Gravity { .. } | LoadKind::Spring { .. } => {}
        }
    }
    all
}

/// A connection under a tension that depends on its length and the rate of its length.
fn tension(
    values: &Values<f64>,
    motion: &Motion<f64>,
    between: &Connection,
    tension: impl Fn(f64, f64) -> f64,
) -> Applied {
    match *between {
        Connection::Coordinate(q) => {
            Applied::Along(q, -tension(values.coordinates[q], values.rates[q]))
        }
        Connection::Points(a, b) => {
            let arm = subtract(motion.positions[b], motion.positions[a]);
            let v = subtract(motion.velocity(None, b), motion.velocity(None, a));
            let length = dot(arm, arm).sqrt();
            let unit = scale(1.0 / length, arm);
            let force = scale(-tension(length, dot(unit, v)), unit);
            Applied::Force {
                force,
                on: (None, b),
                reaction_on: Some(a),
            }
        }
    }
}

/// Power of given loads in a motion with given generalised velocities.
pub fn power(loads: &[Applied], motion: &Motion<f64>, rates: &[f64]) -> f64 {
    loads
        .iter()
        .map(|load| match load {
            Applied::Force {
                force,
                on,
                reaction_on,
            } => {
                let mut v = motion.velocity(on.0, on.1);
                if let Some(other) = reaction_on {
                    v = subtract(v, motion.velocity(None, *other));
                }
                dot(*force, v)
            }
            Applied::Torque {
                torque,
                on,
                reaction_on,
            } => {
                let mut w = motion.body_turning(*on).map(|c| c.value);
                if let Some(other) = reaction_on {
                    w = subtract(w, motion.body_turning(*other).map(|c| c.value));
                }
                dot(*torque, w)
            }
            Applied::Along(coordinate, force) => force * rates[*coordinate],
        })
        .sum()
}

/// Sum of the forces that have no opposite force.
pub fn external_force(loads: &[Applied]) -> V3<f64> {
    loads.iter().fold([0.0; 3], |sum, load| match load {
        Applied::Force {
            force,
            reaction_on: None,
            ..
        } => add(sum, *force),
        _ => sum,
    })
}

/// Potential energy of gravity and springs.
pub fn potential<S: Real>(setting: &Setting<'_>, q: &[S], passed: S) -> S {
    let zeros = vec![S::constant(0.0); q.len()];
    let motion = Motion::new(setting, q, &zeros, &zeros, passed);
    let values = Values::new(setting, q.to_vec(), zeros, passed);
    let mut total = S::constant(0.0);
    for load in &setting.mechanism.loads {
        match &load.kind {
            LoadKind::Gravity { down, acceleration } => {
                let g = values.of(acceleration);
                for body in &setting.mechanism.bodies {
                    let down = down.map(|c| S::constant(f64::from(c)));
                    let fallen = dot(down, motion.positions[body.centre]);
                    total += -(values.of(&body.mass) * g * fallen);
                }
            }
            LoadKind::Spring {
                between,
                stiffness,
                relaxed,
            } => {
                let length = match *between {
                    Connection::Coordinate(c) => q[c],
                    Connection::Points(a, b) => {
                        let arm = subtract(motion.positions[b], motion.positions[a]);
                        dot(arm, arm).sqrt()
                    }
                };
                let extension = length - values.of(relaxed);
                total += S::constant(0.5) * values.of(stiffness) * extension * extension;
            }
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::Damper { .. }
            | LoadKind::Generalized { .. } => {}
        }
    }
    total
}

//! Essential and ignorable states.
//!
//! The pseudo-velocities are essential, and so is every state on which their rates depend, directly
//! or through other essential states. The other coordinates, such as position and heading of a wheel,
//! are ignorable (cyclic). Unit quaternions are essential or ignorable as a whole; essential ones may turn
//! (`turning.rs`).

use super::starts::{Spread, value_at};
use super::turning::{Sample, Turning, normalise, quaternions};
use crate::point::Point;
use appell_runtime::model::{At, Model, ModelInfo};

/// Points at which dependence is tested. An entry of A that is exactly zero at all of them is taken
/// as zero: derivatives of equations without a state are exact zeros.
const POINTS: usize = 8;
/// Largest number of points tried until that many give finite numbers.
const TRIES: usize = 200;

/// Which states are essential and which are ignorable.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// Essential states, by their index in the model.
    pub essential: Vec<usize>,
    /// The others.
    pub ignorable: Vec<usize>,
    /// The ignorable states whose rates depend on essential states alone: constant rates in a steady
    /// motion.
    pub uniform: Vec<usize>,
    /// Symmetric rotations of unit quaternions in a steady motion.
    pub(crate) turning: Turning,
}

/// Why a model has no steady motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StructureError {
    /// The equations depend on time.
    #[error("the equations depend on time: no motion of them is steady")]
    DependsOnTime,
    /// No point gave finite derivatives.
    #[error("the Jacobian is not finite at any of {TRIES} states within the ranges")]
    NotFinite,
}

impl Structure {
    /// From the zeros of A at points within the ranges of states and inputs, and for the parameters
    /// of `point`: a spring of zero stiffness causes no coupling.
    pub fn of(model: &dyn Model, point: &Point) -> Result<Self, StructureError> {
        let info = model.info();
        if info.explicit_time {
            return Err(StructureError::DependsOnTime);
        }
        let n = info.state_len();
        let (samples, quaternions) = samples(model, point)?;
        let depends = dependence(model, point, &samples);
        let mut essential: Vec<bool> = (0..n).map(|state| state < info.speeds).collect();
        while let Some(next) = (0..n).find(|&state| {
            let needed = |other: usize| essential[other] && depends[other * n + state];
            !essential[state] && (0..n).any(needed)
        }) {
            essential[next] = true;
        }
        let components = quaternions.iter().flatten();
        let felt: Vec<usize> = (0..n)
            .filter(|state| essential[*state] || components.clone().any(|e| e == state))
            .collect();
        let turning = Turning::of(quaternions, &samples, &felt);
        let (essential, ignorable): (Vec<usize>, Vec<usize>) = (0..n).partition(|&s| essential[s]);
        let alone = |&&state: &&usize| {
            let free = !ignorable.iter().any(|&other| depends[state * n + other]);
            free && turning.keeps(&samples, state)
        };
        let uniform = ignorable.iter().filter(alone).copied().collect();
        Ok(Self {
            essential,
            ignorable,
            uniform,
            turning,
        })
    }

    /// Whether a state is essential.
    pub fn is_essential(&self, state: usize) -> bool {
        self.essential.contains(&state)
    }

    /// The rates of a state without the symmetric rotation of quaternions; zero for essential states if it is steady.
    pub fn still(&self, x: &[f64], rates: &[f64]) -> Vec<f64> {
        self.turning.still(x, rates)
    }

    /// Whether a state is a component of a unit quaternion that may turn in a steady motion, so that it has no value.
    pub fn turns(&self, state: usize) -> bool {
        let of_quaternion = self
            .turning
            .quaternions
            .iter()
            .flatten()
            .any(|&e| e == state);
        self.turning.moves(state) || of_quaternion && !self.is_essential(state)
    }
}

/// The model at several states, and its quaternions.
fn samples(
    model: &dyn Model,
    point: &Point,
) -> Result<(Vec<Sample>, Vec<[usize; 4]>), StructureError> {
    let info = model.info();
    let (n, m) = (info.state_len(), info.input_len());
    let mut b = vec![0.0; n * m];
    let mut spread = Spread::new(n + m);
    let mut all = Vec::new();
    let mut found = Vec::new();
    for _ in 0..TRIES {
        let (mut x, u) = somewhere(info, point, &spread.next());
        let inputs = At {
            u: &u,
            ..point.at()
        };
        found = quaternions(model, At { x: &x, ..inputs });
        normalise(&found, &mut x);
        let (mut rates, mut a) = (vec![0.0; n], vec![0.0; n * n]);
        model.jacobians(At { x: &x, ..inputs }, &mut rates, &mut a, &mut b);
        if a.iter().chain(&rates).all(|entry| entry.is_finite()) {
            all.push(Sample { x, u, rates, a });
            if all.len() == POINTS {
                break;
            }
        }
    }
    if all.is_empty() {
        return Err(StructureError::NotFinite);
    }
    Ok((all, found))
}

/// Whether the rate of the row's state depends on the column's; a coordinate that follows from
/// others through a position constraint depends on them, and the components of a quaternion on each other.
fn dependence(model: &dyn Model, point: &Point, samples: &[Sample]) -> Vec<bool> {
    let info = model.info();
    let (n, coordinates) = (info.state_len(), info.coordinate_quantities().len());
    let dependent = model.dependent_coordinates();
    let mut residual = vec![0.0; dependent.len()];
    let mut slopes = vec![0.0; dependent.len() * coordinates];
    let mut depends = vec![false; n * n];
    for Sample { x, u, a, .. } in samples {
        for (depends, entry) in depends.iter_mut().zip(a) {
            *depends |= *entry != 0.0;
        }
        let at = At { x, u, ..point.at() };
        if !dependent.is_empty() {
            model.position_constraints(at, &mut residual, &mut slopes);
            for row in slopes.chunks(coordinates) {
                for &follows in dependent.iter().filter(|&&q| row[q] != 0.0) {
                    for (q, slope) in row.iter().enumerate() {
                        depends[(info.speeds + follows) * n + info.speeds + q] |= *slope != 0.0;
                    }
                }
            }
        }
        for quaternion in quaternions(model, at) {
            for row in quaternion {
                for column in quaternion {
                    depends[row * n + column] = true;
                }
            }
        }
    }
    depends
}

/// A state and inputs within their ranges.
fn somewhere(info: &ModelInfo, point: &Point, parts: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (of_states, of_inputs) = parts.split_at(info.state_len());
    let states = info.states.iter().zip(&point.x).zip(of_states);
    let inputs = info.inputs.iter().zip(&point.u).zip(of_inputs);
    (
        states
            .map(|((q, &x), &part)| value_at(q, x, part))
            .collect(),
        inputs
            .map(|((q, &u), &part)| value_at(q, u, part))
            .collect(),
    )
}

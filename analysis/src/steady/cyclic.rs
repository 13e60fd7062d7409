//! Essential and ignorable states.
//!
//! The pseudo-velocities are essential, and so is every state on which their rates depend, directly
//! or through other essential states. The other coordinates, such as position and heading of a wheel,
//! are ignorable (cyclic).

use super::starts::{Spread, value_at};
use crate::point::Point;
use appell_runtime::model::{At, Model, ModelInfo};

/// Points at which dependence is tested. An entry of A that is exactly zero at all of them is taken
/// as zero: derivatives of equations without a state are exact zeros.
const POINTS: usize = 8;
/// Largest number of points tried until that many give finite numbers.
const TRIES: usize = 200;

/// Which states are essential and which are ignorable.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Structure {
    /// Essential states, by their index in the model.
    pub essential: Vec<usize>,
    /// The others.
    pub ignorable: Vec<usize>,
    /// The ignorable states whose rates depend on essential states alone: constant rates in a steady
    /// motion.
    pub uniform: Vec<usize>,
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
    /// of `point`: a spring of zero stiffness couples nothing.
    pub fn of(model: &dyn Model, point: &Point) -> Result<Self, StructureError> {
        let info = model.info();
        if info.explicit_time {
            return Err(StructureError::DependsOnTime);
        }
        let n = info.state_len();
        let depends = dependence(model, point)?;
        let mut essential: Vec<bool> = (0..n).map(|state| state < info.speeds).collect();
        while let Some(next) = (0..n).find(|&state| {
            let needed = |other: usize| essential[other] && depends[other * n + state];
            !essential[state] && (0..n).any(needed)
        }) {
            essential[next] = true;
        }
        let (essential, ignorable): (Vec<usize>, Vec<usize>) = (0..n).partition(|&s| essential[s]);
        let alone = |&&state: &&usize| !ignorable.iter().any(|&other| depends[state * n + other]);
        let uniform = ignorable.iter().filter(alone).copied().collect();
        Ok(Self {
            essential,
            ignorable,
            uniform,
        })
    }

    /// Whether a state is essential.
    pub fn is_essential(&self, state: usize) -> bool {
        self.essential.contains(&state)
    }
}

/// Whether the rate of the row's state depends on the column's; a coordinate that follows from
/// others through a position constraint depends on them.
fn dependence(model: &dyn Model, point: &Point) -> Result<Vec<bool>, StructureError> {
    let info = model.info();
    let (n, m, coordinates) = (
        info.state_len(),
        info.input_len(),
        info.coordinate_quantities().len(),
    );
    let dependent = model.dependent_coordinates();
    let (mut rates, mut a, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
    let mut residual = vec![0.0; dependent.len()];
    let mut slopes = vec![0.0; dependent.len() * coordinates];
    let mut depends = vec![false; n * n];
    let mut spread = Spread::new(n + m);
    let mut found = 0;
    for _ in 0..TRIES {
        let (x, u) = somewhere(info, point, &spread.next());
        let at = At {
            x: &x,
            u: &u,
            ..point.at()
        };
        model.jacobians(at, &mut rates, &mut a, &mut b);
        if !a.iter().chain(&rates).all(|entry| entry.is_finite()) {
            continue;
        }
        for (depends, entry) in depends.iter_mut().zip(&a) {
            *depends |= *entry != 0.0;
        }
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
        found += 1;
        if found == POINTS {
            return Ok(depends);
        }
    }
    if found > 0 {
        Ok(depends)
    } else {
        Err(StructureError::NotFinite)
    }
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

//! Essential states and hidden ones.
//!
//! Where a wheel stands and which way it looks changes nothing about how it moves on: such
//! coordinates are cyclic, or hidden. Essential are the pseudo-velocities and every state that their
//! rates depend on, directly or through other essential states.

use super::starts::{Spread, value_at};
use crate::point::Point;
use appell_runtime::model::{At, Model, ModelInfo};

/// Points at which dependence is looked for. An entry of A that is exactly zero at all of them is
/// taken as zero: derivatives of equations that do not hold a state come out as exact zeros.
const POINTS: usize = 8;
/// Points that are tried until that many give finite numbers.
const TRIES: usize = 200;

/// Which states are essential and which follow.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Structure {
    /// Essential states, by their index in the model.
    pub essential: Vec<usize>,
    /// The others.
    pub hidden: Vec<usize>,
    /// Those of the hidden ones whose rates depend on essential states alone: they run at a constant
    /// rate in a steady motion.
    pub uniform: Vec<usize>,
}

/// Why a model has no steady motions to look for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum StructureError {
    /// Time is in the equations.
    #[error("the equations depend on time: no motion of them is steady")]
    DependsOnTime,
    /// No point gave finite derivatives.
    #[error("the Jacobian is not finite at any of {TRIES} states within the ranges")]
    NotFinite,
}

impl Structure {
    /// From the zeros of A at points within the ranges of states and inputs, and for the parameters
    /// of `point`: a spring of stiffness zero ties nothing.
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
        let (essential, hidden): (Vec<usize>, Vec<usize>) = (0..n).partition(|&s| essential[s]);
        let alone = |&&state: &&usize| !hidden.iter().any(|&other| depends[state * n + other]);
        let uniform = hidden.iter().filter(alone).copied().collect();
        Ok(Self {
            essential,
            hidden,
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

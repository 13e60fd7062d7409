//! Linearisation of models with dependent coordinates.
//!
//! A and B of [`Model::jacobians`] treat all coordinates as independent. Position constraints f(q, t) = 0 couple the
//! dependent ones to the others, `∂f/∂q δq = 0`: modes and controllers of the mechanism are those of the independent
//! states.

use crate::dense::solved_in_place;
use crate::model::{At, Model};
use crate::positions::followers;

/// `δẋ = A δx + B δu` in the independent states: pseudo-velocities and independent coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearisation {
    /// The independent states, by their index in the model.
    pub states: Vec<usize>,
    /// A, row by row: as many rows and columns as independent states.
    pub a: Vec<f64>,
    /// B, row by row: a column for each input and signal.
    pub b: Vec<f64>,
    /// The dependent coordinates, one per position constraint: those that the model declares, unless others are much
    /// better conditioned at this state.
    pub dependent: Vec<usize>,
    /// Their dependence: a row for each, a column for each independent state.
    pub dependence: Vec<f64>,
}

/// The position constraints do not determine the dependent coordinates at this state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the position constraints do not determine the dependent coordinates at this state; choose other \
     `dependent` coordinates in the spec"
)]
pub struct Undetermined;

impl Linearisation {
    /// About a state that satisfies the position constraints. Without constraints these are A and B of the model.
    pub fn about(model: &dyn Model, at: At<'_>) -> Result<Self, Undetermined> {
        let info = model.info();
        let (n, m) = (info.states.len(), info.inputs.len());
        let count = model.dependent_coordinates().len();
        let coordinates = n - info.speeds;
        let (mut residual, mut slopes) = (vec![0.0; count], vec![0.0; count * coordinates]);
        if count > 0 {
            model.position_constraints(at, &mut residual, &mut slopes);
        }
        let follow = followers(&slopes, coordinates, model.dependent_coordinates());
        let dependent: Vec<usize> = follow.iter().map(|q| info.speeds + q).collect();
        let states: Vec<usize> = (0..n).filter(|state| !dependent.contains(state)).collect();
        let (mut rates, mut all, mut b) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * m]);
        model.jacobians(at, &mut rates, &mut all, &mut b);

        let dependence = dependence(&slopes, info.speeds, &follow, &states)?;
        let entry = |&row: &usize, (place, &column): (usize, &usize)| {
            let by_way_of = dependent.iter().enumerate();
            let by_way_of = by_way_of
                .map(|(k, &other)| all[row * n + other] * dependence[k * states.len() + place]);
            all[row * n + column] + by_way_of.sum::<f64>()
        };
        let row = |row| {
            let columns = states.iter().enumerate();
            columns.map(move |column| entry(row, column))
        };
        Ok(Self {
            a: states.iter().flat_map(row).collect(),
            b: states
                .iter()
                .flat_map(|&row| b[row * m..(row + 1) * m].to_vec())
                .collect(),
            dependent: follow,
            dependence,
            states,
        })
    }
}

/// `-(∂f/∂q_dependent)⁻¹ ∂f/∂q` in the columns of the independent states.
fn dependence(
    slopes: &[f64],
    speeds: usize,
    dependent: &[usize],
    states: &[usize],
) -> Result<Vec<f64>, Undetermined> {
    let count = dependent.len();
    if count == 0 {
        return Ok(Vec::new());
    }
    let mut matrix = Vec::with_capacity(count * count);
    let mut right = Vec::with_capacity(count * states.len());
    for row in slopes.chunks(slopes.len() / count) {
        matrix.extend(dependent.iter().map(|&q| row[q]));
        // Positions do not depend on pseudo-velocities.
        let slope = |&state: &usize| state.checked_sub(speeds).map_or(0.0, |q| -row[q]);
        right.extend(states.iter().map(slope));
    }
    let determined = solved_in_place(&mut matrix, &mut right, count);
    determined.then_some(right).ok_or(Undetermined)
}

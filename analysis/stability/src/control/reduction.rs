//! Exact closed equations of chosen states.
//!
//! In the controllable subspace, other states may follow from the chosen ones, and states on which
//! these do not depend are irrelevant. If the dimension that remains equals the number of chosen
//! states, these have closed linear equations, `ẏ = A_y y + B_y u`: the part of the system that is
//! controllable and observable through y. Feedback of y is then state feedback.

use nalgebra::{DMatrix, RowDVector};

use super::LinearSystem;
use super::staircase::{NEGLIGIBLE, Staircase};
use appell_spectra::singular::Singular;

/// The equations of chosen states.
#[derive(Debug, Clone, PartialEq)]
pub struct Subsystem {
    /// The chosen states, by their index in the whole system.
    pub states: Vec<usize>,
    /// `ẏ = A_y y + B_y u`.
    pub system: LinearSystem,
    /// Other states that follow from the chosen ones, with a factor for each of these; they are
    /// substituted.
    pub substituted: Vec<(usize, Vec<f64>)>,
}

/// Why chosen states have no closed equations. States are given by their index in the whole system.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReductionError {
    /// The inputs have no effect on the chosen states.
    #[error("the inputs have no effect on the chosen states")]
    Unmoved,
    /// A chosen state follows from others.
    #[error("chosen state {state} follows from those chosen before it")]
    Dependent {
        /// The state.
        state: usize,
        /// Its factors for the states chosen before it; all zero where the inputs do not move it.
        factors: Vec<f64>,
    },
    /// The chosen states depend on states that were not chosen.
    #[error("{chosen} states were chosen, but closed equations need {order}")]
    Open {
        /// Number of chosen states.
        chosen: usize,
        /// Number of states needed.
        order: usize,
        /// States that would complete the choice.
        missing: Vec<usize>,
    },
}

/// The controllable subspace of a system, and its part observable through chosen states.
struct Quotient {
    /// Controllable subspace: a row for each state, orthonormal columns.
    reached: DMatrix<f64>,
    /// Its observable part, orthonormal columns.
    observed: DMatrix<f64>,
}

impl Quotient {
    fn of(system: &LinearSystem, states: &[usize]) -> Self {
        let form = Staircase::of(system);
        let (part, reached) = (form.controllable_part(), form.basis());
        // Observability is controllability of the transposed system.
        let dual = LinearSystem {
            a: part.a.transpose(),
            b: reached.select_rows(states).transpose(),
        };
        Self {
            observed: Staircase::of(&dual).basis(),
            reached,
        }
    }

    /// A state as a function of the observable part, and its remainder.
    fn state(&self, state: usize) -> (RowDVector<f64>, f64) {
        let row = self.reached.row(state);
        let observable = row * &self.observed;
        let remainder = row - &observable * self.observed.transpose();
        (observable, remainder.norm())
    }
}

/// The equations of chosen states.
pub fn reduce(system: &LinearSystem, states: &[usize]) -> Result<Subsystem, ReductionError> {
    let balanced = system.balanced();
    let scale = |state: usize| balanced.states[state];
    let quotient = Quotient::of(&balanced.system, states);
    let order = quotient.observed.ncols();
    if order == 0 {
        return Err(ReductionError::Unmoved);
    }
    let observable = quotient.reached.select_rows(states) * &quotient.observed;
    if let Some((place, factors)) = first_dependent(&observable) {
        let (state, before) = (states[place], &states[..place]);
        let factors = factors.iter().zip(before);
        return Err(ReductionError::Dependent {
            state,
            factors: factors
                .map(|(factor, &other)| factor * scale(state) / scale(other))
                .collect(),
        });
    }
    let inverse = (order == states.len())
        .then(|| observable.try_inverse())
        .flatten();
    let Some(inverse) = inverse else {
        return Err(ReductionError::Open {
            chosen: states.len(),
            order,
            missing: missing(&quotient, states),
        });
    };
    // All states in terms of the chosen ones; these are themselves, without rounding.
    let mut lift = &quotient.reached * &quotient.observed * inverse;
    for (place, &state) in states.iter().enumerate() {
        lift.row_mut(state).fill(0.0);
        lift[(state, place)] = 1.0;
    }
    let lift = DMatrix::from_fn(system.order(), states.len(), |state, place| {
        let factor = lift[(state, place)];
        let negligible = factor.abs() <= NEGLIGIBLE;
        if negligible {
            0.0
        } else {
            factor * scale(state) / scale(states[place])
        }
    });
    let others = (0..system.order()).filter(|state| !states.contains(state));
    let follows =
        |&state: &usize| quotient.state(state).1 <= NEGLIGIBLE && lift.row(state).amax() > 0.0;
    Ok(Subsystem {
        states: states.to_vec(),
        substituted: others
            .filter(follows)
            .map(|state| (state, lift.row(state).iter().copied().collect()))
            .collect(),
        system: LinearSystem {
            a: system.a.select_rows(states) * lift,
            b: system.b.select_rows(states),
        },
    })
}

/// Candidates that determine the controllable subspace, earlier ones preferred.
pub fn independent_states(system: &LinearSystem, candidates: &[usize]) -> Vec<usize> {
    let reached = Staircase::of(&system.balanced().system).basis();
    complete(&reached, &[], candidates.iter().copied())
}

/// States that complete the chosen ones: first single states that suffice.
fn missing(quotient: &Quotient, states: &[usize]) -> Vec<usize> {
    let all = || (0..quotient.reached.nrows()).rev();
    let within = all().filter(|&state| quotient.state(state).1 <= NEGLIGIBLE);
    let observable = &quotient.reached * &quotient.observed;
    let added = complete(&observable, states, within);
    if states.len() + added.len() == quotient.observed.ncols() {
        added
    } else {
        complete(&quotient.reached, states, all())
    }
}

/// Those of the candidates whose rows are independent of the rows of the states before them.
fn complete(
    rows: &DMatrix<f64>,
    states: &[usize],
    candidates: impl Iterator<Item = usize>,
) -> Vec<usize> {
    let mut kept = states.to_vec();
    for candidate in candidates {
        if kept.len() == rows.ncols() {
            break;
        }
        kept.push(candidate);
        if first_dependent(&rows.select_rows(&kept)).is_some() {
            kept.pop();
        }
    }
    kept.split_off(states.len())
}

/// The first row that depends on those before it, with its factors.
fn first_dependent(rows: &DMatrix<f64>) -> Option<(usize, Vec<f64>)> {
    (0..rows.nrows()).find_map(|place| {
        let before = rows.rows(0, place).transpose();
        let row = rows.row(place).transpose();
        let factors = Singular::of(&before).solve(&row, place);
        let rest = row - before * &factors;
        let clean = |factor: &f64| {
            if factor.abs() <= DEPENDENT {
                0.0
            } else {
                *factor
            }
        };
        (rest.norm() <= DEPENDENT).then(|| (place, factors.iter().map(clean).collect()))
    })
}

/// A state whose row of an orthonormal basis differs by less than this from a combination of others
/// counts as equal to it.
const DEPENDENT: f64 = 1e-8;

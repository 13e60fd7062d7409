//! Inverse dynamics: the inputs of a measured motion, and the relations that it satisfies for any
//! inputs.
//!
//! Appell's equations M ω̇ + b = Π are linear in the inputs, Π = E u + Π₀. For a measured motion q,
//! ω, ω̇ they are equations for u. Where there are more of them than inputs, the rows n with nᵀE =
//! 0 hold without u: input-free relations between measured quantities and parameters,
//!
//! ```text
//! nᵀ (M ω̇ + b − Π₀) = 0
//! ```
//!
//! An acceleration that was not measured is an unknown like an input, and removes one relation.
//!
//! | file | idea |
//! |---|---|
//! | `inverse.rs` | the equations at a state: inputs, relations |
//! | `relation.rs` | relations of a measured motion with exact derivatives; inputs with their covariance |
//! | `track.rs` | recorded coordinates as splines with the covariance of all derivatives |
//! | `consistency.rs` | inconsistency of recordings with a model, weighted by their noise |
//! | `search.rs` | the least inconsistent parameters, with intervals |

mod consistency;
mod relation;
mod search;
mod track;

use nalgebra::{DMatrix, DVector};

pub use consistency::{Consistency, Inconsistency, Sought};
pub use relation::{Moment, Motion, Relations, Rows};
pub use search::Found;
pub use track::{Record, Stretch, Track};

use appell_runtime::model::{At, Model};
use appell_spectra::singular::Singular;

/// Singular values below this fraction of the largest are zero: rounding of a few hundred
/// operations.
const ZERO: f64 = 1e-11;
/// Largest admissible nonlinearity in the inputs, relative to the pseudo-forces.
const LINEAR: f64 = 1e-9;

/// Why the inverse dynamics fails.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InverseError {
    /// The pseudo-forces are not linear in the inputs.
    #[error("the pseudo-forces are not linear in the inputs: relative deviation {part:e}")]
    NotLinear {
        /// Nonlinearity relative to the pseudo-forces.
        part: f64,
    },
    /// The equations do not determine the unknowns.
    #[error("the equations determine {rank} combinations of {unknowns} unknowns")]
    Undetermined {
        /// Number of determined combinations.
        rank: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A measured coordinate that the model does not have.
    #[error("coordinate {index} is measured, but the model has only {coordinates}")]
    NoCoordinate {
        /// Its index.
        index: usize,
        /// Their number.
        coordinates: usize,
    },
    /// The model depends explicitly on time.
    #[error(
        "the model depends explicitly on time, by a signal or a formula; coordinates alone do not determine its motion"
    )]
    Driven,
    /// The inputs can produce any motion.
    #[error("the inputs can produce any motion: no input-free relation exists")]
    NoRelation,
    /// The number of relations differs between motions.
    #[error("{found} input-free relations here, {expected} elsewhere")]
    OtherKind {
        /// Relations here.
        found: usize,
        /// Relations elsewhere.
        expected: usize,
    },
    /// No run is long enough.
    #[error("no run has enough consecutive samples")]
    TooShort,
    /// Non-finite numbers.
    #[error("the relations are not finite at these parameters")]
    NotFinite,
    /// The motion varies too little, or the parameters have no effect.
    #[error("the recorded motions do not determine these values: a matrix is singular")]
    Singular,
    /// A wrong number of accelerations.
    #[error("there are {found} accelerations for {needed} pseudo-velocities")]
    Lengths {
        /// Accelerations that were given.
        found: usize,
        /// Pseudo-velocities.
        needed: usize,
    },
}

/// Appell's equations at a state: M ω̇ + b = E u + Π₀.
#[derive(Debug, Clone, PartialEq)]
pub struct InputEquations {
    /// M.
    pub mass: DMatrix<f64>,
    /// E: a column for each declared input.
    pub inputs: DMatrix<f64>,
    /// b − Π₀.
    pub free: DVector<f64>,
}

impl InputEquations {
    /// Of a model at a state. The inputs of `at` are ignored, the signals after them are used.
    pub fn at(model: &dyn Model, at: At<'_>) -> Result<Self, InverseError> {
        let info = model.info();
        let (s, m) = (info.speeds, info.declared_inputs);
        let mut u = at.u.to_vec();
        let (mut mass, mut bias) = (vec![0.0; s * s], vec![0.0; s]);
        let mut forces = |u: &[f64]| {
            let mut forces = vec![0.0; s];
            model.appell(At { u, ..at }, &mut mass, &mut bias, &mut forces);
            DVector::from_vec(forces)
        };
        u[..m].fill(0.0);
        let without = forces(&u);
        // Inputs of the magnitude of the other forces avoid cancellation.
        let size = 1.0 + without.amax();
        let mut inputs = DMatrix::zeros(s, m);
        for k in 0..m {
            u[k] = size;
            inputs.set_column(k, &((forces(&u) - &without) / size));
            u[k] = 0.0;
        }
        u[..m].fill(2.0 * size);
        let twice = forces(&u);
        let expected = &without + &inputs * DVector::repeat(m, 2.0 * size);
        let part = (&twice - expected).amax() / (size + twice.amax());
        // NaN is not linear either.
        if m > 0 && (part.is_nan() || part > LINEAR) {
            return Err(InverseError::NotLinear { part });
        }
        Ok(Self {
            mass: DMatrix::from_row_slice(s, s, &mass),
            inputs,
            free: DVector::from_vec(bias) - without,
        })
    }

    /// Orthonormal rows n with nᵀE = 0: one for each input-free relation.
    pub fn relations(&self) -> DMatrix<f64> {
        let singular = Singular::of(&self.inputs.transpose());
        let rank = singular.rank(ZERO);
        let left_over = singular.right.ncols() - rank;
        singular.right.columns(rank, left_over).transpose()
    }

    /// M ω̇ + b − Π₀: the pseudo-forces required from the inputs.
    pub fn demand(&self, accelerations: &[f64]) -> Result<DVector<f64>, InverseError> {
        self.count(accelerations.len())?;
        Ok(&self.mass * DVector::from_column_slice(accelerations) + &self.free)
    }

    /// The inputs from some of the equations, by least squares where these exceed the unknowns: the inputs
    /// and the accelerations that were not measured.
    pub fn solve(
        &self,
        accelerations: &[Option<f64>],
        rows: &[usize],
    ) -> Result<Vec<f64>, InverseError> {
        self.count(accelerations.len())?;
        let known: Vec<f64> = accelerations.iter().map(|a| a.unwrap_or(0.0)).collect();
        let open: Vec<usize> = (0..known.len())
            .filter(|&i| accelerations[i].is_none())
            .collect();
        let m = self.inputs.ncols();
        let unknowns = m + open.len();
        // E u − M ω̇ over the unknown ω̇ balances the known part.
        let matrix = DMatrix::from_fn(rows.len(), unknowns, |i, j| {
            if j < m {
                self.inputs[(rows[i], j)]
            } else {
                -self.mass[(rows[i], open[j - m])]
            }
        });
        let demand = self.demand(&known)?;
        let target = DVector::from_iterator(rows.len(), rows.iter().map(|&row| demand[row]));
        let singular = Singular::of(&matrix);
        let rank = singular.rank(ZERO).min(rows.len());
        if rank < unknowns {
            return Err(InverseError::Undetermined { rank, unknowns });
        }
        let first = singular.solve(&target, rank);
        // One step of iterative refinement.
        let solution = &first + singular.solve(&(&target - &matrix * &first), rank);
        Ok(solution.rows(0, m).iter().copied().collect())
    }

    fn count(&self, found: usize) -> Result<(), InverseError> {
        let needed = self.mass.nrows();
        if found == needed {
            Ok(())
        } else {
            Err(InverseError::Lengths { found, needed })
        }
    }
}

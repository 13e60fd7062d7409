//! Steady motions of a model and their stability.
//!
//! | file | idea |
//! |---|---|
//! | `point.rs`, `term.rs` | where a model is evaluated; what can be given, varied or left free there |
//! | `cyclic.rs` | essential states and hidden ones, from the equations |
//! | `equations.rs`, `newton.rs`, `starts.rs` | steady motions as equations, their solution, where to begin |
//! | `steady.rs` | steady motions under conditions, all that are found, the dimension of their family |
//! | `hidden.rs`, `differences.rs` | what the hidden coordinates do: rates, circles; slopes that a model does not tell |
//! | `continuation.rs`, `crossing.rs` | curves of zeros, followed by their length; where two of them cross |
//! | `branch.rs` | steady motions along one quantity: folds, crossings, ends, feasibility |
//! | `critical.rs` | smooth functions whose zeros are changes of stability |
//! | `chart.rs` | stability over two quantities: what a chart holds |
//! | `plane.rs`, `flood.rs`, `grid.rs` | its steady motions: a place, a grid, its verdicts |
//! | `level.rs`, `boundary.rs` | its curves: borders of stability and feasibility |
//! | `locus.rs` | modes that keep their place through crossings |
//! | `stability.rs` | eigenvalues without those of the family; the verdict |
//!
//! ```
//! # use appell_analysis::*;
//! # use appell_runtime::model::Model;
//! /// Speeds at which the verdict on upright running changes.
//! fn critical_speeds(model: &dyn Model) -> Result<Vec<f64>, BranchError> {
//!     let problem = SteadyProblem::new(model, Point::initial(model))?;
//!     let Some(speed) = Term::named(model.info(), "speed") else {
//!         return Ok(Vec::new());
//!     };
//!     let options = BranchOptions::default();
//!     let branches = Branches::new(&problem, speed, [0.5, 10.0], &[], options)?.trace(20)?;
//!     let changes = branches.iter().flat_map(Branch::changes);
//!     Ok(changes.map(|special| special.motion.value).collect())
//! }
//! ```
//!
//! Nothing here knows a mechanism. A steady motion is one whose essential states rest; the wheel
//! rolls, the pendulum spins, and their hidden coordinates run on.

mod boundary;
mod branch;
mod chart;
mod continuation;
pub mod control;
mod critical;
mod crossing;
mod cyclic;
mod differences;
mod equations;
mod flood;
mod grid;
mod hidden;
mod level;
mod locus;
mod newton;
mod plane;
mod point;
mod stability;
mod starts;
mod steady;
mod term;

pub use branch::{
    Branch, BranchError, BranchOptions, BranchPoint, Branches, Kind, Requirement, Special,
};
pub use chart::{Boundary, BoundaryFold, Cell, Chart, ChartError, Edge};
pub use continuation::End;
pub use critical::Change;
pub use cyclic::{Structure, StructureError};
pub use hidden::{Circle, circle};
pub use locus::loci;
pub use plane::Axis;
pub use point::Point;
pub use stability::{Stability, StabilityError, Verdict, essential_matrix};
pub use steady::{Condition, SteadyError, SteadyMotion, SteadyProblem};
pub use term::Term;

//! Steady motions of a model and their stability.
//!
//! | room | idea |
//! |---|---|
//! | `point.rs`, `term.rs` | where a model is evaluated; what can be given, varied or left free there |
//! | `steady.rs` | steady motions under conditions, all that are found, the dimension of their family |
//! | `steady/` | essential states and hidden ones; steady motions as equations, their solution, where to begin; what the hidden coordinates do |
//! | `stability.rs` | eigenvalues without those of the family; the verdict |
//! | `stability/` | smooth functions whose zeros are changes of stability; modes that keep their place through crossings |
//! | `branch.rs` | steady motions along one quantity: folds, crossings, ends, feasibility |
//! | `branch/` | curves of zeros, followed by their length; where two of them cross |
//! | `chart.rs` | stability over two quantities: what a chart holds |
//! | `chart/` | its plane, its grid and the verdicts there; its curves: borders of stability and feasibility |
//! | `control/` | linear models, gains, sampled controllers, schedules, controllability, regions of attraction |
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

mod branch;
mod chart;
pub mod control;
mod point;
mod stability;
mod steady;
mod term;

pub use branch::continuation::End;
pub use branch::{
    Branch, BranchError, BranchOptions, BranchPoint, Branches, Kind, Requirement, Special,
};
pub use chart::plane::Axis;
pub use chart::{Boundary, BoundaryFold, Cell, Chart, ChartError, Edge};
pub use point::Point;
pub use stability::critical::Change;
pub use stability::locus::loci;
pub use stability::{Stability, StabilityError, Verdict, essential_matrix};
pub use steady::cyclic::{Structure, StructureError};
pub use steady::hidden::{Circle, circle};
pub use steady::{Condition, SteadyError, SteadyMotion, SteadyProblem};
pub use term::Term;

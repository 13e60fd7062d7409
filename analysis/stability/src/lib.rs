//! Steady motions of a model and their stability.
//!
//! | module | content |
//! |---|---|
//! | `point.rs`, `term.rs` | state, inputs and parameters; quantities that can be prescribed, varied or left free |
//! | `steady.rs` | steady motions under conditions, and the dimension of their family |
//! | `steady/` | essential and ignorable states; quaternions that turn; the equations of steady motions, their solution, starting points; the paths of points |
//! | `stability.rs` | eigenvalues without the zeros of the family; the verdict; modes tracked through crossings |
//! | `stability/` | smooth test functions for changes of stability |
//! | `branch.rs` | steady motions along one quantity: folds, crossings, ends, feasibility |
//! | `branch/` | pseudo-arclength continuation; special points; branch points |
//! | `chart.rs` | stability over two quantities: data types |
//! | `chart/` | the grid and its verdicts; boundaries of stability and feasibility |
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
//! This crate is independent of mechanisms. In a steady motion the essential states are constant;
//! ignorable coordinates, such as the heading of a wheel, may advance, and quaternions of spinning bodies turn.

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
pub use stability::loci;
pub use stability::{Stability, StabilityError, Verdict, essential_matrix};
pub use steady::cyclic::{Structure, StructureError};
pub use steady::path::{Circle, circle};
pub use steady::{Condition, SteadyError, SteadyMotion, SteadyProblem};
pub use term::Term;

//! Steady motions of a model and their stability.
//!
//! | file | idea |
//! |---|---|
//! | `point.rs`, `term.rs` | where a model is evaluated; what can be given, varied or left free there |
//! | `cyclic.rs` | essential states and hidden ones, from the equations |
//! | `equations.rs`, `newton.rs`, `starts.rs` | steady motions as equations, their solution, where to begin |
//! | `steady.rs` | steady motions under conditions, all that are found, the dimension of their family |
//! | `hidden.rs` | what the hidden coordinates do: rates, circles |
//! | `stability.rs` | eigenvalues without those of the family; the verdict |
//!
//! Nothing here knows a mechanism. A steady motion is one whose essential states rest; the wheel
//! rolls, the pendulum spins, and their hidden coordinates run on.

mod cyclic;
mod equations;
mod hidden;
mod newton;
mod point;
mod stability;
mod starts;
mod steady;
mod term;

pub use cyclic::{Structure, StructureError};
pub use hidden::{Circle, circle};
pub use point::Point;
pub use stability::{Stability, StabilityError, Verdict, essential_matrix};
pub use steady::{Condition, SteadyError, SteadyMotion, SteadyProblem};
pub use term::Term;

//! Initial value problems ẋ = f(t, x).
//!
//! [`Solver`] runs the embedded pairs [`Dop853`] and [`Dopri5`] with step-size control, [`Rk4`] uses a fixed step.
//! All of them provide dense output, locate events, end steps exactly at switching times, and return a typed error
//! where the motion cannot be continued.
//!
//! ```
//! use appell_runtime::integrate::{Dop853, NoObserver, Options, Solver, Watch};
//!
//! let mut x = [1.0, 0.0];
//! let oscillator = |_: f64, x: &[f64], rates: &mut [f64]| {
//!     rates[0] = x[1];
//!     rates[1] = -x[0];
//! };
//! let span = [0.0, std::f64::consts::TAU];
//! let options = Options::default();
//! Solver::<Dop853>::new()
//!     .integrate(oscillator, span, &mut x, &options, &mut Watch::default(), &mut NoObserver)?;
//! assert!((x[0] - 1.0).abs() < 1e-8);
//! # Ok::<(), appell_runtime::integrate::IntegrationError>(())
//! ```

mod block;
mod block_lanes;
mod block_stages;
mod crossings;
mod dense_output;
mod dop853_coefficients;
mod error;
mod events;
mod options;
mod outcome;
mod pace;
mod pairs;
mod pieces;
mod range;
mod rk4;
mod shared;
mod sign_changes;
mod solver;
mod step_size;
mod stops;
mod switches;
mod tableau;
mod watch;

pub use block::BlockSolver;
pub use block_lanes::BlockMotion;
pub use block_stages::Places;
pub use dense_output::DenseOutput;
pub use error::{Cause, Failure, IntegrationError};
pub use events::{Direction, Event, EventFunction, EventHit, HidingFunction};
pub use options::Options;
pub use outcome::{Ending, Outcome, Statistics};
pub use pairs::{Coefficients, Dop853, Dopri5, EmbeddedPair};
pub use pieces::{Piece, Sought, Walk};
pub use range::Range;
pub use rk4::Rk4;
pub use shared::SharedTimes;
pub use solver::Solver;
pub use step_size::Control;
pub use stops::Timetable;
pub use switches::{
    BoundFunction, CrossingFunction, Stretch, StretchFunction, SwitchFunction, Switches,
};
pub use tableau::Row;
pub use watch::{NoObserver, Observer, Projection, ProjectionFunction, Step, Watch};

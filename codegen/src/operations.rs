//! Schedules as graphs of operations, for program transformations: `flatten` converts a schedule to a `graph`,
//! `bind` converts live nodes to a schedule, and `closed_loop` composes two schedules.

pub(crate) mod bind;
pub(crate) mod closed_loop;
pub(crate) mod flatten;
pub(crate) mod graph;

pub use closed_loop::{Seen, closed_loop};

//! Schedules as graphs of operations, for programs that are made from programs: `flatten` reads a schedule into a
//! `graph`, `bind` writes what some results need, and `closed_loop` puts one schedule in front of another.

pub(crate) mod bind;
pub(crate) mod closed_loop;
pub(crate) mod flatten;
pub(crate) mod graph;

pub use closed_loop::{Seen, closed_loop};

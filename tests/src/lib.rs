//! Tests of the whole of appell, and what they share.
//!
//! The tests hold what no single crate can promise: the derived equations are those of the papers,
//! three formulations of mechanics give one motion, three executions of a schedule give one number,
//! and every shipped mechanism obeys the laws. A new spec in `generated/mechanisms` is tested by
//! existing.

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "whatever fails here fails a test, which is the point"
)]

pub use appell_papers::{errata, paper, steering};

pub mod dual;
pub mod engine;
pub mod formula;
pub mod formulations;
pub mod modules;
pub mod place;
pub mod point;
pub mod recorded;
pub mod reference;
pub mod rides;
pub mod shipped;
pub mod steady;

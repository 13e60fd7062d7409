//! The motion between samples, with its transition matrix.
//!
//! | file | idea |
//! |---|---|
//! | `command.rs` | the inputs between rows |
//! | `closure.rs` | closed loops, whose coordinates depend on each other |
//! | `plant.rs` | the equations at one point, with their Jacobians |
//! | `sensors.rs` | lagging channels: filters of the measured quantities |
//! | `timeline.rs` | the order of steps and samples |
//! | `transition.rs` | one step and its transition matrix; step control |
//! | `unfiltered.rs` | the motion alone, along a recording |

pub(crate) mod closure;
pub(crate) mod command;
pub(crate) mod plant;
mod sensors;
pub(crate) mod timeline;
pub(crate) mod transition;
pub(crate) mod unfiltered;

//! Papers whose equations appell derives: their formulas, corrected where necessary, and compared
//! by the identity test.
//!
//! | file | idea |
//! |---|---|
//! | `formula.rs` | formulas as papers print them |
//! | `paper.rs` | the derived equations under the names of the papers |
//! | `equations.rs` | typed equations, compared with the derived ones |
//! | `steering.rs`, `steering.toml` | the equations of *Steering Control of an Autonomous Unicycle*, its tables II and III |
//! | `euc.rs`, `euc.toml` | the equations of *Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle* |
//! | `errata.rs`, `errata.toml` | printed and correct formulas |
//! | `book/` | both papers recomputed, compared with general commands |

#![allow(
    clippy::unwrap_used,
    clippy::missing_panics_doc,
    reason = "every typed formula is a constant of this crate and takes part in a test"
)]

#[warn(clippy::unwrap_used)]
pub mod book;
mod equations;
pub mod errata;
pub mod euc;
pub mod formula;
pub mod paper;
pub mod steering;

//! *Steering Control of an Autonomous Unicycle*, recomputed.
//!
//! | file | part of the book |
//! |---|---|
//! | `equations.rs` | equations that are formulas, by the identity test; definitions |
//! | `numbers.rs` | equations whose content are numbers: critical values, circles, ranks; results beyond the paper |
//! | `tables.rs`, `manoeuvres.rs` | gains; closed loops |
//! | `figure_3.rs` … `figure_8.rs` | figures, and the statements about them |

pub(super) mod equations;
mod figure_3;
mod figure_5;
mod figure_7;
mod figure_8;
mod manoeuvres;
mod numbers;
mod tables;

use super::{Make, Result, Section, made};

/// Parts with their names for progress messages; they are given the number of grid points along each axis.
const PARTS: &[(&str, Make<usize>)] = &[
    ("equations", equations::section),
    ("critical values", numbers::section),
    ("tables", tables::section),
    ("figure 3", figure_3::section),
    ("figure 5", figure_5::section),
    ("figure 6", figure_5::figure_6),
    ("figure 7", figure_7::section),
    ("figure 8", figure_8::section),
    ("results beyond the paper", numbers::additional),
];

/// The book part by part, with charts of `grid` points along each axis; `making` is called with the
/// current part and the progress.
pub fn book(grid: usize, making: impl FnMut(&str, usize, usize)) -> Result<Vec<Section>> {
    made(PARTS, grid, 0, making)
}

//! Papers recomputed: every numbered equation, table and figure beside what general commands find.
//!
//! | file | part of the book |
//! |---|---|
//! | `claim.rs`, `found.rs` | a statement beside ours; steady motions by names |
//! | `equations.rs` | equations that are formulas, by the identity test; definitions |
//! | `numbers.rs` | equations whose content are numbers: critical values, circles, ranks |
//! | `tables.rs`, `manoeuvres.rs` | gains; closed loops |
//! | `figure_3.rs` … `figure_8.rs` | figures, and what they are said to show |
//! | `beyond.rs` | what the paper did not see |
//! | `book.rs` | the page |
//! | `euc/` | the second paper, on simulated rides |

mod beyond;
mod book;
mod claim;
mod equations;
mod euc;
mod figure_3;
mod figure_5;
mod figure_6;
mod figure_7;
mod figure_8;
mod found;
mod manoeuvres;
mod numbers;
mod tables;

pub(crate) use book::page;
pub(crate) use claim::{Claim, Section};
pub(crate) use euc::book as euc;

use crate::failure::Failure;

/// A part of a book: its name while it is made, and what makes it with charts of so many points along
/// each axis.
type Part = (&'static str, fn(usize) -> Result<Section, Failure>);

/// The parts of the paper on steering.
const STEERING: &[Part] = &[
    ("equations", |_| equations::section()),
    ("critical values", |_| numbers::section()),
    ("tables", |_| tables::section()),
    ("figure 3", figure_3::section),
    ("figure 5", figure_5::section),
    ("figure 6", figure_6::section),
    ("figure 7", |_| figure_7::section()),
    ("figure 8", |_| figure_8::section()),
    ("what the paper did not see", |_| beyond::section()),
];

/// *Steering Control of an Autonomous Unicycle*, part by part; `making` hears what is made, and how
/// much of the book is.
pub(crate) fn steering(
    grid: usize,
    mut making: impl FnMut(&str, usize, usize),
) -> Result<Vec<Section>, Failure> {
    let part = |(number, (name, make)): (usize, &Part)| {
        making(name, number, STEERING.len());
        make(grid)
    };
    STEERING.iter().enumerate().map(part).collect()
}

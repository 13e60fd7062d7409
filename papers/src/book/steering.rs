//! *Steering Control of an Autonomous Unicycle*, recomputed.
//!
//! | file | part of the book |
//! |---|---|
//! | `equations.rs` | equations that are formulas, by the identity test; definitions |
//! | `numbers.rs` | equations whose content are numbers: critical values, circles, ranks |
//! | `tables.rs`, `manoeuvres.rs` | gains; closed loops |
//! | `figure_3.rs` … `figure_8.rs` | figures, and what they are said to show |
//! | `beyond.rs` | what the paper did not see |

mod beyond;
pub(super) mod equations;
mod figure_3;
mod figure_5;
mod figure_6;
mod figure_7;
mod figure_8;
mod manoeuvres;
mod numbers;
mod tables;

use appell::Error;

use super::Section;

/// A part of the book: its name while it is made, and what makes it.
type Part = (&'static str, fn() -> Result<Section, Error>);

const PARTS: &[Part] = &[
    ("equations", equations::section),
    ("critical values", numbers::section),
    ("tables", tables::section),
    ("figure 3", figure_3::section),
    ("figure 5", figure_5::section),
    ("figure 6", figure_6::section),
    ("figure 7", figure_7::section),
    ("figure 8", figure_8::section),
    ("what the paper did not see", beyond::section),
];

/// The book part by part; `making` hears what is made, and how much of the book is.
pub fn book(mut making: impl FnMut(&str, usize, usize)) -> Result<Vec<Section>, Error> {
    let part = |(number, (name, make)): (usize, &Part)| {
        making(name, number, PARTS.len());
        make()
    };
    PARTS.iter().enumerate().map(part).collect()
}

//! Papers recomputed: every numbered equation, table and figure beside what general commands find.
//!
//! [`steering`] and [`euc`] make the books part by part, [`page`] writes one as HTML.

mod claim;
pub mod euc;
mod found;
mod page;
pub mod steering;

pub use claim::{Claim, Picture, Reproduction, Section, Tally};
pub use page::page;

//! A gap report for people: a page, and the sentences of any telling.
//!
//! [`page()`] sets [`words`], [`plots`] and tables; [`doubt`] asks after units, [`numbers`] keeps the
//! digits that mean something.

mod doubt;
mod numbers;
mod page;
mod plots;
mod words;

pub use doubt::doubts;
pub use numbers::short;
pub use page::page;
pub use words::{hinted, joined, left_out, sentence};

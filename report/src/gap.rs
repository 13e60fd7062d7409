//! A gap report as a page, and its sentences.
//!
//! [`page()`] sets [`words`], [`plots`] and tables; [`doubt`] suspects unit errors, [`numbers`]
//! writes significant digits.

mod doubt;
mod numbers;
mod page;
mod plots;
mod words;

pub use doubt::doubts;
pub use numbers::short;
pub use page::page;
pub use words::{hinted, joined, left_out, sentence};

//! A gap report as a page, and its sentences.
//!
//! [`headline`] summarises the result, [`page()`] arranges [`words`], [`shares`], [`plots`] and [`elements`];
//! [`budget`] divides the gap, [`law`] shows the measured law of the rest,
//! [`doubt`] suspects unit errors, [`numbers`] writes values with their uncertainty.

mod budget;
mod doubt;
mod elements;
mod headline;
mod law;
mod numbers;
mod page;
mod plots;
mod shares;
mod words;

pub use budget::divided;
pub use doubt::doubts;
pub use headline::Headline;
pub use law::law_sentence;
pub use numbers::{is_determined, percent, share};
pub use page::left_of_forces;
pub use page::page;
pub use words::{
    before_sentence, events, hints, joined, left_out, ranges, refit_sentence, said, sentence,
};

pub use crate::text::short;

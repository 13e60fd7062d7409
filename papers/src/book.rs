//! Papers recomputed: every numbered equation, table and figure, compared with the results of
//! general commands.
//!
//! [`steering`] and [`euc`] make the books part by part, [`page`] writes one as HTML.

mod claim;
pub mod euc;
mod page;
mod steady_motions;
pub mod steering;

use appell::Error;

pub use claim::{Claim, Picture, Reproduction, SIMULATED, Section, Tally};
pub use page::page;

/// A computation that fails for this reason.
pub(crate) fn failed(reason: &str) -> Error {
    Error::Computation(reason.to_owned().into())
}

/// A text with one passage replaced.
pub(crate) fn replaced(text: &str, before: &str, with: &str) -> Result<String, Error> {
    if !text.contains(before) {
        return Err(failed(&format!(
            "`{before}` does not occur in the text to change"
        )));
    }
    Ok(text.replacen(before, with, 1))
}

/// A computation that fails with this error.
pub(crate) fn computation(error: impl std::fmt::Display) -> Error {
    Error::Computation(error.to_string().into())
}

//! Papers recomputed: every numbered equation, table and figure, compared with the results of
//! general commands.
//!
//! [`steering`] and [`euc`] make the books part by part, [`page`] writes one as HTML. The texts of a
//! part (`figure_7.toml`) stand next to its computation (`figure_7.rs`).

mod claim;
mod equations;
pub mod euc;
mod page;
mod steady_motions;
pub mod steering;

use appell::Error;
use appell_analysis::control::operating_point::MotionEquations;
use appell_models::Shipped;
use appell_report::figure::{Figure, Panel, Series};
use appell_runtime::model::ModelInfo;

use claim::Part;

pub use claim::{Claim, Picture, Reproduction, Section, Tally};
pub use page::page;

/// A result, or the reason why a computation failed.
pub(crate) type Result<T> = std::result::Result<T, Error>;

/// A function that makes a section from the data common to the parts of a book.
type Make<C> = fn(C) -> Result<Section>;

/// The parts of a book, made from their common data after some steps that are done; `making` is called with the current part
/// and the progress.
fn made<C: Copy>(
    parts: &[(&str, Make<C>)],
    shared: C,
    done: usize,
    mut making: impl FnMut(&str, usize, usize),
) -> Result<Vec<Section>> {
    let sections = parts.iter().enumerate().map(|(number, (name, make))| {
        making(name, done + number, done + parts.len());
        make(shared)
    });
    sections.collect()
}

/// A shipped mechanism.
pub(crate) fn shipped(name: &str) -> Result<&'static Shipped> {
    Shipped::find(name).ok_or_else(|| failed(&format!("no shipped mechanism `{name}`")))
}

/// Index of a state.
pub(crate) fn state(info: &ModelInfo, name: &str) -> Result<usize> {
    let index = info.state_index(name);
    index.ok_or_else(|| failed(&format!("the model has no state `{name}`")))
}

/// Index of a parameter.
pub(crate) fn parameter(info: &ModelInfo, name: &str) -> Result<usize> {
    let index = info.parameter_index(name);
    index.ok_or_else(|| failed(&format!("the model has no parameter `{name}`")))
}

/// Rows of states in linearised equations.
pub(crate) fn rows(equations: &MotionEquations, states: &[usize]) -> Result<Vec<usize>> {
    let row = |state: &usize| {
        let row = equations.states.iter().position(|kept| kept == state);
        row.ok_or_else(|| failed("a state depends on others"))
    };
    states.iter().map(row).collect()
}

/// A computation that fails for this reason.
pub(crate) fn failed(reason: &str) -> Error {
    Error::computation(reason.to_owned())
}

/// A computation that fails with this error.
pub(crate) fn computation(error: impl std::fmt::Display) -> Error {
    Error::computation(error.to_string())
}

/// A text with passages replaced, one after another.
pub(crate) fn edited<'a>(
    text: &str,
    edits: impl IntoIterator<Item = &'a (&'a str, &'a str)>,
) -> Result<String> {
    let mut edits = edits.into_iter();
    edits.try_fold(text.to_owned(), |text, (before, with)| {
        if !text.contains(before) {
            let reason = format!("`{before}` does not occur in the text to change");
            return Err(failed(&reason));
        }
        Ok(text.replacen(before, with, 1))
    })
}

/// A line with a name in the legend.
pub(crate) fn line(label: &str, x: Vec<f64>, y: Vec<f64>) -> Series {
    let label = label.to_owned();
    Series { label, x, y }
}

/// Paths in a plane, in m, with one scale.
pub(crate) fn paths(title: &str, x_label: &str, series: Vec<Series>) -> Figure {
    Figure {
        equal_axes: true,
        ..Figure::new(title, x_label, vec![Panel::new("m", series)])
    }
}

//! The statistics of a study, as text and as a page with figures.

mod figures;
mod page;
mod parts;

use appell_ensemble::rows::Column;
use appell_ensemble::summary::Summary;

pub use figures::{Named, figures};
pub use page::page;
pub use parts::{Part, parts, sentences};

use crate::text::table;

/// What a report is about.
#[derive(Debug, Clone, Copy)]
pub struct About<'a> {
    /// Its title.
    pub title: &'a str,
    /// The study file.
    pub study: &'a str,
    /// The columns of the rows.
    pub columns: &'a [Column],
    /// Their statistics.
    pub summary: &'a Summary,
}

/// The statistics as text.
pub fn text(about: &About<'_>) -> String {
    let mut text = format!("{}\n", about.title);
    for sentence in sentences(about) {
        text += &format!("  {sentence}\n");
    }
    for part in parts(about) {
        text += &format!("\n{}\n", part.heading);
        text += &table(&part.rows, 1..part.rows.first().map_or(1, Vec::len));
        for note in &part.notes {
            text += &format!("  {note}\n");
        }
    }
    text
}

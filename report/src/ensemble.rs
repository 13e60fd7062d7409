//! The statistics of a study, as text and as a page with figures.

mod about;
mod figures;
mod page;
mod parts;

pub use about::About;
pub use figures::{Named, figures};
pub use page::page;
pub use parts::{Part, parts, sentences};

use std::fmt::Write as _;

use crate::text::table;

/// The statistics as text.
pub fn text(about: &About<'_>) -> String {
    let mut text = format!("{}\n", about.title);
    // Writing to a string cannot fail.
    for sentence in sentences(about) {
        let _ = writeln!(text, "  {sentence}");
    }
    for part in parts(about) {
        let _ = writeln!(text, "\n{}", part.heading);
        text += &table(&part.rows, 1..part.rows.first().map_or(1, Vec::len));
        for note in &part.notes {
            let _ = writeln!(text, "  {note}");
        }
    }
    text
}

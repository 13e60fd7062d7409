//! The statistics of a study, as text and as a page with figures.

mod figures;
mod parts;

use std::fmt::Write as _;

use appell_ensemble::rows::Column;
use appell_ensemble::summary::Summary;
use maud::{PreEscaped, html};

use crate::page_shell::PageShell;
use parts::{parts, sentences};

pub use figures::{Named, figures};

/// A study with its statistics.
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
    // Writing to a string cannot fail.
    for sentence in sentences(about) {
        let _ = writeln!(text, "  {sentence}");
    }
    for part in parts(about) {
        let _ = writeln!(text, "\n{}", part.heading);
        text += &part.text();
        for note in &part.notes {
            let _ = writeln!(text, "  {note}");
        }
    }
    text
}

/// Light and dark, as the figures inside.
const STYLE: &str = include_str!("identification/page.css");

/// The self-contained HTML page.
pub fn page(about: &About<'_>) -> String {
    PageShell::new(about.title, STYLE).around(&html! {
        h1 { (about.title) }
        @for sentence in sentences(about) {
            p { (sentence) "." }
        }
        @for part in parts(about) {
            (part.html())
        }
        @for figure in figures(about) {
            h2 { (figure.heading) }
            (PreEscaped(&figure.svg))
        }
        h2 { "The study" }
        pre { (about.study) }
    })
}

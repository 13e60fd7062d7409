//! The statistics of a study, as text and as a page with figures.

mod figures;
mod parts;

use std::fmt::Write as _;

use maud::{PreEscaped, html};

use crate::page_shell::PageShell;
use parts::{parts, sentences};

pub use figures::{Named, figures};
pub use parts::About;

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

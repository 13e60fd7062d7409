//! The statistics as a self-contained HTML page.

use maud::{PreEscaped, html};

use super::About;
use super::figures::figures;
use super::parts::{parts, sentences};
use crate::page_shell::PageShell;

/// Light and dark, as the figures inside.
const STYLE: &str = include_str!("../identification/page.css");

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

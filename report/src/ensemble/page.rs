//! The statistics as a self-contained HTML page.

use maud::{Markup, PreEscaped, html};

use super::about::About;
use super::figures::figures;
use super::parts::{Part, parts, sentences};
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
            (table(&part))
        }
        @for figure in figures(about) {
            h2 { (figure.heading) }
            (PreEscaped(&figure.svg))
        }
        h2 { "The study" }
        pre { (about.study) }
    })
}

fn table(part: &Part) -> Markup {
    let class = |column: usize| (column > 0).then_some("number");
    html! {
        h2 { (part.heading) }
        div class="wide" {
            table {
                @if let Some((heads, rows)) = part.rows.split_first() {
                    tr {
                        @for (column, cell) in heads.iter().enumerate() {
                            th class=[class(column)] { (cell) }
                        }
                    }
                    @for row in rows {
                        tr {
                            @for (column, cell) in row.iter().enumerate() {
                                td class=[class(column)] { (cell) }
                            }
                        }
                    }
                }
            }
        }
        @for note in &part.notes {
            p { (note) }
        }
    }
}

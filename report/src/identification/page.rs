//! The result as a self-contained HTML page.

use appell_gap::identify::Answer;
use appell_recordings::DataSet;
use maud::{PreEscaped, html};

use super::{figure, parts, warnings};
use crate::page_shell::PageShell;
use crate::recording;

/// Light and dark, as the figure inside.
const STYLE: &str = include_str!("page.css");

/// The self-contained HTML page.
pub fn page(set: &DataSet, answer: &Answer) -> String {
    let name = &set.mechanism.name;
    let title = format!("{name}: parameters");
    PageShell::new(&title, STYLE).around(&html! {
        h1 { (name) ": parameters from recordings" }
        @for warning in warnings(answer) {
            p { strong { (warning) } }
        }
        @for (index, part) in parts(set, answer).iter().enumerate() {
            (part.html())
            @if index == 0 && !answer.traces.is_empty() {
                h2 { "The runs that were held out" }
                (PreEscaped(figure(set, answer).to_svg()))
            }
        }
        h2 { "The recordings" }
        pre { (recording::text(set)) }
    })
}

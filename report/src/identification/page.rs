//! The result as a self-contained HTML page.

use appell_gap::identify::Answer;
use appell_recordings::DataSet;
use maud::{Markup, PreEscaped, html};

use super::{Part, figure, parts, warnings};
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
            h2 { (part.heading) }
            (table(part))
            @if !part.note.is_empty() {
                p { (part.note) }
            }
            @if index == 0 && !answer.traces.is_empty() {
                h2 { "The runs that were held out" }
                (PreEscaped(figure(set, answer).to_svg()))
            }
        }
        h2 { "The recordings" }
        pre { (recording::text(set)) }
    })
}

fn table(part: &Part) -> Markup {
    let class = |column| part.numbers.contains(&column).then_some("number");
    let style = |cell: &String| cell.parse().ok().filter(|_| part.is_heat).map(heat);
    html! {
        div class="wide" {
            table {
                @if let Some((heading, rows)) = part.rows.split_first() {
                    tr {
                        @for (column, cell) in heading.iter().enumerate() {
                            th class=[class(column)] { (cell) }
                        }
                    }
                    @for row in rows {
                        tr {
                            @for (column, cell) in row.iter().enumerate() {
                                td class=[class(column)] style=[style(cell)] { (cell) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The colour of a number between -1 and 1.
fn heat(value: f64) -> String {
    let colour = if value < 0.0 { "#d1602b" } else { "#2f6fb3" };
    let part = 70.0 * value.abs().min(1.0);
    format!("background: color-mix(in srgb, {colour} {part:.0}%, transparent)")
}

//! Elements of the page: tables, bars, figures.

use maud::{Markup, PreEscaped, html};

use super::numbers::percent;

/// A table; the columns from `numbers` on are right-aligned.
pub(super) fn table<const N: usize>(
    heading: [&str; N],
    rows: impl Iterator<Item = [Markup; N]>,
    numbers: usize,
) -> Markup {
    let class = |column: usize| (column >= numbers).then_some("number");
    html! {
        table {
            tr {
                @for (column, text) in heading.iter().enumerate() {
                    th class=[class(column)] { (text) }
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

/// Items with separators.
pub(super) fn separated<T>(list: &[T], shown: impl Fn(&T) -> Markup, between: &Markup) -> Markup {
    html! {
        @for (index, item) in list.iter().enumerate() {
            @if index > 0 { (between) }
            (shown(item))
        }
    }
}

/// A share as a bar with its number.
pub(super) fn bar(part: f64) -> Markup {
    html! {
        span class="share" { (bare_bar(part)) " " (percent(part)) }
    }
}

/// A share as a bar.
pub(super) fn bare_bar(part: f64) -> Markup {
    let width = format!("width:{:.1}%", 100.0 * part.clamp(0.0, 1.0));
    html! {
        span class="bar" { i style=(width) {} }
    }
}

pub(super) fn figure(svg: String, caption: &str) -> Markup {
    html! {
        figure { (PreEscaped(svg)) figcaption { (caption) } }
    }
}

/// A name of the spec.
pub(super) fn code(text: &str) -> Markup {
    html! { code { (text) } }
}

pub(super) fn cells<const N: usize>(texts: [String; N]) -> [Markup; N] {
    texts.map(|text| html! { (text) })
}

//! Tables of a report with their headings, for text and pages.

use std::ops::Range;

use maud::{Markup, html};

/// A table with its heading and notes.
pub(crate) struct Part {
    /// Its heading.
    pub(crate) heading: String,
    /// Its rows, the first one with the names of the columns.
    pub(crate) rows: Vec<Vec<String>>,
    /// Columns with right-aligned numbers.
    pub(crate) numbers: Range<usize>,
    /// Whether the numbers are correlations, which a page colours.
    pub(crate) is_heat: bool,
    /// Notes below the table.
    pub(crate) notes: Vec<String>,
}

impl Part {
    /// A table without rows.
    pub(crate) fn new<const N: usize>(
        heading: &str,
        columns: [&str; N],
        numbers: Range<usize>,
    ) -> Self {
        Self {
            heading: heading.to_owned(),
            rows: vec![columns.map(str::to_owned).to_vec()],
            numbers,
            is_heat: false,
            notes: Vec::new(),
        }
    }

    /// Heading, table and notes of a page.
    pub(crate) fn html(&self) -> Markup {
        let class = |column| self.numbers.contains(&column).then_some("number");
        let style = |cell: &String| cell.parse().ok().filter(|_| self.is_heat).map(heat);
        html! {
            h2 { (self.heading) }
            div class="wide" {
                table {
                    @for (index, row) in self.rows.iter().enumerate() {
                        tr {
                            @for (column, cell) in row.iter().enumerate() {
                                @if index == 0 {
                                    th class=[class(column)] { (cell) }
                                } @else {
                                    td class=[class(column)] style=[style(cell)] { (cell) }
                                }
                            }
                        }
                    }
                }
            }
            @for note in &self.notes {
                p { (note) }
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

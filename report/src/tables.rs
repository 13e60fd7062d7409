//! Tables of a report with their headings, for text and pages.

use std::ops::Range;

use maud::{Markup, html};

use crate::text::table;

/// A table with its heading and notes.
pub(crate) struct Table {
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

impl Table {
    /// A table without rows; `|` separates the names of its columns.
    pub(crate) fn new(heading: &str, columns: &str, numbers: Range<usize>) -> Self {
        let columns = columns.split('|').map(|name| name.trim().to_owned());
        Self {
            heading: heading.to_owned(),
            rows: vec![columns.collect()],
            numbers,
            is_heat: false,
            notes: Vec::new(),
        }
    }

    /// Whether there is more than the names of the columns.
    pub(crate) fn has_rows(&self) -> bool {
        self.rows.len() > 1
    }

    /// The table alone as text.
    pub(crate) fn text(&self) -> String {
        table(&self.rows, self.numbers.clone())
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

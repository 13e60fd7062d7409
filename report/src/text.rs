//! Tables as text and for pages, and readable numbers.

use std::ops::Range;

use maud::{Markup, html};

/// Rows with columns as wide as needed; the columns from `numbers` on are right-aligned.
pub fn table(rows: &[Vec<String>], numbers: std::ops::Range<usize>) -> String {
    let length = |cell: &str| cell.chars().count();
    let widths = widths(rows, length);
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let padding = " ".repeat(widths[column] - length(cell));
            let [before, after] = if numbers.contains(&column) {
                [padding.as_str(), ""]
            } else {
                ["", padding.as_str()]
            };
            line.extend(["  ", before, cell, after]);
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// A row of a table, with everything that can be displayed as a cell.
#[macro_export]
macro_rules! row {
    ($($cell:expr),* $(,)?) => {
        vec![$($cell.to_string()),*]
    };
}

/// Widths of the columns of some rows.
pub(crate) fn widths(rows: &[Vec<String>], width: impl Fn(&str) -> usize) -> Vec<usize> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widest = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| width(cell)).max().unwrap_or(0)
    };
    (0..columns).map(widest).collect()
}

/// A number with its unit; the unit 1 is omitted.
pub fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" | "1" => number.to_owned(),
        unit => format!("{number} {unit}"),
    }
}

/// A number with six significant digits; a very small or large one has an exponent and four.
pub fn number(value: f64) -> String {
    if !(1e-4..1e6).contains(&value.abs()) && value != 0.0 {
        return format!("{value:.3e}");
    }
    significant(value, 6)
}

/// A number with three significant digits; a very small or large one has an exponent and two.
pub fn short(value: f64) -> String {
    match value {
        value if value.is_nan() => "unknown".to_owned(),
        f64::INFINITY => "∞".to_owned(),
        f64::NEG_INFINITY => "−∞".to_owned(),
        value if !(1e-3..1e5).contains(&value.abs()) && value != 0.0 => format!("{value:.1e}"),
        value => significant(value, 3),
    }
}

fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let decimals = usize::try_from(digits - 1 - exponent(value)).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// With a capital letter at the beginning.
pub(crate) fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(letters).collect()
}

/// A prediction horizon in s: 0 is one step, infinity the free run to the end.
pub fn horizon(seconds: f64) -> String {
    if seconds <= 0.0 {
        "one step".to_owned()
    } else if seconds.is_finite() {
        format!("{seconds} s")
    } else {
        "free run".to_owned()
    }
}

/// Decimal exponent of the first digit of a finite number other than 0.
#[expect(clippy::cast_possible_truncation, reason = "between -324 and 308")]
pub(crate) fn exponent(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

/// A table with its heading and notes.
pub(crate) struct Table {
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

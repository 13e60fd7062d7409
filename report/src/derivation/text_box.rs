//! Boxes of characters, the elements of a text page: lines of equal width, one of which is the
//! baseline.

use crate::text::widths;
use appell_codegen::symbolic::print::columns;

/// A rectangle of characters.
#[derive(Debug, Clone)]
pub(super) struct TextBox {
    lines: Vec<String>,
    /// The baseline.
    base: usize,
}

impl TextBox {
    /// One line.
    pub(super) fn line(text: &str) -> Self {
        Self {
            lines: vec![text.to_owned()],
            base: 0,
        }
    }

    /// Columns.
    pub(super) fn width(&self) -> usize {
        let widths = self.lines.iter().map(|line| columns(line));
        widths.max().unwrap_or(0)
    }

    /// Lines.
    pub(super) fn height(&self) -> usize {
        self.lines.len()
    }

    /// Its lines.
    pub(super) fn lines(&self) -> impl Iterator<Item = &str> {
        self.lines.iter().map(String::as_str)
    }

    /// Two adjacent boxes, with aligned baselines.
    pub(super) fn beside(&self, right: &Self) -> Self {
        let base = self.base.max(right.base);
        let below = (self.height() - self.base).max(right.height() - right.base);
        let width = self.width();
        let at = |boxed: &Self, row: usize| -> String {
            (row + boxed.base)
                .checked_sub(base)
                .and_then(|k| boxed.lines.get(k))
                .cloned()
                .unwrap_or_default()
        };
        let lines = (0..base + below)
            .map(|row| padded(&at(self, row), width) + &at(right, row))
            .collect();
        Self { lines, base }
    }

    /// Cells in square brackets, columns aligned to the left.
    pub(super) fn bracketed(cells: &[Vec<String>]) -> Self {
        let widths = widths(cells, columns);
        let last = cells.len().saturating_sub(1);
        let line = |(i, row): (usize, &Vec<String>)| {
            let [open, close] = match i {
                _ if last == 0 => ["[", "]"],
                0 => ["⎡", "⎤"],
                _ if i == last => ["⎣", "⎦"],
                _ => ["⎢", "⎥"],
            };
            let cells = row.iter().zip(&widths);
            let cells: Vec<String> = cells.map(|(cell, &width)| padded(cell, width)).collect();
            format!("{open} {} {close}", cells.join("   "))
        };
        let lines = cells.iter().enumerate().map(line).collect();
        Self {
            base: last / 2,
            lines,
        }
    }

    /// A quotient with a bar.
    pub(super) fn quotient(above: &str, below: &str) -> Self {
        let width = columns(above).max(columns(below));
        let [above, below] = [above, below].map(|text| centred(text, width));
        Self {
            lines: vec![above, "─".repeat(width), below],
            base: 1,
        }
    }

    /// Writes behind the last line.
    pub(super) fn append_to_last(&mut self, text: &str) {
        if let Some(line) = self.lines.last_mut() {
            line.push_str(text);
        }
    }
}

fn padded(text: &str, width: usize) -> String {
    format!("{text}{}", " ".repeat(width.saturating_sub(columns(text))))
}

fn centred(text: &str, width: usize) -> String {
    let free = width.saturating_sub(columns(text));
    let before = " ".repeat(free / 2);
    padded(&format!("{before}{text}"), width)
}

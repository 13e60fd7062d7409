//! Unicode text: the page for a terminal or a plain-text handout.

use appell_codegen::symbolic::print::{columns, text as inline};
use appell_spec::foreign::one_line;

use super::display::{Equation, Piece, left_width};
use super::{Block, Chain, Math, Page, Row, Span, Table};
use crate::text::widths;

/// Width of the page in characters.
const WIDTH: usize = 100;
/// Indentation of displayed equations.
const INDENT: usize = 4;
/// Width of the right margin with the lines of the spec, in columns.
const MARGIN: usize = 6;

/// The page as Unicode text.
pub fn text(page: &Page) -> String {
    let mut out = String::new();
    let title = one_line(&page.title);
    line(&mut out, &title);
    line(&mut out, &"═".repeat(columns(&title)));
    if let Some(source) = &page.source {
        line(&mut out, "");
        paragraph(&mut out, &format!("Source: {}", one_line(source)));
    }
    for (index, section) in page.sections.iter().enumerate() {
        let heading = format!("{}  {}", index + 1, spans(&section.heading));
        line(&mut out, "");
        line(&mut out, &heading);
        line(&mut out, &"─".repeat(columns(&heading)));
        for block in &section.blocks {
            line(&mut out, "");
            match block {
                Block::Sentence(sentence) => paragraph(&mut out, &spans(sentence)),
                Block::Table(t) => table(&mut out, t),
                Block::Chain(c) => chain(&mut out, c),
                Block::Equations(all) => equations(&mut out, all),
            }
        }
    }
    out
}

fn line(out: &mut String, text: &str) {
    out.push_str(text.trim_end());
    out.push('\n');
}

fn spans(spans: &[Span]) -> String {
    let shown = spans.iter().map(|span| match span {
        Span::Text(text) => one_line(text),
        Span::Math(math) => inline(math),
    });
    shown.collect()
}

/// Words in lines of at most `width` columns, where no word is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut current = String::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        if !current.is_empty() {
            if columns(&current) + 1 + columns(word) > width {
                lines.push(std::mem::take(&mut current));
            } else {
                current.push(' ');
            }
        }
        current.push_str(word);
    }
    lines.push(current);
    lines
}

fn paragraph(out: &mut String, text: &str) {
    for part in wrapped(text, WIDTH) {
        line(out, &part);
    }
}

/// Columns as wide as their cells need; the last one wraps.
fn table(out: &mut String, table: &Table) {
    const GAP: usize = 3;
    let cells = |row: &Row| row.cells.iter().map(|cell| spans(cell)).collect();
    let rows: Vec<Vec<String>> = table.rows.iter().map(cells).collect();
    let widths = widths(&rows, columns);
    if !table.title.is_empty() {
        line(out, &format!("  {}", one_line(&table.title)));
    }
    for (row, cells) in table.rows.iter().zip(rows) {
        let Some((last, firsts)) = cells.split_last() else {
            continue;
        };
        let mut head = " ".repeat(INDENT);
        for (cell, &width) in firsts.iter().zip(&widths) {
            head.push_str(cell);
            head.push_str(&" ".repeat(width + GAP - columns(cell)));
        }
        let indent = columns(&head);
        let free = WIDTH.saturating_sub(indent + MARGIN);
        let mut lines;
        if free < WIDTH / 5 {
            // Without room after the other cells the last one continues below.
            lines = broken(head.trim_end());
            let below = wrapped(last, WIDTH - 3 * INDENT - MARGIN);
            lines.extend(indented(below, 3 * INDENT));
        } else {
            lines = indented(wrapped(last, free.max(WIDTH / 4)), indent);
            lines[0].replace_range(..indent, &head);
        }
        let right = WIDTH.saturating_sub(columns(&lines[0]));
        lines[0] = format!("{}{:>right$}", lines[0], row.line);
        for text in &lines {
            line(out, text);
        }
    }
}

fn indented(lines: Vec<String>, columns: usize) -> Vec<String> {
    let indent = " ".repeat(columns);
    lines
        .into_iter()
        .map(|text| format!("{indent}{text}"))
        .collect()
}

/// A row as wide as a page, broken into several lines left of the margin.
fn broken(text: &str) -> Vec<String> {
    if columns(text) + MARGIN <= WIDTH {
        return vec![text.to_owned()];
    }
    let mut lines = indented(wrapped(text, WIDTH - 2 * INDENT - MARGIN), 2 * INDENT);
    lines[0].replace_range(..INDENT, "");
    lines
}

fn chain(out: &mut String, chain: &Chain) {
    let mut current = format!("{}{}", " ".repeat(INDENT), one_line(&chain.start));
    for (label, to) in &chain.links {
        let link = match spans(label).as_str() {
            "" => format!(" ────▶ {}", one_line(to)),
            label => format!(" ── {label} ──▶ {}", one_line(to)),
        };
        if columns(&current) + columns(&link) > WIDTH {
            line(out, &current);
            current = " ".repeat(2 * INDENT);
        }
        current.push_str(&link);
    }
    line(out, &current);
}

/// Equations below each other, aligned at their equality signs.
fn equations(out: &mut String, equations: &[Equation]) {
    let left_width = left_width(equations);
    let mut after_tall = false;
    for (index, equation) in equations.iter().enumerate() {
        let display = equation.display(WIDTH - INDENT, left_width);
        let space = |width: usize| TextBox::line(&" ".repeat(width));
        let (head, indent) = match display.left.map(boxed) {
            Some(left) => {
                let pad = space(INDENT + left_width.saturating_sub(left.width()));
                let head = pad.beside(&left).beside(&TextBox::line(" = "));
                let indent = head.width();
                (head, indent)
            }
            None => (space(INDENT), 2 * INDENT),
        };
        let starts = std::iter::once(head).chain(std::iter::repeat_with(|| space(indent)));
        let lines = display.lines.iter().zip(starts);
        let whole: Vec<TextBox> = lines
            .map(|(pieces, start)| start.beside(&pieces_box(pieces)))
            .collect();
        // Blank lines around blocks taller than a line.
        let tall = whole.len() > 1 || whole.iter().any(|p| p.height() > 1);
        if index > 0 && (tall || after_tall) {
            line(out, "");
        }
        after_tall = tall;
        for part in whole {
            part.lines().for_each(|l| line(out, l));
        }
    }
}

fn pieces_box(pieces: &[Piece<'_>]) -> TextBox {
    let mut line = TextBox::line("");
    let mut is_after_minus = false;
    for piece in pieces {
        let space = if line.width() == 0 { "" } else { " " };
        let next = match *piece {
            Piece::Whole(math) => {
                let next = boxed(math);
                // A minus must not run into the bar of a quotient.
                let runs_in = next.height() > 1 && is_after_minus;
                TextBox::line(if runs_in { " " } else { "" }).beside(&next)
            }
            Piece::Times => TextBox::line(" "),
            Piece::Sign { minus, first: true } => TextBox::line(if minus { "−" } else { "" }),
            Piece::Sign { minus, .. } => {
                TextBox::line(&format!("{space}{} ", if minus { "−" } else { "+" }))
            }
            Piece::Equals => TextBox::line(&format!("{space}= ")),
            Piece::Open => TextBox::line("("),
            Piece::Close => TextBox::line(")"),
        };
        is_after_minus = matches!(
            piece,
            Piece::Sign {
                minus: true,
                first: true
            }
        );
        line = line.beside(&next);
    }
    line
}

/// A formula that may take several lines: matrices, columns and quotients of sums do.
fn boxed(math: &Math) -> TextBox {
    match math {
        Math::Matrix(rows) => {
            let cells = |row: &Vec<Math>| row.iter().map(inline).collect();
            TextBox::bracketed(&rows.iter().map(cells).collect::<Vec<_>>())
        }
        Math::Vector {
            components,
            frame,
            column: true,
        } => {
            let cells: Vec<Vec<String>> = components.iter().map(|c| vec![inline(c)]).collect();
            let mut boxed = TextBox::bracketed(&cells);
            if let Some(frame) = frame {
                boxed.append_to_last(&format!(" {}", one_line(frame)));
            }
            boxed
        }
        Math::Fraction(above, below) if is_tall(above) || is_tall(below) => {
            TextBox::quotient(&inline(above), &inline(below))
        }
        Math::Row(factors) => {
            let boxes = factors.iter().map(boxed);
            let beside = |left: TextBox, right| left.beside(&TextBox::line(" ")).beside(&right);
            boxes.reduce(beside).unwrap_or_else(|| TextBox::line(""))
        }
        other => TextBox::line(&inline(other)),
    }
}

fn is_tall(part: &Math) -> bool {
    matches!(part, Math::Sum(_)) || part.width() > 12
}

/// A rectangle of characters.
#[derive(Debug, Clone)]
pub(super) struct TextBox {
    lines: Vec<String>,
    /// The baseline.
    base: usize,
}

impl TextBox {
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

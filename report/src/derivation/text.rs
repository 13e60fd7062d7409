//! Unicode text: the page for a terminal or a plain-text handout.

use super::display::{Equation, Piece, left_width};
use super::text_box::TextBox;
use super::{Block, Chain, Math, Page, Span, Table};
use appell_codegen::symbolic::print::columns;
use appell_codegen::symbolic::print::text as inline;
use appell_spec::foreign::one_line;

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
    spans
        .iter()
        .map(|span| match span {
            Span::Text(text) => one_line(text),
            Span::Math(math) => inline(math),
        })
        .collect()
}

/// Words in lines of at most `width` columns, where no word is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut used = 0;
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        if used > 0 && used + 1 + columns(word) > width {
            lines.push(String::new());
            used = 0;
        }
        if let Some(current) = lines.last_mut() {
            if used > 0 {
                current.push(' ');
                used += 1;
            }
            current.push_str(word);
            used += columns(word);
        }
    }
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
    let rows: Vec<Vec<String>> = table
        .rows
        .iter()
        .map(|row| row.cells.iter().map(|cell| spans(cell)).collect())
        .collect();
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count)
        .map(|k| {
            rows.iter()
                .filter_map(|row| row.get(k))
                .map(|cell| columns(cell))
                .max()
                .unwrap_or(0)
        })
        .collect();
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
        if free < WIDTH / 5 {
            // Without room after the other cells the last one continues below.
            let mut heads = broken(head.trim_end()).into_iter();
            let text = heads.next().unwrap_or_default();
            let right = WIDTH.saturating_sub(columns(&text));
            line(out, &format!("{text}{:>right$}", row.line));
            heads.for_each(|part| line(out, &part));
            for part in wrapped(last, WIDTH - 3 * INDENT - MARGIN) {
                line(out, &format!("{}{part}", " ".repeat(3 * INDENT)));
            }
            continue;
        }
        for (k, part) in wrapped(last, free.max(WIDTH / 4)).iter().enumerate() {
            if k > 0 {
                line(out, &format!("{}{part}", " ".repeat(indent)));
                continue;
            }
            let text = format!("{head}{part}");
            let right = WIDTH.saturating_sub(columns(&text));
            line(out, &format!("{text}{:>right$}", row.line));
        }
    }
}

/// A row as wide as a page, broken into several lines left of the margin.
fn broken(text: &str) -> Vec<String> {
    if columns(text) + MARGIN <= WIDTH {
        return vec![text.to_owned()];
    }
    let parts = wrapped(text, WIDTH - 2 * INDENT - MARGIN).into_iter();
    let indented =
        |(k, part): (usize, String)| format!("{}{part}", " ".repeat(INDENT * (1 + k.min(1))));
    parts.enumerate().map(indented).collect()
}

fn chain(out: &mut String, chain: &Chain) {
    let mut current = format!("{}{}", " ".repeat(INDENT), one_line(&chain.start));
    for (label, to) in &chain.links {
        let link = format!(" ──{}─▶ {}", arrow_label(&spans(label)), one_line(to));
        if columns(&current) + columns(&link) > WIDTH {
            line(out, &current);
            current = " ".repeat(2 * INDENT);
        }
        current.push_str(&link);
    }
    line(out, &current);
}

fn arrow_label(label: &str) -> String {
    if label.is_empty() {
        "─".to_owned()
    } else {
        format!(" {label} ─")
    }
}

/// Equations below each other, aligned at their equality signs.
fn equations(out: &mut String, equations: &[Equation]) {
    let left_width = left_width(equations);
    let mut after_tall = false;
    for (index, equation) in equations.iter().enumerate() {
        let display = equation.display(WIDTH - INDENT, left_width);
        let (head, indent) = match display.left {
            Some(left) => {
                let left = boxed(left);
                let pad = " ".repeat(INDENT + left_width.saturating_sub(left.width()));
                let head = TextBox::line(&pad)
                    .beside(&left)
                    .beside(&TextBox::line(" = "));
                let indent = head.width();
                (head, indent)
            }
            None => (TextBox::line(&" ".repeat(INDENT)), 2 * INDENT),
        };
        let mut whole: Vec<TextBox> = Vec::new();
        for (k, pieces) in display.lines.iter().enumerate() {
            let start = if k == 0 {
                head.clone()
            } else {
                TextBox::line(&" ".repeat(indent))
            };
            whole.push(start.beside(&pieces_box(pieces)));
        }
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
    let mut boxed = TextBox::line("");
    let (mut after_whole, mut after_minus) = (false, false);
    for piece in pieces {
        let space = if boxed.width() == 0 { "" } else { " " };
        let next = match piece {
            Piece::Whole(math) => {
                let next = self::boxed(math);
                // A minus must not run into the bar of a quotient.
                let runs_in = after_whole || (next.height() > 1 && after_minus);
                let gap = if runs_in { " " } else { "" };
                TextBox::line(gap).beside(&next)
            }
            Piece::Sign { minus, first: true } => TextBox::line(if *minus { "−" } else { "" }),
            Piece::Sign { minus, .. } => {
                TextBox::line(&format!("{space}{} ", if *minus { "−" } else { "+" }))
            }
            Piece::Equals => TextBox::line(&format!("{space}= ")),
            Piece::Open => TextBox::line(if after_whole { " (" } else { "(" }),
            Piece::Close => TextBox::line(")"),
        };
        after_whole = matches!(piece, Piece::Whole(_) | Piece::Close);
        after_minus = matches!(
            piece,
            Piece::Sign {
                minus: true,
                first: true
            }
        );
        boxed = boxed.beside(&next);
    }
    boxed
}

/// A formula that may take several lines: matrices, columns and quotients of sums do.
fn boxed(math: &Math) -> TextBox {
    match math {
        Math::Matrix(rows) => {
            let cells: Vec<Vec<String>> = rows
                .iter()
                .map(|row| row.iter().map(inline).collect())
                .collect();
            TextBox::bracketed(&cells)
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
            factors
                .iter()
                .enumerate()
                .fold(TextBox::line(""), |boxed, (k, factor)| {
                    let gap = if k == 0 { "" } else { " " };
                    boxed
                        .beside(&TextBox::line(gap))
                        .beside(&self::boxed(factor))
                })
        }
        other => TextBox::line(&inline(other)),
    }
}

fn is_tall(part: &Math) -> bool {
    matches!(part, Math::Sum(_)) || part.width() > 12
}

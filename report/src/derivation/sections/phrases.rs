//! Sentences, lists, tables and formulas common to the sections.

use appell_spec::mechanism::Label;

use super::super::{About, Block, Equation, Letter, Math, Row, Section, Span, Table, Writer};
use crate::text::capitalised;

/// A section with a heading of words.
pub(super) fn headed(heading: &str, blocks: Vec<Block>) -> Section {
    Section {
        heading: vec![words(heading)],
        blocks,
    }
}

pub(super) fn words(text: &str) -> Span {
    Span::Text(text.to_owned())
}

pub(super) fn sentence(text: &str) -> Block {
    Block::Sentence(vec![words(text)])
}

pub(super) fn math(math: Math) -> Span {
    Span::Math(math)
}

/// A text with formulas at its places `{}`.
pub(super) fn with_formulas<const N: usize>(text: &str, formulas: [Math; N]) -> Block {
    let mut formulas = formulas.into_iter();
    let mut spans = Vec::new();
    for (k, part) in text.split("{}").enumerate() {
        if k > 0 {
            spans.extend(formulas.next().map(math));
        }
        spans.push(words(part));
    }
    Block::Sentence(spans)
}

/// `left = right` in the text.
pub(super) fn equality(left: Math, right: Math) -> Span {
    math(Math::Row(vec![left, Math::Sign("="), right]))
}

/// A row of letters and signs, separated by spaces. `*` makes a letter bold, δ stands before it, `'` is a dot,
/// `_` begins a subscript; `{ … }` is a row of its own, `( … )` in brackets, and `∂a/∂b` a derivative.
pub(super) fn formula(text: &str) -> Math {
    row_of(&mut text.split(' '))
}

fn row_of<'t>(parts: &mut impl Iterator<Item = &'t str>) -> Math {
    let mut row = Vec::new();
    while let Some(part) = parts.next() {
        row.push(match part {
            "=" => Math::Sign("="),
            "+" => Math::Sign("+"),
            "·" => Math::Sign("·"),
            "×" => Math::Sign("×"),
            "Σ" => Math::Sign("Σ"),
            "½" => Math::Ratio("1".to_owned(), "2".to_owned()),
            "{" => row_of(parts),
            "(" => Math::Brackets(Box::new(row_of(parts))),
            "}" | ")" => break,
            part => match part.split_once('/') {
                Some((above, below)) => Math::fraction(letter(above), letter(below)),
                None => letter(part),
            },
        });
    }
    Math::Row(row)
}

fn letter(text: &str) -> Math {
    let (text, below) = text.split_once('_').unwrap_or((text, ""));
    let before = text.chars().next().filter(|c| "δ∂".contains(*c));
    let base = text.trim_matches(|c| "δ∂*'".contains(c));
    let mut letter = Letter::plain(base);
    letter.bold = text.contains('*');
    letter.before = before;
    if text.ends_with('\'') {
        letter = letter.dot();
    }
    if !below.is_empty() {
        letter = letter.below(below);
    }
    Math::Letter(letter)
}

/// Definitions needed by the equations, then the equations after their sentence.
pub(super) fn with(w: &mut Writer<'_>, lead: &str, equations: Vec<Equation>) -> Vec<Block> {
    let mut blocks = w.definitions();
    if equations.is_empty() {
        return blocks;
    }
    if !lead.is_empty() {
        blocks.push(sentence(lead));
    }
    blocks.push(Block::Equations(equations));
    blocks
}

/// The components of a vector, about something.
pub(super) fn about(vector: Vec<Equation>, what: About) -> impl Iterator<Item = Equation> {
    vector.into_iter().map(move |equation| equation.about(what))
}

/// Description of an item and its line in the spec: `The wheel rolls (line 48 of the spec)`.
pub(super) fn introduced(name: &str, about: &str, line: usize) -> Span {
    let about = if about.is_empty() { name } else { about };
    words(&format!("{} (line {line} of the spec)", capitalised(about)))
}

/// `a, b and c`
pub(super) fn listed(items: Vec<Vec<Span>>) -> Vec<Span> {
    let count = items.len();
    let mut out = Vec::new();
    for (k, item) in items.into_iter().enumerate() {
        if k > 0 {
            out.push(words(if k + 1 == count { " and " } else { ", " }));
        }
        out.extend(item);
    }
    out
}

/// Rows with their title; none without rows.
pub(super) fn table(title: &str, rows: Vec<Row>) -> Option<Block> {
    let title = title.to_owned();
    (!rows.is_empty()).then_some(Block::Table(Table { title, rows }))
}

/// A row about a quantity of the spec, with its description.
pub(super) fn described(label: &Label, first: Span, second: String) -> Row {
    Row {
        cells: vec![
            vec![first],
            vec![Span::Text(second)],
            vec![words(&label.about)],
        ],
        line: label.line,
    }
}

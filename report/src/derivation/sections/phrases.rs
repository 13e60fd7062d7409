//! Sentences, lists and headings common to the sections.

use super::super::display::Equation;
use super::super::writer::Writer;
use super::super::{About, Block, Math, Section, Span};

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

/// `left = right` in the text.
pub(super) fn equality(left: Math, right: Math) -> Span {
    Span::Math(Math::Row(vec![left, Math::Sign("="), right]))
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

/// With a capital letter at the start of a sentence.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
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

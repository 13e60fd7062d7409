//! The sections of the page, in reading order.

mod accelerations;
mod constraints;
mod divisors;
mod energy;
mod equations;
mod forces;
mod jacobians;
mod linear;
mod loads;
mod placement;
mod quantities;
mod reactions;
mod solution;
mod velocities;

use super::Math;
use super::display::Equation;
use super::writer::Writer;
use super::{Block, Section, Span, Stage};
use appell_codegen::linearisation::Linearisation;
use appell_codegen::mechanics::finding;

/// The sections up to a stage.
pub(super) fn sections(w: &mut Writer<'_>, stage: Stage) -> finding::Outcome<Vec<Section>> {
    let mut sections = vec![
        quantities::section(w),
        placement::section(w),
        constraints::section(w),
        velocities::section(w),
        accelerations::section(w),
    ];
    // The handout needs M and b where they solve the equations in letters.
    let in_letters = stage != Stage::Equations || !equations::are_written_out(w);
    if stage >= Stage::Energy {
        sections.push(energy::section(w));
        if in_letters {
            sections.push(energy::derivatives(w));
        }
    }
    if stage >= Stage::Equations {
        sections.push(forces::section(w));
        sections.push(equations::appell(w));
        sections.push(equations::motion(w));
        sections.push(equations::energies(w));
    }
    if stage >= Stage::Jacobians {
        sections.push(jacobians::section(w));
    }
    if stage >= Stage::All {
        sections.extend(reactions::section(w)?);
        sections.extend(quantities::outputs(w));
    }
    Ok(sections)
}

/// The sections of a page about linear equations.
pub(super) fn linear(w: &mut Writer<'_>, linear: &Linearisation) -> Vec<Section> {
    let mut sections = vec![
        quantities::section(w),
        linear::steady(w, linear),
        linear::equations(w, linear),
    ];
    if let Some(polynomial) = linear.characteristic(w.derivation) {
        sections.push(linear::characteristic(w, &polynomial));
    }
    sections
}

/// A section with a heading of words.
fn section(heading: &str, blocks: Vec<Block>) -> Section {
    Section {
        heading: vec![words(heading)],
        blocks,
    }
}

fn words(text: &str) -> Span {
    Span::Text(text.to_owned())
}

fn sentence(text: &str) -> Block {
    Block::Sentence(vec![words(text)])
}

fn math(math: Math) -> Span {
    Span::Math(math)
}

/// `left = right` in the text.
fn equality(left: Math, right: Math) -> Span {
    Span::Math(Math::Row(vec![left, Math::Sign("="), right]))
}

/// Definitions of what the equations use, then the equations after their sentence.
fn with(w: &mut Writer<'_>, lead: &str, equations: Vec<Equation>) -> Vec<Block> {
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

/// With a capital letter at the start of a sentence.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// What an item is and where the spec says it: `The wheel rolls (line 48 of the spec)`.
fn introduced(name: &str, about: &str, line: usize) -> Span {
    let about = if about.is_empty() { name } else { about };
    words(&format!("{} (line {line} of the spec)", capitalised(about)))
}

/// `a, b and c`
fn listed(items: Vec<Vec<Span>>) -> Vec<Span> {
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

//! The derivation as a readable page: Unicode text, LaTeX, HTML.
//!
//! [`page`] writes the derivation of a mechanism from its frames to its equations. A [`Page`] is
//! independent of its format and of the expression graph; [`text()`], [`latex()`] and [`html()`]
//! set it. [`linear`] is the page of the linear equations about a steady motion.

mod arrange;
mod collect;
mod content;
mod display;
mod html;
mod latex;
mod lexicon;
mod sections;
mod sources;
mod text;
mod writer;

use appell_codegen::linearisation::Linearisation;
use appell_codegen::mechanics::{Derivation, derive_in_letters, finding};
use appell_spec::mechanism::Mechanism;

use writer::Writer;

pub use appell_codegen::symbolic::print::{Letter, Math};
pub use content::{Block, Chain, Page, Row, Section, Span, Stage, Table};
pub use display::{About, Equation};
pub use html::{EQUATIONS, clickable, html};
pub use latex::{formulas, latex};
pub use sources::locate;
pub use text::text;

/// Writes the derivation of a mechanism, up to a stage.
///
/// The derivation must be that of this mechanism; the expressions of the page are added to it.
/// Findings are those of the reactions, only at [`Stage::All`].
pub fn page(
    mechanism: &Mechanism,
    derivation: &mut Derivation,
    stage: Stage,
) -> finding::Outcome<Page> {
    let as_derived = page_of(mechanism, derivation, stage)?;
    let length = as_derived.length();
    let graph = &derivation.algebra.graph;
    let mut rates = derivation.velocities.rates.iter();
    let has_quotients = rates.any(|&rate| graph.divisor_count(rate) > 0);
    if length <= LONGEST_TO_READ || !has_quotients {
        return Ok(as_derived);
    }
    let in_letters = derive_in_letters(mechanism).ok();
    let solved = in_letters.filter(|other| other.dependent.system.by_division);
    let in_letters = solved.and_then(|mut other| page_of(mechanism, &mut other, stage).ok());
    let shorter = in_letters.filter(|page| 3 * page.length() < 2 * length);
    Ok(shorter.unwrap_or(as_derived))
}

/// In a page with more formula characters, generalised velocities that are quotients keep their letters.
const LONGEST_TO_READ: usize = 5_000;

fn page_of(
    mechanism: &Mechanism,
    derivation: &mut Derivation,
    stage: Stage,
) -> finding::Outcome<Page> {
    let mut writer = Writer::new(mechanism, derivation);
    let sections = sections::sections(&mut writer, stage)?;
    Ok(written(mechanism, &mut writer, sections))
}

/// Writes the equations of motion alone, the end of the derivation. Quantities that a [`page`] has defined
/// before keep their letters.
pub fn equations_of_motion(mechanism: &Mechanism, derivation: &mut Derivation) -> Page {
    let mut writer = Writer::new(mechanism, derivation);
    let sections = sections::equations_of_motion(&mut writer);
    written(mechanism, &mut writer, sections)
}

/// Writes the linear equations about a steady motion of a mechanism, with their characteristic
/// polynomial; see [`Linearisation::about`].
pub fn linear(mechanism: &Mechanism, derivation: &mut Derivation, linear: &Linearisation) -> Page {
    let mut writer = Writer::new(mechanism, derivation);
    let sections = sections::linear(&mut writer, linear);
    written(mechanism, &mut writer, sections)
}

fn written(mechanism: &Mechanism, writer: &mut Writer<'_>, mut sections: Vec<Section>) -> Page {
    by_definition(&mut sections, writer.bases());
    Page {
        title: mechanism.title.clone(),
        source: mechanism.source.clone(),
        sections,
    }
}

/// Numbers the letters with one of these `bases` in the order of their definitions; letters used without a
/// definition follow.
fn by_definition(sections: &mut [Section], bases: [&str; 2]) {
    for base in bases {
        let mut order: Vec<String> = Vec::new();
        for definitions_only in [true, false] {
            each_letter(sections, definitions_only, &mut |letter| {
                if let Some(number) = number_of(letter, base)
                    && !order.contains(number)
                {
                    order.push(number.clone());
                }
            });
        }
        each_letter(sections, false, &mut |letter| {
            if let Some(number) = number_of(letter, base)
                && let Some(place) = order.iter().position(|known| known == number)
            {
                letter.below[0] = (place + 1).to_string();
            }
        });
    }
}

fn number_of<'a>(letter: &'a Letter, base: &str) -> Option<&'a String> {
    let first = letter.below.first()?;
    let is_number = first.bytes().all(|byte| byte.is_ascii_digit());
    (letter.base == base && is_number).then_some(first)
}

/// All letters of the sections, or only those that equations define: on the left, or anywhere in an implicit
/// equation.
fn each_letter(
    sections: &mut [Section],
    definitions_only: bool,
    change: &mut dyn FnMut(&mut Letter),
) {
    for block in sections.iter_mut().flat_map(|s| &mut s.blocks) {
        match block {
            Block::Equations(equations) => {
                for Equation { left, right, .. } in equations {
                    let is_implicit = left.is_integer("0");
                    left.for_each_letter(change);
                    if is_implicit || !definitions_only {
                        right.for_each_letter(change);
                    }
                }
            }
            Block::Sentence(spans) if !definitions_only => each_in_text(spans, change),
            Block::Table(table) if !definitions_only => {
                for row in &mut table.rows {
                    row.cells
                        .iter_mut()
                        .for_each(|cell| each_in_text(cell, change));
                }
            }
            _ => {}
        }
    }
}

fn each_in_text(spans: &mut [Span], change: &mut dyn FnMut(&mut Letter)) {
    for span in spans {
        if let Span::Math(math) = span {
            math.for_each_letter(change);
        }
    }
}

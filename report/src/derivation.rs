//! The derivation as a readable page: Unicode text, LaTeX, HTML.
//!
//! [`page`] writes the derivation of a mechanism from its frames to its equations. A [`Page`] is
//! independent of its format and of the expression graph; [`text()`], [`latex()`] and [`html()`]
//! set it. [`linear`] is the page of the linear equations about a steady motion.

mod about;
mod angles;
mod arrange;
mod collect;
mod content;
mod display;
mod html;
mod latex;
mod lexicon;
mod renumber;
mod sections;
mod sources;
mod text;
mod text_box;
mod units;
mod writer;

use appell_spec::mechanism::Mechanism;

pub use about::About;
pub use content::{Block, Chain, Page, Row, Section, Span, Stage, Table};
pub use html::{EQUATIONS, clickable, html};
pub use latex::{formulas, latex};
pub use sources::locate;
pub use text::text;

use appell_codegen::linearisation::Linearisation;
use appell_codegen::mechanics::{Derivation, derive_in_letters, finding};
pub use appell_codegen::symbolic::print::{Letter, Math};
pub use display::Equation;
use writer::Writer;

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
    renumber::by_definition(&mut sections, writer.bases());
    Page {
        title: mechanism.title.clone(),
        source: mechanism.source.clone(),
        sections,
    }
}

//! The sections of the page, in reading order.

mod constraints;
mod energy;
mod equations;
mod linear;
mod loads;
mod phrases;
mod placement;
mod quantities;
mod velocities;

use super::writer::Writer;
use super::{Section, Stage};
use appell_codegen::linearisation::Linearisation;
use appell_codegen::mechanics::finding;

/// The sections up to a stage.
pub(super) fn sections(w: &mut Writer<'_>, stage: Stage) -> finding::Outcome<Vec<Section>> {
    let mut sections = vec![quantities::section(w)];
    sections.extend(quantities::definitions(w));
    sections.extend([
        placement::section(w),
        constraints::section(w),
        velocities::section(w),
        velocities::accelerations(w),
    ]);
    // The handout needs M and b where they solve the equations in letters.
    let in_letters = stage != Stage::Equations || !equations::are_written_out(w);
    if stage >= Stage::Energy {
        sections.push(energy::section(w));
        if in_letters {
            sections.push(energy::derivatives(w));
        }
    }
    if stage >= Stage::Equations {
        sections.push(loads::section(w));
        sections.push(equations::appell(w));
        sections.push(equations::motion(w));
        sections.push(equations::energies(w));
    }
    if stage >= Stage::Jacobians {
        sections.push(linear::jacobians(w));
    }
    if stage >= Stage::All {
        sections.extend(constraints::forces(w)?);
        sections.extend(quantities::outputs(w));
    }
    Ok(sections)
}

/// The equations of motion alone.
pub(super) fn equations_of_motion(w: &mut Writer<'_>) -> Vec<Section> {
    let mut section = equations::motion(w);
    if !equations::are_written_out(w) {
        section.blocks.push(phrases::sentence(
            "M, b and Π of Appell's equations M ω̇ + b = Π are those of the derivation.",
        ));
    }
    vec![section]
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

//! Constraint forces.

use super::super::lexicon::AXES;
use super::super::{Equation, Letter, Math, Section, Writer};
use super::phrases::{headed, with};
use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::finding::Outcome;
use appell_codegen::mechanics::reactions::reactions;
use appell_codegen::symbolic::Graph;

/// The reaction of every constraint; none without constraints.
pub(super) fn section(w: &mut Writer<'_>) -> Outcome<Option<Section>> {
    let d = &mut *w.derivation;
    let forces = reactions(
        &mut d.algebra,
        Setting::free(w.mechanism, &d.symbols),
        &d.constraints,
        &d.velocities.violating,
        &d.bodies,
        &d.motion.accelerations,
        &d.reactions_in_loads,
    )?;
    if forces.is_empty() {
        return Ok(None);
    }
    let mut equations = Vec::new();
    let places = w.derivation.constraints.reactions.clone();
    for (place, force) in places.iter().zip(forces) {
        for (component, axis) in force.into_iter().zip(AXES) {
            let component = w.derivation.algebra.shortest(component);
            if component == Graph::ZERO {
                continue;
            }
            let left = Letter::plain("F").below(&place.name).below(axis);
            let right = w.explicit(component);
            equations.push(Equation::new(Math::Letter(left), right));
        }
    }
    let blocks = with(
        w,
        "Each constraint row gets an auxiliary speed that violates it; Appell's equation for that \
         speed gives its reaction. Components are in the ground; accelerations are those solved above:",
        equations,
    );
    Ok(Some(headed("Constraint forces", blocks)))
}

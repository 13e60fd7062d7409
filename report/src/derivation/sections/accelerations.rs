//! Accelerations of centres of mass, angular accelerations of bodies.

use super::super::{About, Letter, Section, Writer};
use super::phrases::{about, formula, headed, with, with_formulas};
use appell_codegen::mechanics::gibbs_appell::along;
use appell_codegen::symbolic::vector;

/// Accelerations, linear in the pseudo-accelerations.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut equations = Vec::new();
    let mut shown = Vec::new();
    let accelerations = w.derivation.symbols.accelerations.clone();
    let bodies = w.derivation.bodies.clone();
    for (id, body) in w.mechanism.bodies.ids().zip(bodies) {
        let centre = w.mechanism.bodies[id].centre;
        if !shown.contains(&centre) {
            shown.push(centre);
            let motion = body.centre;
            let a = along(w.graph(), motion.bias, &motion.partial, &accelerations);
            let letter = Letter::bold("a").below(&w.point(centre));
            let vector = w.vector(letter, a, motion.velocity.frame);
            equations.extend(about(vector, About::Point(centre)));
        }
        if let Some(rotation) = body.rotation
            && rotation.velocity.v != vector::ZERO
        {
            let alpha = along(w.graph(), rotation.bias, &rotation.partial, &accelerations);
            let letter = Letter::bold("α").below(&body.name);
            let vector = w.vector(letter, alpha, rotation.velocity.frame);
            equations.extend(about(vector, About::Body(id)));
        }
    }
    let rule = with_formulas(
        "In a rotating frame {}, differentiated component by component; angular accelerations likewise.",
        [formula("*a = *v' + *Ω × *v")],
    );
    let mut blocks = vec![rule];
    blocks.extend(with(w, "", equations));
    headed("Accelerations", blocks)
}

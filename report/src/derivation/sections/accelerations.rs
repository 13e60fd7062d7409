//! Accelerations of centres of mass, angular accelerations of bodies.

use appell_spec::mechanism::BodyId;

use super::super::writer::Writer;
use super::super::{About, Letter, Math};
use super::super::{Block, Section};
use super::phrases::{about, headed, math, with, words};
use appell_codegen::mechanics::gibbs_appell::along;
use appell_codegen::symbolic::vector;

/// Accelerations, linear in the pseudo-accelerations.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut equations = Vec::new();
    let mut shown = Vec::new();
    let accelerations = w.derivation.symbols.accelerations.clone();
    for (index, body) in w.derivation.bodies.clone().into_iter().enumerate() {
        let centre = w.mechanism.bodies[BodyId::new(index)].centre;
        if !shown.contains(&centre) {
            shown.push(centre);
            let a = along(
                w.graph(),
                body.centre.bias,
                &body.centre.partial,
                &accelerations,
            );
            let letter = Letter::bold("a").below(&w.point(centre));
            let vector = w.vector(letter, a, body.centre.velocity.frame);
            equations.extend(about(vector, About::Point(centre)));
        }
        if let Some(rotation) = body.rotation
            && rotation.velocity.v != vector::ZERO
        {
            let alpha = along(w.graph(), rotation.bias, &rotation.partial, &accelerations);
            let letter = Letter::bold("α").below(&body.name);
            let vector = w.vector(letter, alpha, rotation.velocity.frame);
            equations.extend(about(vector, About::Body(BodyId::new(index))));
        }
    }
    let rule = Math::Row(vec![
        Math::Letter(Letter::bold("a")),
        Math::Sign("="),
        Math::Letter(Letter::bold("v").dot()),
        Math::Sign("+"),
        Math::Letter(Letter::bold("Ω")),
        Math::Sign("×"),
        Math::Letter(Letter::bold("v")),
    ]);
    let mut blocks = vec![Block::Sentence(vec![
        words("In a rotating frame "),
        math(rule),
        words(", differentiated component by component; angular accelerations likewise."),
    ])];
    blocks.extend(with(w, "", equations));
    headed("Accelerations", blocks)
}

//! Pseudo-forces from virtual power.

use super::super::arrange::signed;
use super::super::{About, Block, Equation, Math, Section, Writer};
use super::energy::numbered;
use super::loads;
use super::phrases::{formula, headed, introduced, sentence, with, with_formulas, words};
use appell_codegen::mechanics::loads::{AppliedLoad, generalized_forces};
use appell_codegen::symbolic::Graph;

/// The virtual power of every load, and their sum.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut blocks = load_by_load(w);
    let mut equations = Vec::new();
    for (i, force) in w.derivation.forces.clone().into_iter().enumerate() {
        let right = w.explicit(force);
        equations.push(Equation::new(numbered("Π", i), right).about(About::Force(i)));
    }
    blocks.extend(with(
        w,
        "The pseudo-forces are the coefficients of the virtual velocities:",
        equations,
    ));
    headed("Pseudo-forces Π", blocks)
}

fn load_by_load(w: &mut Writer<'_>) -> Vec<Block> {
    if w.derivation.loads.is_empty() {
        return vec![sentence("No load acts.")];
    }
    let mut blocks = vec![with_formulas(
        "The virtual power of the forces F and torques T is {}. Load by load:",
        [formula("δP = { Σ *F · δ*v } + { Σ *T · δ*ω } = Σ Π_i δω_i")],
    )];
    let applied = w.derivation.loads.clone();
    for (load, (id, item)) in applied.iter().zip(w.mechanism.loads.entries()) {
        let mut what = vec![introduced(&item.name, &item.about, item.line), words(": ")];
        what.extend(loads::statement(w, item));
        what.push(words("."));
        blocks.extend(w.definitions());
        blocks.push(Block::Sentence(what));
        let power = virtual_power(w, load);
        let equation = Equation::new(loads::virtual_power(item), power).about(About::Load(id));
        blocks.extend(with(w, "", vec![equation]));
    }
    blocks
}

/// `Σ Πᵢ δωᵢ` of one load.
fn virtual_power(w: &mut Writer<'_>, load: &AppliedLoad) -> Math {
    let speeds = w.derivation.symbols.speeds.clone();
    let load = std::slice::from_ref(load);
    let forces = generalized_forces(&mut w.derivation.algebra, load, &speeds);
    let mut terms = Vec::new();
    for (k, force) in forces.into_iter().enumerate() {
        if force == Graph::ZERO {
            continue;
        }
        let along = Math::Letter(w.speed(k).before('δ'));
        let (minus, force) = signed(w.explicit(force));
        let factors = if force.is_integer("1") {
            vec![along]
        } else {
            vec![force, along]
        };
        terms.push((minus, Math::product(factors)));
    }
    Math::sum(terms)
}

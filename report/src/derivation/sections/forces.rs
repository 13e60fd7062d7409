//! Pseudo-forces from virtual power.

use super::super::display::Equation;
use super::super::writer::Writer;
use super::super::{About, Block, Section};
use super::super::{Letter, Math};
use super::energy::numbered;
use super::loads;
use super::phrases::{headed, introduced, math, sentence, with, words};
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

/// `δP = Σ F · δv + Σ T · δω = Σ Πᵢ δωᵢ`
fn rule() -> Math {
    let virtual_work = |load: &str, velocity: &str| {
        Math::Row(vec![
            Math::Sign("Σ"),
            Math::Letter(Letter::bold(load)),
            Math::Sign("·"),
            Math::Letter(Letter::bold(velocity).before('δ')),
        ])
    };
    Math::Row(vec![
        Math::Letter(Letter::plain("P").before('δ')),
        Math::Sign("="),
        virtual_work("F", "v"),
        Math::Sign("+"),
        virtual_work("T", "ω"),
        Math::Sign("="),
        Math::Sign("Σ"),
        Math::Letter(Letter::plain("Π").below("i")),
        Math::Letter(Letter::plain("ω").below("i").before('δ')),
    ])
}

fn load_by_load(w: &mut Writer<'_>) -> Vec<Block> {
    if w.derivation.loads.is_empty() {
        return vec![sentence("No load acts.")];
    }
    let mut blocks = vec![Block::Sentence(vec![
        words("The virtual power of the forces F and torques T is "),
        math(rule()),
        words(". Load by load:"),
    ])];
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
    let forces = generalized_forces(
        &mut w.derivation.algebra,
        std::slice::from_ref(load),
        &speeds,
    );
    let mut terms = Vec::new();
    for (k, force) in forces.into_iter().enumerate() {
        if force == Graph::ZERO {
            continue;
        }
        let along = Math::Letter(w.speed(k).before('δ'));
        let (minus, force) = match w.explicit(force) {
            Math::Sum(mut single) if single.len() == 1 => single.remove(0),
            other => (false, other),
        };
        let factors = if force.is_integer("1") {
            vec![along]
        } else {
            vec![force, along]
        };
        terms.push((minus, Math::product(factors)));
    }
    Math::sum(terms)
}

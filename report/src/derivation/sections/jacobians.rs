//! Jacobians of the motion, by implicit differentiation.

use super::super::display::Equation;
use super::super::writer::Writer;
use super::super::{Block, Section};
use super::super::{Letter, Math};
use super::phrases::{headed, math, with, words};
use appell_codegen::symbolic::{Expr, Graph};

/// The derivatives of the residual ρ, those of ω̇ that follow, and those of q̇.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut blocks = vec![rule()];
    let symbols = w.derivation.symbols.clone();
    let signals: Vec<Expr> = symbols.signals.iter().flatten().copied().collect();
    let lists = [
        (
            "With respect to the state, for A:",
            [symbols.speeds.clone(), symbols.coordinates.clone()].concat(),
        ),
        (
            "With respect to the inputs, for B:",
            [symbols.inputs.clone(), signals].concat(),
        ),
        (
            "With respect to the parameters, for P:",
            symbols.parameters.clone(),
        ),
    ];
    let mut rows = residual(w);
    rows.extend((0..symbols.rates.len()).map(|k| {
        let letter = w.letter(symbols.rates[k]);
        (letter, w.derivation.velocities.rates[k])
    }));
    for (lead, variables) in lists {
        let mut equations = Vec::new();
        for (letter, value) in &rows {
            for &variable in &variables {
                let entry = w.derivation.algebra.derivative(*value, variable);
                let entry = w.derivation.algebra.shortest(entry);
                if entry != Graph::ZERO {
                    let by = w.letter(variable);
                    let right = w.explicit(entry);
                    equations.push(Equation::new(Math::partial(letter.clone(), by), right));
                }
            }
        }
        blocks.extend(with(w, lead, equations));
    }
    headed("Jacobians", blocks)
}

/// The differentiated residual, and the equations of the derivatives.
fn rule() -> Block {
    let bold = |name: &str| Math::Letter(Letter::bold(name));
    let rates = || Math::Letter(Letter::bold("ω").dot());
    let residual_rule = Math::Row(vec![
        bold("ρ"),
        Math::Sign("="),
        Math::sum(vec![
            (false, bold("Π")),
            (true, bold("b")),
            (true, Math::Row(vec![bold("M"), rates()])),
        ]),
    ]);
    let derivative = |of: Letter| Math::partial(of, Letter::plain("z"));
    let rule = Math::Row(vec![
        bold("M"),
        derivative(Letter::bold("ω").dot()),
        Math::Sign("="),
        derivative(Letter::bold("ρ")),
    ]);
    Block::Sentence(vec![
        words("By Appell's equations "),
        math(residual_rule),
        words(
            " vanishes. Differentiation with respect to a state, an input or a parameter z gives ",
        ),
        math(rule),
        words(
            ", where ρ is differentiated at constant accelerations. It is solved like the equations \
             of motion. Entries not listed are zero.",
        ),
    ])
}

/// ρ = Π - b - M ω̇, with letters for the accelerations.
fn residual(w: &mut Writer<'_>) -> Vec<(Letter, Expr)> {
    let accelerations = w.derivation.symbols.accelerations.clone();
    let gibbs = w.derivation.gibbs.clone();
    let forces = w.derivation.forces.clone();
    let mut rows = Vec::with_capacity(forces.len());
    for (i, (&force, &bias)) in forces.iter().zip(&gibbs.bias).enumerate() {
        let graph = w.graph();
        let mut parts = vec![force, graph.neg(bias)];
        for (&entry, &acceleration) in gibbs.mass_matrix[i].iter().zip(&accelerations) {
            let inertial = graph.mul(entry, acceleration);
            parts.push(graph.neg(inertial));
        }
        rows.push((
            Letter::plain("ρ").below(&(i + 1).to_string()),
            graph.sum(&parts),
        ));
    }
    rows
}

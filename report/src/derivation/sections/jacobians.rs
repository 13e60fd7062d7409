//! Jacobians of the motion, by implicit differentiation.

use super::super::{Block, Equation, Letter, Math, Section, Writer};
use super::phrases::{formula, headed, with, with_formulas};
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
    let rates = w.derivation.velocities.rates.clone();
    rows.extend((symbols.rates.iter().zip(rates)).map(|(&rate, value)| (w.letter(rate), value)));
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
    let terms = vec![
        (false, bold("Π")),
        (true, bold("b")),
        (true, formula("*M *ω'")),
    ];
    let residual = Math::Row(vec![bold("ρ"), Math::Sign("="), Math::sum(terms)]);
    with_formulas(
        "By Appell's equations {} vanishes. Differentiation with respect to a state, an input or a parameter z \
         gives {}, where ρ is differentiated at constant accelerations. It is solved like the equations of motion. \
         Entries not listed are zero.",
        [residual, formula("*M ∂*ω'/∂z = ∂*ρ/∂z")],
    )
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

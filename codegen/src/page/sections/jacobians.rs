//! Jacobians of the motion, by implicit differentiation.

use super::super::letters::Letter;
use super::super::math::{Equation, Math};
use super::super::writer::Writer;
use super::super::{Block, Section};
use super::{math, with, words};
use crate::mechanics::linear::ImplicitMotion;
use crate::symbolic::{Expr, Graph};

/// The entries of A, B and P that are not zero everywhere.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let rule = Math::Row(vec![
        Math::Letter(Letter::bold("M")),
        Math::partial(Letter::bold("ω").dot(), Letter::plain("z")),
        Math::Sign("="),
        Math::fraction(Math::Letter(Letter::plain("").before('∂')), Math::Letter(Letter::plain("z").before('∂'))),
        Math::Brackets(Box::new(Math::sum(vec![
            (false, Math::Letter(Letter::bold("Π"))),
            (true, Math::Letter(Letter::bold("b"))),
            (true, Math::Row(vec![Math::Letter(Letter::bold("M")), Math::Letter(Letter::bold("ω").dot())])),
        ]))),
    ]);
    let mut blocks = vec![Block::Sentence(vec![
        words("Appell's equations, differentiated by a state, an input or a parameter z: "),
        math(rule),
        words(". What is not listed is zero; accelerations stand for their values."),
    ])];
    let symbols = w.derivation.symbols.clone();
    let derivation = &mut *w.derivation;
    let implicit = ImplicitMotion {
        gibbs: &derivation.gibbs,
        forces: &derivation.forces,
        motion: &derivation.motion,
        coordinate_rates: &derivation.coordinate_rates,
    };
    let residual = implicit.residual(&mut derivation.algebra, &symbols);
    let signals: Vec<Expr> = symbols.signals.iter().flatten().copied().collect();
    let inputs = [symbols.inputs.clone(), signals].concat();
    let lists = [
        ("Of the state, A:", [symbols.speeds.clone(), symbols.coordinates.clone()].concat()),
        ("Of the inputs, B:", inputs),
        ("Of the parameters, P:", symbols.parameters.clone()),
    ];
    let mut columns = Vec::new();
    for (_, variables) in &lists {
        columns.push(implicit.jacobian(&mut derivation.algebra, &symbols, &residual, variables));
    }
    let rows: Vec<Letter> = {
        let rates = symbols.accelerations.iter().chain(&symbols.rates);
        rates.copied().collect::<Vec<_>>().into_iter().map(|rate| w.letter(rate)).collect()
    };
    for ((heading, variables), columns) in lists.into_iter().zip(columns) {
        let mut equations = Vec::new();
        for (row, letter) in rows.iter().enumerate() {
            for (&variable, column) in variables.iter().zip(&columns) {
                let entry = w.derivation.algebra.shortest(column[row]);
                if entry != Graph::ZERO {
                    let by = w.letter(variable);
                    let right = w.explicit(entry);
                    equations.push(Equation::new(Math::partial(letter.clone(), by), right));
                }
            }
        }
        if !equations.is_empty() {
            blocks.extend(with(w, heading, equations));
        }
    }
    super::section("Jacobians", blocks)
}

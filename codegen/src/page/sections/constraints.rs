//! Constraints, pseudo-velocities, and the generalised velocities that solve both.

use appell_spec::mechanism::ConstraintKind;

use super::super::display::Equation;
use super::super::units::unit;
use super::super::writer::Writer;
use super::super::{Block, Row, Section, Table};
use super::super::{Letter, Math};
use super::placement::from_to;
use super::{equality, listed, math, sentence, with, words};
use crate::mechanics::lower::Lowering;
use crate::symbolic::Graph;

/// Constraints and pseudo-velocities.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut blocks = Vec::new();
    for index in 0..w.mechanism.constraints.len() {
        blocks.extend(constraint(w, index));
    }
    blocks.push(sentence(
        "The pseudo-velocities are linear in the generalised velocities:",
    ));
    let definitions = definitions(w);
    blocks.push(definitions);
    let by = if w
        .derivation
        .constraints
        .rows
        .iter()
        .any(|r| !r.is_embedded())
    {
        "With the constraints they determine the generalised velocities:"
    } else {
        "They determine the generalised velocities:"
    };
    let equations = rates(w);
    blocks.extend(with(w, by, equations));
    if !w.derivation.velocities.solved_numerically.is_empty() {
        blocks.push(sentence(
            "No pivot of the linear system is safe in the declared ranges; it is solved with pivoting \
             when the equations are evaluated.",
        ));
    }
    super::section("Constraints and pseudo-velocities", blocks)
}

/// Generalised velocities in terms of the pseudo-velocities; those with the letter of a
/// pseudo-velocity go without saying.
pub(super) fn rates(w: &mut Writer<'_>) -> Vec<Equation> {
    let mut equations = Vec::new();
    for k in 0..w.mechanism.coordinates.len() {
        let left = w.symbol(w.derivation.symbols.rates[k]);
        let right = w.explicit(w.derivation.velocities.rates[k]);
        if left != right {
            equations.push(Equation::new(left, right));
        }
    }
    equations
}

fn constraint(w: &mut Writer<'_>, index: usize) -> Vec<Block> {
    let constraint = &w.mechanism.constraints[index];
    let about = if constraint.about.is_empty() {
        &constraint.name
    } else {
        &constraint.about
    };
    let mut what = vec![words(&format!(
        "{} (line {})",
        capitalised(about),
        constraint.line
    ))];
    if let ConstraintKind::Rolling { body, contact } = constraint.kind {
        let centre = w.point(w.mechanism.bodies[body].centre);
        let contact = w.point(contact);
        let spin = Letter::bold("ω").below(&w.mechanism.bodies[body].name);
        let formula = [
            Math::Letter(Letter::bold("v").below(contact)),
            Math::Sign("="),
            Math::Letter(Letter::bold("v").below(centre)),
            Math::Sign("+"),
            Math::Letter(spin),
            Math::Sign("×"),
            Math::Letter(Letter::bold("r").below(&from_to(centre, contact))),
            Math::Sign("="),
            Math::Words("0".to_owned()),
        ];
        what.push(words(": "));
        what.push(math(Math::Row(formula.into())));
    }
    let (mut open, mut held) = (Vec::new(), Vec::new());
    for row in w.derivation.constraints.rows.clone() {
        if row.constraint != index {
            continue;
        }
        if row.is_embedded() {
            held.push(vec![words(
                row.name.rsplit('.').next().unwrap_or(&row.name),
            )]);
            continue;
        }
        let mut parts = vec![row.rest];
        for (&coefficient, rate) in row
            .coefficients
            .iter()
            .zip(w.derivation.symbols.rates.clone())
        {
            parts.push(w.graph().mul(coefficient, rate));
        }
        let left = w.graph().sum(&parts);
        let left = w.explicit(left);
        open.push(Equation::new(left, Math::zero()));
    }
    if !open.is_empty() {
        let rolling = matches!(constraint.kind, ConstraintKind::Rolling { .. });
        what.push(words(if rolling { ". In the ground:" } else { ":" }));
    }
    let mut blocks = vec![Block::Sentence(what)];
    blocks.extend(with(w, "", open));
    if !held.is_empty() {
        let noun = if held.len() == 1 {
            "Its component along "
        } else {
            "Its components along "
        };
        let mut text = vec![words(noun)];
        let verb = if held.len() == 1 {
            " holds by geometry: the coordinates satisfy it already."
        } else {
            " hold by geometry: the coordinates satisfy them already."
        };
        text.extend(listed(held));
        text.push(words(verb));
        blocks.push(Block::Sentence(text));
    }
    blocks
}

/// With a capital letter at the start of a sentence.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

fn definitions(w: &mut Writer<'_>) -> Block {
    let mechanism = w.mechanism;
    let mut rows = Vec::new();
    for (index, speed) in mechanism.pseudo_velocities.iter().enumerate() {
        let derivation = &mut *w.derivation;
        let lowering = Lowering {
            symbols: &derivation.symbols,
            rates: &derivation.symbols.rates,
        };
        let value = lowering
            .lower(&mut derivation.algebra.graph, &speed.definition)
            .unwrap_or(Graph::ZERO);
        let left = Math::Letter(w.speed(index));
        let mut right = w.set(value);
        // A pseudo-velocity with the letter of a generalised velocity: γ̇ = dγ/dt.
        if left == right
            && let Some(place) = w
                .derivation
                .symbols
                .rates
                .iter()
                .position(|&rate| rate == value)
        {
            let coordinate = w.letter(w.derivation.symbols.coordinates[place]);
            right = Math::fraction(
                Math::Letter(coordinate.before('d')),
                Math::Letter(Letter::plain("t").before('d')),
            );
        }
        let cells = vec![
            vec![equality(left, right)],
            vec![words(&unit(&speed.label))],
            vec![words(&speed.label.about)],
        ];
        rows.push(Row {
            cells,
            line: speed.label.line,
        });
    }
    Block::Table(Table {
        title: String::new(),
        rows,
    })
}

//! Pseudo-forces from virtual power.

use super::super::display::Equation;
use super::super::writer::Writer;
use super::super::{Block, Row, Section, Table};
use super::super::{Letter, Math};
use super::energy::numbered;
use super::{math, sentence, with, words};
use crate::mechanics::loads::generalized_forces;
use crate::symbolic::Graph;

/// The virtual power of every load, and what it sums to.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let virtual_power = || Math::Letter(Letter::plain("P").before('δ'));
    let product = |a: Math, b: Math| Math::Row(vec![Math::Sign("Σ"), a, Math::Sign("·"), b]);
    let bold = |name: &str| Math::Letter(Letter::bold(name));
    let delta = |name: &str| Math::Letter(Letter::bold(name).before('δ'));
    let sum = Math::Row(vec![
        virtual_power(),
        Math::Sign("="),
        product(bold("F"), delta("v")),
        Math::Sign("+"),
        product(bold("T"), delta("ω")),
        Math::Sign("="),
        Math::Sign("Σ"),
        Math::Letter(Letter::plain("Π").below("i")),
        Math::Letter(Letter::plain("ω").below("i").before('δ')),
    ]);
    let mut blocks = Vec::new();
    if w.derivation.loads.is_empty() {
        blocks.push(sentence("No load acts."));
    } else {
        blocks.push(Block::Sentence(vec![
            words("Forces F and torques T work along virtual velocities: "),
            math(sum),
            words(". Load by load:"),
        ]));
    }
    let mut rows: Vec<Row> = Vec::new();
    let mut equations = Vec::new();
    let speeds = w.derivation.symbols.speeds.clone();
    for (index, load) in w.derivation.loads.clone().into_iter().enumerate() {
        let item = &w.mechanism.loads[index];
        let letter = Math::Letter(Letter::plain("P").before('δ').below(&item.name));
        rows.push(Row {
            cells: vec![vec![math(letter.clone())], vec![words(&item.about)]],
            line: item.line,
        });
        let forces = generalized_forces(
            &mut w.derivation.algebra,
            std::slice::from_ref(&load),
            &speeds,
        );
        let mut terms = Vec::new();
        for (k, &force) in forces.iter().enumerate() {
            if force != Graph::ZERO {
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
        }
        equations.push(Equation::new(letter, Math::sum(terms)));
    }
    if !rows.is_empty() {
        blocks.push(Block::Table(Table {
            title: String::new(),
            rows,
        }));
    }
    blocks.extend(with(w, "", equations));
    let mut equations = Vec::new();
    for (i, force) in w.derivation.forces.clone().into_iter().enumerate() {
        let right = w.explicit(force);
        equations.push(Equation::new(numbered("Π", i), right));
    }
    blocks.extend(with(
        w,
        "The pseudo-forces are the factors of the virtual velocities:",
        equations,
    ));
    super::section("Pseudo-forces Π", blocks)
}

//! Meaning of the letters: parameters, coordinates, inputs, signals, outputs.

use appell_spec::expr::Expr;
use appell_spec::mechanism::Label;

use super::super::units::{range, unit, value};
use super::super::writer::Writer;
use super::super::{Block, Row, Section, Table};
use super::super::{Letter, Math};
use super::phrases::{equality, headed, math, sentence, words};
use appell_codegen::mechanics::expressions::Lowering;

/// Tables of the quantities.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let m = w.mechanism;
    let plain = |label: &Label, second: String| {
        let cells = vec![
            vec![math(Math::Letter(Letter::of(&label.name)))],
            vec![words(&second)],
            vec![words(&label.about)],
        ];
        Row {
            cells,
            line: label.line,
        }
    };
    let mut blocks = vec![sentence(
        "Numbers at the right margin are lines of the spec.",
    )];
    let mut table = |title: &str, rows: Vec<Row>| {
        if !rows.is_empty() {
            blocks.push(Block::Table(Table {
                title: title.to_owned(),
                rows,
            }));
        }
    };
    table(
        "Parameters",
        m.parameters
            .iter()
            .map(|p| plain(&p.label, value(&p.label, p.value)))
            .collect(),
    );
    table(
        "Coordinates q",
        m.coordinates
            .iter()
            .map(|q| {
                let ends = q.range.map(|ends| range(&q.label, ends));
                plain(&q.label, ends.unwrap_or_else(|| unit(&q.label)))
            })
            .collect(),
    );
    table(
        "Inputs",
        m.inputs
            .iter()
            .map(|u| plain(&u.label, unit(&u.label)))
            .collect(),
    );
    table(
        "Known functions of time",
        m.signals
            .iter()
            .map(|s| plain(&s.label, unit(&s.label)))
            .collect(),
    );
    headed("Quantities", blocks)
}

/// The named expressions of the spec.
pub(super) fn definitions(w: &mut Writer<'_>) -> Option<Section> {
    let mechanism = w.mechanism;
    let named = mechanism.definitions.iter();
    let named = named.map(|definition| (&definition.label, &definition.value));
    equalities(w, "Definitions", named)
}

/// The outputs of the spec.
pub(super) fn outputs(w: &mut Writer<'_>) -> Option<Section> {
    let mechanism = w.mechanism;
    let named = mechanism.outputs.iter();
    let named = named.map(|output| (&output.label, &output.value));
    equalities(w, "Outputs", named)
}

/// Names with their expressions, units and sentences.
fn equalities<'m>(
    w: &mut Writer<'_>,
    title: &str,
    named: impl Iterator<Item = (&'m Label, &'m Expr)>,
) -> Option<Section> {
    let mut rows = Vec::new();
    for (label, value) in named {
        let derivation = &mut *w.derivation;
        let lowering = Lowering {
            symbols: &derivation.symbols,
            rates: &derivation.symbols.rates,
        };
        let Ok(expr) = lowering.lower(&mut derivation.algebra.graph, value) else {
            continue;
        };
        let right = w.set(expr);
        let left = Math::Letter(Letter::of(&label.name));
        let cells = vec![
            vec![equality(left, right)],
            vec![words(&unit(label))],
            vec![words(&label.about)],
        ];
        rows.push(Row {
            cells,
            line: label.line,
        });
    }
    if rows.is_empty() {
        return None;
    }
    let mut blocks = w.definitions();
    blocks.push(Block::Table(Table {
        title: String::new(),
        rows,
    }));
    Some(headed(title, blocks))
}

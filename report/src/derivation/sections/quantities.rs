//! Meaning of the letters: parameters, coordinates, inputs, signals, outputs.

use appell_spec::expr::Expr;
use appell_spec::mechanism::Label;

use super::super::units::{range, unit, value};
use super::super::{Letter, Math, Row, Section, Writer};
use super::phrases::{described, equality, headed, math, sentence, table};
use super::placement::try_lowered;

/// Tables of the quantities.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let m = w.mechanism;
    let row = |label: &Label, second: String| -> Row {
        described(label, math(Math::Letter(Letter::of(&label.name))), second)
    };
    let with_unit = |label: &Label| row(label, unit(label));
    let parameters = m.parameters.iter();
    let parameters = parameters.map(|p| row(&p.label, value(&p.label, p.value)));
    let coordinates = m.coordinates.iter().map(|q| match q.range {
        Some(ends) => row(&q.label, range(&q.label, ends)),
        None => with_unit(&q.label),
    });
    let inputs = m.inputs.iter().map(|u| with_unit(&u.label));
    let signals = m.signals.iter().map(|s| with_unit(&s.label));
    let mut blocks = vec![sentence(
        "Numbers at the right margin are lines of the spec.",
    )];
    blocks.extend(table("Parameters", parameters.collect()));
    blocks.extend(table("Coordinates q", coordinates.collect()));
    blocks.extend(table("Inputs", inputs.collect()));
    blocks.extend(table("Known functions of time", signals.collect()));
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
    let rows = named.filter_map(|(label, value)| {
        let expr = try_lowered(w, value)?;
        let left = Math::Letter(Letter::of(&label.name));
        Some(described(label, equality(left, w.set(expr)), unit(label)))
    });
    let table = table("", rows.collect())?;
    let mut blocks = w.definitions();
    blocks.push(table);
    Some(headed(title, blocks))
}

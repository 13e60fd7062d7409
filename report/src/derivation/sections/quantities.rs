//! Meaning of the letters: parameters, coordinates, inputs, signals, outputs, with readable numbers and units.

use appell_codegen::symbolic::print::superscript;
use appell_spec::expr::Expr;
use appell_spec::mechanism::Label;

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

/// A unit with raised exponents: `kg*m^2` is `kg m²`.
pub(super) fn unit(label: &Label) -> String {
    let mut out = String::new();
    let mut raised = false;
    for c in label.unit.text.chars() {
        raised = c == '^' || raised && (c.is_ascii_digit() || c == '-');
        match c {
            '*' => out.push(' '),
            '^' => {}
            c if raised => out.push(superscript(c)),
            c => out.push(c),
        }
    }
    if out == "1" { String::new() } else { out }
}

/// A value in SI as the number and unit that the spec uses.
pub(super) fn value(label: &Label, si: f64) -> String {
    let number = number(label.unit.from_si(si));
    format!("{number} {}", unit(label)).trim_end().to_owned()
}

/// A range in SI as the numbers and the unit that the spec uses: `−1.5 to 1.5 rad`.
pub(super) fn range(label: &Label, [low, high]: [f64; 2]) -> String {
    let low = number(label.unit.from_si(low));
    format!("{low} to {}", value(label, high))
}

/// Twelve digits, beyond which unit conversion adds rounding.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    let size = rounded.abs();
    let number = if rounded != 0.0 && !(1e-4..1e7).contains(&size) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    };
    number.replace('-', "−")
}

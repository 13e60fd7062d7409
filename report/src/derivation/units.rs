//! Numbers and units in readable form.

use appell_spec::mechanism::Label;

use appell_codegen::symbolic::print::superscript;

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

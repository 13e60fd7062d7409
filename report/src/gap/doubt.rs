//! Suspected errors of units and signs: fitted values that are close to a common conversion factor, or to −1.

use appell_gap::diagnose::{Hypothesis, Report, Value};

use crate::text::number;

/// Conversion factors that are often forgotten.
const FACTORS: [(f64, &str); 6] = [
    (180.0 / std::f64::consts::PI, "180/π"),
    (std::f64::consts::PI / 180.0, "π/180"),
    (1000.0, "1000"),
    (0.001, "1/1000"),
    (9.81, "9.81"),
    (1.0 / 9.81, "1/9.81"),
];
/// Relative rounding of gravity and of units.
const ROUNDED: f64 = 0.005;
/// A value is close to a factor within this many standard deviations.
const NEAR: f64 = 2.0;
/// Relative uncertainty above which a value matches too many factors.
const VAGUE: f64 = 0.05;
/// Hypotheses less probable than this are not checked.
const PROBABLE: f64 = 0.05;

/// Suspected unit errors in the probable hypotheses.
pub fn doubts(report: &Report) -> Vec<String> {
    let mut doubts: Vec<String> = (report.which.iter())
        .filter(|hypothesis| hypothesis.probability >= PROBABLE)
        .flat_map(of)
        .collect();
    doubts.dedup();
    doubts
}

fn of(hypothesis: &Hypothesis) -> Vec<String> {
    let Some(changes) = &hypothesis.changes else {
        return Vec::new();
    };
    let values = hypothesis.parameters.iter();
    // An input that acts as u + p u acts 1 + p times.
    let inputs = changes.inputs.iter().filter_map(|term| {
        let input = &term.quantity;
        let gain = term.adds.strip_suffix(&format!("*{input}"))?;
        let named = |value: &&Value| value.name.replace(['@', '.'], "_") == gain;
        let value = values.clone().find(named)?;
        doubt(
            1.0 + value.value,
            value.std,
            "acts as {} times its command",
            input,
        )
    });
    let mut doubts: Vec<String> = inputs.collect();
    let scales = changes.signal_effects.iter();
    let scales = scales.filter(|effect| effect.acts == "scale");
    doubts.extend(scales.filter_map(|scale| {
        let prefix = format!("{}.", scale.effect);
        let value = values
            .clone()
            .find(|value| value.name.starts_with(&prefix))?;
        doubt(
            value.value,
            value.std,
            "reads {} times the true value",
            &scale.on,
        )
    }));
    doubts.extend(changes.parameters.iter().filter_map(|parameter| {
        let stated = parameter.stated;
        let (ratio, std) = (parameter.value / stated, parameter.std? / stated.abs());
        doubt(ratio, std, "is {} times its stated value", &parameter.name)
    }));
    doubts
}

/// The question, if a conversion factor lies within the uncertainty of a value.
fn doubt(value: f64, std: f64, says: &str, whose: &str) -> Option<String> {
    let size = value.abs();
    if !(std.is_finite() && std <= VAGUE * size) {
        return None;
    }
    let within = (NEAR * std).max(ROUNDED * size);
    let says = format!("`{whose}` {}", says.replace("{}", &number(value)));
    if (value + 1.0).abs() <= within {
        return Some(format!("{says}: is the sign of `{whose}` right?"));
    }
    let near = |(factor, _): &&(f64, &str)| (size - factor).abs() <= within;
    let (_, factor) = FACTORS.iter().find(near)?;
    Some(format!(
        "{says}, which is close to {factor}: is the unit of `{whose}` right?"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_between_units_is_doubted_and_nothing_else() {
        let question = |value, std| doubt(value, std, "shows {} times what there is", "x");
        let degrees = question(57.1, 0.6).unwrap_or_default();
        assert!(degrees.contains("57.1"), "{degrees}");
        assert!(degrees.ends_with("close to 180/π: is the unit of `x` right?"));
        assert!(question(-0.10197, 1e-6).is_some_and(|text| text.contains("1/9.81")));
        let reversed = question(-1.001, 0.002).unwrap_or_default();
        assert!(reversed.ends_with("times what there is: is the sign of `x` right?"));
        for (value, std) in [(1.02, 0.01), (50.0, 1.0), (9.0, 2.0), (1000.0, f64::NAN)] {
            assert_eq!(question(value, std), None, "{value} ± {std}");
        }
    }
}

//! Writing parameter values back into a spec, with its comments and layout untouched.

use toml_edit::{DocumentMut, Item, Value};

use crate::units::{self, Unit};

/// Why the values could not be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EditError {
    /// The text is not TOML.
    #[error("the spec is not TOML: {message}")]
    Syntax {
        /// The message of the TOML parser.
        message: String,
    },
    /// The spec has no such parameter.
    #[error("the spec has no parameter `{name}`")]
    UnknownParameter {
        /// Its name.
        name: String,
    },
    /// The parameter is written in a form that has no value or no unit.
    #[error("the parameter `{name}` has no readable value and unit")]
    Unreadable {
        /// Its name.
        name: String,
    },
    /// The value is infinite or not a number.
    #[error("the value {value} of the parameter `{name}` is not finite")]
    NotFinite {
        /// Name of the parameter.
        name: String,
        /// The value in SI.
        value: f64,
    },
}

/// Writes parameter values, given in SI, each in the unit of its parameter.
///
/// A value that does not change keeps its notation.
pub fn set_parameters(text: &str, values: &[(&str, f64)]) -> Result<String, EditError> {
    set_numbers(text, "value", values)
}

/// Writes the standard deviations of parameters in the same way, also of those that have none yet.
pub fn set_deviations(text: &str, deviations: &[(&str, f64)]) -> Result<String, EditError> {
    set_numbers(text, STD, deviations)
}

/// The key of a standard deviation.
const STD: &str = "std";

/// Writes numbers, given in SI, under a key of parameters.
fn set_numbers(text: &str, key: &str, numbers: &[(&str, f64)]) -> Result<String, EditError> {
    let mut document: DocumentMut =
        text.parse()
            .map_err(|e: toml_edit::TomlError| EditError::Syntax {
                message: e.message().to_owned(),
            })?;
    for (name, number) in numbers {
        set_number(&mut document, name, key, *number)?;
    }
    Ok(document.to_string())
}

fn set_number(
    document: &mut DocumentMut,
    name: &str,
    key: &str,
    value: f64,
) -> Result<(), EditError> {
    if !value.is_finite() {
        return Err(EditError::NotFinite {
            name: name.to_owned(),
            value,
        });
    }
    let parameter = document
        .get_mut("parameters")
        .and_then(Item::as_table_like_mut)
        .and_then(|parameters| parameters.get_mut(name))
        .ok_or_else(|| EditError::UnknownParameter {
            name: name.to_owned(),
        })?;
    let unreadable = || EditError::Unreadable {
        name: name.to_owned(),
    };
    let table = parameter.as_table_like_mut().ok_or_else(unreadable)?;
    let unit = table
        .get("unit")
        .and_then(Item::as_str)
        .and_then(|text| units::parse(text).ok())
        .ok_or_else(unreadable)?;
    if key == STD && !table.contains_key(key) {
        append(parameter, key, shortest(&unit, value));
        return Ok(());
    }
    let old = table
        .get_mut(key)
        .and_then(Item::as_value_mut)
        .ok_or_else(unreadable)?;
    let stated = match old {
        Value::Integer(n) => Some(n.value().to_string()),
        Value::Float(x) => Some(format!("{:e}", x.value())),
        _ => None,
    };
    if stated.is_some_and(|text| unit.read(&text) == Some(value)) {
        return Ok(());
    }
    let decor = old.decor().clone();
    *old = Value::from(shortest(&unit, value));
    *old.decor_mut() = decor;
    Ok(())
}

/// Adds a key to a table; the space before the brace of an inline one stays there.
fn append(table: &mut Item, key: &str, number: f64) {
    let mut number = Value::from(number);
    number.decor_mut().set_prefix(" ");
    if let Some(inline) = table.as_inline_table_mut()
        && let Some((_, last)) = inline.iter_mut().last()
    {
        let space = last.decor().suffix().cloned();
        last.decor_mut().set_suffix("");
        number.decor_mut().set_suffix(space.unwrap_or_default());
    }
    if let Some(table) = table.as_table_like_mut() {
        table.insert(key, Item::Value(number));
    }
}

/// The shortest decimal number that is read as `value` in `unit`.
fn shortest(unit: &Unit, value: f64) -> f64 {
    let exact_number = unit.from_si(value);
    (0..17)
        .map(|digits| format!("{exact_number:.digits$e}"))
        .find(|text| unit.read(text) == Some(value))
        .and_then(|text| text.parse().ok())
        .unwrap_or(exact_number)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    const SPEC: &str = r#"# A rig.
[parameters]
m = { value = 10,   unit = "kg", about = "mass" }  # weighed
d = { value = 35,   unit = "mm" }
a = { value = 30.0, unit = "deg" }

[parameters.k]   # from the data sheet
value = 1_000 # soft
unit  = "N/m"
"#;

    #[test]
    fn values_are_written_in_their_units_and_nothing_else_moves() {
        let edited = set_parameters(SPEC, &[("m", 10.25), ("d", 0.0352), ("k", 1250.0)]);
        let expected = SPEC
            .replace("10,  ", "10.25,  ")
            .replace("35, ", "35.2, ")
            .replace("1_000", "1250.0");
        assert_eq!(edited, Ok(expected));
    }

    #[test]
    fn deviations_are_written_where_there_were_none_and_replaced_where_there_were() {
        let edited = set_deviations(SPEC, &[("m", 0.25), ("k", 12.0)]).unwrap();
        let expected = SPEC
            .replace("\"mass\" }", "\"mass\", std = 0.25 }")
            .replace("\"N/m\"\n", "\"N/m\"\nstd = 12.0\n");
        assert_eq!(edited, expected);
        let again = set_deviations(&edited, &[("m", 0.5)]);
        assert_eq!(again, Ok(expected.replace("0.25", "0.5")));
    }

    #[test]
    fn stated_values_keep_their_form() {
        let same = [
            ("m", 10.0),
            ("k", 1000.0),
            ("a", std::f64::consts::PI / 6.0),
        ];
        assert_eq!(set_parameters(SPEC, &same), Ok(SPEC.to_owned()));
    }

    #[test]
    fn every_value_survives_writing_and_reading() {
        for value in [0.1 + 0.2, 1e-9, 12_345.678_901_234_5, -2.5e7] {
            let text = set_parameters(SPEC, &[("d", value)]).unwrap();
            let document: DocumentMut = text.parse().unwrap();
            let written = document["parameters"]["d"]["value"].as_float().unwrap();
            let unit = units::parse("mm").unwrap();
            assert_eq!(unit.read(&format!("{written:e}")), Some(value));
        }
    }

    #[test]
    fn impossible_edits_are_refused() {
        let refused = |name, value| set_parameters(SPEC, &[(name, value)]).unwrap_err();
        assert_eq!(
            refused("q", 1.0).to_string(),
            "the spec has no parameter `q`"
        );
        assert_eq!(
            refused("m", f64::INFINITY).to_string(),
            "the value inf of the parameter `m` is not finite"
        );
        assert!(set_parameters("[", &[]).is_err());
    }
}

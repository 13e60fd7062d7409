//! Formulas on one line of Unicode text: `ω₁² sin θ`.

use appell_spec::foreign::one_line;

use super::letter::superscript;
use super::math::Math;

/// A formula on one line.
pub fn text(math: &Math) -> String {
    match math {
        Math::Integer(digits) => digits.clone(),
        Math::Ratio(n, d) => ratio(n, d),
        Math::Letter(letter) => one_line(&letter.to_string()),
        Math::Words(words) => one_line(words),
        Math::Sign(sign) => (*sign).to_owned(),
        Math::Row(factors) => factors.iter().map(text).collect::<Vec<_>>().join(" "),
        Math::Sum(terms) => Math::signed(terms, ["−", " + ", " − "], |term| match term {
            Math::Sum(_) => format!("({})", text(term)),
            _ => text(term),
        }),
        Math::Fraction(above, below) => {
            let above = match **above {
                Math::Sum(_) => format!("({})", text(above)),
                // `cos φ/a` would read as the cosine of a quotient.
                _ if ends_with_function(above) => format!("({})", text(above)),
                _ => text(above),
            };
            format!("{above}/{}", divisor(below))
        }
        Math::Power(base, exponent) => match &**exponent {
            Math::Integer(digits) => format!("{}{}", text(base), raised(digits)),
            other => format!("{}^({})", text(base), text(other)),
        },
        Math::Call(name, exponent, argument) => {
            let raised = match exponent {
                1 => String::new(),
                exponent => raised(&exponent.to_string()),
            };
            match **argument {
                Math::Letter(_) => format!("{name}{raised} {}", text(argument)),
                Math::Vector { .. } => format!("{name}{raised}{}", text(argument)),
                _ => format!("{name}{raised}({})", text(argument)),
            }
        }
        Math::Root(inner) => match **inner {
            Math::Letter(_) | Math::Integer(_) => format!("√{}", text(inner)),
            _ => format!("√({})", text(inner)),
        },
        Math::Size(inner) => format!("|{}|", text(inner)),
        Math::Brackets(inner) => format!("({})", text(inner)),
        Math::Vector {
            components, frame, ..
        } => {
            let components: Vec<String> = components.iter().map(text).collect();
            match frame {
                Some(frame) => format!("[{}] {}", components.join(",  "), one_line(frame)),
                None => format!("({})", components.join(", ")),
            }
        }
        Math::Matrix(rows) => {
            let rows: Vec<String> = rows
                .iter()
                .map(|row| row.iter().map(text).collect::<Vec<_>>().join(", "))
                .collect();
            format!("[{}]", rows.join("; "))
        }
        Math::Cases {
            value,
            condition,
            otherwise,
        } => {
            format!(
                "({} if {}, else {})",
                text(value),
                text(condition),
                text(otherwise)
            )
        }
    }
}

fn ends_with_function(math: &Math) -> bool {
    match math {
        Math::Call(..) => true,
        Math::Row(factors) => factors.last().is_some_and(|f| matches!(f, Math::Call(..))),
        _ => false,
    }
}

fn divisor(below: &Math) -> String {
    match below {
        Math::Letter(_)
        | Math::Integer(_)
        | Math::Power(..)
        | Math::Call(..)
        | Math::Size(_)
        | Math::Brackets(_) => text(below),
        _ => format!("({})", text(below)),
    }
}

fn raised(digits: &str) -> String {
    digits.chars().map(superscript).collect()
}

fn ratio(n: &str, d: &str) -> String {
    let known = match (n, d) {
        ("1", "2") => "½",
        ("1", "3") => "⅓",
        ("2", "3") => "⅔",
        ("1", "4") => "¼",
        ("3", "4") => "¾",
        ("1", "8") => "⅛",
        ("3", "8") => "⅜",
        ("5", "8") => "⅝",
        ("7", "8") => "⅞",
        _ => return format!("{n}/{d}"),
    };
    known.to_owned()
}

/// Width of a text in columns.
pub fn columns(text: &str) -> usize {
    text.chars().filter(|&c| !is_combining(c)).count()
}

/// Whether a character has zero width.
fn is_combining(c: char) -> bool {
    matches!(c, '\u{300}'..='\u{36f}' | '\u{20d0}'..='\u{20ff}')
}

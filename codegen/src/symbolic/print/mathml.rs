//! Formulas as presentation `MathML`, restricted to what browsers support natively.

use std::fmt::Write;

use appell_spec::foreign::one_line;

use super::letter::Letter;
use super::math::Math;

/// Text with HTML's special characters escaped.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in one_line(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// Invisible multiplication with a little space.
pub const TIMES: &str = "<mo lspace=\"0.08em\" rspace=\"0.08em\">\u{2062}</mo>";

/// Plus or minus before a term.
pub fn sign(minus: bool, first: bool) -> &'static str {
    match (minus, first) {
        (false, true) => "",
        (true, true) => "<mo form=\"prefix\">−</mo>",
        (false, false) => "<mo form=\"infix\">+</mo>",
        (true, false) => "<mo form=\"infix\">−</mo>",
    }
}

/// A formula, without the surrounding `<math>`.
pub fn mathml(math: &Math) -> String {
    match math {
        Math::Integer(digits) => format!("<mn>{}</mn>", escaped(digits)),
        Math::Ratio(n, d) => format!(
            "<mstyle displaystyle=\"false\"><mfrac><mn>{}</mn><mn>{}</mn></mfrac></mstyle>",
            escaped(n),
            escaped(d)
        ),
        Math::Letter(l) => letter(l),
        Math::Words(words) => format!("<mtext>{}</mtext>", escaped(words)),
        Math::Sign("Σ") => "<mo largeop=\"false\">∑</mo>".to_owned(),
        Math::Sign(sign) => format!("<mo>{}</mo>", escaped(sign)),
        Math::Row(factors) => row(factors),
        Math::Sum(terms) => {
            let signs = [sign(true, true), sign(false, false), sign(true, false)];
            let out = Math::signed(terms, signs, mathml);
            format!("<mrow>{out}</mrow>")
        }
        Math::Fraction(above, below) => {
            format!("<mfrac>{}{}</mfrac>", mathml(above), mathml(below))
        }
        Math::Power(base, exponent) => {
            format!("<msup>{}{}</msup>", mathml(base), mathml(exponent))
        }
        Math::Call(name, exponent, argument) => call(name, *exponent, argument),
        Math::Root(inner) => format!("<msqrt>{}</msqrt>", mathml(inner)),
        Math::Size(inner) => format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", mathml(inner)),
        Math::Brackets(inner) => bracketed(inner),
        Math::Vector {
            components,
            frame,
            column,
        } => vector(components, frame.as_deref(), *column),
        Math::Matrix(rows) => {
            let rows: Vec<Vec<String>> = rows
                .iter()
                .map(|row| row.iter().map(mathml).collect())
                .collect();
            grid(&rows)
        }
        Math::Cases {
            value,
            condition,
            otherwise,
        } => {
            let rows = [
                vec![
                    mathml(value),
                    format!("<mtext>if </mtext>{}", mathml(condition)),
                ],
                vec![mathml(otherwise), "<mtext>otherwise</mtext>".to_owned()],
            ];
            format!("<mrow><mo>{{</mo>{}</mrow>", table("<mtable>", &rows))
        }
    }
}

fn row(factors: &[Math]) -> String {
    let mut out = String::new();
    for (k, factor) in factors.iter().enumerate() {
        let signs =
            matches!(factor, Math::Sign(_)) || k == 0 || matches!(factors[k - 1], Math::Sign(_));
        if !signs {
            out.push_str(TIMES);
        }
        out.push_str(&mathml(factor));
    }
    format!("<mrow>{out}</mrow>")
}

/// Brackets are stretched only around content taller than a line, since stretched ones add space.
fn bracketed(inner: &Math) -> String {
    let stretchy = inner.has_fraction();
    format!(
        "<mrow><mo stretchy=\"{stretchy}\">(</mo>{}<mo stretchy=\"{stretchy}\">)</mo></mrow>",
        mathml(inner)
    )
}

fn call(name: &str, exponent: u32, argument: &Math) -> String {
    let mut head = format!("<mi>{name}</mi>");
    if exponent != 1 {
        head = format!("<msup>{head}<mn>{exponent}</mn></msup>");
    }
    let argument = match argument {
        Math::Letter(_) => format!("<mspace width=\"0.16em\"/>{}", mathml(argument)),
        Math::Vector { .. } => mathml(argument),
        _ => bracketed(argument),
    };
    format!("<mrow>{head}<mo>\u{2061}</mo>{argument}</mrow>")
}

/// Rows in brackets drawn by the style sheet, since fonts often lack stretchable ones.
fn grid(rows: &[Vec<String>]) -> String {
    table("<mtable class=\"matrix\">", rows)
}

fn table(tag: &str, rows: &[Vec<String>]) -> String {
    let mut out = String::from(tag);
    for row in rows {
        out.push_str("<mtr>");
        for cell in row {
            let _ = write!(out, "<mtd>{cell}</mtd>");
        }
        out.push_str("</mtr>");
    }
    out.push_str("</mtable>");
    out
}

fn vector(components: &[Math], frame: Option<&str>, column: bool) -> String {
    let components: Vec<String> = components.iter().map(mathml).collect();
    let Some(frame) = frame else {
        return if column {
            let rows: Vec<Vec<String>> = components.into_iter().map(|c| vec![c]).collect();
            grid(&rows)
        } else {
            format!(
                "<mrow><mo>(</mo>{}<mo>)</mo></mrow>",
                components.join("<mo>,</mo>")
            )
        };
    };
    let frame = format!("<mtext>{}</mtext>", escaped(frame));
    if column {
        let rows: Vec<Vec<String>> = components.into_iter().map(|c| vec![c]).collect();
        return format!("<msub>{}{frame}</msub>", grid(&rows));
    }
    let inside = grid(&[components]);
    format!("<msubsup>{inside}{frame}<mi mathvariant=\"normal\">T</mi></msubsup>")
}

fn letter(letter: &Letter) -> String {
    let base = escaped(&letter.base);
    let mut out = match (letter.base.is_empty(), letter.bold) {
        (true, _) => String::new(),
        (_, true) => format!("<mi class=\"b\" mathvariant=\"normal\">{base}</mi>"),
        (_, false) => format!("<mi>{base}</mi>"),
    };
    if letter.dots > 0 {
        let dots = match letter.dots {
            1 => "˙",
            2 => "¨",
            _ => "⃛",
        };
        out = format!(
            "<mover accent=\"true\">{out}<mo class=\"dot\" stretchy=\"false\">{dots}</mo></mover>"
        );
    }
    let below: Vec<String> = letter.below.iter().map(|part| label(part)).collect();
    let below = match below.as_slice() {
        [] => None,
        [single] => Some(single.clone()),
        several => Some(format!(
            "<mrow>{}</mrow>",
            several.join("<mo rspace=\"0.1em\">,</mo>")
        )),
    };
    let above = letter
        .above
        .as_ref()
        .map(|mark| format!("<mn>{}</mn>", escaped(mark)));
    out = match (below, above) {
        (None, None) => out,
        (Some(below), None) => format!("<msub>{out}{below}</msub>"),
        (None, Some(above)) => format!("<msup>{out}{above}</msup>"),
        (Some(below), Some(above)) => format!("<msubsup>{out}{below}{above}</msubsup>"),
    };
    match letter.before {
        Some(sign) => format!("<mrow><mi mathvariant=\"normal\">{sign}</mi>{out}</mrow>"),
        None => out,
    }
}

/// A subscript: Greek letters, axes and counters slanted, names upright.
fn label(part: &str) -> String {
    let text = escaped(part);
    if part.chars().all(|c| c.is_ascii_digit()) {
        return format!("<mn>{text}</mn>");
    }
    let slanted = matches!(part, "x" | "y" | "z" | "i") || !part.is_ascii();
    if slanted || part.chars().count() > 1 {
        format!("<mi>{text}</mi>")
    } else {
        format!("<mi mathvariant=\"normal\">{text}</mi>")
    }
}

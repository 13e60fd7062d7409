//! Formulas as `LaTeX` in math mode, with `amsmath`.

use std::fmt::Write;

use appell_spec::foreign::one_line;

use super::letter::{Letter, greek_command};
use super::math::Math;

fn letter(letter: &Letter) -> String {
    let mut characters = letter.base.chars();
    let mut base = match (characters.next(), letter.is_word()) {
        (Some(c), false) => match greek_command(c) {
            Some(command) => format!("\\{command}"),
            None => mathematical(&letter.base),
        },
        (None, _) => String::new(),
        _ => format!("\\mathrm{{{}}}", mathematical(&letter.base)),
    };
    if letter.bold && !base.is_empty() {
        base = format!("\\boldsymbol{{{base}}}");
    }
    base = match letter.dots {
        0 => base,
        1 => format!("\\dot{{{base}}}"),
        2 => format!("\\ddot{{{base}}}"),
        _ => format!("\\dddot{{{base}}}"),
    };
    if let Some(mark) = &letter.above {
        let _ = write!(base, "^{{{}}}", mathematical(mark));
    }
    if !letter.below.is_empty() {
        let labels: Vec<String> = letter.below.iter().map(|part| label(part)).collect();
        let _ = write!(base, "_{{{}}}", labels.join(","));
    }
    let before = match letter.before {
        None => "",
        Some('δ') => "\\delta ",
        Some('∂') => "\\partial ",
        Some(_) => "\\mathrm{d}",
    };
    format!("{before}{base}")
}

/// A subscript: Greek letters, axes and counters slanted, names upright.
fn label(part: &str) -> String {
    if part.chars().all(|c| c.is_ascii_digit() || c == ',') {
        return part.to_owned();
    }
    let single = part.chars().next().filter(|_| part.chars().count() == 1);
    match (single, single.and_then(greek_command)) {
        (_, Some(command)) => format!("\\{command}"),
        (Some(c @ ('x' | 'y' | 'z' | 'i')), None) => c.to_string(),
        _ => format!("\\mathrm{{{}}}", mathematical(part)),
    }
}

/// Characters in a formula: a name consists of letters, digits and underscores.
fn mathematical(name: &str) -> String {
    name.chars()
        .map(|c| match c {
            '_' => "\\_".to_owned(),
            c if c.is_ascii_alphanumeric() || c == ',' => c.to_string(),
            c => match greek_command(c) {
                Some(command) => format!("\\{command} "),
                None => format!("\\text{{{}}}", latex_text(&c.to_string())),
            },
        })
        .collect()
}

/// A formula in math mode.
pub fn latex(math: &Math) -> String {
    match math {
        Math::Integer(digits) => digits.clone(),
        Math::Ratio(n, d) => format!("\\tfrac{{{n}}}{{{d}}}"),
        Math::Letter(l) => letter(l),
        Math::Words(words) => format!("\\text{{{}}}", latex_text(words)),
        Math::Sign(sign) => match *sign {
            "·" => "\\cdot ".to_owned(),
            "×" => "\\times ".to_owned(),
            "Σ" => "\\sum ".to_owned(),
            "≤" => "\\le ".to_owned(),
            "≠" => "\\ne ".to_owned(),
            sign => format!("{sign} "),
        },
        Math::Row(factors) => row(factors),
        Math::Sum(terms) => Math::signed(terms, ["-", " + ", " - "], latex),
        Math::Fraction(above, below) => {
            format!("\\frac{{{}}}{{{}}}", latex(above), latex(below))
        }
        Math::Power(base, exponent) => format!("{}^{{{}}}", powered(base), latex(exponent)),
        Math::Call(name, exponent, argument) => call(name, *exponent, argument),
        Math::Root(inner) => format!("\\sqrt{{{}}}", latex(inner)),
        Math::Size(inner) => format!("\\left|{}\\right|", latex(inner)),
        Math::Brackets(inner) => bracketed(inner),
        Math::Vector {
            components,
            frame,
            column,
        } => vector(components, frame.as_deref(), *column),
        Math::Matrix(rows) => {
            let row = |row: &Vec<Math>| row.iter().map(latex).collect::<Vec<_>>().join(" & ");
            matrix(&rows.iter().map(row).collect::<Vec<_>>(), " \\\\ ")
        }
        Math::Cases {
            value,
            condition,
            otherwise,
        } => format!(
            "\\begin{{cases}} {} & {} \\\\ {} & \\text{{otherwise}} \\end{{cases}}",
            latex(value),
            latex(condition),
            latex(otherwise)
        ),
    }
}

fn row(factors: &[Math]) -> String {
    let mut out = String::new();
    for (k, factor) in factors.iter().enumerate() {
        let signs =
            matches!(factor, Math::Sign(_)) || k == 0 || matches!(factors[k - 1], Math::Sign(_));
        if !signs {
            // Functions insert their own space.
            let apart = !matches!(factor, Math::Call(..) | Math::Brackets(_));
            out.push_str(if apart { "\\, " } else { " " });
        }
        out.push_str(&latex(factor));
    }
    out
}

/// Rows of a matrix in brackets.
fn matrix(rows: &[String], between: &str) -> String {
    format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}", rows.join(between))
}

fn vector(components: &[Math], frame: Option<&str>, column: bool) -> String {
    let components: Vec<String> = components.iter().map(latex).collect();
    match (frame, column) {
        (None, true) => matrix(&components, " \\\\ "),
        (None, false) => format!("({})", components.join(",\\, ")),
        (Some(frame), _) => {
            let (between, turned) = if column {
                (" \\\\ ", "")
            } else {
                (" & ", "^{\\mathsf T}")
            };
            let matrix = matrix(&components, between);
            format!("{matrix}{turned}_{{\\text{{{}}}}}", latex_text(frame))
        }
    }
}

fn bracketed(inner: &Math) -> String {
    if inner.has_fraction() {
        format!("\\left({}\\right)", latex(inner))
    } else {
        format!("({})", latex(inner))
    }
}

/// A letter with a superscript needs braces before it is raised to a power.
fn powered(base: &Math) -> String {
    match base {
        Math::Letter(l) if l.above.is_some() => format!("\\bigl({}\\bigr)", latex(base)),
        Math::Letter(_) => format!("{{{}}}", latex(base)),
        _ => latex(base),
    }
}

fn call(name: &str, exponent: u32, argument: &Math) -> String {
    let name = match name {
        "diag" | "sgn" | "atan2" => format!("\\operatorname{{{name}}}"),
        name => format!("\\{name}"),
    };
    let raised = if exponent == 1 {
        String::new()
    } else {
        format!("^{{{exponent}}}")
    };
    match argument {
        Math::Letter(_) => format!("{name}{raised} {}", latex(argument)),
        Math::Vector { .. } => format!("{name}{raised}{}", latex(argument)),
        _ => format!("{name}{raised}{}", bracketed(argument)),
    }
}

/// Text with LaTeX's special characters escaped.
pub fn latex_text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in one_line(text).chars() {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => {
                out.push('\\');
                out.push(c);
            }
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '"' => out.push_str("\\textquotedbl{}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '|' => out.push_str("\\textbar{}"),
            '\'' => out.push_str("{'}"),
            '`' => out.push_str("{`}"),
            '-' => out.push_str("{-}"),
            '−' => out.push_str("$-$"),
            '₀'..='₉' => {
                let digit = u32::from(c) - u32::from('₀');
                let _ = write!(out, "$_{digit}$");
            }
            'ᵢ' => out.push_str("$_i$"),
            ' '..='~' => out.push(c),
            c => foreign(&mut out, c),
        }
    }
    out
}

/// A non-ASCII character.
fn foreign(out: &mut String, c: char) {
    if let Some(command) = greek_command(c) {
        let _ = write!(out, "$\\{command}$");
        return;
    }
    let raised = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹']
        .iter()
        .position(|&digit| digit == c);
    match (c, raised) {
        (_, Some(digit)) => {
            let _ = write!(out, "$^{{{digit}}}$");
        }
        ('⁻', _) => out.push_str("$^{-}$"),
        ('°', _) => out.push_str("$^{\\circ}$"),
        ('·', _) => out.push_str("$\\cdot$"),
        ('–', _) => out.push_str("--"),
        ('—', _) => out.push_str("---"),
        ('’', _) => out.push('\''),
        ('…', _) => out.push_str("\\dots{}"),
        // Accented Latin letters are supported by every engine.
        ('À'..='ÿ' | 'Ā'..='ž', _) => out.push(c),
        _ => {
            let _ = write!(out, "\\other{{{}}}{{{:04X}}}", c as u32, c as u32);
        }
    }
}

//! LaTeX: a document of its own that compiles with `pdftex`, `xetex` and `luatex`.

use std::fmt::Write;

use super::letters::{Letter, greek_command};
use super::math::{Equation, Math, Piece, left_width};
use super::{Block, Chain, Page, Span, Table};

/// Width of a line of equations, in characters as [`Math::width`] counts them.
const WIDTH: usize = 88;

/// What stands before the text. `\other` shows a character where the engine knows all of Unicode,
/// and its number elsewhere.
const PREAMBLE: &str = r"\documentclass[10pt,a4paper,fleqn]{article}
\usepackage{iftex}
\ifPDFTeX
  \usepackage[T1]{fontenc}
  \usepackage{lmodern}
  \newcommand{\other}[2]{[U+#2]}
\else
  \newcommand{\other}[2]{\symbol{#1}}
\fi
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath}
\usepackage{array}
\setlength{\parindent}{0pt}
\setlength{\parskip}{5pt}
\setlength{\mathindent}{2em}
\setcounter{MaxMatrixCols}{64}
\allowdisplaybreaks
\raggedbottom
\sloppy
\newcommand{\quantities}[1]{\par\medskip\textbf{#1}\par}
";

/// The page as a LaTeX document.
pub fn latex(page: &Page) -> String {
    let mut out = String::from(PREAMBLE);
    let _ = write!(
        out,
        "\\begin{{document}}\n\n{{\\LARGE\\bfseries {}\\par}}\n",
        escaped(&page.title)
    );
    if let Some(source) = &page.source {
        let _ = write!(
            out,
            "\\smallskip\n{{\\small After: {}\\par}}\n",
            escaped(source)
        );
    }
    for section in &page.sections {
        let _ = write!(out, "\n\\section{{{}}}\n", spans(&section.heading));
        for (k, block) in section.blocks.iter().enumerate() {
            // A display belongs to the paragraph before it.
            let follows = k > 0 && matches!(section.blocks[k - 1], Block::Sentence(_));
            if !(follows && matches!(block, Block::Equations(_) | Block::Chain(_))) {
                out.push('\n');
            }
            match block {
                Block::Sentence(sentence) => out.push_str(&spans(sentence)),
                Block::Table(t) => table(&mut out, t),
                Block::Chain(c) => chain(&mut out, c),
                Block::Equations(all) => equations(&mut out, all),
            }
            out.push('\n');
        }
    }
    out.push_str("\n\\end{document}\n");
    out
}

/// Text that LaTeX prints and does not obey.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
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
            ' '..='~' => out.push(c),
            c => foreign(&mut out, c),
        }
    }
    out
}

/// A character beyond ASCII.
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
        // Latin letters with accents are known to every engine.
        ('À'..='ÿ' | 'Ā'..='ž', _) => out.push(c),
        _ if c.is_control() => out.push(' '),
        _ => {
            let _ = write!(out, "\\other{{{}}}{{{:04X}}}", c as u32, c as u32);
        }
    }
}

fn spans(spans: &[Span]) -> String {
    spans
        .iter()
        .map(|span| match span {
            Span::Text(text) => escaped(text),
            Span::Math(math) => format!("${}$", formula(math)),
        })
        .collect()
}

fn table(out: &mut String, table: &Table) {
    let columns = table.rows.iter().map(Vec::len).max().unwrap_or(1);
    if !table.title.is_empty() {
        let _ = writeln!(out, "\\quantities{{{}}}", escaped(&table.title));
    }
    // The last column takes what the others leave.
    let firsts = "l".repeat(columns.saturating_sub(1));
    let widest = |k: usize| {
        table
            .rows
            .iter()
            .filter_map(|row| row.get(k))
            .map(|cell| width(cell))
            .max()
    };
    let used: usize = (0..columns.saturating_sub(1))
        .map(|k| widest(k).unwrap_or(0) + 3)
        .sum();
    let share =
        f64::from(u32::try_from(92_usize.saturating_sub(used).max(24)).unwrap_or(24)) / 100.0;
    let _ = writeln!(
        out,
        "\\begin{{tabular}}{{{firsts}>{{\\raggedright\\arraybackslash}}p{{{share:.2}\\textwidth}}}}"
    );
    for row in &table.rows {
        let cells: Vec<String> = row.iter().map(|cell| spans(cell)).collect();
        let _ = writeln!(out, "{} \\\\", cells.join(" & "));
    }
    out.push_str("\\end{tabular}\\par");
}

fn width(spans: &[Span]) -> usize {
    spans
        .iter()
        .map(|span| match span {
            Span::Text(text) => text.chars().count(),
            Span::Math(math) => math.width(),
        })
        .sum()
}

fn chain(out: &mut String, chain: &Chain) {
    let _ = write!(out, "\\[ \\text{{{}}}", escaped(&chain.start));
    for (label, to) in &chain.links {
        let label: String = label
            .iter()
            .map(|span| match span {
                Span::Text(text) => format!("\\text{{{}}}", escaped(text)),
                Span::Math(math) => formula(math),
            })
            .collect();
        let _ = write!(
            out,
            " \\xrightarrow{{\\;{label}\\;}} \\text{{{}}}",
            escaped(to)
        );
    }
    out.push_str(" \\]");
}

fn equations(out: &mut String, equations: &[Equation]) {
    let left_width = left_width(equations);
    out.push_str("\\begin{align*}\n");
    let mut rows = Vec::new();
    for equation in equations {
        let display = equation.display(WIDTH, left_width);
        for (k, line) in display.lines.iter().enumerate() {
            let right = pieces(line);
            rows.push(match (display.left, k) {
                (Some(left), 0) => format!("{} &= {right}", formula(left)),
                (Some(_), _) => format!("&\\quad {right}"),
                (None, 0) => format!("&{right}"),
                (None, _) => format!("&\\qquad {right}"),
            });
        }
    }
    let _ = write!(out, "{}\n\\end{{align*}}", rows.join(" \\\\\n"));
}

fn pieces(pieces: &[Piece<'_>]) -> String {
    // A bracket is as tall as what it holds; lines may break between the two.
    let tall = pieces
        .iter()
        .any(|piece| matches!(piece, Piece::Whole(math) if math.has_fraction()));
    let (open, close) = if tall {
        ("\\Bigl(", "\\Bigr)")
    } else {
        ("\\bigl(", "\\bigr)")
    };
    let mut out = String::new();
    let mut after_whole = false;
    for piece in pieces {
        match piece {
            Piece::Whole(math) => {
                if after_whole {
                    out.push_str("\\, ");
                }
                out.push_str(&formula(math));
            }
            Piece::Sign { minus, first: true } => out.push_str(if *minus { "-" } else { "" }),
            // An empty group makes a sign at the start of a line a sign between two terms.
            Piece::Sign { minus, .. } => out.push_str(if *minus { " {}- " } else { " {}+ " }),
            Piece::Equals => out.push_str(" {}= "),
            Piece::Open => {
                out.push_str(if after_whole { "\\, " } else { "" });
                out.push_str(open);
            }
            Piece::Close => out.push_str(close),
        }
        after_whole = matches!(piece, Piece::Whole(_) | Piece::Close);
    }
    out.trim_start().to_owned()
}

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

/// A label below a letter: Greek letters, axes and counters slanted, names upright.
fn label(part: &str) -> String {
    if part.chars().all(|c| c.is_ascii_digit() || c == ',') {
        return part.to_owned();
    }
    let single = part.chars().next().filter(|_| part.chars().count() == 1);
    match single {
        Some(c) => match greek_command(c) {
            Some(command) => format!("\\{command}"),
            None if matches!(c, 'x' | 'y' | 'z' | 'i') => c.to_string(),
            None => format!("\\mathrm{{{}}}", mathematical(part)),
        },
        None => format!("\\mathrm{{{}}}", mathematical(part)),
    }
}

/// Characters in a formula: a name holds letters, digits and underscores.
fn mathematical(name: &str) -> String {
    name.chars()
        .map(|c| match c {
            '_' => "\\_".to_owned(),
            c if c.is_ascii_alphanumeric() || c == ',' => c.to_string(),
            c => match greek_command(c) {
                Some(command) => format!("\\{command} "),
                None => format!("\\text{{{}}}", escaped(&c.to_string())),
            },
        })
        .collect()
}

/// A formula in math mode.
fn formula(math: &Math) -> String {
    match math {
        Math::Integer(digits) => digits.clone(),
        Math::Ratio(n, d) => format!("\\tfrac{{{n}}}{{{d}}}"),
        Math::Letter(l) => letter(l),
        Math::Words(words) => format!("\\text{{{}}}", escaped(words)),
        Math::Sign(sign) => match *sign {
            "·" => "\\cdot ".to_owned(),
            "×" => "\\times ".to_owned(),
            "Σ" => "\\sum ".to_owned(),
            "≤" => "\\le ".to_owned(),
            sign => format!("{sign} "),
        },
        Math::Row(factors) => row(factors),
        Math::Sum(terms) => sum(terms),
        Math::Fraction(above, below) => {
            format!("\\frac{{{}}}{{{}}}", formula(above), formula(below))
        }
        Math::Power(base, exponent) => format!("{}^{{{}}}", powered(base), formula(exponent)),
        Math::Call(name, exponent, argument) => call(name, *exponent, argument),
        Math::Root(inner) => format!("\\sqrt{{{}}}", formula(inner)),
        Math::Size(inner) => format!("\\left|{}\\right|", formula(inner)),
        Math::Brackets(inner) => bracketed(inner),
        Math::Vector {
            components,
            frame,
            column,
        } => {
            let Some(frame) = frame else {
                let components: Vec<String> = components.iter().map(formula).collect();
                return if *column {
                    format!(
                        "\\begin{{bmatrix}} {} \\end{{bmatrix}}",
                        components.join(" \\\\ ")
                    )
                } else {
                    format!("({})", components.join(",\\, "))
                };
            };
            let between = if *column { " \\\\ " } else { " & " };
            let turned = if *column { "" } else { "^{\\mathsf T}" };
            let components: Vec<String> = components.iter().map(formula).collect();
            format!(
                "\\begin{{bmatrix}} {} \\end{{bmatrix}}{turned}_{{\\text{{{}}}}}",
                components.join(between),
                escaped(frame)
            )
        }
        Math::Matrix(rows) => {
            let rows: Vec<String> = rows
                .iter()
                .map(|row| row.iter().map(formula).collect::<Vec<_>>().join(" & "))
                .collect();
            format!(
                "\\begin{{bmatrix}} {} \\end{{bmatrix}}",
                rows.join(" \\\\ ")
            )
        }
        Math::Cases {
            value,
            condition,
            otherwise,
        } => format!(
            "\\begin{{cases}} {} & {} \\\\ {} & \\text{{otherwise}} \\end{{cases}}",
            formula(value),
            formula(condition),
            formula(otherwise)
        ),
    }
}

fn row(factors: &[Math]) -> String {
    let mut out = String::new();
    for (k, factor) in factors.iter().enumerate() {
        let signs =
            matches!(factor, Math::Sign(_)) || k == 0 || matches!(factors[k - 1], Math::Sign(_));
        if !signs {
            // Functions bring their own space.
            let apart = !matches!(factor, Math::Call(..) | Math::Brackets(_));
            out.push_str(if apart { "\\, " } else { " " });
        }
        out.push_str(&formula(factor));
    }
    out
}

fn sum(terms: &[(bool, Math)]) -> String {
    let mut out = String::new();
    for (k, (minus, term)) in terms.iter().enumerate() {
        match (k, minus) {
            (0, false) => {}
            (0, true) => out.push('-'),
            (_, false) => out.push_str(" + "),
            (_, true) => out.push_str(" - "),
        }
        out.push_str(&formula(term));
    }
    out
}

fn bracketed(inner: &Math) -> String {
    if inner.has_fraction() {
        format!("\\left({}\\right)", formula(inner))
    } else {
        format!("({})", formula(inner))
    }
}

/// A letter with a mark above gets braces before it is raised.
fn powered(base: &Math) -> String {
    match base {
        Math::Letter(l) if l.above.is_some() => format!("\\bigl({}\\bigr)", formula(base)),
        Math::Letter(_) => format!("{{{}}}", formula(base)),
        _ => formula(base),
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
        Math::Letter(_) => format!("{name}{raised} {}", formula(argument)),
        Math::Vector { .. } => format!("{name}{raised}{}", formula(argument)),
        _ => format!("{name}{raised}{}", bracketed(argument)),
    }
}

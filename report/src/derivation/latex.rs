//! LaTeX: a self-contained document that compiles with `pdftex`, `xetex` and `luatex`.

use std::fmt::Write;

use super::display::{Equation, Piece, left_width};
use super::{Block, Chain, Page, Span, Table};
use appell_codegen::symbolic::print::{latex as formula, latex_text as escaped};

/// Width of a line of equations, in characters as [`Math::width`] counts them.
const WIDTH: usize = 88;

/// The preamble. `\other` shows a character if the engine supports Unicode, and its number
/// otherwise.
const PREAMBLE: &str = r"\documentclass[10pt,a4paper,fleqn]{article}
\usepackage{iftex}
\ifPDFTeX
  \usepackage[T1]{fontenc}
  \usepackage{lmodern}
  \newcommand{\other}[2]{[U+#2]}
\else
  \newcommand{\other}[2]{\symbol{#1}}
\fi
\usepackage[margin=18mm]{geometry}
\usepackage{amsmath}
\usepackage{tabularx}
\setlength{\parindent}{0pt}
\setlength{\parskip}{3pt}
\setlength{\mathindent}{2em}
\setcounter{MaxMatrixCols}{64}
\allowdisplaybreaks
\raggedbottom
\sloppy
\newcommand{\quantities}[1]{\par\smallskip\textbf{#1}\par}
\makeatletter
\renewcommand{\section}{\@startsection{section}{1}{0pt}{8pt plus 2pt}{3pt}{\large\bfseries}}
\makeatother
\AtBeginDocument{%
  \setlength{\abovedisplayskip}{3pt plus 1pt}%
  \setlength{\belowdisplayskip}{3pt plus 1pt}%
}
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
            "\\smallskip\n{{\\small Source: {}\\par}}\n",
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

/// The equations of the page alone, for a page that sets formulas itself.
pub fn formulas(page: &Page) -> String {
    let mut out = String::new();
    for block in page.sections.iter().flat_map(|section| &section.blocks) {
        if let Block::Equations(all) = block {
            equations(&mut out, all);
            out.push('\n');
        }
    }
    out
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
    let columns = table
        .rows
        .iter()
        .map(|row| row.cells.len())
        .max()
        .unwrap_or(1);
    if !table.title.is_empty() {
        let _ = writeln!(out, "\\quantities{{{}}}", escaped(&table.title));
    }
    // The last column takes the remaining width, followed by the lines of the spec.
    let firsts = "l".repeat(columns.saturating_sub(1));
    let _ = writeln!(
        out,
        "\\begin{{tabularx}}{{\\textwidth}}{{{firsts}>{{\\raggedright\\arraybackslash}}Xr}}"
    );
    for row in &table.rows {
        let cells: Vec<String> = row.cells.iter().map(|cell| spans(cell)).collect();
        let _ = writeln!(
            out,
            "{} & \\footnotesize {} \\\\",
            cells.join(" & "),
            row.line
        );
    }
    out.push_str("\\end{tabularx}\\par");
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
    // A bracket is as tall as its content; lines may break between the two.
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

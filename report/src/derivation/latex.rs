//! LaTeX: a self-contained document that compiles with `pdftex`, `xetex` and `luatex`.

use std::fmt::Write;

use super::display::{Equation, Piece, left_width};
use super::{Block, Chain, Page, Span, Table};
use appell_codegen::symbolic::print::{latex as formula, latex_text as escaped};

/// Width of a line of equations, in characters as [`Math::width`] counts them.
const WIDTH: usize = 88;

/// The preamble. `\other` shows a character if the engine supports Unicode, and its number
/// otherwise.
const PREAMBLE: &str = include_str!("preamble.tex");

/// The page as a LaTeX document.
pub fn latex(page: &Page) -> String {
    let title = escaped(&page.title);
    let mut out = format!("{PREAMBLE}\\begin{{document}}\n\n{{\\LARGE\\bfseries {title}\\par}}\n");
    if let Some(source) = &page.source {
        let source = escaped(source);
        // Writing to a string cannot fail.
        let _ = writeln!(out, "\\smallskip\n{{\\small Source: {source}\\par}}");
    }
    for section in &page.sections {
        let _ = writeln!(out, "\n\\section{{{}}}", spans(&section.heading));
        let mut is_sentence = false;
        for block in &section.blocks {
            // A display belongs to the paragraph before it.
            if !(is_sentence && matches!(block, Block::Equations(_) | Block::Chain(_))) {
                out.push('\n');
            }
            is_sentence = matches!(block, Block::Sentence(_));
            out += &match block {
                Block::Sentence(sentence) => spans(sentence),
                Block::Table(all) => table(all),
                Block::Chain(all) => chain(all),
                Block::Equations(all) => equations(all),
            };
            out.push('\n');
        }
    }
    out + "\n\\end{document}\n"
}

/// The equations of the page alone, for a page that sets formulas itself.
pub fn formulas(page: &Page) -> String {
    let blocks = page.sections.iter().flat_map(|section| &section.blocks);
    let formulas = blocks.filter_map(|block| match block {
        Block::Equations(all) => Some(equations(all) + "\n"),
        _ => None,
    });
    formulas.collect()
}

fn spans(spans: &[Span]) -> String {
    let shown = spans.iter().map(|span| match span {
        Span::Text(text) => escaped(text),
        Span::Math(math) => format!("${}$", formula(math)),
    });
    shown.collect()
}

fn table(table: &Table) -> String {
    let mut out = String::new();
    if !table.title.is_empty() {
        let _ = writeln!(out, "\\quantities{{{}}}", escaped(&table.title));
    }
    let columns = table.rows.iter().map(|row| row.cells.len()).max();
    // The last column takes the remaining width, followed by the lines of the spec.
    let firsts = "l".repeat(columns.unwrap_or(1).saturating_sub(1));
    let _ = writeln!(
        out,
        "\\begin{{tabularx}}{{\\textwidth}}{{{firsts}>{{\\raggedright\\arraybackslash}}Xr}}"
    );
    for row in &table.rows {
        let cells: Vec<String> = row.cells.iter().map(|cell| spans(cell)).collect();
        let (cells, line) = (cells.join(" & "), row.line);
        let _ = writeln!(out, "{cells} & \\footnotesize {line} \\\\");
    }
    out + "\\end{tabularx}\\par"
}

fn chain(chain: &Chain) -> String {
    let mut out = format!("\\[ \\text{{{}}}", escaped(&chain.start));
    for (label, to) in &chain.links {
        let label = label.iter().map(|span| match span {
            Span::Text(text) => format!("\\text{{{}}}", escaped(text)),
            Span::Math(math) => formula(math),
        });
        let (label, to) = (label.collect::<String>(), escaped(to));
        let _ = write!(out, " \\xrightarrow{{\\;{label}\\;}} \\text{{{to}}}");
    }
    out + " \\]"
}

fn equations(equations: &[Equation]) -> String {
    let left_width = left_width(equations);
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
    let rows = rows.join(" \\\\\n");
    format!("\\begin{{align*}}\n{rows}\n\\end{{align*}}")
}

fn pieces(pieces: &[Piece<'_>]) -> String {
    // A bracket is as tall as its content; lines may break between the two.
    let is_tall = |piece: &Piece<'_>| matches!(piece, Piece::Whole(math) if math.has_fraction());
    let [open, close] = if pieces.iter().any(is_tall) {
        ["\\Bigl(", "\\Bigr)"]
    } else {
        ["\\bigl(", "\\bigr)"]
    };
    let shown = |piece: &Piece<'_>| {
        let shown = match *piece {
            Piece::Whole(math) => return formula(math),
            Piece::Times => "\\, ",
            Piece::Sign { minus, first: true } => {
                if minus {
                    "-"
                } else {
                    ""
                }
            }
            // An empty group makes a sign at the start of a line a sign between two terms.
            Piece::Sign { minus, .. } => {
                if minus {
                    " {}- "
                } else {
                    " {}+ "
                }
            }
            Piece::Equals => " {}= ",
            Piece::Open => open,
            Piece::Close => close,
        };
        shown.to_owned()
    };
    let line: String = pieces.iter().map(shown).collect();
    line.trim_start().to_owned()
}

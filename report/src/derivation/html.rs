//! HTML: one file that opens from disk, with `MathML`, in light, dark and on paper.

use std::fmt::Write;

use super::display::{Equation, Piece, left_width};
use super::{Block, Chain, Page, Span, Table};
use appell_codegen::symbolic::print::mathml::{TIMES, escaped, mathml as formula, sign};

/// Width of a line of equations, in characters as [`super::Math::width`] counts them.
const WIDTH: usize = 92;

/// How the page looks.
const STYLE: &str = include_str!("page.css");

/// The page as an HTML document of its own.
pub fn html(page: &Page) -> String {
    let mut out =
        String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    out.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let title = escaped(&page.title);
    let _ = write!(
        out,
        "<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n"
    );
    let _ = writeln!(out, "<h1>{title}</h1>");
    if let Some(source) = &page.source {
        let _ = writeln!(out, "<p class=\"source\">After: {}</p>", escaped(source));
    }
    for (index, section) in page.sections.iter().enumerate() {
        let number = index + 1;
        let _ = writeln!(
            out,
            "<section>\n<h2><span class=\"number\">{number}</span>{}</h2>",
            spans(&section.heading)
        );
        for block in &section.blocks {
            match block {
                Block::Sentence(sentence) => {
                    let _ = writeln!(out, "<p>{}</p>", spans(sentence));
                }
                Block::Table(t) => table(&mut out, t),
                Block::Chain(c) => chain(&mut out, c),
                Block::Equations(all) => equations(&mut out, all),
            }
        }
        out.push_str("</section>\n");
    }
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

fn spans(spans: &[Span]) -> String {
    let mut out = String::new();
    let mut spans = spans.iter().peekable();
    // The stop of a formula stays on its line.
    let mut stopped = false;
    while let Some(span) = spans.next() {
        match span {
            Span::Text(text) => {
                out.push_str(&escaped(&text[usize::from(stopped)..]));
                stopped = false;
            }
            Span::Math(math) => {
                let formula = formula(math);
                let stop = match spans.peek() {
                    Some(Span::Text(text)) => text.chars().next().filter(|c| ".,;:".contains(*c)),
                    _ => None,
                };
                stopped = stop.is_some();
                let _ = match stop {
                    Some(stop) => write!(
                        out,
                        "<span class=\"stopped\"><math>{formula}</math>{stop}</span>"
                    ),
                    None => write!(out, "<math>{formula}</math>"),
                };
            }
        }
    }
    out
}

fn table(out: &mut String, table: &Table) {
    out.push_str("<table>\n");
    if !table.title.is_empty() {
        let _ = writeln!(out, "<caption>{}</caption>", escaped(&table.title));
    }
    for row in &table.rows {
        out.push_str("<tr>");
        for cell in &row.cells {
            let _ = write!(out, "<td>{}</td>", spans(cell));
        }
        let _ = writeln!(out, "<td class=\"line\">{}</td></tr>", row.line);
    }
    out.push_str("</table>\n");
}

fn chain(out: &mut String, chain: &Chain) {
    let _ = write!(
        out,
        "<p class=\"chain\"><span class=\"frame\">{}</span>",
        escaped(&chain.start)
    );
    for (label, to) in &chain.links {
        let _ = write!(
            out,
            "<span class=\"turn\">{}</span><span class=\"frame\">{}</span>",
            spans(label),
            escaped(to)
        );
    }
    out.push_str("</p>\n");
}

/// Rows of a table with three columns: left-hand side, sign, right-hand side. What is broken itself
/// spans all of them.
fn equations(out: &mut String, equations: &[Equation]) {
    let left_width = left_width(equations);
    out.push_str(
        "<div class=\"equations\"><math display=\"block\"><mtable displaystyle=\"true\">\n",
    );
    for equation in equations {
        let display = equation.display(WIDTH, left_width);
        for (k, line) in display.lines.iter().enumerate() {
            let right = format!("<mrow>{}</mrow>", pieces(line));
            let _ = match (display.left, k) {
                (Some(left), 0) => writeln!(
                    out,
                    "<mtr class=\"first\"><mtd class=\"left\">{}</mtd><mtd class=\"sign\"><mo>=</mo></mtd>\
                     <mtd class=\"right\">{right}</mtd></mtr>",
                    formula(left)
                ),
                (Some(_), _) => writeln!(
                    out,
                    "<mtr><mtd></mtd><mtd></mtd><mtd class=\"right more\">{right}</mtd></mtr>"
                ),
                (None, _) => writeln!(
                    out,
                    "<mtr{}><mtd columnspan=\"3\" class=\"right{}\">{right}</mtd></mtr>",
                    if k == 0 { " class=\"first\"" } else { "" },
                    if k == 0 { "" } else { " more" }
                ),
            };
        }
    }
    out.push_str("</mtable></math></div>\n");
}

/// One line of a broken equation.
fn pieces(pieces: &[Piece<'_>]) -> String {
    let mut out = String::new();
    let mut after_whole = false;
    for piece in pieces {
        match piece {
            Piece::Whole(math) => {
                out.push_str(if after_whole { TIMES } else { "" });
                out.push_str(&formula(math));
            }
            Piece::Sign { minus, first } => out.push_str(sign(*minus, *first)),
            Piece::Equals => out.push_str("<mo>=</mo>"),
            Piece::Open => {
                out.push_str(if after_whole { TIMES } else { "" });
                out.push_str("<mo stretchy=\"false\">(</mo>");
            }
            Piece::Close => out.push_str("<mo stretchy=\"false\">)</mo>"),
        }
        after_whole = matches!(piece, Piece::Whole(_) | Piece::Close);
    }
    out
}

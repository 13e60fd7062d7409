//! HTML: one self-contained file with `MathML`, for light and dark displays and for print.

use maud::{Markup, PreEscaped, html as markup};

use super::display::{Equation, Piece, left_width};
use super::{Block, Chain, Page, Section, Span, Table};
use crate::page_shell::PageShell;
use appell_codegen::symbolic::print::Math;
use appell_codegen::symbolic::print::mathml::{TIMES, mathml, sign};
use appell_spec::foreign::one_line;

/// Width of a line of equations, in characters as [`super::Math::width`] counts them.
const WIDTH: usize = 92;

/// A longer formula has its description on the next line.
const LONGEST_CELL: usize = 56;

/// Style sheet of the page.
const STYLE: &str = concat!(
    include_str!("page.css"),
    include_str!("equations.css"),
    include_str!("print.css"),
);

/// The page as a self-contained HTML document.
pub fn html(page: &Page) -> String {
    let title = one_line(&page.title);
    PageShell::new(&title, STYLE).around(&markup! {
        main {
            h1 { (title) }
            @if let Some(source) = &page.source {
                p class="source" { "Source: " (one_line(source)) }
            }
            @for (index, section) in page.sections.iter().enumerate() {
                section {
                    h2 { span class="number" { (index + 1) } (spans(&section.heading)) }
                    @for block in &section.blocks { (shown(block, Use::Reading)) "\n" }
                }
            }
        }
    })
}

/// Style of the equations and tables of a page.
pub const EQUATIONS: &str = include_str!("equations.css");

/// A section to embed in another page. Equations and table rows list the lines of the spec that they depend on
/// as `data-lines`, and can be selected.
pub fn clickable(section: &Section) -> String {
    let markup = markup! {
        h2 { (spans(&section.heading)) }
        @for block in &section.blocks { (shown(block, Use::Choosing)) "\n" }
    };
    markup.into_string()
}

/// Purpose of a page.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Reading,
    Choosing,
}

/// The attribute `data-lines`, where equations can be selected.
fn located(purpose: Use, lines: &[usize]) -> Option<String> {
    let lines = || lines.iter().map(usize::to_string).collect::<Vec<_>>();
    (purpose == Use::Choosing && !lines().is_empty()).then(|| lines().join(" "))
}

fn shown(block: &Block, purpose: Use) -> Markup {
    match block {
        Block::Sentence(sentence) => markup! { p { (spans(sentence)) } },
        Block::Table(all) => table(all, purpose),
        Block::Chain(all) => chain(all),
        Block::Equations(all) => equations(all, purpose),
    }
}

fn formula(math: &Math) -> PreEscaped<String> {
    PreEscaped(mathml(math))
}

fn spans(spans: &[Span]) -> Markup {
    let mut out = Vec::with_capacity(spans.len());
    let mut spans = spans.iter().peekable();
    // The full stop after a formula stays on its line.
    let mut stopped = false;
    while let Some(span) = spans.next() {
        out.push(match span {
            Span::Text(text) => {
                let rest = &text[usize::from(stopped)..];
                stopped = false;
                markup! { (one_line(rest)) }
            }
            Span::Math(math) => {
                let stop = match spans.peek() {
                    Some(Span::Text(text)) => text.chars().next().filter(|c| ".,;:".contains(*c)),
                    _ => None,
                };
                stopped = stop.is_some();
                let formula = markup! { math { (formula(math)) } };
                match stop {
                    Some(stop) => markup! { span class="stopped" { (formula) (stop) } },
                    None => formula,
                }
            }
        });
    }
    markup! { @for part in out { (part) } }
}

fn table(table: &Table, purpose: Use) -> Markup {
    markup! {
        div class="table" { table {
            @if !table.title.is_empty() {
                caption { (one_line(&table.title)) }
            }
            @for row in &table.rows {
                @let lines = located(purpose, &[row.line]);
                @match row.cells.as_slice() {
                    // A long formula would squeeze its description to one word a line.
                    [formula, about] if width(formula) > LONGEST_CELL && !about.is_empty() => {
                        tr data-lines=[lines.clone()] {
                            td colspan="2" { (spans(formula)) }
                            td class="line" { (row.line) }
                        }
                        tr data-lines=[lines] { td {} td { (spans(about)) } td class="line" {} }
                    }
                    cells => {
                        tr data-lines=[lines] {
                            @for cell in cells { td { (spans(cell)) } }
                            td class="line" { (row.line) }
                        }
                    }
                }
            }
        } }
    }
}

/// Width of a cell, in characters.
fn width(cell: &[Span]) -> usize {
    let width = |span: &Span| match span {
        Span::Text(text) => text.chars().count(),
        Span::Math(math) => math.width(),
    };
    cell.iter().map(width).sum()
}

fn chain(chain: &Chain) -> Markup {
    markup! {
        p class="chain" {
            span class="frame" { (one_line(&chain.start)) }
            @for (label, to) in &chain.links {
                span class="turn" { (spans(label)) }
                span class="frame" { (one_line(to)) }
            }
        }
    }
}

/// Rows of a table with three columns: left-hand side, sign, right-hand side. A broken left-hand
/// side spans all of them.
fn equations(equations: &[Equation], purpose: Use) -> Markup {
    let left_width = left_width(equations);
    markup! {
        div class="equations" {
            math display="block" {
                mtable displaystyle="true" {
                    @for equation in equations {
                        @let display = equation.display(WIDTH, left_width);
                        @let lines = located(purpose, &equation.lines);
                        @for (k, line) in display.lines.iter().enumerate() {
                            (row(display.left, k == 0, line, lines.as_deref()))
                        }
                    }
                }
            }
        }
    }
}

fn row(left: Option<&Math>, is_first: bool, line: &[Piece<'_>], lines: Option<&str>) -> Markup {
    let right = markup! { mrow { (PreEscaped(pieces(line))) } };
    match (left, is_first) {
        (Some(left), true) => markup! {
            mtr class="first" data-lines=[lines] {
                mtd class="left" { (formula(left)) }
                mtd class="sign" { mo { "=" } }
                mtd class="right" { (right) }
            }
        },
        (Some(_), false) => markup! {
            mtr data-lines=[lines] { mtd {} mtd {} mtd class="right more" { (right) } }
        },
        (None, true) => markup! {
            mtr class="first" data-lines=[lines] { mtd columnspan="3" class="right" { (right) } }
        },
        (None, false) => markup! {
            mtr data-lines=[lines] { mtd columnspan="3" class="right more" { (right) } }
        },
    }
}

/// One line of a broken equation.
fn pieces(pieces: &[Piece<'_>]) -> String {
    let mut out = String::new();
    let mut after_whole = false;
    for piece in pieces {
        match piece {
            Piece::Whole(math) => {
                out.push_str(if after_whole { TIMES } else { "" });
                out.push_str(&mathml(math));
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

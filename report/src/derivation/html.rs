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
    let numbers: Vec<String> = lines.iter().map(usize::to_string).collect();
    (purpose == Use::Choosing && !lines.is_empty()).then(|| numbers.join(" "))
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

/// The punctuation after a formula stays on its line.
fn spans(spans: &[Span]) -> Markup {
    let stop = |k: usize| match &spans[k..] {
        [Span::Math(_), Span::Text(text), ..] => text.chars().next().filter(|&c| is_stop(c)),
        _ => None,
    };
    markup! {
        @for (k, span) in spans.iter().enumerate() {
            @match span {
                Span::Text(text) => {
                    @let is_stopped = k > 0 && stop(k - 1).is_some();
                    (one_line(&text[usize::from(is_stopped)..]))
                }
                Span::Math(math) => {
                    @match stop(k) {
                        Some(stop) => { span class="stopped" { math { (formula(math)) } (stop) } }
                        None => { math { (formula(math)) } }
                    }
                }
            }
        }
    }
}

const fn is_stop(letter: char) -> bool {
    matches!(letter, '.' | ',' | ';' | ':')
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
    markup! {
        mtr class=[is_first.then_some("first")] data-lines=[lines] {
            @match left {
                Some(left) if is_first => {
                    mtd class="left" { (formula(left)) }
                    mtd class="sign" { mo { "=" } }
                }
                Some(_) => { mtd {} mtd {} }
                None => {}
            }
            mtd columnspan=[left.is_none().then_some("3")] class=(if is_first { "right" } else { "right more" }) {
                mrow { @for piece in line { (PreEscaped(shown_piece(piece))) } }
            }
        }
    }
}

fn shown_piece(piece: &Piece<'_>) -> String {
    let shown = match piece {
        Piece::Whole(math) => return mathml(math),
        Piece::Times => TIMES,
        Piece::Sign { minus, first } => sign(*minus, *first),
        Piece::Equals => "<mo>=</mo>",
        Piece::Open => "<mo stretchy=\"false\">(</mo>",
        Piece::Close => "<mo stretchy=\"false\">)</mo>",
    };
    shown.to_owned()
}

//! The book as a self-contained page, also well-formed XML.

use appell_report::page_shell::PageShell;
use maud::{Markup, PreEscaped, html};

use super::claim::{Claim, Reproduction, Section, Tally};

const STYLE: &str = include_str!("page.css");
/// A new line, in HTML and in XML.
const BREAK: PreEscaped<&str> = PreEscaped("<br/>");

/// The page.
pub fn page(title: &str, sections: &[Section]) -> String {
    let title = format!("{title}, recomputed");
    let shell = PageShell {
        namespace: Some("http://www.w3.org/1999/xhtml"),
        ..PageShell::new(&title, STYLE)
    };
    shell.around(&html! {
        main {
            h1 { (title) }
            p {
                "Equations, tables and figures: what is published, what appell finds, how the two compare, \
                 and the command that makes it."
            }
            p { (Tally::of(sections).words()) "." }
            dl {
                @for agreement in Reproduction::ALL {
                    @let [name, class, meaning] = legend(agreement);
                    dt class=(class) { (name) }
                    dd { (meaning) }
                }
            }
            nav {
                ul {
                    @for (number, section) in sections.iter().enumerate() {
                        @let errata = section.claims.iter().filter(|c| c.erratum.is_some()).count();
                        li {
                            a href={ "#part" (number) } { (section.title) }
                            " (" (section.claims.len()) " rows, " (errata) " errata)"
                        }
                    }
                }
            }
            @for (number, section) in sections.iter().enumerate() {
                (part(number, section))
            }
        }
    })
}

fn part(number: usize, section: &Section) -> Markup {
    html! {
        section id={ "part" (number) } {
            h2 { (section.title) }
            p { (section.about) }
            @for picture in &section.pictures {
                figure {
                    (PreEscaped(&picture.svg))
                    figcaption { (picture.caption) }
                }
                // Adjacent figures.
                "\n"
            }
            table {
                thead {
                    tr {
                        th { "place" }
                        th { "published" }
                        th { "found" }
                        th { "agreement" }
                    }
                }
                tbody {
                    @for claim in &section.claims { (row(claim)) "\n" }
                }
            }
        }
    }
}

/// Name, colour and meaning.
const fn legend(agreement: Reproduction) -> [&'static str; 3] {
    match agreement {
        Reproduction::Exact => [
            "exact",
            "exact",
            "the same function, by the identity test; a number in every published digit, beside a formula \
             in ten at least",
        ],
        Reproduction::Approximate => [
            "approximate",
            "approximate",
            "within a tolerance, or at every point that was tried",
        ],
        Reproduction::Differs => [
            "differs",
            "differs",
            "something else is found; both are shown",
        ],
        Reproduction::CannotBeChecked => [
            "cannot be checked",
            "unchecked",
            "a definition, or it rests on recordings that are not public",
        ],
        Reproduction::NotInPaper => ["not in the paper", "added", "a result of ours"],
    }
}

fn row(claim: &Claim) -> Markup {
    let [agreement, class, _] = legend(claim.agreement);
    html! {
        tr class=(class) {
            td { (claim.place) }
            td { (lines(&claim.published)) }
            td {
                (lines(&claim.ours)) (BREAK)
                code class="command" { (claim.command) }
            }
            td {
                (agreement)
                @if !claim.note.is_empty() {
                    (BREAK) small { (claim.note) }
                }
                @if !claim.as_expected {
                    (BREAK) "Unexpected: this comparison used to give another result."
                }
            }
        }
    }
}

/// The first line as text, the others as formulas; long ones are folded.
fn lines(text: &str) -> Markup {
    /// Number of lines shown unfolded.
    const SHORT: usize = 4;
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    html! {
        @match rest.lines().count() {
            0 => (first),
            1..=SHORT => { (first) pre { (rest) } },
            _ => details { summary { (first) } pre { (rest) } },
        }
    }
}

//! The book as a page that needs nothing beside it. It is well-formed XML, too.

use std::fmt::Write as _;

use super::claim::{Claim, Reproduction, Section, Tally};

const STYLE: &str = include_str!("page.css");

/// The page.
pub fn page(title: &str, sections: &[Section]) -> String {
    let tally = Tally::of(sections);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n\
         <meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n\
         <title>{title}, recomputed</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <h1>{title}, recomputed</h1>\n\
         <p>Equations, tables and figures: what is published, what appell finds, how the two compare, and \
         the command that makes it.</p>\n<p>{}.</p>\n<dl>\n",
        escaped(&tally.words()),
    );
    for agreement in Reproduction::ALL {
        // Writing to a string cannot fail.
        let _ = writeln!(
            page,
            "<dt class=\"{}\">{}</dt><dd>{}</dd>",
            class(agreement),
            agreement.words(),
            meaning(agreement)
        );
    }
    page.push_str("</dl>\n<nav><ul>\n");
    for (number, section) in sections.iter().enumerate() {
        let errata = section.claims.iter().filter(|c| c.erratum.is_some());
        let _ = writeln!(
            page,
            "<li><a href=\"#part{number}\">{}</a> ({} rows, {} errata)</li>",
            escaped(&section.title),
            section.claims.len(),
            errata.count(),
        );
    }
    page.push_str("</ul></nav>\n");
    for (number, section) in sections.iter().enumerate() {
        let _ = writeln!(
            page,
            "<section id=\"part{number}\">\n<h2>{}</h2>\n<p>{}</p>",
            escaped(&section.title),
            escaped(&section.about)
        );
        for picture in &section.pictures {
            let _ = writeln!(
                page,
                "<figure>{}<figcaption>{}</figcaption></figure>",
                picture.svg,
                escaped(&picture.caption)
            );
        }
        page.push_str(
            "<table>\n<thead><tr><th>place</th><th>published</th><th>found</th><th>agreement</th>\
             </tr></thead>\n<tbody>\n",
        );
        for claim in &section.claims {
            row(&mut page, claim);
        }
        page.push_str("</tbody>\n</table>\n</section>\n");
    }
    page + "</main>\n</body>\n</html>\n"
}

/// Its colour.
const fn class(agreement: Reproduction) -> &'static str {
    match agreement {
        Reproduction::Exact => "exact",
        Reproduction::Approximate => "approximate",
        Reproduction::Differs => "differs",
        Reproduction::CannotBeChecked => "unchecked",
        Reproduction::NotInPaper => "added",
    }
}

const fn meaning(agreement: Reproduction) -> &'static str {
    match agreement {
        Reproduction::Exact => {
            "the same function, by the identity test; a number in every published digit, beside a formula \
             in ten at least"
        }
        Reproduction::Approximate => "within a tolerance, or at every point that was tried",
        Reproduction::Differs => "something else is found; both are shown",
        Reproduction::CannotBeChecked => {
            "a definition, or it rests on recordings that are not public"
        }
        Reproduction::NotInPaper => "a result of ours",
    }
}

fn row(page: &mut String, claim: &Claim) {
    let note = match claim.note.as_str() {
        "" => String::new(),
        note => format!("<br/><small>{}</small>", escaped(note)),
    };
    let broken = if claim.as_expected {
        ""
    } else {
        "<br/>This is not what is known to come out."
    };
    let _ = writeln!(
        page,
        "<tr class=\"{}\"><td>{}</td><td>{}</td><td>{}<br/><code class=\"command\">{}</code></td>\
         <td>{}{note}{broken}</td></tr>",
        class(claim.agreement),
        escaped(&claim.place),
        lines(&claim.published),
        lines(&claim.ours),
        escaped(&claim.command),
        claim.agreement.words(),
    );
}

/// The first line as text, the others as formulas; long ones are folded.
fn lines(text: &str) -> String {
    /// Lines that are shown at once.
    const SHORT: usize = 4;
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    if rest.is_empty() {
        return escaped(first);
    }
    let formulas = format!("<pre>{}</pre>", escaped(rest));
    if rest.lines().count() <= SHORT {
        return format!("{}{formulas}", escaped(first));
    }
    format!(
        "<details><summary>{}</summary>{formulas}</details>",
        escaped(first)
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

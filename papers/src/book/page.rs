//! The book as a page that needs nothing beside it. It is well-formed XML, too.

use std::fmt::Write as _;

use super::claim::{Claim, Section};

const STYLE: &str = include_str!("page.css");

/// The page.
pub fn page(title: &str, sections: &[Section]) -> String {
    let claims = || sections.iter().flat_map(|section| &section.claims);
    let (count, good) = (claims().count(), claims().filter(|c| c.holds).count());
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\" xmlns=\"http://www.w3.org/1999/xhtml\">\n<head>\n\
         <meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n\
         <title>{title}, recomputed</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
         <h1>{title}, recomputed</h1>\n\
         <p>Equations, tables and figures: what is published, what appell finds, what that means, and \
         the command that makes it. {count} statements are compared; {good} came out as they \
         should.</p>\n<nav><ul>\n"
    );
    for (number, section) in sections.iter().enumerate() {
        let errata = section.claims.iter().filter(|c| c.verdict.is_erratum());
        // Writing to a string cannot fail.
        let _ = writeln!(
            page,
            "<li><a href=\"#part{number}\">{}</a> ({} statements, {} errata)</li>",
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
            "<table>\n<thead><tr><th>place</th><th>published</th><th>found</th><th>verdict</th>\
             </tr></thead>\n<tbody>\n",
        );
        for claim in &section.claims {
            row(&mut page, claim);
        }
        page.push_str("</tbody>\n</table>\n</section>\n");
    }
    page + "</main>\n</body>\n</html>\n"
}

fn row(page: &mut String, claim: &Claim) {
    let mark = if claim.holds { "good" } else { "bad" };
    let doubt = if claim.holds {
        ""
    } else {
        ", but this did not come out"
    };
    let _ = writeln!(
        page,
        "<tr class=\"{mark}\"><td>{}</td><td>{}</td><td>{}<br/><code class=\"command\">{}</code></td>\
         <td>{}{doubt}</td></tr>",
        escaped(&claim.place),
        lines(&claim.published),
        lines(&claim.ours),
        escaped(&claim.command),
        escaped(&claim.verdict.words()),
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

//! Comments and blank lines, which syntax trees cannot represent.
//!
//! The printer writes `#[comment = "…"]` as a comment. A reserved comment marks a blank line; it cannot occur
//! in the text of a spec, because all other comments start with a space.

use appell_spec::foreign::{one_line, sentence};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// The printed form of the marker.
const BLANK_LINE: &str = "//%blank";
/// An attribute that is printed as a blank line.
pub(super) const BLANK: &str = "#[comment = \"%blank\"]\n";

/// An attribute that is printed as a comment of one line.
pub(super) fn comment(text: &str) -> String {
    let text = Literal::string(&format!(" {}", sentence(text)));
    format!("#[comment = {text}]\n")
}

/// [`BLANK`] as tokens.
pub(super) fn blank_tokens() -> TokenStream {
    quote!(#[comment = "%blank"])
}

/// Rustdoc lines as tokens.
pub(super) fn docs(lines: &[String]) -> TokenStream {
    let lines = lines.iter().map(|text| match one_line(text).trim_end() {
        "" => String::new(),
        text => format!(" {text}"),
    });
    quote!(#(#[doc = #lines])*)
}

/// A name or a unit in rustdoc, as code.
pub(super) fn code(text: &str) -> String {
    format!("`{}`", sentence(text).replace('`', "'"))
}

/// A sentence of a spec in rustdoc: without links, tags, emphasis or code.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in sentence(text).chars() {
        if matches!(c, '[' | ']' | '<' | '>' | '`' | '*' | '~' | '#' | '&' | '|') {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// Replaces the markers in printed code by blank lines.
pub(super) fn with_blank_lines(printed: &str) -> String {
    let mut text = String::with_capacity(printed.len());
    for line in printed.lines() {
        if line.trim_start() != BLANK_LINE {
            text.push_str(line);
        } else if text.is_empty() || text.ends_with("\n\n") || text.ends_with("{\n") {
            continue;
        }
        text.push('\n');
    }
    text
}

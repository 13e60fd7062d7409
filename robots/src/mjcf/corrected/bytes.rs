//! Replacements of ranges of a text.

use crate::xml::Span;

/// Replacements, which do not overlap.
#[derive(Debug, Default)]
pub(super) struct Edits {
    all: Vec<(Span, String)>,
}

impl Edits {
    /// Replaces a range; what is inserted at one place stands in the order in which it was inserted.
    pub(super) fn replace(&mut self, range: Span, text: impl Into<String>) {
        self.all.push((range, text.into()));
    }

    /// Inserts remarks as comments at the head, after the XML declaration.
    pub(super) fn remark(&mut self, text: &str, remarks: &[String]) {
        let line_end = line_end(text);
        let blanks = |c: char| c == '\u{feff}' || c.is_whitespace();
        let body = text.trim_start_matches(blanks);
        let declared = body
            .starts_with("<?xml")
            .then(|| body.find("?>"))
            .flatten()
            .map(|at| text.len() - body.len() + at + 2);
        let at = declared.unwrap_or_else(|| text.len() - text.trim_start_matches('\u{feff}').len());
        for remark in remarks {
            // A comment has no `--` and does not end with `-`.
            let mut words = remark.replace("--", "- -").replace("--", "- -");
            if words.ends_with('-') {
                words.push(' ');
            }
            let comment = format!("<!-- appell: {words} -->");
            self.all.push(match declared {
                Some(at) => (at..at, format!("{line_end}{comment}")),
                None => (at..at, format!("{comment}{line_end}")),
            });
        }
    }

    /// The text with all replacements.
    pub(super) fn applied(mut self, text: &str) -> String {
        self.all.sort_by_key(|(range, _)| (range.start, range.end));
        let mut edited = String::with_capacity(text.len());
        let mut from = 0;
        for (range, words) in self.all {
            edited.push_str(&text[from..range.start]);
            edited.push_str(&words);
            from = range.end;
        }
        edited.push_str(&text[from..]);
        edited
    }
}

/// How the lines of a text end.
pub(super) fn line_end(text: &str) -> &'static str {
    match text.find('\n') {
        Some(at) if text[..at].ends_with('\r') => "\r\n",
        _ => "\n",
    }
}

/// A text as the value of an attribute in double quotes.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// A number with twelve digits, the shortest that reads the same.
pub(super) fn number(x: f64) -> String {
    let rounded: f64 = format!("{x:.11e}").parse().unwrap_or(x);
    crate::letters::plain(rounded)
}

/// Whether two numbers are written alike.
pub(super) fn same(a: f64, b: f64) -> bool {
    number(a) == number(b)
}

/// Numbers separated by blanks.
pub(super) fn numbers(all: &[f64]) -> String {
    let words: Vec<String> = all.iter().map(|x| number(*x)).collect();
    words.join(" ")
}

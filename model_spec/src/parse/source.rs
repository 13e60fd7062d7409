//! From places in a TOML string back to places in the file.

use std::ops::Range;

use crate::expr::Span;

/// The decoded text of a TOML string, and where it came from.
#[derive(Debug, Clone)]
pub(super) struct Source<'a> {
    /// What the string means.
    pub(super) text: &'a str,
    /// The whole string in the file, quotes included.
    pub(super) whole: Span,
    /// Where the text starts in the file, if the file holds it unchanged.
    start: Option<usize>,
}

impl<'a> Source<'a> {
    pub(super) fn new(file: &str, text: &'a str, whole: Span) -> Self {
        // Opening quotes: one, or three and perhaps a line break. Where the string holds escapes
        // the file differs from the text, and only the whole string can be pointed at.
        let start = [1, 3, 4, 5, 0]
            .into_iter()
            .map(|quotes| whole.start + quotes)
            .find(|start| {
                let end = start + text.len();
                end <= whole.end && file.get(*start..end) == Some(text)
            });
        Self { text, whole, start }
    }

    /// The place in the file of a place in the text.
    pub(super) fn span(&self, part: Range<usize>) -> Span {
        match self.start {
            Some(start) => start + part.start..start + part.end,
            None => self.whole.clone(),
        }
    }
}

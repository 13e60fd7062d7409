//! Maps positions in a TOML string to positions in the file.

use std::ops::Range;

use crate::expr::Span;

/// The decoded text of a TOML string, and its source.
#[derive(Debug, Clone)]
pub(super) struct Source<'a> {
    /// The decoded text.
    pub(super) text: &'a str,
    /// Span of the whole string in the file, quotes included.
    pub(super) whole: Span,
    /// Start of the text in the file, if it is the same there.
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

    /// The position in the file of a position in the text.
    pub(super) fn span(&self, part: Range<usize>) -> Span {
        match self.start {
            Some(start) => start + part.start..start + part.end,
            None => self.whole.clone(),
        }
    }
}

//! A text and positions in it: bytes here, lines and UTF-16 units in the protocol.

use appell_spec::expr::Span;
use lsp_types::{Position, Range, TextDocumentContentChangeEvent};

/// A text with the offsets of its lines.
#[derive(Debug, Clone)]
pub(crate) struct Text {
    whole: String,
    starts: Vec<usize>,
}

impl Text {
    pub(crate) fn new(whole: String) -> Self {
        let bytes = whole.as_bytes();
        // A line ends with `\n`, `\r\n` or `\r`.
        let ends_at = |at: &usize| match bytes[*at] {
            b'\n' => true,
            b'\r' => bytes.get(at + 1) != Some(&b'\n'),
            _ => false,
        };
        let ends = (0..bytes.len()).filter(ends_at).map(|at| at + 1);
        let starts = std::iter::once(0).chain(ends).collect();
        Self { whole, starts }
    }

    pub(crate) fn as_str(&self) -> &str {
        &self.whole
    }

    /// The text of a range; nothing if the range is not within the text.
    pub(crate) fn part(&self, span: &Span) -> &str {
        self.whole.get(span.clone()).unwrap_or_default()
    }

    pub(crate) fn position(&self, at: usize) -> Position {
        let at = self.whole.floor_char_boundary(at);
        let line = self.starts.partition_point(|start| *start <= at) - 1;
        let units = self.part(&(self.starts[line]..at)).encode_utf16().count();
        Position::new(small(line), small(units))
    }

    pub(crate) fn range(&self, span: &Span) -> Range {
        Range::new(self.position(span.start), self.position(span.end))
    }

    /// Byte offset of a position; one beyond the end of a line counts as the end of the line.
    pub(crate) fn offset(&self, position: Position) -> usize {
        let line = position.line as usize;
        let Some(&start) = self.starts.get(line) else {
            return self.whole.len();
        };
        let end = self.starts.get(line + 1).copied();
        let line = self.part(&(start..end.unwrap_or(self.whole.len())));
        let line = line.trim_end_matches(['\r', '\n']);
        let mut units = position.character as usize;
        for (at, letter) in line.char_indices() {
            if units < letter.len_utf16() {
                return start + at;
            }
            units -= letter.len_utf16();
        }
        start + line.len()
    }

    /// The text after an edit.
    pub(crate) fn changed(&self, change: TextDocumentContentChangeEvent) -> Self {
        let Some(range) = change.range else {
            return Self::new(change.text);
        };
        let (start, end) = (self.offset(range.start), self.offset(range.end));
        let mut whole = self.whole.clone();
        whole.replace_range(start..end.max(start), &change.text);
        Self::new(whole)
    }
}

fn small(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_in_utf_16() {
        let text = Text::new("a\r\n𝛂β = 1\rlast".to_owned());
        for (at, line, units) in [(0, 0, 0), (3, 1, 0), (7, 1, 2), (9, 1, 3), (14, 2, 0)] {
            let position = Position::new(line, units);
            assert_eq!(text.position(at), position);
            assert_eq!(text.offset(position), at);
        }
    }

    #[test]
    fn places_outside_are_moved_to_the_nearest_inside() {
        let text = Text::new("𝛂\r\nb".to_owned());
        assert_eq!(text.offset(Position::new(0, 1)), 0);
        assert_eq!(text.offset(Position::new(0, 9)), 4);
        assert_eq!(text.offset(Position::new(7, 0)), 7);
        assert_eq!(text.position(2), Position::new(0, 0));
        assert_eq!(text.position(99), Position::new(1, 1));
    }
}

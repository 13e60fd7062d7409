//! Positions in a text as the page counts them: lines from 1, columns from 0 in UTF-16 units.

use std::collections::BTreeMap;

use appell_spec::expr::Span;
use appell_spec::outline::Outline;
use serde_json::{Value, json};

/// A text with the offsets of its lines.
pub(crate) struct Places<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Places<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        let ends = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            text,
            starts: std::iter::once(0).chain(ends).collect(),
        }
    }

    fn position(&self, at: usize) -> [usize; 2] {
        let at = self.text.floor_char_boundary(at);
        let line = self.starts.partition_point(|start| *start <= at);
        let before = self.text.get(self.starts[line - 1]..at);
        [line, before.unwrap_or_default().encode_utf16().count()]
    }

    /// First and last position of a span.
    pub(crate) fn range(&self, span: &Span) -> Value {
        json!([self.position(span.start), self.position(span.end)])
    }

    /// Last line of each item of several lines, by its first line.
    pub(crate) fn items(&self) -> BTreeMap<usize, usize> {
        let outline = Outline::new(self.text);
        let mut items: BTreeMap<&[String], [usize; 2]> = BTreeMap::new();
        for part in outline.keys.iter().chain(&outline.strings) {
            let Some(item) = part.path.get(..2) else {
                continue;
            };
            let [line, _] = self.position(part.span.end);
            let lines = items.entry(item).or_insert([line, line]);
            *lines = [lines[0].min(line), lines[1].max(line)];
        }
        let longer = items.into_values().filter(|[first, last]| last > first);
        longer.map(|[first, last]| (first, last)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_those_of_a_browser() {
        let places = Places::new("a\n𝛂β = 1\n");
        assert_eq!(places.range(&(2..8)), json!([[2, 0], [2, 3]]));
        assert_eq!(places.range(&(0..99)), json!([[1, 0], [3, 0]]));
    }

    #[test]
    fn an_item_ends_with_its_last_key() {
        let text = "[bodies.wheel]\nabout = 'x'\nmass = 'm'\n[frames]\na = { parent = 'ground' }\n";
        assert_eq!(Places::new(text).items(), BTreeMap::from([(1, 3)]));
    }
}

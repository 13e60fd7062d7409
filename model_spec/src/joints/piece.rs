//! Generated text with a source map to the spec.

use std::ops::Range;

use crate::expr::Span;

/// Source of a part of generated text.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    /// The part.
    made: Range<usize>,
    /// Its position in the spec.
    from: Span,
    /// Whether the spec has the same text there.
    is_copy: bool,
}

impl Origin {
    /// The position in the spec of a position in the part, if it lies there.
    fn of(&self, place: &Span) -> Option<Span> {
        let is_inside = self.made.start <= place.start && place.end <= self.made.end;
        is_inside.then(|| {
            if self.is_copy {
                let shifted = |at: usize| self.from.start + (at - self.made.start);
                shifted(place.start)..shifted(place.end)
            } else {
                self.from.clone()
            }
        })
    }
}

/// Generated text.
#[derive(Debug, Clone, Default)]
pub(super) struct Piece {
    /// The text.
    pub(super) text: String,
    origins: Vec<Origin>,
}

impl Piece {
    /// A text without a source in the spec.
    pub(super) fn new(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            origins: Vec::new(),
        }
    }

    /// A text with its source at `from`.
    pub(super) fn copied(text: impl Into<String>, from: Span) -> Self {
        let text = text.into();
        let is_copy = text.len() == from.len();
        let origins = vec![Origin {
            made: 0..text.len(),
            from,
            is_copy,
        }];
        Self { text, origins }
    }

    /// The same text with a source for all parts that have none.
    pub(super) fn from(mut self, place: &Span) -> Self {
        self.origins.push(Origin {
            made: 0..self.text.len(),
            from: place.clone(),
            is_copy: false,
        });
        self
    }

    /// With more text.
    pub(super) fn word(mut self, text: &str) -> Self {
        self.text.push_str(text);
        self
    }

    /// With another piece.
    pub(super) fn then(mut self, other: &Self) -> Self {
        let start = self.text.len();
        self.text.push_str(&other.text);
        let moved = other.origins.iter().map(|origin| Origin {
            made: origin.made.start + start..origin.made.end + start,
            ..origin.clone()
        });
        self.origins.extend(moved);
        self
    }

    /// Enclosed by two strings.
    pub(super) fn within(&self, before: &str, after: &str) -> Self {
        Self::new(before).then(self).word(after)
    }

    /// As a string of TOML.
    pub(super) fn quoted(&self) -> Self {
        self.within("\"", "\"")
    }

    /// Several, joined by a string.
    pub(super) fn joined(pieces: &[Self], between: &str) -> Self {
        let mut all = Self::default();
        for (count, piece) in pieces.iter().enumerate() {
            if count > 0 {
                all = all.word(between);
            }
            all = all.then(piece);
        }
        all
    }

    /// The position in the spec of a position in the text, as precisely as known.
    pub(super) fn place(&self, place: &Span) -> Option<Span> {
        let mut known: Vec<&Origin> = self.origins.iter().collect();
        known.sort_by_key(|origin| origin.made.len());
        known.into_iter().find_map(|origin| origin.of(place))
    }
}

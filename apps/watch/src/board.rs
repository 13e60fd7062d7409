//! The content of the page: the newest version of each part, and the last valid model.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use appell::Model;
use appell_report::film::FilmMaker;
use serde_json::Value;
use tokio::sync::watch;

/// A part of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// The text of the spec, with the lines of its items.
    Text,
    /// Errors, warnings and notes.
    Findings,
    /// The equations of motion with the lines that they depend on.
    Equations,
    /// The whole derivation, on request.
    Derivation,
    /// The mechanism at its initial state.
    Drawing,
    /// The availability of a model for simulations, with its sliders.
    Model,
}

impl Part {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Findings => "findings",
            Self::Equations => "equations",
            Self::Derivation => "derivation",
            Self::Drawing => "drawing",
            Self::Model => "model",
        }
    }
}

/// The latest version of a part.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    /// Grows with every change of any part.
    pub(crate) stamp: u64,
    pub(crate) part: Part,
    /// JSON on one line.
    pub(crate) json: Arc<str>,
}

/// The model of the last valid text.
#[derive(Clone)]
pub(crate) struct Good {
    /// The number of its text.
    pub(crate) version: u64,
    pub(crate) model: Arc<Model>,
    /// Renders its simulations as animations.
    pub(crate) films: Arc<FilmMaker>,
}

#[derive(Default)]
struct Written {
    entries: Vec<Entry>,
    good: Option<Good>,
    stamp: u64,
}

/// The parts of the page, for many readers.
#[derive(Default)]
pub(crate) struct Board {
    written: Mutex<Written>,
    news: watch::Sender<u64>,
}

impl Board {
    fn lock(&self) -> MutexGuard<'_, Written> {
        // Each change is complete, even if the writer has panicked since.
        self.written.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes a part.
    pub(crate) fn write(&self, part: Part, value: &Value) {
        let json = Arc::from(value.to_string());
        let mut written = self.lock();
        written.stamp += 1;
        let stamp = written.stamp;
        written.entries.retain(|entry| entry.part != part);
        written.entries.push(Entry { stamp, part, json });
        drop(written);
        self.news.send_replace(stamp);
    }

    /// Stores a model for simulations.
    pub(crate) fn keep(&self, good: Good) {
        self.lock().good = Some(good);
    }

    pub(crate) fn good(&self) -> Option<Good> {
        self.lock().good.clone()
    }

    /// The parts that changed after a stamp, in the order of their changes.
    pub(crate) fn since(&self, stamp: u64) -> Vec<Entry> {
        let written = self.lock();
        let newer = written.entries.iter().filter(|entry| entry.stamp > stamp);
        newer.cloned().collect()
    }

    /// Signals the stamp of the newest change.
    pub(crate) fn subscribe(&self) -> watch::Receiver<u64> {
        self.news.subscribe()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn readers_get_the_newest_of_each_part_once() {
        let board = Board::default();
        board.write(Part::Text, &json!(1));
        board.write(Part::Model, &json!(2));
        board.write(Part::Text, &json!(3));
        let told = board.since(0);
        let told: Vec<_> = told.iter().map(|e| (e.part, &*e.json)).collect();
        assert_eq!(told, [(Part::Model, "2"), (Part::Text, "3")]);
        assert!(board.since(3).is_empty());
        assert_eq!(*board.subscribe().borrow(), 3);
    }
}

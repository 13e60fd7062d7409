//! Common subexpression elimination.

use rustc_hash::FxHashMap;

use super::{Operation, ResultArray, Tape, Value};

/// A tape in which no operation occurs twice.
#[derive(Debug, Default)]
pub struct Unique {
    tape: Tape,
    known: FxHashMap<Operation, Value>,
}

impl Unique {
    /// The value of an operation, which is added if it is new. Its parts are the next values.
    pub fn push(&mut self, operation: Operation) -> Value {
        if let Some(&known) = self.known.get(&operation) {
            return known;
        }
        let value = self.tape.push(operation.clone());
        self.known.insert(operation, value);
        value
    }

    /// The value of an operation that has been added.
    pub fn find(&self, operation: &Operation) -> Option<Value> {
        self.known.get(operation).copied()
    }

    /// The tape so far, without results.
    pub fn tape(&self) -> &Tape {
        &self.tape
    }

    /// The tape with these results.
    #[must_use]
    pub fn finish(self, results: Vec<ResultArray>) -> Tape {
        Tape {
            results,
            ..self.tape
        }
    }
}

//! How an integration ended, and what it cost.

use super::events::EventHit;

/// What an integration cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Accepted steps.
    pub steps: usize,
    /// Rejected steps.
    pub rejected: usize,
    /// Evaluations of the rates.
    pub evaluations: usize,
}

/// Why an integration ended without an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The interval's end was reached.
    Finished,
    /// The terminal event of this index occurred.
    Event(usize),
    /// The observer broke off.
    Stopped,
}

/// How an integration ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Why it ended.
    pub ending: Ending,
    /// When it ended, in s.
    pub t: f64,
    /// Events found, in the order of time.
    pub hits: Vec<EventHit>,
    /// Its cost.
    pub statistics: Statistics,
}

//! Results and statistics of an integration.

use super::events::EventHit;

/// Statistics of an integration.
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
    /// The observer stopped the integration.
    Stopped,
}

/// The result of an integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Why it ended.
    pub ending: Ending,
    /// When it ended, in s.
    pub t: f64,
    /// Events located, in the order of time.
    pub hits: Vec<EventHit>,
    /// Steps and evaluations.
    pub statistics: Statistics,
}

//! Results of each case: a row of named columns.

/// Role of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Role {
    /// A factor; where it chooses between items, their names.
    Factor(Vec<String>),
    /// A number of a motion.
    Value,
    /// Whether something happened, 1 or 0.
    Event,
    /// When the event of the column before happened, in s; NaN where it did not.
    When,
    /// The value of a course at this time in s.
    Course {
        /// Name of the course.
        of: String,
        /// The time in s.
        t: f64,
    },
}

/// A column. Its values are in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// A sentence.
    pub about: String,
    /// Display unit.
    pub unit: String,
    /// One of this unit in SI.
    pub scale: f64,
    /// Its role.
    pub role: Role,
}

impl Column {
    /// A value in SI, in the display unit.
    pub fn to_unit(&self, si: f64) -> f64 {
        si / self.scale
    }
}

/// Rows of consecutive cases.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    /// The first case.
    pub first: u64,
    /// One list a column.
    pub values: Vec<Vec<f64>>,
    /// When each motion ended, in s.
    pub ends: Vec<f64>,
    /// Why it ended early; empty where it did not.
    pub reasons: Vec<String>,
}

impl Rows {
    /// No rows yet, with room for some.
    pub fn new(first: u64, columns: usize, room: usize) -> Self {
        Self {
            first,
            values: vec![Vec::with_capacity(room); columns],
            ends: Vec::with_capacity(room),
            reasons: Vec::with_capacity(room),
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Drops the rows of other cases. Lists may be empty.
    pub(crate) fn keep(&mut self, cases: std::ops::Range<u64>) {
        let count = |cases: u64| usize::try_from(cases).unwrap_or(usize::MAX);
        let before = count(cases.start.saturating_sub(self.first));
        let left = count(cases.end.saturating_sub(self.first));
        for list in self.values.iter_mut().chain([&mut self.ends]) {
            list.truncate(left);
            list.drain(..before.min(list.len()));
        }
        self.reasons.truncate(left);
        self.reasons.drain(..before.min(self.reasons.len()));
        self.first = self.first.max(cases.start);
    }

    /// Appends the row of the next case.
    pub fn push(&mut self, values: &[f64], end: f64, reason: &str) {
        for (column, value) in self.values.iter_mut().zip(values) {
            column.push(*value);
        }
        self.ends.push(end);
        self.reasons.push(reason.to_owned());
    }
}

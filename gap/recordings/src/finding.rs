//! Repairs of recordings, and warnings.

use appell_spec::Severity;

/// Kind of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum FindingKind {
    /// Rows with the time of the previous row; omitted.
    RepeatedTime,
    /// Rows earlier than a previous row; omitted.
    BackwardTime,
    /// Rows without a time; omitted.
    MissingTime,
    /// A run too short for an estimate.
    FewRows,
    /// A truncated last line; omitted.
    CutOff,
    /// Rows so far apart that times are probably not in seconds.
    SlowClock,
    /// A unit that the motion contradicts.
    Unit,
    /// A sign that the motion seems to contradict.
    Sign,
    /// A step much longer than the others.
    Gap,
    /// A run with gaps; cut there.
    Cut,
    /// Measurements that are missing.
    Dropouts,
    /// Missing inputs; the previous value is held.
    HeldInput,
    /// Commands and measurements with times of their own; joined.
    Asynchronous,
    /// An input that may have been sampled from a continuous signal.
    SmoothInput,
    /// A wrapped angle; unwrapped.
    Unwrapped,
    /// An angle or a length that jumps, other than by a turn.
    Jump,
    /// A column that the data set does not describe; ignored.
    UnknownColumn,
    /// A channel that never changes.
    Constant,
    /// A channel that changes in steps.
    Quantised,
    /// A stated noise level that the data contradict.
    NoiseDisagrees,
    /// A noise level that cannot be distinguished from the motion.
    NoiseBound,
    /// Recordings were split, as no held-out runs were specified.
    Split,
    /// There are no held-out runs.
    NoTestRun,
    /// An input without a column; taken as zero.
    NoInput,
    /// No parameter has a tolerance.
    NoTolerance,
}

impl FindingKind {
    /// Its identifier in JSON.
    pub const fn word(self) -> &'static str {
        self.described().0
    }

    /// Severity: whether it affects conclusions.
    pub const fn severity(self) -> Severity {
        self.described().1
    }

    const fn described(self) -> (&'static str, Severity) {
        use Severity::{Note, Warning};
        match self {
            Self::RepeatedTime => ("repeated-time", Note),
            Self::BackwardTime => ("backward-time", Warning),
            Self::MissingTime => ("missing-time", Warning),
            Self::FewRows => ("few-rows", Warning),
            Self::CutOff => ("cut-off", Note),
            Self::SlowClock => ("slow-clock", Warning),
            Self::Unit => ("unit", Warning),
            Self::Sign => ("sign", Warning),
            Self::Gap => ("gap", Note),
            Self::Cut => ("cut", Note),
            Self::Dropouts => ("dropouts", Note),
            Self::HeldInput => ("held-input", Warning),
            Self::Asynchronous => ("asynchronous", Note),
            Self::SmoothInput => ("smooth-input", Note),
            Self::Unwrapped => ("unwrapped", Note),
            Self::Jump => ("jump", Warning),
            Self::UnknownColumn => ("unknown-column", Note),
            Self::Constant => ("constant", Warning),
            Self::Quantised => ("quantised", Note),
            Self::NoiseDisagrees => ("noise-disagrees", Warning),
            Self::NoiseBound => ("noise-bound", Warning),
            Self::Split => ("split", Note),
            Self::NoTestRun => ("no-test-run", Warning),
            Self::NoInput => ("no-input", Warning),
            Self::NoTolerance => ("no-tolerance", Warning),
        }
    }
}

/// One finding.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Its kind.
    pub kind: FindingKind,
    /// File of the run, where it is about one.
    pub run: Option<String>,
    /// First line of the file, from 1, where it is about one.
    pub line: Option<usize>,
    /// Column of the file, where it is about one.
    pub channel: Option<String>,
    /// One sentence.
    pub message: String,
}

impl Finding {
    /// A finding about the whole data set.
    pub(crate) fn new(kind: FindingKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            run: None,
            line: None,
            channel: None,
            message: message.into(),
        }
    }

    #[must_use]
    pub(crate) fn in_run(mut self, run: &str) -> Self {
        self.run = Some(run.to_owned());
        self
    }

    #[must_use]
    pub(crate) fn on_line(mut self, line: usize) -> Self {
        self.line = Some(line);
        self
    }

    #[must_use]
    pub(crate) fn of_channel(mut self, channel: &str) -> Self {
        self.channel = Some(channel.to_owned());
        self
    }

    /// By severity, then run by run.
    pub(crate) fn order(&self) -> (Severity, Option<String>, FindingKind, Option<String>) {
        (
            self.kind.severity(),
            self.run.clone(),
            self.kind,
            self.channel.clone(),
        )
    }
}

/// Largest number of items listed in a message.
const LISTED: usize = 3;

/// `a, b, c and 4 more`.
pub(crate) fn listed(items: &[String]) -> String {
    let shown = items[..items.len().min(LISTED)].join(", ");
    match items.len().saturating_sub(LISTED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// `1 row`, `3 rows`.
pub(crate) fn counted(count: usize, one: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {one}{plural}")
}

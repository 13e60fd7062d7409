//! Errors of estimations.

/// Why a recording, a setup or values are invalid, or an estimation fails.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// A table whose size does not match its times.
    #[error(
        "{what}: {found} numbers for {rows} rows of {columns} columns; {} are needed", rows * columns
    )]
    Lengths {
        /// Which table.
        what: &'static str,
        /// Rows, as many as times.
        rows: usize,
        /// Columns.
        columns: usize,
        /// Numbers that were given.
        found: usize,
    },
    /// Fewer than two rows.
    #[error("a recording needs at least two rows; this one has {rows}")]
    TooShort {
        /// Rows.
        rows: usize,
    },
    /// A time that does not increase, or is not finite.
    #[error("row {row}: time {t} s is not later than the row before")]
    TimesNotIncreasing {
        /// Row, counted from 0.
        row: usize,
        /// Its time in s.
        t: f64,
    },
    /// An input that is not a number. Only measurements may be missing.
    #[error("row {row}: input {input} is {value}; inputs must be known in every row")]
    InputNotFinite {
        /// Row, counted from 0.
        row: usize,
        /// Column, counted from 0.
        input: usize,
        /// Its value.
        value: f64,
    },
    /// An infinite measurement.
    #[error("row {row}: channel {channel} is infinite; write NaN for a missing value")]
    MeasurementInfinite {
        /// Row, counted from 0.
        row: usize,
        /// Column, counted from 0.
        channel: usize,
    },
    /// A reference to something that does not exist.
    #[error("there is no {what} {index}; the model has {len}")]
    Unknown {
        /// State, input, output, pseudo-velocity or run.
        what: &'static str,
        /// Its index.
        index: usize,
        /// Their number.
        len: usize,
    },
    /// A setup that refers to something twice.
    #[error("{what} {index} is given twice")]
    Twice {
        /// Input or parameter.
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// No measurements, no recordings, or no states.
    #[error("there are no {what}")]
    Nothing {
        /// The missing items, in the plural.
        what: &'static str,
    },
    /// Recordings whose rows lie far apart, or that are long.
    #[error(
        "the recordings take {steps:.1e} steps of the filter, which need {:.0} GB; are the times in the unit that is \
         stated? Leave out rows, or cut runs at their gaps",
        bytes / 1e9
    )]
    TooManySteps {
        /// Steps of all recordings.
        steps: f64,
        /// Memory for them.
        bytes: f64,
    },
    /// A wrong number of values.
    #[error("{found} values were given, {expected} are needed")]
    ValueCount {
        /// Number needed.
        expected: usize,
        /// Number given.
        found: usize,
    },
    /// A value outside its admissible range.
    #[error("{what} is {value}; it must be {demand}")]
    Value {
        /// Which value.
        what: String,
        /// The value.
        value: f64,
        /// The admissible range.
        demand: &'static str,
    },
    /// Times of input changes and samples move with a delay, so that rates which depend explicitly
    /// on time would have to be differentiated with respect to time.
    #[error("delays cannot be estimated if the equations depend explicitly on time")]
    DelayWithTime,
    /// A filter with non-finite numbers.
    #[error("run {run}: the filter has no finite state at {t} s")]
    Diverged {
        /// The run.
        run: usize,
        /// Time in s.
        t: f64,
    },
    /// Position constraints without a solution near the estimate.
    #[error("run {run}: at {t} s: {source}")]
    Open {
        /// The run.
        run: usize,
        /// Time in s.
        t: f64,
        /// The violation.
        source: appell_runtime::positions::Inconsistent,
    },
    /// An optimisation that found no better point, though it is not at an optimum.
    #[error(
        "no better values were found after {steps} steps; the largest component of the gradient is {slope:.2e}"
    )]
    Stuck {
        /// Steps taken.
        steps: usize,
        /// Largest remaining component of the scaled gradient.
        slope: f64,
    },
    /// A value that multiple shooting cannot estimate.
    #[error(
        "{unknown:?} cannot be estimated by shooting, only parameters, biases, scales and lags"
    )]
    NotByShooting {
        /// Which.
        unknown: super::Unknown,
    },
    /// A matrix that is not positive definite.
    #[error("{what} is singular: some combination of the unknowns is not determined")]
    Singular {
        /// Which matrix.
        what: &'static str,
    },
    /// A table of a signal that is not a function of time.
    #[error(transparent)]
    Signal(#[from] appell_runtime::signal::SignalError),
}

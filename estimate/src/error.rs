//! Why nothing can be estimated.

/// What is wrong with a recording, a setup or values.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EstimateError {
    /// A table whose lengths do not fit its times.
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
    #[error("a recording of {rows} rows has no motion; at least two are needed")]
    TooShort {
        /// Rows.
        rows: usize,
    },
    /// A time that does not follow its predecessor, or is not finite.
    #[error("row {row}: time {t} s is not later than the row before")]
    TimesNotIncreasing {
        /// Row, counted from 0.
        row: usize,
        /// Its time in s.
        t: f64,
    },
    /// An input that is not a number. Only measurements may be missing.
    #[error("row {row}: input {input} is {value}; an input has to be known in every row")]
    InputNotFinite {
        /// Row, counted from 0.
        row: usize,
        /// Column, counted from 0.
        input: usize,
        /// Its value.
        value: f64,
    },
    /// An infinite measurement.
    #[error("row {row}: channel {channel} is infinite; write NaN for what is missing")]
    MeasurementInfinite {
        /// Row, counted from 0.
        row: usize,
        /// Column, counted from 0.
        channel: usize,
    },
    /// A setup that names something which the model lacks, or names it twice.
    #[error("{what} {index}: the model has {len}, and each may be named once")]
    Unknown {
        /// State, input, output, pseudo-velocity or run.
        what: &'static str,
        /// Its index.
        index: usize,
        /// How many there are.
        len: usize,
    },
    /// Nothing is measured, nothing was recorded, or the model does not move.
    #[error("there are no {what}")]
    Nothing {
        /// What is missing.
        what: &'static str,
    },
    /// Values of the wrong number.
    #[error("{found} values were given, {expected} are needed")]
    ValueCount {
        /// How many are needed.
        expected: usize,
        /// How many were given.
        found: usize,
    },
    /// A value outside of what its kind may have.
    #[error("{what} is {value}; it has to be {demand}")]
    Value {
        /// Which value.
        what: String,
        /// What it is.
        value: f64,
        /// What it may be.
        demand: &'static str,
    },
    /// The moments at which inputs change or sensors sample move with a delay; rates that depend on
    /// time by themselves would have to be differentiated by time.
    #[error("delays cannot be estimated where the equations depend on time by themselves")]
    DelayWithTime,
    /// A filter whose numbers are no longer finite.
    #[error("run {run}: the filter has no finite state at {t} s")]
    Diverged {
        /// Which run.
        run: usize,
        /// Where, in s.
        t: f64,
    },
    /// Position constraints that no state near the estimate satisfies.
    #[error("run {run}: at {t} s: {source}")]
    Open {
        /// Which run.
        run: usize,
        /// Where, in s.
        t: f64,
        /// How far off.
        source: appell_runtime::positions::Inconsistent,
    },
    /// An optimisation that found no better point from a start that is not an optimum.
    #[error("no better values are found after {steps} steps; the slope is {slope:.2e}")]
    Stuck {
        /// Steps taken.
        steps: usize,
        /// Largest scaled slope that remains.
        slope: f64,
    },
    /// A value that multiple shooting does not look for.
    #[error(
        "{unknown:?} is not found by shooting, which knows parameters, biases, scales and lags"
    )]
    NotByShooting {
        /// Which.
        unknown: super::Unknown,
    },
    /// A matrix that ought to be positive definite and is not.
    #[error("{what} is singular: some combination of the unknowns is not determined")]
    Singular {
        /// Which matrix.
        what: &'static str,
    },
    /// A table of a signal that is not a function of time.
    #[error(transparent)]
    Signal(#[from] appell_runtime::signal::SignalError),
}

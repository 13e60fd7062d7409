//! Limits of the size of a data set, as untrusted input.

/// Largest number of values of a data set, times included; eight bytes each.
pub const MAX_NUMBERS: usize = 100_000_000;
/// Largest file that is read as a whole, in bytes: C3D and MCAP.
pub const MAX_BYTES: u64 = 1 << 30;
/// Largest file that is read in parts, in bytes: CSV and Parquet.
pub const MAX_FILE: u64 = 1 << 36;
/// Longest line of a CSV file, in bytes.
pub const MAX_LINE: usize = 1 << 16;
/// Largest number of runs of a data set.
pub const MAX_RUNS: usize = 1024;
/// Least number of rows of a run; fewer determine neither a rate nor a noise level.
pub const MIN_ROWS: usize = 8;
/// Largest plausible measurement or input, in SI.
pub const MAX_VALUE: f64 = 1e30;
/// Latest plausible time in s; a date counted in nanoseconds, read in seconds, is 2e18.
pub const MAX_TIME: f64 = 1e20;
/// Least plausible step between rows in s.
pub const MIN_STEP: f64 = 1e-12;
/// Largest fraction of rows out of order that are omitted; with more the clock is wrong.
pub const MAX_LEFT_OUT: f64 = 0.05;
/// Largest number of errors reported for one file.
pub const MAX_MISTAKES: usize = 20;

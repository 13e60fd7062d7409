//! Bounds on what a data set may hold: it comes from strangers.

/// Most numbers of a data set, times included; eight bytes each.
pub const MAX_NUMBERS: usize = 100_000_000;
/// Largest file that is read as a whole, in bytes: C3D and MCAP.
pub const MAX_BYTES: u64 = 1 << 30;
/// Longest line of a CSV file, in bytes.
pub const MAX_LINE: usize = 1 << 16;
/// Most runs of a data set.
pub const MAX_RUNS: usize = 1024;
/// Fewest rows of a run: fewer tell neither a rate nor a noise level.
pub const MIN_ROWS: usize = 8;
/// Largest measurement or input, in SI: larger ones are no numbers of a rig.
pub const MAX_VALUE: f64 = 1e30;
/// Most rows out of order, as a part of all, that are left out; with more the clock is wrong.
pub const MAX_LEFT_OUT: f64 = 0.05;
/// Most mistakes told for one file.
pub const MAX_MISTAKES: usize = 20;

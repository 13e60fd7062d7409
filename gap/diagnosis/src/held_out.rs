//! Origins and horizons of predictions on held-out runs.

use appell_estimate::Recording;

/// Horizons in s: 0 is one step, infinity the free run to the end.
pub const HORIZONS: [f64; 4] = [0.0, 0.1, 1.0, f64::INFINITY];
/// The horizon of traces in s.
pub const AHEAD: f64 = 1.0;
/// Time in s, and number of rows, for the filter to converge before the first prediction, but no more than a tenth
/// of the run.
const WARM_UP: f64 = 0.5;
const ROWS: usize = 20;

/// Rows from which predictions start, no more than `most`.
pub(crate) fn origins(recording: &Recording, most: usize) -> Vec<usize> {
    let times = recording.times();
    let (start, end) = (times[0], times[times.len() - 1]);
    let rows = times[ROWS.min(times.len() - 1)] - start;
    let from = start + WARM_UP.max(rows).min(0.1 * (end - start));
    let first = times.partition_point(|&t| t < from);
    let every = (times.len() - first).div_ceil(most).max(1);
    (first..times.len()).step_by(every).collect()
}

//! Jumps of measured angles: a wrapped angle, which is counted on, and others, which are only reported.

use std::f64::consts::TAU;

use appell_estimate::smoothing::angle::unwrap;

/// Range in turns beyond which an angle is not wrapped.
const MOST_TURNS: f64 = 3.0;
/// Rows on both sides that show how fast the angle moves there.
const AROUND: usize = 4;
/// How many times as large as the steps around it a jump is.
const FAR: f64 = 8.0;
/// Least size of a jump, relative to the range of the values.
const LEAST: f64 = 0.1;

/// Jumps that begin at a row, from 0.
pub(crate) struct Jumps {
    pub(crate) count: usize,
    pub(crate) row: usize,
    /// Of the first one.
    pub(crate) size: f64,
}

/// Counts on an angle that begins anew after a turn; the jumps that were removed.
pub(crate) fn wrapped(values: &mut [f64], turn: f64) -> Option<Jumps> {
    if !may_be_wrapped(values, turn) {
        return None;
    }
    let (row, size) = steps(values).find(|(_, step)| step.abs() > turn / 2.0)?;
    // In turns of a circle.
    let unit = TAU / turn;
    for value in values.iter_mut() {
        *value *= unit;
    }
    let count = unwrap(values);
    for value in values.iter_mut() {
        *value /= unit;
    }
    Some(Jumps { count, row, size })
}

/// Steps far larger than those around them: no motion, but a dead zone, a turn of another size, or a fault.
pub(crate) fn others(values: &[f64]) -> Option<Jumps> {
    let steps: Vec<(usize, f64)> = steps(values).collect();
    let sizes: Vec<f64> = steps.iter().map(|(_, step)| step.abs()).collect();
    if sizes.len() <= 2 * AROUND {
        return None;
    }
    let place = sizes.len() * 9 / 10;
    let usual = *(sizes.clone())
        .select_nth_unstable_by(place, f64::total_cmp)
        .1;
    let smallest = sizes.iter().copied().filter(|size| *size > 0.0);
    let smallest = smallest.fold(f64::INFINITY, f64::min);
    let [low, high] = ends(values);
    let least = (LEAST * (high - low)).max(FAR * usual.max(smallest));
    let is_jump = |&place: &usize| {
        if sizes[place] < least {
            return false;
        }
        let around = place.saturating_sub(AROUND)..(place + AROUND + 1).min(sizes.len());
        let mut others = around.filter(|other| *other != place);
        others.all(|other| FAR * sizes[other] < sizes[place])
    };
    let found: Vec<usize> = (0..sizes.len()).filter(is_jump).collect();
    let (row, size) = steps[*found.first()?];
    let count = found.len();
    Some(Jumps { count, row, size })
}

/// Rows and steps between successive values that are there.
fn steps(values: &[f64]) -> impl Iterator<Item = (usize, f64)> {
    let mut last = f64::NAN;
    let present = values
        .iter()
        .enumerate()
        .filter(|(_, value)| !value.is_nan());
    let steps = present.map(move |(row, value)| {
        let step = value - last;
        last = *value;
        (row, step)
    });
    steps.skip(1)
}

/// Whether an angle may be wrapped; one with a range of several turns is not.
fn may_be_wrapped(values: &[f64], turn: f64) -> bool {
    let [low, high] = ends(values);
    high - low < MOST_TURNS * turn
}

fn ends(values: &[f64]) -> [f64; 2] {
    let present = values.iter().copied().filter(|value| !value.is_nan());
    present.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

//! How long steps may be lest they pass over what time does.
//!
//! Where nothing acts between two pulses the estimated error is zero, and steps would grow beyond a pulse. The span is
//! divided until each function of time passes through no more than half of its values in one part, by bounds that hold
//! for certain; a step is no longer than two of the parts that it touches.

use crate::interval::Interval;
use crate::real::Enclosure;

/// Parts of the span to begin with.
const FIRST_PARTS: usize = 16;
/// Most parts for one function. What varies throughout the span, the estimated error sees.
const MOST_PARTS: usize = 4096;
/// Halvings of the first parts.
const HALVINGS: usize = 40;
/// Part of its values that a function may pass through in one part.
const PASSED: f64 = 0.5;
/// A variation that is none.
const NONE: f64 = 1e-300;
/// Rounding, relative to a value.
const ROUNDING: f64 = 1e-12;
/// Parts as short as the shortest that a step touches in one step.
const PARTS_PER_STEP: f64 = 2.0;

/// The parts of the span by each function: their starts and lengths in s, in the order of time.
#[derive(Debug, Default)]
pub(super) struct Pace {
    by_function: Vec<Vec<[f64; 2]>>,
}

impl Pace {
    /// Divides a span; `bounds` tells those of a function by its number.
    pub(super) fn new(
        span: [f64; 2],
        count: usize,
        mut bounds: impl FnMut(usize, [f64; 2]) -> Enclosure,
    ) -> Self {
        let by_function = (0..count).filter_map(|i| parts(span, |part| bounds(i, part)));
        Self {
            by_function: by_function.collect(),
        }
    }

    /// The longest step from `t` that is not longer than `h`.
    pub(super) fn longest(&self, t: f64, mut h: f64) -> f64 {
        for parts in &self.by_function {
            let first = parts.partition_point(|&[start, length]| start + length <= t);
            for &[start, length] in &parts[first..] {
                if start >= t + h {
                    break;
                }
                h = h.min((PARTS_PER_STEP * length).max(start - t));
            }
        }
        h
    }
}

/// The parts of a span by one function; nothing where they do not matter.
fn parts(
    [start, end]: [f64; 2],
    mut bounds: impl FnMut([f64; 2]) -> Enclosure,
) -> Option<Vec<[f64; 2]>> {
    let length = (end - start) / FIRST_PARTS as f64;
    let first = |i: usize| start + length * i as f64;
    let mut waiting: Vec<[f64; 2]> = (0..FIRST_PARTS).map(|i| [first(i), first(i + 1)]).collect();
    let mut done: Vec<[f64; 2]> = Vec::new();
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..HALVINGS {
        let found: Vec<Enclosure> = waiting.iter().map(|&part| bounds(part)).collect();
        for Interval { lo, hi } in found.iter().map(Enclosure::middle) {
            if lo.is_finite() && hi.is_finite() {
                (lowest, highest) = (lowest.min(lo), highest.max(hi));
            }
        }
        let mut halves = Vec::new();
        for (&[from, to], of) in waiting.iter().zip(&found) {
            let Interval { lo, hi } = of.range();
            let rounding = NONE + ROUNDING * lo.abs().max(hi.abs());
            let middle = f64::midpoint(from, to);
            let passed = hi - lo;
            let is_seen = passed.is_finite() && passed <= rounding.max(PASSED * (highest - lowest));
            if is_seen || middle <= from || middle >= to {
                done.push([from, to - from]);
            } else {
                halves.extend([[from, middle], [middle, to]]);
            }
        }
        waiting = halves;
        if waiting.is_empty() || done.len() + waiting.len() > MOST_PARTS {
            break;
        }
    }
    done.extend(waiting.iter().map(|&[from, to]| [from, to - from]));
    if done.len() <= FIRST_PARTS {
        return None;
    }
    done.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Some(done)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Real;

    fn pace(span: [f64; 2], f: impl Fn(Enclosure) -> Enclosure) -> Pace {
        Pace::new(span, 1, |_, [from, to]| f(Enclosure::time(from, to)))
    }

    #[test]
    fn steps_are_short_at_a_pulse_and_long_elsewhere() {
        let pace = pace([0.0, 20.0], |t| {
            let since = t - Real::constant(13.0);
            // Not known to be a square: its bounds let the exponential be infinite.
            (since * since * Real::constant(-1e4)).exp()
        });
        assert!(pace.longest(0.0, 20.0) > 2.0);
        assert!(pace.longest(14.0, 20.0) > 2.0);
        // Its values fall to a half within 0.0083 s.
        assert!(pace.longest(12.999, 1.0) < 0.03);
        let before = pace.longest(12.9, 20.0);
        assert!(12.9 + before < 13.03, "{before}");
    }

    #[test]
    fn what_varies_slowly_bounds_no_step() {
        let pace = pace([0.0, 20.0], |t| (t * Real::constant(0.01)).exp());
        assert!(pace.longest(0.0, 1e3) > 999.0);
    }
}

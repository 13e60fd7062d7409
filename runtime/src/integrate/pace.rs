//! Step-size limits that prevent stepping over pulses of functions of time.
//!
//! Between two pulses the estimated error may be zero, and steps would grow beyond a pulse. The span is bisected
//! until, by interval bounds, each function varies by at most half of its range within a subinterval; a step is at most
//! twice as long as each subinterval that it overlaps.

use crate::interval::Interval;
use crate::real::Enclosure;

/// Initial number of subintervals.
const FIRST_PARTS: usize = 16;
/// Most subintervals for one function. The error estimate resolves functions that vary throughout the span.
const MOST_PARTS: usize = 4096;
/// Bisections of the initial subintervals.
const HALVINGS: usize = 40;
/// Fraction of its range by which a function may vary within a subinterval.
const PASSED: f64 = 0.5;
/// A variation below this is zero.
const NONE: f64 = 1e-300;
/// Relative rounding error of a value.
const ROUNDING: f64 = 1e-12;
/// Length of a step in subintervals of the shortest length that it overlaps.
const PARTS_PER_STEP: f64 = 2.0;

/// The subintervals for each function: their starts and lengths in s, in the order of time.
#[derive(Debug, Default)]
pub(super) struct Pace {
    by_function: Vec<Vec<[f64; 2]>>,
}

impl Pace {
    /// Divides a span; `bounds` returns those of a function by its index. For each subinterval it is called for all
    /// functions that need it in a row.
    pub(super) fn new(
        span: [f64; 2],
        count: usize,
        mut bounds: impl FnMut(usize, [f64; 2]) -> Enclosure,
    ) -> Self {
        let [start, end] = span;
        let length = (end - start) / FIRST_PARTS as f64;
        let first = |i: usize| start + length * i as f64;
        let mut all: Vec<Division> = (0..count).map(|_| Division::default()).collect();
        let everyone: Vec<usize> = (0..count).collect();
        let mut waiting: Vec<Part> = (0..FIRST_PARTS)
            .map(|i| ([first(i), first(i + 1)], everyone.clone()))
            .collect();
        for _ in 0..HALVINGS {
            let mut found = Vec::new();
            for (part, functions) in &waiting {
                for &i in functions {
                    let of = bounds(i, *part);
                    all[i].takes(of);
                    found.push(of);
                }
            }
            let mut found = found.iter();
            let mut halves = Vec::new();
            for (part, functions) in waiting {
                let [from, to] = part;
                let middle = f64::midpoint(from, to);
                let mut unseen = functions.clone();
                unseen.retain(|&i| {
                    let is_seen = found.next().is_none_or(|of| all[i].sees(of));
                    let is_done = is_seen || middle <= from || middle >= to;
                    if is_done {
                        all[i].done.push([from, to - from]);
                    } else {
                        all[i].waiting += 2;
                    }
                    !is_done
                });
                if !unseen.is_empty() {
                    halves.extend([([from, middle], unseen.clone()), ([middle, to], unseen)]);
                }
            }
            waiting = halves;
            // Functions that vary throughout the span are not refined further.
            for (part, functions) in &mut waiting {
                functions.retain(|&i| all[i].goes_on_after(*part));
            }
            waiting.retain(|(_, functions)| !functions.is_empty());
            if waiting.is_empty() {
                break;
            }
            for of in &mut all {
                of.waiting = 0;
            }
        }
        for ([from, to], functions) in waiting {
            for i in functions {
                all[i].done.push([from, to - from]);
            }
        }
        let by_function = all.into_iter().filter_map(Division::sorted);
        Self {
            by_function: by_function.collect(),
        }
    }

    /// The subintervals of all functions, in the order of time.
    pub(super) fn all(&self) -> Vec<[f64; 2]> {
        let mut all = self.by_function.concat();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]));
        all
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

/// A subinterval, and the functions that still need bounds on it.
type Part = ([f64; 2], Vec<usize>);

/// The subdivision of the span for one function.
#[derive(Debug)]
struct Division {
    /// Starts and lengths of the subintervals that are short enough.
    done: Vec<[f64; 2]>,
    /// Number of subintervals in the next round.
    waiting: usize,
    /// The range of its values, as far as known.
    values: [f64; 2],
}

impl Default for Division {
    fn default() -> Self {
        Self {
            done: Vec::new(),
            waiting: 0,
            values: [f64::INFINITY, f64::NEG_INFINITY],
        }
    }
}

impl Division {
    fn takes(&mut self, of: Enclosure) {
        let Interval { lo, hi } = of.middle();
        if lo.is_finite() && hi.is_finite() {
            let [lowest, highest] = self.values;
            self.values = [lowest.min(lo), highest.max(hi)];
        }
    }

    /// Whether these bounds cover only a small fraction of its range.
    fn sees(&self, of: &Enclosure) -> bool {
        let Interval { lo, hi } = of.range();
        let [lowest, highest] = self.values;
        let rounding = NONE + ROUNDING * lo.abs().max(hi.abs());
        let passed = hi - lo;
        passed.is_finite() && passed <= rounding.max(PASSED * (highest - lowest))
    }

    /// Whether a subinterval is refined in the next round; if not, it is final.
    fn goes_on_after(&mut self, [from, to]: [f64; 2]) -> bool {
        let goes_on = self.done.len() + self.waiting <= MOST_PARTS;
        if !goes_on {
            self.done.push([from, to - from]);
            self.waiting -= 1;
        }
        goes_on
    }

    /// The subintervals in the order of time; `None` if they do not limit the step.
    fn sorted(mut self) -> Option<Vec<[f64; 2]>> {
        self.done.sort_by(|a, b| a[0].total_cmp(&b[0]));
        (self.done.len() > FIRST_PARTS).then_some(self.done)
    }
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
            // Not recognised as a square: its bounds let the exponential be infinite.
            (since * since * Real::constant(-1e4)).exp()
        });
        assert!(pace.longest(0.0, 20.0) > 2.0);
        assert!(pace.longest(14.0, 20.0) > 2.0);
        // It falls to half its value within 0.0083 s.
        assert!(pace.longest(12.999, 1.0) < 0.03);
        let before = pace.longest(12.9, 20.0);
        assert!(12.9 + before < 13.03, "{before}");
    }

    #[test]
    fn functions_are_bounded_together() {
        let mut asked = Vec::new();
        let count = 50;
        let pace = Pace::new([0.0, 20.0], count, |i, [from, to]| {
            if asked.last() != Some(&from) {
                asked.push(from);
            }
            let since = Enclosure::time(from, to) - Real::constant(5.0 + 0.01 * i as f64);
            (since * since * Real::constant(-1e4)).exp()
        });
        assert_eq!(pace.by_function.len(), count);
        let parts: usize = pace.by_function.iter().map(Vec::len).sum();
        // The bounds on a subinterval are requested once for all functions: a new round starts with the first one.
        assert!(asked.len() < parts / 5, "{} of {parts}", asked.len());
    }

    #[test]
    fn what_varies_slowly_bounds_no_step() {
        let pace = pace([0.0, 20.0], |t| (t * Real::constant(0.01)).exp());
        assert!(pace.longest(0.0, 1e3) > 999.0);
    }
}

//! Where a function of the motion crosses zero.

use super::dense_output::{DenseOutput, Ends};

/// Which crossings of zero count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
    /// Both.
    Either,
}

impl Direction {
    fn admits(self, before: i8) -> bool {
        match self {
            Self::Rising => before < 0,
            Self::Falling => before > 0,
            Self::Either => true,
        }
    }
}

/// g(t, x), boxed.
pub type EventFunction<'a> = Box<dyn FnMut(f64, &[f64]) -> f64 + 'a>;

/// A function g(t, x) whose zeros are wanted.
///
/// A crossing counts when g reaches zero or changes its sign. Where g is zero at the start of
/// the integration there is no crossing: its sign is taken from the first instant it has one.
/// Within a step g is sampled at eighths, so a pair of crossings closer than that can be missed;
/// `max_step` bounds the step.
pub struct Event<'a> {
    /// The function.
    pub function: EventFunction<'a>,
    /// Which crossings count.
    pub direction: Direction,
    /// Whether the integration ends at the first crossing that counts.
    pub terminal: bool,
}

impl<'a> Event<'a> {
    /// An event that is recorded.
    pub fn new(direction: Direction, function: impl FnMut(f64, &[f64]) -> f64 + 'a) -> Self {
        Self {
            function: Box::new(function),
            direction,
            terminal: false,
        }
    }

    /// An event that ends the integration.
    pub fn terminal(direction: Direction, function: impl FnMut(f64, &[f64]) -> f64 + 'a) -> Self {
        Self {
            terminal: true,
            ..Self::new(direction, function)
        }
    }
}

impl std::fmt::Debug for Event<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Event")
            .field("direction", &self.direction)
            .field("terminal", &self.terminal)
            .finish_non_exhaustive()
    }
}

/// A crossing that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct EventHit {
    /// Index of the event.
    pub event: usize,
    /// When, in s.
    pub t: f64,
    /// State at that time.
    pub state: Vec<f64>,
}

/// Parts of a step between which sign changes are sought.
const PARTS: usize = 8;

/// The signs of all events up to the current time.
#[derive(Debug, Default)]
pub(super) struct Crossings {
    signs: Vec<i8>,
    x: Vec<f64>,
    found: Vec<(f64, usize)>,
}

impl Crossings {
    /// Takes the signs at the start.
    pub(super) fn start(&mut self, events: &mut [Event<'_>], t: f64, x: &[f64]) {
        self.x.clear();
        self.x.resize(x.len(), 0.0);
        self.signs.clear();
        self.signs.extend(
            events
                .iter_mut()
                .map(|event| sign((event.function)(t, x)).unwrap_or(0)),
        );
    }

    /// The crossings of one step in the order of time, as (time, event).
    pub(super) fn in_step(
        &mut self,
        events: &mut [Event<'_>],
        ends: &Ends<'_>,
        dense: &DenseOutput,
    ) -> &[(f64, usize)] {
        let [t_old, t_new] = ends.t;
        self.found.clear();
        let time = |part: usize| t_old + (t_new - t_old) * (part as f64 / PARTS as f64);
        for part in 1..=PARTS {
            let t = if part == PARTS { t_new } else { time(part) };
            if part == PARTS {
                self.x.copy_from_slice(ends.x[1]);
            } else {
                dense.state(t, &mut self.x);
            }
            for (index, event) in events.iter_mut().enumerate() {
                let before = self.signs[index];
                let Some(after) = sign((event.function)(t, &self.x)) else {
                    continue;
                };
                self.signs[index] = after;
                let crosses = before != 0 && after != before;
                if crosses && event.direction.admits(before) {
                    let x = &mut self.x;
                    let bracket = (time(part - 1), t);
                    let root = brent(bracket, |s| {
                        dense.state(s, x);
                        (event.function)(s, x)
                    });
                    self.found.push((root, index));
                    dense.state(t, &mut self.x);
                }
            }
        }
        self.found.sort_by(|a, b| a.0.total_cmp(&b.0));
        &self.found
    }
}

/// −1, 0 or 1; nothing for NaN.
fn sign(value: f64) -> Option<i8> {
    value.partial_cmp(&0.0).map(|ordering| ordering as i8)
}

/// Iterations after which a bracket is as short as it will get.
const BRENT_ITERATIONS: usize = 100;

/// A zero of `g` between the ends of `bracket`, where its signs differ, to the spacing of `f64`
/// (Brent, *Algorithms for Minimization without Derivatives*, chapter 4).
pub(super) fn brent(bracket: (f64, f64), mut g: impl FnMut(f64) -> f64) -> f64 {
    // b is the best estimate, a the one before, and the zero lies between b and c.
    let (mut a, mut b) = bracket;
    let (mut g_a, mut g_b) = (g(a), g(b));
    let (mut c, mut g_c) = (a, g_a);
    let mut step = b - a;
    let mut step_before = step;
    let length = (b - a).abs();
    for _ in 0..BRENT_ITERATIONS {
        if g_c.abs() < g_b.abs() {
            (a, b, c) = (b, c, b);
            (g_a, g_b, g_c) = (g_b, g_c, g_b);
        }
        let tolerance = 2.0 * f64::EPSILON * b.abs() + 0.5 * f64::EPSILON * length;
        let half = 0.5 * (c - b);
        if half.abs() <= tolerance || g_b == 0.0 {
            break;
        }
        if step_before.abs() < tolerance || g_a.abs() <= g_b.abs() {
            (step, step_before) = (half, half);
        } else {
            let (p, q) = interpolation((a, g_a), (b, g_b), (c, g_c), half);
            if 2.0 * p < (3.0 * half * q - (tolerance * q).abs()).min((step_before * q).abs()) {
                (step_before, step) = (step, p / q);
            } else {
                (step, step_before) = (half, half);
            }
        }
        (a, g_a) = (b, g_b);
        b += if step.abs() > tolerance {
            step
        } else {
            tolerance.copysign(half)
        };
        g_b = g(b);
        if (g_b > 0.0) == (g_c > 0.0) {
            (c, g_c) = (a, g_a);
            step = b - a;
            step_before = step;
        }
    }
    b
}

/// The step p / q, p ≥ 0, to the zero of the line through two points or of the inverse parabola
/// through three.
fn interpolation(a: (f64, f64), b: (f64, f64), c: (f64, f64), half: f64) -> (f64, f64) {
    let s = b.1 / a.1;
    let (p, q) = if a.0.to_bits() == c.0.to_bits() {
        (2.0 * half * s, 1.0 - s)
    } else {
        let (q, r) = (a.1 / c.1, b.1 / c.1);
        let p = s * (2.0 * half * q * (q - r) - (b.0 - a.0) * (r - 1.0));
        (p, (q - 1.0) * (r - 1.0) * (s - 1.0))
    };
    if p > 0.0 { (p, -q) } else { (-p, q) }
}

//! Zeros of functions along a motion.

use super::dense_output::{DenseOutput, Ends};
use super::pieces::{Piece, Sought, Walk};

/// Sign changes that count as events.
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

/// Whether a function may vary more within a piece than its values show, given the start of the step; boxed.
pub type HidingFunction<'a> = Box<dyn FnMut(&Piece, f64, &DenseOutput) -> bool + 'a>;
/// g(t, x), boxed.
pub type EventFunction<'a> = Box<dyn FnMut(f64, &[f64]) -> f64 + 'a>;

/// An event function g(t, x), whose zeros are located.
///
/// An event occurs when g reaches zero or changes its sign. A zero at the start of the integration is no event: the
/// first nonzero value determines the sign. Within a step g is resolved to about 1e-7 of its magnitude; variations
/// between the samples of a shortest piece, up to a fifth of `longest` apart, can be missed unless `hides` detects
/// them.
pub struct Event<'a> {
    /// The function.
    pub function: EventFunction<'a>,
    /// Sign changes that count.
    pub direction: Direction,
    /// Whether the integration ends at the first event.
    pub terminal: bool,
    /// The longest interval in s on which the function is approximated by one polynomial.
    pub longest: f64,
    /// Whether the function may vary within a piece of a step more than its values show, where that is known.
    pub hides: Option<HidingFunction<'a>>,
}

impl<'a> Event<'a> {
    /// An event that is recorded.
    pub fn new(direction: Direction, function: impl FnMut(f64, &[f64]) -> f64 + 'a) -> Self {
        Self {
            function: Box::new(function),
            direction,
            terminal: false,
            longest: f64::INFINITY,
            hides: None,
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

/// A located event.
#[derive(Debug, Clone, PartialEq)]
pub struct EventHit {
    /// Index of the event.
    pub event: usize,
    /// Time in s.
    pub t: f64,
    /// State at that time.
    pub state: Vec<f64>,
}

/// The signs of all events up to the current time.
#[derive(Debug, Default)]
pub(super) struct Crossings {
    signs: Vec<i8>,
    /// The largest absolute value of each function so far.
    sizes: Vec<f64>,
    x: Vec<f64>,
    found: Vec<(f64, usize)>,
    walk: Walk,
}

impl Crossings {
    /// Initialises the signs.
    pub(super) fn start(&mut self, events: &mut [Event<'_>], t: f64, x: &[f64]) {
        self.x.clear();
        self.x.resize(x.len(), 0.0);
        self.signs.clear();
        self.signs.extend(
            events
                .iter_mut()
                .map(|event| sign((event.function)(t, x)).unwrap_or(0)),
        );
        self.sizes.clear();
        self.sizes.resize(events.len(), 0.0);
    }

    /// The events of one step in the order of time, as (time, index).
    pub(super) fn in_step(
        &mut self,
        events: &mut [Event<'_>],
        ends: &Ends<'_>,
        dense: &DenseOutput,
    ) -> &[(f64, usize)] {
        self.found.clear();
        if events.is_empty() {
            return &self.found;
        }
        let [from, to] = ends.t;
        let longest = events
            .iter()
            .map(|e| e.longest)
            .fold(f64::INFINITY, f64::min);
        let (mut walk, mut x) = (std::mem::take(&mut self.walk), std::mem::take(&mut self.x));
        let mut seen = Seen {
            events,
            ends,
            dense,
            x: &mut x,
            crossings: self,
        };
        // Inputs may be discontinuous at the end of the step.
        let before = to.next_down().max(from);
        walk.walk([from, before], longest, &mut seen);
        for index in 0..seen.events.len() {
            let value = seen.value(index, to);
            seen.point(index, before, to, value);
        }
        (self.walk, self.x) = (walk, x);
        self.found.sort_by(|a, b| a.0.total_cmp(&b.0));
        &self.found
    }
}

/// The search for events in a step.
struct Seen<'s, 'a> {
    events: &'s mut [Event<'a>],
    ends: &'s Ends<'s>,
    dense: &'s DenseOutput,
    x: &'s mut Vec<f64>,
    crossings: &'s mut Crossings,
}

impl Seen<'_, '_> {
    /// The value of an event.
    fn value(&mut self, index: usize, t: f64) -> f64 {
        let x = state(self.ends, self.dense, self.x, t);
        (self.events[index].function)(t, x)
    }

    /// Compares the value of an event function with its last sign.
    fn point(&mut self, index: usize, last: f64, t: f64, value: f64) {
        let Some(after) = sign(value) else {
            return;
        };
        let before = std::mem::replace(&mut self.crossings.signs[index], after);
        let crosses = before != 0 && after != before;
        if crosses && self.events[index].direction.admits(before) {
            let root = if last < t {
                brent((last, t), |s| self.value(index, s))
            } else {
                t
            };
            self.crossings.found.push((root, index));
        }
    }
}

/// The state at a time within a step; at both ends that of the step itself.
fn state<'x>(ends: &Ends<'x>, dense: &DenseOutput, x: &'x mut [f64], t: f64) -> &'x [f64] {
    if t <= ends.t[0] {
        ends.x[0]
    } else if t >= ends.t[1].next_down() {
        ends.x[1]
    } else {
        dense.state(t, x);
        x
    }
}

impl Sought for Seen<'_, '_> {
    fn count(&self) -> usize {
        self.events.len()
    }

    fn evaluate(&mut self, t: f64, values: &mut [f64]) {
        let x = state(self.ends, self.dense, self.x, t);
        for (event, value) in self.events.iter_mut().zip(values) {
            *value = (event.function)(t, x);
        }
    }

    fn is_enough(&mut self, which: usize, piece: &Piece) -> bool {
        let size = piece.size().max(ROUNDING * self.crossings.sizes[which]);
        if !piece.keeps_its_sign() && !piece.is_resolved(size) {
            return false;
        }
        let start = self.ends.t[0];
        let hides = &mut self.events[which].hides;
        !hides
            .as_mut()
            .is_some_and(|hides| hides(piece, start, self.dense))
    }

    fn see(&mut self, pieces: &[Piece]) {
        for (index, piece) in pieces.iter().enumerate() {
            let size = &mut self.crossings.sizes[index];
            *size = size.max(piece.size());
            let mut last = piece.span()[0];
            let mut doubts = piece.doubts().into_iter().peekable();
            for (t, value) in piece.points() {
                while let Some(doubt) = doubts.next_if(|doubt| *doubt <= t) {
                    let value = self.value(index, doubt);
                    self.point(index, last, doubt, value);
                    last = doubt;
                }
                self.point(index, last, t, value);
                last = t;
            }
        }
    }
}

/// Values on a piece below this fraction of the largest one so far are rounding errors.
const ROUNDING: f64 = 1e-6;

/// −1, 0 or 1; `None` for NaN.
fn sign(value: f64) -> Option<i8> {
    value.partial_cmp(&0.0).map(|ordering| ordering as i8)
}

/// Iterations after which the bracket is as short as possible.
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

//! Piecewise Chebyshev interpolation of functions of time along a step, bisected until resolved: extrema, zeros and
//! means within a step of any length.
//!
//! The nodes are the extrema of the polynomial of degree 8. A function is resolved where its last coefficients are
//! small (L. N. Trefethen, *Approximation Theory and Approximation Practice*, chapters 3, 4 and 19).

/// Nodes of a piece, including both ends.
const NODES: usize = 9;
/// cos(k π / 8).
const COSINES: [f64; NODES] = [
    1.0,
    0.923_879_532_511_286_7,
    0.707_106_781_186_547_5,
    0.382_683_432_365_089_8,
    0.0,
    -0.382_683_432_365_089_8,
    -0.707_106_781_186_547_5,
    -0.923_879_532_511_286_7,
    -1.0,
];
/// Bound on the last two coefficients of a resolved function, relative to its magnitude, and the factor by which the
/// one before may exceed it, since the coefficients decay.
const TAIL: f64 = 1e-7;
const DECAY: f64 = 100.0;
/// Most bisections of a piece: a jump is then located to about 1e-7 of the step.
const HALVINGS: u32 = 24;
/// Most pieces of an interval; faster oscillations are not resolved.
const MOST: u32 = 1024;
/// Intervals of a step, at most.
const INTERVALS: f64 = 100_000.0;
/// Sampling points of the polynomial per interval between nodes.
const PARTS: usize = 4;

/// A function on a piece of an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    times: [f64; NODES],
    values: [f64; NODES],
    coefficients: [f64; NODES],
}

impl Piece {
    fn new([from, to]: [f64; 2], values: [f64; NODES]) -> Self {
        let last = NODES - 1;
        let mut coefficients = [0.0; NODES];
        for (k, coefficient) in coefficients.iter_mut().enumerate() {
            for (j, value) in values.iter().enumerate() {
                // The nodes rise, the cosines fall.
                let turns = k * (last - j) % (2 * last);
                let cosine = COSINES[turns.min(2 * last - turns)];
                let weight = if j == 0 || j == last { 0.5 } else { 1.0 };
                *coefficient += weight * cosine * value;
            }
            let weight = if k == 0 || k == last { 1.0 } else { 2.0 };
            *coefficient *= weight / last as f64;
        }
        Self {
            times: times([from, to]),
            values,
            coefficients,
        }
    }

    /// Start and end in s.
    pub fn span(&self) -> [f64; 2] {
        [self.times[0], self.times[NODES - 1]]
    }

    /// Times and values at the nodes.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.times.iter().copied().zip(self.values.iter().copied())
    }

    /// The smallest and the largest value at the nodes.
    pub fn ends(&self) -> [f64; 2] {
        let values = self.values.iter().copied();
        [
            values.clone().fold(f64::INFINITY, f64::min),
            values.fold(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// The largest absolute value at the nodes.
    pub fn size(&self) -> f64 {
        let [least, most] = self.ends();
        least.abs().max(most.abs())
    }

    /// Whether all values are finite.
    pub fn is_finite(&self) -> bool {
        self.values.iter().all(|value| value.is_finite())
    }

    /// Whether the polynomial approximates the function to about 1e-7 of `size`.
    pub fn is_resolved(&self, size: f64) -> bool {
        let [.., before, first, last] = self.coefficients.map(f64::abs);
        first + last <= TAIL * size && before <= DECAY * TAIL * size
    }

    /// Whether a function stays away from zero, judged by the variation of its values at the nodes; true for a
    /// function that is not finite.
    pub fn keeps_its_sign(&self) -> bool {
        let [least, most] = self.ends();
        !self.is_finite() || least.max(-most) > 2.0 * (most - least)
    }

    /// The mean over the piece.
    pub fn mean(&self) -> f64 {
        let even = self.coefficients.iter().enumerate().step_by(2);
        even.map(|(k, c)| c / (1.0 - (k * k) as f64)).sum()
    }

    /// The piece of the negated function.
    #[must_use]
    pub fn negative(&self) -> Self {
        Self {
            times: self.times,
            values: self.values.map(|value| -value),
            coefficients: self.coefficients.map(|c| -c),
        }
    }

    /// Bounds on the polynomial: midpoint and radius.
    fn range(&self) -> [f64; 2] {
        let radius = self.coefficients[1..].iter().map(|c| c.abs()).sum();
        [self.coefficients[0], radius]
    }

    /// The time of the maximum of the polynomial, if it exceeds `above` between the nodes.
    pub fn top(&self, above: f64) -> Option<f64> {
        let [middle, radius] = self.range();
        if middle + radius <= above {
            return None;
        }
        let points = self.fine();
        let best = (1..points.len() - 1).max_by(|a, b| points[*a].1.total_cmp(&points[*b].1))?;
        let (place, value) = self.turn([points[best - 1], points[best], points[best + 1]]);
        (value > above).then(|| self.time(place))
    }

    /// Times between the nodes at which the polynomial has the opposite sign of both neighbours: candidates for pairs
    /// of zeros.
    pub(super) fn doubts(&self) -> Vec<f64> {
        let [middle, radius] = self.range();
        let mut times = Vec::new();
        if !radius.is_finite() || radius < middle.abs() {
            return times;
        }
        let points = self.fine();
        let sign = |point: &(f64, f64)| point.1.partial_cmp(&0.0);
        for node in 0..NODES - 1 {
            let between = &points[PARTS * node..=PARTS * (node + 1)];
            let changes = between
                .windows(2)
                .filter(|w| sign(&w[0]) != sign(&w[1]))
                .count();
            if changes > 1 {
                times.extend(between[1..PARTS].iter().map(|point| self.time(point.0)));
            }
        }
        for near in points.windows(3) {
            let [a, b, c] = [near[0], near[1], near[2]];
            let turns_to_zero = a.1 * b.1 > 0.0
                && b.1 * c.1 > 0.0
                && b.1.abs() <= a.1.abs()
                && b.1.abs() <= c.1.abs();
            if turns_to_zero {
                let towards = b.1.signum();
                let mirrored = [a, b, c].map(|(place, value)| (place, -towards * value));
                let (place, _) = self.turn_of(mirrored, -towards);
                if self.at(place) * towards <= 0.0 {
                    times.push(self.time(place));
                }
            }
        }
        times.sort_by(f64::total_cmp);
        times
    }

    /// The polynomial at a point of [−1, 1] (C. W. Clenshaw).
    fn at(&self, place: f64) -> f64 {
        let (mut next, mut after) = (0.0, 0.0);
        for c in self.coefficients[1..].iter().rev() {
            (next, after) = (c + 2.0 * place * next - after, next);
        }
        self.coefficients[0] + place * next - after
    }

    fn time(&self, place: f64) -> f64 {
        let [from, to] = self.span();
        (0.5 * (from + to) + 0.5 * (to - from) * place).clamp(from, to)
    }

    /// The polynomial at the nodes and at points between them, as points and values.
    fn fine(&self) -> [(f64, f64); PARTS * (NODES - 1) + 1] {
        std::array::from_fn(|i| {
            let (node, part) = (i / PARTS, i % PARTS);
            let place = -COSINES[node];
            if part == 0 {
                return (place, self.values[node]);
            }
            let next = -COSINES[node + 1];
            let place = place + (next - place) * (part as f64 / PARTS as f64);
            (place, self.at(place))
        })
    }

    /// The maximum of the polynomial near three of its points, the middle of which is the highest.
    fn turn(&self, near: [(f64, f64); 3]) -> (f64, f64) {
        self.turn_of(near, 1.0)
    }

    fn turn_of(&self, mut near: [(f64, f64); 3], sign: f64) -> (f64, f64) {
        for _ in 0..3 {
            let [(a, at_a), (b, at_b), (c, at_c)] = near;
            // The parabola through the three points.
            let (left, right) = ((b - a) * (at_b - at_c), (b - c) * (at_b - at_a));
            let place = b - 0.5 * ((b - a) * left - (b - c) * right) / (left - right);
            if !(a < place && place < c) {
                break;
            }
            let found = (place, sign * self.at(place));
            near = match (found.1 >= at_b, place < b) {
                (true, true) => [near[0], found, near[1]],
                (true, false) => [near[1], found, near[2]],
                (false, true) => [found, near[1], near[2]],
                (false, false) => [near[0], near[1], found],
            };
        }
        near[1]
    }
}

/// The times of the nodes.
fn times([from, to]: [f64; 2]) -> [f64; NODES] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut times = COSINES.map(|cosine| (middle - half * cosine).clamp(from, to));
    (times[0], times[NODES - 1]) = (from, to);
    times
}

/// Functions of time, with the criterion for their resolution.
pub trait Sought {
    /// Number of functions.
    fn count(&self) -> usize;
    /// Writes their values at a time.
    fn evaluate(&mut self, t: f64, values: &mut [f64]);
    /// Whether a function is sufficiently resolved on a piece.
    fn is_enough(&mut self, which: usize, piece: &Piece) -> bool;
    /// Receives the pieces of all functions, in the order of time.
    fn see(&mut self, pieces: &[Piece]);
}

/// Work arrays of [`walk`](Walk::walk).
#[derive(Debug, Default)]
pub struct Walk {
    waiting: Vec<([f64; 2], u32)>,
    values: Vec<f64>,
    pieces: Vec<Piece>,
}

impl Walk {
    /// Visits the pieces of functions over an interval, none of which is longer than `longest` in s.
    pub fn walk(&mut self, [from, to]: [f64; 2], longest: f64, of: &mut impl Sought) {
        if to <= from || of.count() == 0 {
            return;
        }
        let count = of.count();
        self.values.resize(count, 0.0);
        let intervals = ((to - from) / longest).ceil().clamp(1.0, INTERVALS);
        let end = |interval: f64| from + (to - from) * (interval / intervals);
        let mut interval = 0.0;
        while interval < intervals {
            let next = interval + 1.0;
            let last = if next < intervals { end(next) } else { to };
            self.waiting.push(([end(interval), last], 0));
            interval = next;
            let mut left = MOST;
            while let Some((span, halvings)) = self.waiting.pop() {
                self.sample(span, of);
                let pieces = self.pieces.iter().enumerate();
                let middle = 0.5 * (span[0] + span[1]);
                let is_whole = halvings >= HALVINGS
                    || left == 0
                    || !(span[0] < middle && middle < span[1])
                    || pieces.into_iter().all(|(k, piece)| of.is_enough(k, piece));
                if is_whole {
                    of.see(&self.pieces);
                } else {
                    left -= 1;
                    self.waiting.push(([middle, span[1]], halvings + 1));
                    self.waiting.push(([span[0], middle], halvings + 1));
                }
            }
        }
    }

    fn sample(&mut self, span: [f64; 2], of: &mut impl Sought) {
        let mut samples = vec![[0.0; NODES]; self.values.len()];
        for (node, t) in times(span).into_iter().enumerate() {
            of.evaluate(t, &mut self.values);
            for (samples, value) in samples.iter_mut().zip(&self.values) {
                samples[node] = *value;
            }
        }
        self.pieces.clear();
        self.pieces
            .extend(samples.into_iter().map(|samples| Piece::new(span, samples)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean, the largest value with its time, and the number of evaluations.
    struct One<F> {
        f: F,
        integral: f64,
        best: (f64, f64),
        evaluations: usize,
    }

    impl<F: Fn(f64) -> f64> Sought for One<F> {
        fn count(&self) -> usize {
            1
        }

        fn evaluate(&mut self, t: f64, values: &mut [f64]) {
            self.evaluations += 1;
            values[0] = (self.f)(t);
        }

        fn is_enough(&mut self, _: usize, piece: &Piece) -> bool {
            piece.is_resolved(1.0)
        }

        fn see(&mut self, pieces: &[Piece]) {
            let piece = &pieces[0];
            let [from, to] = piece.span();
            self.integral += (to - from) * piece.mean();
            for (t, value) in piece.points() {
                if value > self.best.1 {
                    self.best = (t, value);
                }
            }
            if let Some(t) = piece.top(self.best.1) {
                self.best = (t, (self.f)(t));
            }
        }
    }

    fn known(span: [f64; 2], f: impl Fn(f64) -> f64) -> One<impl Fn(f64) -> f64> {
        let mut one = One {
            f,
            integral: 0.0,
            best: (f64::NAN, f64::NEG_INFINITY),
            evaluations: 0,
        };
        Walk::default().walk(span, f64::INFINITY, &mut one);
        one
    }

    #[test]
    fn means_and_tops_of_many_periods_are_those_of_the_formulas() {
        // Sixteen periods, such as those of a wheel rolling at constant speed within one step.
        let one = known([0.0, 10.0], |t| libm::sin(10.0 * t).powi(2));
        let mean = 0.5 - libm::sin(200.0) / 400.0;
        assert!(
            (one.integral / 10.0 - mean).abs() < 1e-9,
            "{}",
            one.integral
        );
        assert!((one.best.1 - 1.0).abs() < 1e-10, "{:?}", one.best);
        // 32 periods of the square, an eighth of one per piece.
        assert!(one.evaluations < 5000, "{}", one.evaluations);
        // A jump and a kink.
        let one = known([0.0, 1.0], |t| if t < 0.3 { 1.0 } else { 0.0 });
        assert!((one.integral - 0.3).abs() < 1e-7, "{}", one.integral);
        let one = known([-1.0, 1.0], |t| -(t - 0.2_f64).abs());
        assert!((one.integral + 1.04).abs() < 1e-7, "{}", one.integral);
        assert!(one.best.1 > -1e-7, "{:?}", one.best);
    }

    #[test]
    fn a_polynomial_takes_one_piece() {
        let one = known([1.0, 3.0], |t| 2.0 - (t - 1.37_f64).powi(2));
        assert_eq!(one.evaluations, 9);
        assert!((one.best.0 - 1.37).abs() < 1e-9 && (one.best.1 - 2.0).abs() < 1e-15);
        let exact = 4.0 - (1.63_f64.powi(3) + 0.37_f64.powi(3)) / 3.0;
        assert!((one.integral - exact).abs() < 1e-13);
    }
}

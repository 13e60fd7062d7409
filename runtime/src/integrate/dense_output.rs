//! Dense output: the solution between the ends of a step.

use crate::real::Enclosure;

/// Start and end of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ends<'a> {
    /// Times in s.
    pub(super) t: [f64; 2],
    /// States.
    pub(super) x: [&'a [f64]; 2],
    /// Their rates.
    pub(super) rates: [&'a [f64]; 2],
}

/// Coefficients of the cubic Hermite polynomial.
pub(super) const HERMITE: usize = 4;

/// A polynomial through both ends of the current step.
///
/// In θ, the fraction of the step, and θ̄ = 1 − θ, it reads c₀ + θ (c₁ + θ̄ (c₂ + θ (c₃ + θ̄ (…
/// (Hairer, Nørsett and Wanner, section II.6). Four coefficients are the cubic Hermite
/// polynomial, five belong to order 5 and eight to order 8(5,3).
#[derive(Debug, Clone, Default)]
pub struct DenseOutput {
    t_old: f64,
    h: f64,
    n: usize,
    /// Coefficients one after the other, `n` numbers each, lowest first.
    coefficients: Vec<f64>,
}

impl DenseOutput {
    /// The state at `t`, written to `x`, which has as many entries. Valid within the step; elsewhere the polynomial
    /// is extrapolated.
    pub fn state(&self, t: f64, x: &mut [f64]) {
        let factors = self.factors(t);
        let mut coefficients = self
            .coefficients
            .chunks_exact(self.n.max(1))
            .enumerate()
            .rev();
        if let Some((_, highest)) = coefficients.next() {
            for (x, highest) in x.iter_mut().zip(highest) {
                *x = *highest;
            }
        }
        for (c, coefficients) in coefficients {
            for (x, coefficient) in x.iter_mut().zip(coefficients) {
                *x = coefficient + factors[c % 2] * *x;
            }
        }
    }

    /// Component `i` of the state at `t`.
    ///
    /// # Panics
    ///
    /// If `i` is not below the number of states.
    pub fn component(&self, t: f64, i: usize) -> f64 {
        self.component_and_slope(t, i).0
    }

    /// Component `i` of the state at `t` and its derivative.
    pub(super) fn component_and_slope(&self, t: f64, i: usize) -> (f64, f64) {
        let factors = self.factors(t);
        let factor_slopes = [1.0 / self.h, -1.0 / self.h];
        let highest = self.coefficients.len() / self.n - 1;
        let (mut value, mut slope) = (self.coefficients[highest * self.n + i], 0.0);
        for c in (0..highest).rev() {
            slope = factor_slopes[c % 2] * value + factors[c % 2] * slope;
            value = self.coefficients[c * self.n + i] + factors[c % 2] * value;
        }
        (value, slope)
    }

    /// The factors in front of the coefficients after 0, 2, … and after 1, 3, …: θ and θ̄.
    fn factors(&self, t: f64) -> [f64; 2] {
        let theta = (t - self.t_old) / self.h;
        [theta, 1.0 - theta]
    }

    /// Number of states.
    pub(super) fn states(&self) -> usize {
        self.n
    }

    /// Bounds on the state between two times within the step, written to `x`.
    pub fn within(&self, [from, to]: [f64; 2], x: &mut Vec<Enclosure>) {
        let half = 0.5 * (to - from);
        let factors = self.factors(from + half);
        let turns = [half / self.h, -half / self.h];
        let orders = self.coefficients.len() / self.n.max(1);
        // In the distance from the midpoint, in units of half the interval.
        let mut polynomial = vec![0.0; orders];
        x.clear();
        for i in 0..self.n {
            polynomial.fill(0.0);
            for c in (0..orders).rev() {
                let (factor, turn) = (factors[c % 2], turns[c % 2]);
                let mut below = 0.0;
                for term in &mut polynomial[..orders - c] {
                    let own = *term;
                    *term = factor * own + turn * below;
                    below = own;
                }
                polynomial[0] += self.coefficients[c * self.n + i];
            }
            x.push(Enclosure::polynomial(&polynomial, half));
        }
    }

    /// Allocates the polynomial for `n` states and `count` coefficients.
    pub(super) fn prepare(&mut self, n: usize, count: usize) {
        self.n = n;
        self.coefficients.clear();
        self.coefficients.resize(n * count, 0.0);
    }

    /// Sets the interval and the four coefficients of the cubic Hermite polynomial, common to all methods.
    pub(super) fn set_hermite(&mut self, ends: &Ends<'_>) {
        let n = self.n;
        let Ends { t, x, rates } = ends;
        (self.t_old, self.h) = (t[0], t[1] - t[0]);
        for i in 0..n {
            let difference = x[1][i] - x[0][i];
            let bend = self.h * rates[0][i] - difference;
            self.coefficients[i] = x[0][i];
            self.coefficients[n + i] = difference;
            self.coefficients[2 * n + i] = bend;
            self.coefficients[3 * n + i] = difference - self.h * rates[1][i] - bend;
        }
    }

    /// Coefficient `c`, one number per state.
    pub(super) fn coefficient(&mut self, c: usize) -> &mut [f64] {
        &mut self.coefficients[c * self.n..][..self.n]
    }
}

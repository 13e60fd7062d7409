//! The solution between the ends of a step.

/// A polynomial through both ends of the current step.
///
/// In θ, the part of the step that has passed, and with θ̄ = 1 − θ, it reads c₀ + θ (c₁ + θ̄ (c₂ + θ (c₃ + θ̄ (…
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
    /// The state at `t`, written to `x`. Meant for times within the step; elsewhere the
    /// polynomial is extrapolated.
    pub fn state(&self, t: f64, x: &mut [f64]) {
        for (i, x) in x.iter_mut().enumerate().take(self.n) {
            *x = self.component(t, i);
        }
    }

    /// Component `i` of the state at `t`.
    ///
    /// # Panics
    ///
    /// If `i` is not below the number of states.
    #[inline]
    pub fn component(&self, t: f64, i: usize) -> f64 {
        let theta = (t - self.t_old) / self.h;
        let factors = [1.0 - theta, theta];
        let count = self.coefficients.len() / self.n;
        let mut value = self.coefficients[(count - 1) * self.n + i];
        for c in (0..count - 1).rev() {
            value = self.coefficients[c * self.n + i] + factors[(c + 1) % 2] * value;
        }
        value
    }

    /// Sizes the polynomial for `n` states and `count` coefficients.
    pub(super) fn prepare(&mut self, n: usize, count: usize) {
        self.n = n;
        self.coefficients.clear();
        self.coefficients.resize(n * count, 0.0);
    }

    /// Sets the interval and the four coefficients of the cubic Hermite polynomial, which every
    /// method starts from: the states and rates at both ends.
    pub(super) fn set_hermite(&mut self, t_old: f64, h: f64, x: [&[f64]; 2], rates: [&[f64]; 2]) {
        let n = self.n;
        (self.t_old, self.h) = (t_old, h);
        for i in 0..n {
            let difference = x[1][i] - x[0][i];
            let bend = h * rates[0][i] - difference;
            self.coefficients[i] = x[0][i];
            self.coefficients[n + i] = difference;
            self.coefficients[2 * n + i] = bend;
            self.coefficients[3 * n + i] = difference - h * rates[1][i] - bend;
        }
    }

    /// Sets coefficient `c` of component `i`.
    pub(super) fn set(&mut self, c: usize, i: usize, value: f64) {
        self.coefficients[c * self.n + i] = value;
    }
}

//! Sampled controllers with a delay.
//!
//! Between measurements the inputs are held (zero-order hold), and a command acts after a delay. In
//! the states at the measurements, extended by the pending commands, the system is linear and
//! discrete (K. J. Åström, B. Wittenmark, *Computer-Controlled Systems*, sections 2.3 and 3.2).

use nalgebra::{Complex, DMatrix};

use super::LinearSystem;
use super::lqr::{self, Regulator, RiccatiError};
use super::placement::{self, Placement, PlacementError};

/// Longest delay in sampling periods.
const MOST_PENDING: usize = 100;

/// Sampling period and delay of a controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    period: f64,
    delay: f64,
}

/// Why a sampling is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SamplingError {
    /// The period is not a positive time.
    #[error("the sampling period must be a positive number of seconds, not {0}")]
    Period(f64),
    /// The delay is negative or not finite.
    #[error("the delay must be a non-negative number of seconds, not {0}")]
    Delay(f64),
    /// The delay is too long.
    #[error("the delay of {delay} s exceeds {MOST_PENDING} sampling periods of {period} s")]
    Pending {
        /// The period in s.
        period: f64,
        /// The delay in s.
        delay: f64,
    },
}

impl Sampling {
    /// Measures each `period` in s, and acts `delay` in s later.
    pub fn new(period: f64, delay: f64) -> Result<Self, SamplingError> {
        let sampling = Self { period, delay };
        if !(period.is_finite() && period > 0.0) {
            Err(SamplingError::Period(period))
        } else if !(delay.is_finite() && delay >= 0.0) {
            Err(SamplingError::Delay(delay))
        } else if sampling.pending() > MOST_PENDING {
            Err(SamplingError::Pending { period, delay })
        } else {
            Ok(sampling)
        }
    }

    /// Time between two measurements, in s.
    pub fn period(self) -> f64 {
        self.period
    }

    /// Time from a measurement to the change of the input, in s.
    pub fn delay(self) -> f64 {
        self.delay
    }

    /// Number of pending commands at a measurement.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a count; values out of range saturate"
    )]
    pub fn pending(self) -> usize {
        // Rounding must not turn a delay of exactly three periods (0.3 s / 0.1 s) into four.
        (self.delay / self.period * (1.0 - 1e-12)).ceil() as usize
    }

    /// The pole of the sampled loop for a pole of the continuous one: e^{sT}.
    pub fn pole(self, continuous: Complex<f64>) -> Complex<f64> {
        (continuous * self.period).exp()
    }

    /// The equivalent pole in continuous time: ln z / T. None for z = 0, which decays in one
    /// period.
    pub fn continuous_pole(self, sampled: Complex<f64>) -> Option<Complex<f64>> {
        (sampled.norm() > 0.0).then(|| sampled.ln() / self.period)
    }

    /// The discrete system: states y at a measurement, then the pending commands, oldest first. Its
    /// inputs are the commands.
    #[must_use]
    pub fn discretise(self, system: &LinearSystem) -> LinearSystem {
        let (n, m, pending) = (system.order(), system.inputs(), self.pending());
        let size = n + m * pending;
        let (mut a, mut b) = (DMatrix::zeros(size, size), DMatrix::zeros(size, m));
        // The input changes once in a period, after this time.
        let change = (self.delay - self.period * (pending as f64 - 1.0)).clamp(0.0, self.period);
        if pending == 0 {
            let [phi, gamma] = held(system, self.period);
            return LinearSystem { a: phi, b: gamma };
        }
        let [_, before] = held(system, change);
        let [after, now] = held(system, self.period - change);
        let [phi, _] = held(system, self.period);
        a.view_mut((0, 0), (n, n)).copy_from(&phi);
        a.view_mut((0, n), (n, m)).copy_from(&(after * before));
        if pending == 1 {
            b.rows_mut(0, n).copy_from(&now);
        } else {
            a.view_mut((0, n + m), (n, m)).copy_from(&now);
        }
        for place in 1..pending {
            a.view_mut((n + (place - 1) * m, n + place * m), (m, m))
                .fill_with_identity();
        }
        b.rows_mut(n + (pending - 1) * m, m).fill_with_identity();
        LinearSystem { a, b }
    }

    /// Gains that give the sampled loop the poles e^{sT} for poles s of a continuous one, and the
    /// pole 0 for pending commands. The gains are for y and then for the pending commands.
    pub fn place(
        self,
        system: &LinearSystem,
        poles: &[Complex<f64>],
    ) -> Result<Placement, PlacementError> {
        if poles.len() != system.order() {
            return Err(PlacementError::Count {
                given: poles.len(),
                order: system.order(),
            });
        }
        let sampled = self.discretise(system);
        let mut poles: Vec<_> = poles.iter().map(|pole| self.pole(*pole)).collect();
        poles.resize(sampled.order(), 0.0.into());
        placement::place(&sampled, &poles)
    }

    /// Gains that minimise Σ (yᵀ Q y + uᵀ R u) T over the measurements; Q and R are of the order and
    /// the inputs of `system`.
    pub fn regulate(
        self,
        system: &LinearSystem,
        q: &DMatrix<f64>,
        r: &DMatrix<f64>,
    ) -> Result<Regulator, RiccatiError> {
        let n = system.order();
        let (found_rows, found_columns) = q.shape();
        if (found_rows, found_columns) != (n, n) {
            return Err(RiccatiError::Shape {
                what: "Q",
                rows: n,
                columns: n,
                found_rows,
                found_columns,
            });
        }
        let sampled = self.discretise(system);
        // Pending commands have no weight.
        let mut weight = DMatrix::zeros(sampled.order(), sampled.order());
        weight
            .view_mut((0, 0), (n, n))
            .copy_from(&(q * self.period));
        lqr::discrete(&sampled, &weight, &(r * self.period))
    }
}

/// e^{At} and ∫₀ᵗ e^{As} ds B, by one exponential (C. F. Van Loan, *Computing integrals involving the
/// matrix exponential*, IEEE Transactions on Automatic Control 23, 1978).
fn held(system: &LinearSystem, time: f64) -> [DMatrix<f64>; 2] {
    let (n, m) = (system.order(), system.inputs());
    let mut both = DMatrix::zeros(n + m, n + m);
    both.view_mut((0, 0), (n, n)).copy_from(&system.a);
    both.view_mut((0, n), (n, m)).copy_from(&system.b);
    let exponential = (both * time).exp();
    [
        exponential.view((0, 0), (n, n)).into_owned(),
        exponential.view((0, n), (n, m)).into_owned(),
    ]
}

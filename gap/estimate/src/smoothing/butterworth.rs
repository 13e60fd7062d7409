//! A Butterworth low-pass applied forwards and backwards, with zero phase.

use std::f64::consts::PI;

use super::samples::{Samples, SamplesError, positive, within};

/// Highest order.
pub const MOST_ORDER: usize = 8;
/// Relative deviation of steps from their mean, for rounded time stamps.
const UNEQUAL: f64 = 0.01;
/// Remainder of the transient at the beginning of the record.
const TRANSIENT: f64 = 1e-6;

/// A low-pass for equal steps, applied twice.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroPhase {
    sections: Vec<Section>,
    /// Length of the transient in samples.
    settling: usize,
}

impl ZeroPhase {
    /// Of an order, a frequency in Hz and a step in s. At the frequency the two passes together
    /// transmit half the power (D. A. Winter, 2009, section 3.4.4).
    pub fn new(order: usize, frequency: f64, step: f64) -> Result<Self, SamplesError> {
        let order = within("order", order, [1, MOST_ORDER])?;
        let step = positive("step", step)?;
        let frequency = positive("frequency", frequency)?;
        let n = order as f64;
        if frequency * step >= 0.5 {
            let (what, value) = ("distance to half the sampling rate", 0.5 / step - frequency);
            return Err(SamplesError::NotPositive { what, value });
        }
        // One pass transmits 1/(1 + r^2n) of the power; two passes half of it at r^2n = √2 − 1.
        let single = (PI * frequency * step).tan() / (2f64.sqrt() - 1.0).powf(0.5 / n);
        let pairs = order / 2;
        let mut sections: Vec<Section> = (0..pairs)
            .map(|k| Section::second(single, PI * (2 * k + 1) as f64 / (2.0 * n)))
            .collect();
        if order % 2 == 1 {
            sections.push(Section::first(single));
        }
        // The slowest pole decays with ω sin(π/2n).
        let decay = 2.0 * single.min(1.0) * (PI / (2.0 * n)).sin();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive number; a huge one becomes the largest"
        )]
        let settling = (-TRANSIENT.ln() / decay).ceil() as usize;
        Ok(Self { sections, settling })
    }

    /// The filter of an order and a frequency for the steps of a record, and the filtered values.
    pub fn filtered(
        order: usize,
        frequency: f64,
        samples: Samples<'_>,
    ) -> Result<Vec<f64>, SamplesError> {
        samples.at_least(2)?;
        if let Some(row) = samples.values().iter().position(|value| value.is_nan()) {
            return Err(SamplesError::Missing { row });
        }
        let mean = samples.mean_step();
        let steps = samples.times().windows(2).map(|pair| pair[1] - pair[0]);
        let [shortest, longest] = steps.fold([f64::INFINITY, 0.0], |[low, high], step: f64| {
            [low.min(step), high.max(step)]
        });
        if longest - mean > UNEQUAL * mean || mean - shortest > UNEQUAL * mean {
            return Err(SamplesError::NotUniform { shortest, longest });
        }
        Ok(Self::new(order, frequency, mean)?.apply(samples.values()))
    }

    /// The filtered values.
    ///
    /// The record is extended at both ends by point reflection, until the transient has decayed;
    /// there the filter starts in the steady state of the first value.
    pub fn apply(&self, values: &[f64]) -> Vec<f64> {
        let Some(last) = values.len().checked_sub(1) else {
            return Vec::new();
        };
        let beyond = self.settling.min(last);
        let before = (1..=beyond).rev().map(|i| 2.0 * values[0] - values[i]);
        let after = (1..=beyond).map(|i| 2.0 * values[last] - values[last - i]);
        let mut all: Vec<f64> = before.chain(values.iter().copied()).chain(after).collect();
        for _ in 0..2 {
            for section in &self.sections {
                section.pass(&mut all);
            }
            all.reverse();
        }
        all[beyond..=beyond + last].to_vec()
    }
}

/// (b₀ + b₁ z⁻¹ + b₂ z⁻²) / (1 + a₁ z⁻¹ + a₂ z⁻²), of unit static gain.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    /// The pole pair at an angle from the imaginary axis, by the bilinear transform; `k` is the tangent
    /// of half the angular frequency per step.
    fn second(k: f64, angle: f64) -> Self {
        let damping = 2.0 * angle.sin() * k;
        let scale = 1.0 / (1.0 + damping + k * k);
        let b = k * k * scale;
        Self {
            b: [b, 2.0 * b, b],
            a: [2.0 * (k * k - 1.0) * scale, (1.0 - damping + k * k) * scale],
        }
    }

    fn first(k: f64) -> Self {
        let b = k / (1.0 + k);
        Self {
            b: [b, b, 0.0],
            a: [(k - 1.0) / (k + 1.0), 0.0],
        }
    }

    /// In place, transposed direct form II, from the steady state of a constant.
    fn pass(&self, values: &mut [f64]) {
        let Some(&first) = values.first() else { return };
        let [b0, b1, b2] = self.b;
        let [a1, a2] = self.a;
        let mut s2 = (b2 - a2) * first;
        let mut s1 = (b1 - a1) * first + s2;
        for value in values {
            let x = *value;
            let y = b0 * x + s1;
            s1 = b1 * x - a1 * y + s2;
            s2 = b2 * x - a2 * y;
            *value = y;
        }
    }
}

//! Inputs that excite a mechanism: shapes between -1 and 1 over time.

use std::f64::consts::{PI, TAU};
use std::fmt;

/// The shape of an input over a time, from -1 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// Multisine of whole periods up to a frequency in Hz, of equal amplitudes, with phases for a
    /// low crest factor (M. R. Schroeder, 1970).
    Multisine(f64),
    /// Linear chirp up to this frequency in Hz.
    Chirp(f64),
    /// Pseudo-random binary sequence with this clock period in s.
    Steps(f64),
    /// A slow ramp up and down, so many times.
    Ramps(u32),
}

impl fmt::Display for Excitation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Multisine(highest) => write!(f, "multisine up to {highest:.2} Hz"),
            Self::Chirp(highest) => write!(f, "chirp up to {highest:.2} Hz"),
            Self::Steps(shortest) => write!(f, "random steps of {shortest:.2} s and more"),
            Self::Ramps(count) => write!(f, "{count} slow ramps up and down"),
        }
    }
}

impl Excitation {
    /// Suitable shapes for `duration` s with samples every `step` s.
    pub fn library(duration: f64, step: f64) -> Vec<Self> {
        // A period of fewer than ten samples is no longer a sine.
        let highest = 0.1 / step;
        let slowest = 2.0 / duration;
        let bands = [0.3, 1.0, 3.0, 10.0].map(|band: f64| band.min(highest).max(slowest));
        let mut shapes = vec![Self::Ramps(1), Self::Ramps(3)];
        for band in bands {
            for shape in [
                Self::Multisine(band),
                Self::Chirp(band),
                Self::Steps(0.5 / band),
            ] {
                if !shapes.contains(&shape) {
                    shapes.push(shape);
                }
            }
        }
        shapes
    }

    /// Values at the times `k·step` below `duration`, at most 1 in size.
    pub fn samples(self, duration: f64, step: f64) -> Vec<f64> {
        // A count of rows in memory.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let rows = (duration / step).round().max(1.0) as usize;
        let times = (0..rows).map(|row| row as f64 * step);
        let mut values: Vec<f64> = match self {
            Self::Multisine(highest) => times.map(|t| multisine(highest, duration, t)).collect(),
            Self::Chirp(highest) => times
                .map(|t| (PI * highest * t * t / duration).sin())
                .collect(),
            Self::Steps(shortest) => steps(rows, shortest / step),
            Self::Ramps(count) => times
                .map(|t| (TAU * f64::from(count) * t / duration).sin().asin() * 2.0 / PI)
                .collect(),
        };
        let most = values
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs()));
        for value in &mut values {
            *value /= most.max(f64::MIN_POSITIVE);
        }
        values
    }
}

fn multisine(highest: f64, duration: f64, t: f64) -> f64 {
    /// Sines beyond this add nothing that those before do not.
    const MOST: f64 = 200.0;
    let count = (highest * duration).floor().clamp(1.0, MOST);
    let mut sum = 0.0;
    let mut k = 1.0;
    while k <= count {
        sum += (TAU * k * t / duration - PI * k * (k - 1.0) / count).cos();
        k += 1.0;
    }
    sum
}

/// Up or down by the bits of a shift register of maximal length, 2¹⁵ − 1.
fn steps(rows: usize, length: f64) -> Vec<f64> {
    let mut register = 0b101_0101_1001_0011_u32;
    // A count of rows in memory.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let length = length.round().max(1.0) as usize;
    let mut values = Vec::with_capacity(rows);
    while values.len() < rows {
        let bit = (register ^ (register >> 1)) & 1;
        register = (register >> 1) | (bit << 14);
        let level = if register & 1 == 1 { 1.0 } else { -1.0 };
        values.extend(std::iter::repeat_n(level, length));
    }
    values.truncate(rows);
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_fills_its_time_between_its_limits() {
        for shape in Excitation::library(10.0, 0.01) {
            let values = shape.samples(10.0, 0.01);
            assert_eq!(values.len(), 1000, "{shape}");
            let most = values
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!((most - 1.0).abs() < 1e-12, "{shape}: {most}");
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(low < -0.4, "{shape} goes one way only: {low}");
        }
    }

    #[test]
    fn steps_last_as_long_as_they_should_and_are_up_and_down() {
        let values = Excitation::Steps(0.1).samples(100.0, 0.01);
        for part in values.chunks(10) {
            assert!(part.iter().all(|value| value.total_cmp(&part[0]).is_eq()));
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!(mean.abs() < 0.1, "{mean}");
    }
}

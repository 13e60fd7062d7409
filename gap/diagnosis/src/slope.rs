//! Rates from samples: slopes of the parabolas through neighbouring ones.

use appell_estimate::smoothing::savitzky_golay::weights;

/// Samples of a parabola.
pub(crate) const WINDOW: usize = 15;

/// The slope of a parabola through samples.
pub(crate) struct Slope {
    pub(crate) value: f64,
    /// Its standard deviation for samples of standard deviation 1.
    pub(crate) deviation: f64,
}

impl Slope {
    /// At a time, by least squares; `None` if the samples do not determine a parabola.
    pub(crate) fn at(t: f64, times: &[f64], values: impl Iterator<Item = f64>) -> Option<Self> {
        let weights = weights(times, t, 2, 1)?;
        Some(Self {
            value: weights.iter().zip(values).map(|(w, y)| w * y).sum(),
            deviation: weights.iter().map(|w| w * w).sum::<f64>().sqrt(),
        })
    }
}

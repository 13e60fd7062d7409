//! Deterministic, evenly distributed points.

use appell_runtime::model::Quantity;

/// Half the width of the range of a quantity; 1 in SI without a range.
pub(crate) fn reach(quantity: &Quantity) -> f64 {
    let [low, high] = quantity.range;
    let half = 0.5 * (high - low);
    if half.is_finite() && half > 0.0 {
        half
    } else {
        1.0
    }
}

/// Largest distance of starting points for a quantity without a range, in units of its reach.
const AWAY: f64 = 10.0;

/// A low-discrepancy sequence in the unit cube: fractional parts of multiples of powers of a
/// generalised golden ratio (M. Roberts, 2018).
#[derive(Debug, Clone)]
pub(crate) struct Spread {
    steps: Vec<f64>,
    count: u32,
}

impl Spread {
    pub(crate) fn new(dimensions: usize) -> Self {
        // g^(d+1) = g + 1.
        let mut golden: f64 = 1.5;
        for _ in 0..60 {
            golden = (1.0 + golden).powf(1.0 / (dimensions as f64 + 1.0));
        }
        let mut steps = Vec::with_capacity(dimensions);
        let mut step = 1.0;
        for _ in 0..dimensions {
            step /= golden;
            steps.push(step);
        }
        Self { steps, count: 0 }
    }

    /// The next point.
    pub(crate) fn next(&mut self) -> Vec<f64> {
        self.count += 1;
        let at = |step: &f64| (0.5 + step * f64::from(self.count)).fract();
        self.steps.iter().map(at).collect()
    }
}

/// A value of a quantity for a number between 0 and 1: inside its range, or distributed around
/// `centre`.
pub(crate) fn value_at(quantity: &Quantity, centre: f64, part: f64) -> f64 {
    let [low, high] = quantity.range;
    if low.is_finite() && high.is_finite() {
        return low + part * (high - low);
    }
    let away = 2.0 * part - 1.0;
    let value = centre + AWAY * reach(quantity) * away * away.abs();
    value.clamp(low, high)
}

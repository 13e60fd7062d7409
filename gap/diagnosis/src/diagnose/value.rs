//! Estimates with their intervals.

use serde::Serialize;

use super::yardstick::Yardstick;

/// The 97.5 % quantile of the normal distribution: half of a 95 % interval in standard deviations.
pub const QUANTILE: f64 = 1.959_964;

/// An estimate.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Value {
    /// Effect and parameter.
    pub name: String,
    /// Most likely value.
    pub value: f64,
    /// Standard deviation; NaN if it is undefined, as at a limit, or where sensitivities diverge and there is no prior.
    pub std: f64,
    /// Unit.
    pub unit: String,
    /// Value without the effect; `None` for a shape, which then has no meaning.
    pub without: Option<f64>,
    /// Whether the recordings determine it: the 95 % interval of a size does not reach the value without the effect, and
    /// that of a shape is less than half of the prior one.
    #[serde(rename = "determined")]
    pub is_determined: bool,
    /// Its size relative to a known quantity, where there is one.
    pub yardstick: Option<Yardstick>,
}

impl Value {
    /// Of a size, which has this value without the effect.
    pub(super) fn of_size(mut self, without: f64) -> Self {
        self.without = Some(without);
        let interval = QUANTILE * self.std;
        // At a limit there is no interval.
        self.is_determined = self.std.is_nan() || (self.value - without).abs() > interval;
        self
    }
}

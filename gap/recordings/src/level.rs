//! Noise level of a channel.

/// The noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation in SI.
    pub std: f64,
    /// Its source.
    pub source: NoiseSource,
    /// Estimate from the data alone, in SI.
    pub found: Option<f64>,
    /// Resolution of the sensor in SI.
    pub quantum: Option<f64>,
}

/// Source of a noise level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseSource {
    /// The description, confirmed or not contradicted by the data.
    Stated,
    /// Differences of neighbouring samples.
    Differences,
    /// Samples at rest.
    Standstill,
    /// The resolution of the sensor.
    Quantisation,
}

impl NoiseSource {
    /// Its identifier in JSON.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Stated => "stated",
            Self::Differences => "differences",
            Self::Standstill => "standstill",
            Self::Quantisation => "quantisation",
        }
    }
}

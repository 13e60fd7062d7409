//! How noisy a channel is.

/// The noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation in SI.
    pub std: f64,
    /// Where it is from.
    pub source: NoiseSource,
    /// What the data alone tell, in SI.
    pub found: Option<f64>,
    /// Step of the sensor in SI.
    pub quantum: Option<f64>,
}

/// Where a noise level is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseSource {
    /// The description; the data do not tell better.
    Stated,
    /// Differences of neighbouring samples.
    Differences,
    /// Samples at rest.
    Standstill,
    /// The step of the sensor.
    Quantisation,
}

impl NoiseSource {
    /// Its word for programs.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Stated => "stated",
            Self::Differences => "differences",
            Self::Standstill => "standstill",
            Self::Quantisation => "quantisation",
        }
    }
}

//! Tolerances and limits of an integration.

use super::error::IntegrationError;

/// Accuracy and limits of an adaptive integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Relative tolerance per step, for each state.
    pub rtol: f64,
    /// Absolute tolerance per step, in SI.
    pub atol: f64,
    /// First step in s; chosen from the rates if absent.
    pub first_step: Option<f64>,
    /// Longest step in s. The last step before a switching time or the end may be 1 % longer.
    pub max_step: f64,
    /// Maximum number of accepted and rejected steps.
    pub max_steps: usize,
}

impl Default for Options {
    /// Tolerances 1e-11, a million steps. At order 8 a 60 times smaller error costs two thirds more evaluations: on a
    /// rattleback 5e-8 after 20 s, against 3e-6 with tolerances 1e-9.
    fn default() -> Self {
        Self {
            rtol: 1e-11,
            atol: 1e-11,
            first_step: None,
            max_step: f64::INFINITY,
            max_steps: 1_000_000,
        }
    }
}

impl Options {
    /// The default limits with other tolerances.
    pub fn with_tolerances(rtol: f64, atol: f64) -> Self {
        Self {
            rtol,
            atol,
            ..Self::default()
        }
    }

    /// The error scale of a state of this magnitude; never zero, so that a state that stays zero has no error even
    /// without `atol`.
    // Inlined into loops over lanes.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    pub(super) fn scale(&self, size: f64) -> f64 {
        (self.atol + self.rtol * size).max(f64::MIN_POSITIVE)
    }

    pub(super) fn check(&self, span: [f64; 2]) -> Result<(), IntegrationError> {
        let invalid = |what, value| Err(IntegrationError::InvalidArgument { what, value });
        if self.rtol.is_nan() || self.rtol < 0.0 {
            return invalid("rtol", self.rtol);
        }
        if self.atol.is_nan() || self.atol < 0.0 || self.atol + self.rtol == 0.0 {
            return invalid("atol", self.atol);
        }
        if self.max_step.is_nan() || self.max_step <= 0.0 {
            return invalid("max_step", self.max_step);
        }
        if let Some(h) = self.first_step.filter(|h| h.is_nan() || *h <= 0.0) {
            return invalid("first_step", h);
        }
        check_span(span)
    }
}

pub(super) fn check_span([start, end]: [f64; 2]) -> Result<(), IntegrationError> {
    if !start.is_finite() {
        return Err(IntegrationError::InvalidArgument {
            what: "start of the interval",
            value: start,
        });
    }
    if !end.is_finite() || end < start {
        return Err(IntegrationError::InvalidArgument {
            what: "end of the interval",
            value: end,
        });
    }
    Ok(())
}

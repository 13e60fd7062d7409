//! Options of a diagnosis.

use appell_recordings::Spec;

use super::report::Limit;

/// Options of a diagnosis.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Whether to include the data of the plots: traces, and the missing force over its variable.
    pub pictures: bool,
    /// Limits of the next experiment; by default it stays near the recorded ranges.
    pub limits: Vec<Limit>,
    /// Other specs of the same rig, each a hypothesis of its own.
    pub alternatives: Vec<Spec>,
    /// Horizon in s at which the gap is reported; by default 1 s, limited by the length of the runs.
    pub horizon: Option<f64>,
    /// Share of the gap of the re-fitted model below which an effect is not reported as a cause; by default 0.02.
    pub tolerance: Option<f64>,
    /// Names of effects that the spec contains already, which are no hypotheses.
    pub present: Vec<String>,
}

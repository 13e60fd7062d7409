//! What a diagnosis is asked for.

use appell_recordings::Spec;

use super::report::Limit;

/// What is asked for beside the report.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Traces, and the missing force over what it depends on.
    pub pictures: bool,
    /// Within which the next experiment has to stay; elsewhere it stays near what is recorded.
    pub limits: Vec<Limit>,
    /// Other specs of the same thing, each a hypothesis of its own.
    pub alternatives: Vec<Spec>,
    /// Horizon in s at which the gap is reported; by default 1 s, or what the runs allow.
    pub horizon: Option<f64>,
    /// Part of what re-fitted parameters leave of the gap below which an effect names no cause; by default 0.02.
    pub tolerance: Option<f64>,
    /// Names of effects that the spec has already, and that are no hypotheses.
    pub present: Vec<String>,
}

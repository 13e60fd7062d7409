//! Options of an identification.

/// Largest integration step in s for models without fast modes.
const LONGEST_STEP: f64 = 0.02;

/// Where the search for parameters begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Begin {
    /// At the values of the rig.
    #[default]
    Nominal,
    /// At the result of multiple shooting from these, for values far from the truth.
    Shooting,
}

/// Options of an identification.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Parameters to estimate; `None` for those with a tolerance in the data set.
    pub free: Option<Vec<String>>,
    /// Further quantities to estimate: `tau.lag` and `tau.delay` of inputs; `theta.bias`, `theta.scale` and
    /// `theta.delay` of channels.
    pub additional: Vec<String>,
    /// Drifting parameters, with the standard deviations of their changes in one second, in their
    /// units.
    pub drifting: Vec<(String, f64)>,
    /// Whether a problem without free parameters is accepted.
    pub allow_none: bool,
    /// Where the search begins.
    pub begin: Begin,
    /// Whether a search may end before an optimum, where the likelihood is rough as with sticking friction.
    pub rough: bool,
}

impl Options {
    /// All parameters with a tolerance, if there are any.
    pub(crate) fn tolerant() -> Self {
        Self {
            allow_none: true,
            ..Self::default()
        }
    }
}

/// The largest integration step in s, given that of the model.
pub(crate) fn longest_step(borne: Option<f64>) -> f64 {
    borne.map_or(LONGEST_STEP, |borne| borne.min(LONGEST_STEP))
}

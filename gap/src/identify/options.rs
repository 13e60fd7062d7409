//! What is identified, from where, and in steps of which length.

/// Steps of the integration are this long in s at most, where the equations are not fast.
const LONGEST_STEP: f64 = 0.02;

/// Where the search for parameters begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Begin {
    /// At the values of the rig.
    #[default]
    Nominal,
    /// Where multiple shooting ends that begins there: for values far from the truth.
    Shooting,
}

/// What is identified.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Parameters to look for; nothing means those that the data set states a tolerance for.
    pub free: Option<Vec<String>>,
    /// Further quantities to estimate: `tau.lag` and `tau.delay` of inputs; `theta.bias`, `theta.scale` and
    /// `theta.delay` of channels.
    pub additional: Vec<String>,
    /// Parameters that change on the way, with the standard deviations of their changes in one second,
    /// in their units.
    pub drifting: Vec<(String, f64)>,
    /// Whether no free parameter at all is accepted.
    pub allow_none: bool,
    /// Where the search begins.
    pub begin: Begin,
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

/// The longest step in s of the integration, where equations bear no longer one than this.
pub(crate) fn longest_step(borne: Option<f64>) -> f64 {
    borne.map_or(LONGEST_STEP, |borne| borne.min(LONGEST_STEP))
}

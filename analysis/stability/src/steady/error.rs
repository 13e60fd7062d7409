//! Why steady motions could not be computed.

use super::cyclic::StructureError;
use crate::term::Term;

/// Why steady motions could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SteadyError {
    /// The model has none.
    #[error(transparent)]
    Structure(#[from] StructureError),
    /// A term that the model does not have.
    #[error("the model has no quantity {0:?}")]
    Unknown(Term),
    /// An ignorable state has no value in a steady motion.
    #[error(
        "`{0}` is ignorable: the motion does not depend on its value; prescribe its rate, `{0}_dot`"
    )]
    Ignorable(String),
    /// A component of a quaternion that turns.
    #[error(
        "`{name}` is not constant in a steady motion, as its quaternion turns; prescribe {instead}, or declare an \
         output that the turning does not change, such as a tilt"
    )]
    Turns {
        /// The component.
        name: String,
        /// Quantities that can be prescribed.
        instead: String,
    },
    /// A rate or output that changes along the motion.
    #[error(
        "`{name}` is not constant in a steady motion, as it depends on ignorable states; prescribe {instead}"
    )]
    NotConstant {
        /// The quantity.
        name: String,
        /// Quantities that can be prescribed.
        instead: String,
    },
    /// The rate of an essential state.
    #[error("`{0}` is zero in every steady motion and cannot be prescribed")]
    Zero(String),
    /// Only inputs and parameters can be left free.
    #[error("`{name}` cannot be left free: {reason}")]
    NotFree {
        /// The quantity.
        name: String,
        /// Why.
        reason: &'static str,
    },
    /// No steady motion was found.
    #[error(
        "no steady motion was found that satisfies the conditions: the best of {starts} starting points leaves {}; {}{}",
        list(.left), if *.conditions { "release one of the conditions or free an input" } else { "free an input" },
        if *.turning { PERIODIC } else { "" }
    )]
    None {
        /// Number of starting points.
        starts: usize,
        /// Equations that do not hold there, with their residuals in SI.
        left: Vec<(String, f64)>,
        /// Whether there are conditions that could be released.
        conditions: bool,
        /// Whether there are quaternions.
        turning: bool,
    },
    /// All steady motions that were found lie outside of declared ranges.
    #[error(
        "the steady motions that were found lie outside of declared ranges: {}; widen the range, or ignore the ranges",
        .outside.join(", ")
    )]
    OutOfRange {
        /// Quantities outside of their ranges, with the ranges.
        outside: Vec<String>,
    },
    /// The conditions determine a family of motions.
    #[error(
        "the conditions leave a family of {dimension} {}; prescribe {dimension} more of {}",
        if *.dimension == 1 { "dimension" } else { "dimensions" }, .open.join(", ")
    )]
    Family {
        /// Its dimension.
        dimension: usize,
        /// Quantities that vary within it.
        open: Vec<String>,
    },
}

/// Hint for models whose attitudes are quaternions.
const PERIODIC: &str = "; pseudo-velocities along a body that spins while its axis goes around are periodic, not \
                        steady: take them along a frame that does not spin, with an angle for the spin";

fn list(left: &[(String, f64)]) -> String {
    let residual = |(name, value): &(String, f64)| format!("{name} = {value:.3e}");
    left.iter().map(residual).collect::<Vec<_>>().join(", ")
}

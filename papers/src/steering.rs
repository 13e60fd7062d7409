//! The equations of *Steering Control of an Autonomous Unicycle* (Vizi, Orosz, Takács, Stépán) that
//! are formulas, corrected by the errata, and its tables of gains.
//!
//! Letters: `th`, `psi`, `phi` for the angles, `w1` … for the pseudo-velocities, `s` for σ, `Pd`
//! and `Fd` for the steady yaw and pitch rate, a trailing `d` for a rate. Steady values are those
//! with w1 = s = 0; `c1`, `c2`, … are the coefficients of the characteristic polynomial.

use std::sync::LazyLock;

pub use crate::equations::Equation;
pub use crate::gains::{GAINS, Gains, MISPRINT, OUTPUTS};

/// The equations in the order of the paper.
pub static EQUATIONS: LazyLock<Vec<Equation>> =
    LazyLock::new(|| Equation::read(include_str!("steering.toml")));

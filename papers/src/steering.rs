//! The equations of *Steering Control of an Autonomous Unicycle* (Vizi, Orosz, Takács, Stépán) that
//! are formulas, corrected by the errata, and its tables of gains.
//!
//! Letters: `th`, `psi`, `phi` for the angles, `w1` … for the pseudo-velocities, `s` for σ, `Pd`
//! and `Fd` for the steady yaw and pitch rate, a trailing `d` for a rate. Steady values are those
//! with w1 = s = 0; `c1`, `c2`, … are the coefficients of the characteristic polynomial.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::equations::items;

pub use crate::equations::Equation;

/// The equations in the order of the paper.
pub static EQUATIONS: LazyLock<Vec<Equation>> =
    LazyLock::new(|| items(include_str!("steering.toml")).unwrap());

/// A column of table II or III.
#[derive(Debug, Deserialize)]
pub struct Gains {
    /// The table.
    pub table: String,
    /// Forward velocity in m/s.
    pub speed: f64,
    /// Gains as printed, in the order of [`OUTPUTS`]; the turn of table III leaves the last one out.
    pub printed: Vec<String>,
}

impl Gains {
    /// The gains with the misprint corrected.
    pub fn mended(&self) -> impl Iterator<Item = f64> {
        let [misprint, right] = MISPRINT;
        self.printed.iter().map(move |printed| {
            let digits = if printed == misprint { right } else { printed };
            digits.parse().unwrap_or(f64::NAN)
        })
    }
}

/// The outputs of the gains.
pub const OUTPUTS: [&str; 6] = ["omega_1", "theta", "sigma", "r", "psi", "y_G"];

/// The misprinted gain and its correction: two digits are swapped.
pub const MISPRINT: [&str; 2] = ["536.67", "563.67"];

/// The columns of both tables.
pub static GAINS: LazyLock<Vec<Gains>> =
    LazyLock::new(|| items(include_str!("gains.toml")).unwrap());

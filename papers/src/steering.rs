//! The equations of *Steering Control of an Autonomous Unicycle* (Vizi, Orosz, Takács, Stépán) that
//! are formulas, corrected by the errata. Each is compared with the derivation as a function, not
//! at points.
//!
//! Letters: `th`, `psi`, `phi` for the angles, `w1` … for the pseudo-velocities, `s` for σ, `Pd`
//! and `Fd` for the steady yaw and pitch rate, a trailing `d` for a rate. Steady values are those
//! with w1 = s = 0; `c1`, `c2`, … are the coefficients of the characteristic polynomial.

use crate::errata::Subject;

mod gains;
mod table;

pub use gains::{GAINS, Gains, MISPRINT, OUTPUTS};
pub use table::EQUATIONS;

/// A numbered equation.
#[derive(Debug)]
pub struct Equation {
    /// Its number or numbers in the paper.
    pub number: &'static str,
    /// Its content.
    pub about: &'static str,
    /// The compared formulas.
    pub claims: &'static [Identity],
}

/// Formulas of one mechanism, each identical to a derived one.
#[derive(Debug)]
pub struct Identity {
    /// The mechanism.
    pub subject: Subject,
    /// Symbols with given values.
    pub at: &'static [(&'static str, &'static str)],
    /// The formulas.
    pub formulas: Formulas,
}

/// Kind of comparison.
#[derive(Debug)]
pub enum Formulas {
    /// Lines `derived = formula`.
    Lines(&'static str),
    /// Entries of matrices; entries that are not listed are zero.
    Matrix(&'static str),
    /// The acceleration energy, up to terms without accelerations.
    Energy(&'static str),
}

impl Formulas {
    /// Literally.
    pub const fn text(&self) -> &'static str {
        match self {
            Self::Lines(text) | Self::Matrix(text) | Self::Energy(text) => text,
        }
    }
}

impl Equation {
    /// The equation of a number.
    pub fn find(number: &str) -> Option<&'static Self> {
        EQUATIONS.iter().find(|equation| equation.number == number)
    }

    /// Differences from the derivation; empty if the equation holds.
    pub fn differences(&self) -> Vec<String> {
        self.claims.iter().flat_map(Identity::differences).collect()
    }
}

impl Identity {
    fn differences(&self) -> Vec<String> {
        let mut paper = self.subject.paper();
        match self.formulas {
            Formulas::Lines(lines) => paper.differences(lines, self.at),
            Formulas::Matrix(lines) => paper.matrix_differences(lines, self.at),
            Formulas::Energy(text) if paper.has_acceleration_energy(text) => Vec::new(),
            Formulas::Energy(text) => vec![format!("S is not {text}")],
        }
    }
}

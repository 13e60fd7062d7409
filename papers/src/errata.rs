//! Errata of the papers. `docs/errata.md` is generated from this table.

use std::fmt::Write as _;

use crate::paper::{self, Paper};

mod table;

pub use table::ERRATA;

/// Acceleration energy (89) of the steering paper, corrected.
pub const ACCELERATION_ENERGY: &str = "1/8*(5*m*R**2 + 4*m0*(R**2 + r**2))*w1d**2 + 1/4*(3*m + 2*m0)*R**2*w2d**2 \
     + 1/8*(m*R**2 + 4*m0*r**2)*w3d**2 + m0/2*sd**2 - m0*R*w1d*sd - m0*R*r*w2d*w3d \
     + 1/4*(8*w1*s*m0*r + w3**2*(4*m0*r**2*tan(th) + 4*m0*R*r + m*R**2*tan(th)) \
         - w2*w3*(6*m*R**2 + 4*m0*R**2 + 4*m0*R*r*tan(th)))*w1d \
     + (w1*w3*(m*R**2 + m0*R**2 + m0*R*r*tan(th)) - 2*w3*s*m0*R)*w2d \
     + 1/4*(2*w1*w2*m*R**2 - w1*w3*(m*R**2 + 4*m0*r**2)*tan(th) - 4*w1*w3*m0*R*r + 8*w3*s*m0*r)*w3d \
     - m0*(w1**2*r - w2*w3*R + w3**2*r)*sd";

/// An erratum: a difference between a paper and the correct equation.
#[derive(Debug)]
pub struct Erratum {
    /// The paper.
    pub source: Source,
    /// Number of the equation, or position in the text.
    pub equation: &'static str,
    /// The printed text.
    pub printed: &'static str,
    /// The correct text.
    pub right: &'static str,
    /// Origin of the error.
    pub origin: ErratumOrigin,
    /// Evidence.
    pub evidence: Evidence,
}

/// A paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// *Steering Control of an Autonomous Unicycle*.
    Steering,
    /// *Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle
    /// with a Human Rider*.
    Euc,
}

/// Origin of an erratum. The papers were read by text recognition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErratumOrigin {
    /// An error of the text recognition, evident from the context.
    Recognition,
    /// An error or over-claim of the paper.
    Misprint,
    /// An error of the text recognition or a misprint.
    Undecided,
}

impl ErratumOrigin {
    /// For people.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Recognition => "text recognition",
            Self::Misprint => "misprint or over-claim",
            Self::Undecided => "undecided",
        }
    }
}

/// Evidence of an erratum.
#[derive(Debug)]
pub enum Evidence {
    /// A formula is compared with a derived quantity, by the test of this name.
    Test(&'static str, Comparison),
    /// Evident from the context; there is no formula to compare.
    Context(&'static str),
}

/// A quantity as printed and as corrected.
#[derive(Debug)]
pub struct Comparison {
    /// The mechanism it belongs to.
    pub subject: Subject,
    /// The quantity: the name of a derived one, or a formula in derived quantities.
    pub quantity: Quantity,
    /// The printed formula.
    pub printed: &'static str,
    /// The correct formula.
    pub right: &'static str,
}

/// The model of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The rolling wheel.
    Wheel,
    /// The unicycle.
    Unicycle,
    /// The unicycle in straight rolling: no tilt, no yaw rate, centred mass.
    StraightUnicycle,
    /// The EUC with three degrees of freedom.
    Euc3,
    /// The EUC with two.
    Euc2,
}

impl Subject {
    /// The derivation to which its formulas are compared.
    pub fn paper(self) -> std::sync::MutexGuard<'static, Paper> {
        match self {
            Self::Wheel => paper::rolling_wheel(),
            Self::Unicycle | Self::StraightUnicycle => paper::unicycle(),
            Self::Euc3 => paper::euc_3dof(),
            Self::Euc2 => paper::euc_2dof(),
        }
    }

    /// The shipped mechanism.
    pub const fn mechanism(self) -> &'static str {
        match self {
            Self::Wheel => "rolling_wheel",
            Self::Unicycle | Self::StraightUnicycle => "unicycle",
            Self::Euc3 => "euc_3dof",
            Self::Euc2 => "euc_2dof",
        }
    }
}

/// The quantity to which a formula is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The derived quantity of this name.
    Derived(&'static str),
    /// The derived quantity up to terms without pseudo-accelerations.
    AccelerationEnergy,
    /// The derived quantity vanishes where the input has the value of the formula.
    Solves {
        /// The derived quantity.
        residual: &'static str,
        /// The input.
        unknown: &'static str,
        /// Further substitutions.
        before: &'static [(&'static str, &'static str)],
    },
    /// A formula in derived quantities.
    Formula(&'static str),
}

impl Comparison {
    /// Whether the printed and the correct formula agree with the derivation.
    pub fn verdicts(&self) -> [bool; 2] {
        let mut paper = self.subject.paper();
        let before = paper.scope.clone();
        // Derived quantities may occur in the formulas; symbols keep their names.
        for name in paper.derived_names() {
            if paper.scope.get(&name).is_none() {
                let value = paper.derived(&name);
                paper.scope.define(&name, value);
            }
        }
        let verdicts = [self.printed, self.right].map(|text| self.holds(&mut paper, text));
        paper.scope = before;
        verdicts
    }

    fn holds(&self, paper: &mut Paper, text: &str) -> bool {
        let typed = paper.formula(text);
        match self.quantity {
            Quantity::Derived(name) => {
                let mut derived = paper.derived(name);
                if self.subject == Subject::StraightUnicycle {
                    let mut straight =
                        paper.substitution(&[("th", "0"), ("r", "0"), ("Pd", "0"), ("psi", "0")]);
                    derived = straight
                        .apply(&mut paper.derivation.algebra.graph, derived)
                        .unwrap();
                }
                paper.same(derived, typed)
            }
            Quantity::AccelerationEnergy => paper.has_acceleration_energy(text),
            Quantity::Solves {
                residual,
                unknown,
                before,
            } => {
                let mut first = paper.substitution(before);
                let residual = paper.formula(residual);
                let residual = first
                    .apply(&mut paper.derivation.algebra.graph, residual)
                    .unwrap();
                let mut second = paper.substitution(&[(unknown, text)]);
                let value = second
                    .apply(&mut paper.derivation.algebra.graph, residual)
                    .unwrap();
                let zero = paper.formula("0");
                paper.same(value, zero)
            }
            Quantity::Formula(formula) => {
                let derived = paper.formula(formula);
                paper.same(derived, typed)
            }
        }
    }
}

/// Runs the comparison of a test.
///
/// # Panics
///
/// If the correct formula does not hold, or the printed one does.
pub fn check(test: &str) {
    let mut found = 0;
    for erratum in ERRATA {
        let Evidence::Test(name, comparison) = &erratum.evidence else {
            continue;
        };
        if *name == test {
            let [printed, right] = comparison.verdicts();
            assert!(
                right,
                "{}: the corrected formula is not the derived one",
                erratum.equation
            );
            assert!(
                !printed,
                "{}: the printed formula is the derived one, no erratum",
                erratum.equation
            );
            found += 1;
        }
    }
    assert!(found > 0, "no erratum names the test `{test}`");
}

/// The table as a page.
pub fn markdown() -> String {
    let mut page = String::from(
        "# Errata of the papers\n\n\
         Passages in which a paper differs from the equations of its mechanism. The papers were read \
         as\nrecognised text, so a garbled formula is not always the authors'. This page is \
         written by\n`tests/tests/errata.rs` from `papers/src/errata/table.rs`: a row with a test is \
         shown by the identity\ntest, which compares functions and not numbers. The printed form \
         fails it, the right one passes.\n",
    );
    for (source, title) in [
        (
            Source::Steering,
            "Steering Control of an Autonomous Unicycle",
        ),
        (
            Source::Euc,
            "Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle with a Human Rider",
        ),
    ] {
        // Writing to a string cannot fail.
        let _ = write!(
            page,
            "\n## {title}\n\n| place | printed | right | cause | evidence |\n|---|---|---|---|---|\n"
        );
        for e in ERRATA.iter().filter(|e| e.source == source) {
            let evidence = match &e.evidence {
                Evidence::Test(name, _) => format!("test `{name}`"),
                Evidence::Context(words) => (*words).to_owned(),
            };
            let _ = writeln!(
                page,
                "| {} | {} | {} | {} | {evidence} |",
                e.equation,
                e.printed,
                e.right,
                e.origin.words()
            );
        }
    }
    page
}

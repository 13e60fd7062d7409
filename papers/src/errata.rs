//! Errata of the papers. `docs/errata.md` is generated from `errata.toml`.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::equations::items;
use crate::paper::Subject;

/// All errata, in the order of the papers.
pub static ERRATA: LazyLock<Vec<Erratum>> =
    LazyLock::new(|| items(include_str!("errata.toml")).unwrap());

/// An erratum: a difference between a paper and the correct equation.
#[derive(Debug, Deserialize)]
pub struct Erratum {
    /// The paper.
    pub source: Source,
    /// Number of the equation, or position in the text.
    pub equation: String,
    /// The printed text.
    pub printed: String,
    /// The correct text.
    pub right: String,
    /// Origin of the error.
    pub origin: ErratumOrigin,
    /// Evidence.
    #[serde(flatten)]
    pub evidence: Evidence,
}

/// A paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// *Steering Control of an Autonomous Unicycle*.
    Steering,
    /// *Experimental Model Identification of the Longitudinal Dynamics of an Electric Unicycle
    /// with a Human Rider*.
    Euc,
}

/// Origin of an erratum. The papers were read by text recognition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
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
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub enum Evidence {
    /// A formula is compared with a derived quantity.
    Test {
        /// The test of this name compares them.
        test: String,
        /// The formulas.
        comparison: Comparison,
    },
    /// There is no formula to compare.
    Context {
        /// The context from which it is evident.
        context: String,
    },
}

/// A quantity as printed and as corrected.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// The mechanism it belongs to.
    of: Subject,
    /// The quantity, as a formula in derived ones. The acceleration energy `S` is compared up to
    /// terms without pseudo-accelerations.
    quantity: String,
    /// The quantity vanishes where this input has the value of the formula; without an unknown, it
    /// is the formula.
    unknown: Option<String>,
    /// Replacements of symbols.
    #[serde(default)]
    at: Vec<(String, String)>,
    /// The printed formula.
    printed: String,
    /// The correct formula.
    right: String,
}

impl Comparison {
    /// Whether the printed and the correct formula agree with the derivation.
    pub fn verdicts(&self) -> [bool; 2] {
        [&self.printed, &self.right].map(|text| self.holds(text))
    }

    fn holds(&self, text: &str) -> bool {
        let (mut paper, quantity) = (self.of.paper(), &self.quantity);
        if quantity == "S" {
            return paper.has_acceleration_energy(text);
        }
        let mut at = self.at.clone();
        let line = match &self.unknown {
            Some(unknown) => {
                at.push((unknown.clone(), text.to_owned()));
                format!("{quantity} = 0")
            }
            None => format!("{quantity} = {text}"),
        };
        paper.differences(&line, &at).is_empty()
    }
}

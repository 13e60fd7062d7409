//! Numbered equations of the papers that are formulas, each compared with the derivation as a
//! function, not at points.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::paper::Subject;

/// The items of a file, which is one list of tables.
pub(crate) fn items<T: DeserializeOwned>(file: &str) -> Result<Vec<T>, toml::de::Error> {
    let lists: BTreeMap<String, Vec<T>> = toml::from_str(file)?;
    Ok(lists.into_values().flatten().collect())
}

/// A numbered equation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Equation {
    /// Its number or numbers in the paper.
    pub number: String,
    /// Its content.
    pub about: String,
    /// The printed form, where the compared formulas are another one.
    text: Option<String>,
    /// The compared formulas.
    pub claims: Vec<Identity>,
}

/// Formulas of one or several mechanisms, identical to derived ones.
#[derive(Debug, Deserialize)]
pub struct Identity {
    /// The mechanisms.
    pub of: Vec<Subject>,
    /// Replacements of symbols.
    #[serde(default)]
    pub at: Vec<(String, String)>,
    /// The formulas.
    #[serde(flatten)]
    pub formulas: Formulas,
}

/// Kind of comparison.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Formulas {
    /// Lines `derived = formula`.
    Lines(String),
    /// Entries of matrices; entries that are not listed are zero.
    Matrix(String),
    /// The acceleration energy, up to terms without accelerations.
    Energy(String),
}

impl Formulas {
    /// Literally.
    pub const fn text(&self) -> &str {
        let (Self::Lines(text) | Self::Matrix(text) | Self::Energy(text)) = self;
        text.as_str()
    }
}

impl Equation {
    /// The printed form: each formula once.
    pub fn text(&self) -> String {
        let claims = self.claims.iter().map(|claim| claim.formulas.text());
        let mut lines: Vec<&str> = Vec::new();
        for line in claims.flat_map(str::lines) {
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        self.text.clone().unwrap_or_else(|| lines.join("\n"))
    }

    /// Differences from the derivation; empty if the equation holds.
    pub fn differences(&self) -> Vec<String> {
        self.claims.iter().flat_map(Identity::differences).collect()
    }
}

impl Identity {
    fn differences(&self) -> Vec<String> {
        let of = |subject: &Subject| {
            let mut paper = subject.paper();
            match &self.formulas {
                Formulas::Lines(lines) => paper.differences(lines, &self.at),
                Formulas::Matrix(lines) => paper.matrix_differences(lines, &self.at),
                Formulas::Energy(text) if paper.has_acceleration_energy(text) => Vec::new(),
                Formulas::Energy(text) => vec![format!("S is not {text}")],
            }
        };
        self.of.iter().flat_map(of).collect()
    }
}

//! A law outside the library: its site, its names and its coefficients.

use appell_spec::Mechanism;

use super::candidate::{Acts, Candidate, Part, identifier, unused};
use super::effect::Family;

/// Normal prior of a coefficient: mean and standard deviation.
pub(crate) type Known = [f64; 2];

/// The site of a law, and the prefix of its names.
pub(super) struct Stem<'n> {
    site: &'n str,
    stem: String,
}

impl<'n> Stem<'n> {
    pub(super) fn of(site: &'n str, mechanism: &Mechanism) -> Self {
        let stem = unused(format!("law_{}", identifier(site)), mechanism);
        Self { site, stem }
    }

    pub(super) fn words(&self) -> Vec<(&str, &str)> {
        vec![("law", self.stem.as_str()), ("site", self.site)]
    }

    pub(super) fn candidate(
        &self,
        about: String,
        items: String,
        known: &[(&str, Known)],
        begins: [f64; 2],
    ) -> Candidate {
        let parameter = |&(name, known): &(&str, Known)| {
            let name = format!("{}_{name}", self.stem);
            (name, Part::Term(known))
        };
        Candidate {
            kind: "law".to_owned(),
            site: self.site.to_owned(),
            group: Vec::new(),
            family: Family::Force,
            about,
            is_component: false,
            acts: Acts::Items,
            parameters: known.iter().map(parameter).collect(),
            centre: None,
            items,
            brings: None,
            hides: Some(begins),
            added: Vec::new(),
            limits: None,
            has_tolerance: false,
            counts: 1,
            shows: Vec::new(),
            source: None,
            stem: self.stem.clone(),
        }
    }
}

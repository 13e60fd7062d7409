//! A term that an effect adds to a quantity of the spec wherever that acts.

use appell_spec::compose::Composition;
use serde::{Deserialize, Serialize};
use toml_edit::DocumentMut;

use super::candidate::texts;

/// Sections in whose expressions inputs act.
const ACTING: [&str; 2] = ["loads", "constraints"];
/// Sections in whose expressions coordinates give the geometry.
const GEOMETRY: [&str; 2] = ["frames", "points"];

/// A term.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Term {
    /// The input or, in the geometry, the coordinate.
    #[serde(rename = "input")]
    pub quantity: String,
    /// Expression of what is added.
    pub adds: String,
    /// Whether the quantity is a coordinate, and the term is added in frames and points.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub in_geometry: bool,
}

impl Term {
    /// Takes the sections of terms from the items of an effect.
    pub(super) fn of(document: &mut DocumentMut) -> Vec<Self> {
        let mut terms = Vec::new();
        for (section, in_geometry) in [("input", false), ("geometry", true)] {
            let section = document.remove(section);
            let own = section.iter().flat_map(texts);
            terms.extend(own.map(|(quantity, adds)| Self {
                quantity,
                adds,
                in_geometry,
            }));
        }
        terms
    }

    /// Adds terms to a spec; `stated` are definitions in which inputs act too.
    pub(crate) fn add<'t>(
        terms: impl Iterator<Item = &'t Self> + Clone,
        spec: &mut Composition,
        mut stated: Option<&mut Composition>,
    ) {
        let mut quantities: Vec<(&str, bool)> = terms
            .clone()
            .map(|term| (term.quantity.as_str(), term.in_geometry))
            .collect();
        quantities.sort_unstable();
        quantities.dedup();
        for (quantity, in_geometry) in quantities {
            let own = terms.clone();
            let own = own
                .filter(|own| (own.quantity.as_str(), own.in_geometry) == (quantity, in_geometry));
            let added = own.map(|own| own.adds.as_str());
            let sum: Vec<&str> = std::iter::once(quantity).chain(added).collect();
            let sum = sum.join(" + ");
            let sections = if in_geometry { GEOMETRY } else { ACTING };
            spec.substitute(&sections, quantity, &sum);
            if let Some(stated) = stated.as_mut().filter(|_| !in_geometry) {
                stated.substitute(&["definitions"], quantity, &sum);
            }
        }
    }
}

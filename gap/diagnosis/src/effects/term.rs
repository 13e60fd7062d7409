//! A term that an effect adds to a quantity of the spec wherever that acts.

use std::collections::BTreeMap;

use appell_spec::compose::Composition;
use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item};

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
    pub(crate) fn add(
        terms: &[&Self],
        spec: &mut Composition,
        mut stated: Option<&mut Composition>,
    ) {
        let mut sums: BTreeMap<(&str, bool), String> = BTreeMap::new();
        for term in terms {
            let sum = sums.entry((&term.quantity, term.in_geometry));
            let sum = sum.or_insert_with(|| term.quantity.clone());
            *sum += " + ";
            *sum += &term.adds;
        }
        for ((quantity, in_geometry), sum) in sums {
            let sections = if in_geometry { GEOMETRY } else { ACTING };
            spec.substitute(&sections, quantity, &sum);
            if let Some(stated) = stated.as_mut().filter(|_| !in_geometry) {
                stated.substitute(&["definitions"], quantity, &sum);
            }
        }
    }
}

/// The texts of a section, with their names.
pub(super) fn texts(item: &Item) -> Vec<(String, String)> {
    let Some(table) = item.as_table_like() else {
        return Vec::new();
    };
    let pairs = table.iter();
    pairs
        .filter_map(|(name, item)| Some((name.to_owned(), item.as_str()?.to_owned())))
        .collect()
}

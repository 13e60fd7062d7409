//! Effects that a model may lack, each a few lines of the spec language for every place where it
//! makes sense.
//!
//! | file | idea |
//! |---|---|
//! | `library.rs` | the effects that are shipped |
//! | `effect.rs` | the file of an effect |
//! | `site.rs` | the sites in a mechanism, and their placeholders |
//! | `candidate.rs` | an effect at a place: names, items to add, values to look for |
//! | `memory.rs` | laws with a state of their own |
//! | `hidden_mass.rs` | a mass that swings behind a coordinate |
//! | `hysteresis.rs` | a force that follows the way since the last turn |
//! | `stem.rs` | names and numbers of such a law |
//! | `drive.rs` | forces of inputs along a pseudo-velocity, and the inertia there |
//! | `place.rs` | errors in the file of an effect, at their positions |
//! | `model.rs` | a mechanism with many candidates, derived at once; at its nominal values the mechanism itself |

mod candidate;
mod drive;
mod effect;
mod hidden_mass;
mod hysteresis;
mod library;
mod memory;
mod model;
mod place;
mod site;
mod stem;

pub(crate) use candidate::Part;
pub use candidate::{Acts, Candidate};
pub(crate) use drive::Drive;
pub use effect::{Effect, EffectError, Family};
pub(crate) use hidden_mass::HiddenMass;
pub(crate) use hysteresis::Hysteresis;
pub use library::shipped;
pub(crate) use memory::Memory;
pub(crate) use model::ACTING;
pub use model::{EffectModel, ModelError, candidates, with_candidates};
pub(crate) use site::driven;
pub use site::{Scales, SiteKind};

#[cfg(test)]
mod tests {
    use super::*;

    /// The manual about effects of users.
    fn manual() -> String {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/effects.md");
        std::fs::read_to_string(path).unwrap_or_default()
    }

    /// The last cell of the row of a table whose first cell has a word.
    fn row<'m>(manual: &'m str, word: &str) -> Option<&'m str> {
        let quoted = format!("`{word}`");
        manual.lines().find_map(|line| {
            let cells: Vec<&str> = line.split('|').collect();
            (cells.get(1)?.contains(&quoted)).then(|| cells[cells.len() - 2])
        })
    }

    #[test]
    fn every_word_of_every_site_stands_in_the_manual() {
        let manual = manual();
        for kind in SiteKind::all() {
            let site = kind.word();
            let told = row(&manual, site).unwrap_or_default().to_owned();
            let base = ["coordinate", "body"]
                .into_iter()
                .filter(|base| told.contains(&format!("those of `{base}`")))
                .map(|base| row(&manual, base).unwrap_or_default());
            let told = told.clone() + &base.collect::<String>();
            for word in kind.words().concat() {
                let word = format!("{{{word}}}");
                assert!(told.contains(&word), "{site}: {word} is not in its row");
                assert!(row(&manual, &word).is_some(), "{word} has no meaning");
            }
            let known = kind.words().concat();
            for word in told.split('`').filter_map(|part| part.strip_prefix('{')) {
                let word = word.trim_end_matches('}');
                assert!(known.contains(&word), "{site} does not know {word}");
            }
        }
    }

    #[test]
    fn every_key_and_every_choice_stands_in_the_manual() {
        let manual = manual();
        for key in effect::KEYS.iter().chain(&["size", "shape", "switch"]) {
            let plain = manual.contains(&format!("| {key} |"));
            assert!(plain || row(&manual, key).is_some(), "{key}");
        }
        for word in effect::choices() {
            assert!(manual.contains(&format!("`{word}`")), "{word}");
        }
    }
}

//! Effects that a model may lack, each a few lines of the spec language, instantiated at every site where
//! it makes sense.
//!
//! | file | idea |
//! |---|---|
//! | `library.rs` | the effects that are shipped |
//! | `effect.rs` | the file of an effect |
//! | `site_kind.rs`, `site.rs` | kinds of sites with their placeholders; the sites in a mechanism |
//! | `load.rs` | loads that depend on the motion like a feedback controller |
//! | `acts.rs` | how it acts |
//! | `candidate.rs` | an effect at a site: names, items to add, parameters to estimate |
//! | `law.rs` | measured laws outside the library, some with a state of their own |
//! | `drive.rs` | forces of inputs along a pseudo-velocity, and the inertia there |
//! | `place.rs` | errors in the file of an effect, at their positions |
//! | `model.rs` | a mechanism with many candidates, derived at once; equal to the mechanism at nominal values |

mod acts;
mod candidate;
mod drive;
mod effect;
mod law;
mod library;
mod load;
mod model;
mod place;
mod site;
mod site_kind;
mod term;

pub use acts::Acts;
pub use candidate::Candidate;
pub(crate) use candidate::Part;
pub(crate) use drive::Drive;
pub use effect::{Effect, EffectError, Family};
pub(crate) use law::Memory;
pub use library::shipped;
pub(crate) use load::controlled;
pub use model::{EffectModel, ModelError, candidates, with_candidates, written};
pub use site::Scales;
pub(crate) use site::driven;
pub use site_kind::SiteKind;
pub use term::Term;

#[cfg(test)]
mod tests {
    use super::*;

    /// The manual of user-defined effects.
    fn manual() -> String {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/effects.md");
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
        for kind in &site_kind::KINDS {
            let site = kind.word;
            let cell = row(&manual, site).unwrap_or_default().to_owned();
            let base = ["coordinate", "body"]
                .into_iter()
                .filter(|base| cell.contains(&format!("those of `{base}`")))
                .map(|base| row(&manual, base).unwrap_or_default());
            let cell = cell.clone() + &base.collect::<String>();
            for word in kind.words() {
                let word = format!("{{{word}}}");
                assert!(cell.contains(&word), "{site}: {word} is not in its row");
                assert!(row(&manual, &word).is_some(), "{word} has no meaning");
            }
            let known = kind.words();
            for word in cell.split('`').filter_map(|part| part.strip_prefix('{')) {
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

    /// A cart and a pole on a driven arm, with a site of every kind.
    const SPEC: &str = r#"[mechanism]
name = "arm"
title = "An arm and a cart"
[parameters]
m = { value = 1.0, unit = "kg", at_least = 0 }
l = { value = 0.3, unit = "m" }
c = { value = 0.05, unit = "N*m*s", at_least = 0 }
[coordinates]
th = { unit = "deg" }
s = { unit = "m" }
[inputs]
tau = { unit = "N*m" }
u = { unit = "N" }
[frames]
arm = { parent = "ground", about_axis = "-y", by = "th" }
[points]
B = { from = "O", in = "arm", at = [0, 0, "-l"] }
S = { from = "O", in = "ground", at = ["s", 0, 0] }
[bodies]
arm = { frame = "arm", centre = "O", mass = "0.5 [kg]", inertia = "0.05 [kg*m^2]" }
load = { centre = "B", mass = "m" }
cart = { centre = "S", mass = "m" }
[pseudo_velocities]
om = { value = "dot(th)", unit = "deg/s" }
v = { value = "dot(s)", unit = "m/s" }
[loads]
w = { kind = "gravity", down = "-z", acceleration = "9.81 [m/s^2]" }
mot = { kind = "torque", on = "arm", in = "ground", vector = [0, "-2*tau", 0] }
push = { kind = "generalized", coordinate = "s", force = "u" }
servo = { kind = "torque", on = "arm", in = "ground", vector = [0, "-2*tau - c*dot(th)", 0] }
fr = { kind = "damper", coordinate = "th", damping = "c" }
"#;

    #[test]
    fn every_effect_is_written_as_a_spec_that_loads() {
        let spec = appell_recordings::Spec {
            file: "arm.toml".to_owned(),
            text: SPEC.to_owned(),
        };
        let mechanism = appell_spec::load(&spec.file, &spec.text)
            .expect("a spec")
            .mechanism;
        let scales = Scales {
            rates: vec![1.0; 2],
            narrow: vec![0.005; 2],
            largest: vec![1.0; 2],
            reached: vec![Some([-1.0, 1.0]); 2],
            loads: vec![1.0; 5],
            channels: vec!["th".to_owned(), "s".to_owned()],
            coordinates: vec![Some(0), Some(1)],
            speeds: vec![None; 2],
            uncertain: vec![0, 1, 2],
        };
        let effects = shipped().expect("a library");
        let all = candidates(&mechanism, &spec, &effects, &scales).expect("candidates");
        let mut of = std::collections::BTreeSet::new();
        for candidate in &all {
            let name = candidate.name();
            let Some(written) = written(&spec, candidate).expect("a model") else {
                panic!("nothing drives {name}");
            };
            let about = &candidate.about;
            assert!(!about.contains('{'), "a word is left in {name}: {about}");
            let items = written.items();
            let open = items.match_indices('{').find(|(at, _)| {
                let next = items[at + 1..].chars().next();
                next.is_some_and(char::is_alphabetic)
            });
            assert!(open.is_none(), "a word is left in {name}: {items}");
            let text = with_candidates(SPEC, std::slice::from_ref(&written)).expect("a spec");
            if let Err(report) = appell_spec::load("arm.toml", &text) {
                panic!("{name}: {}", report.plain());
            }
            of.insert(candidate.kind.clone());
        }
        assert!(of.contains("backlash") && of.len() > 10, "{of:?}");
    }
}

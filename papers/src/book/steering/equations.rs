//! Every numbered equation that is a formula or a definition.

use crate::book::equations::{misprint, typed};
use crate::book::{Part, Result, Section, shipped};
use crate::errata::{ERRATA, Erratum, Source};
use crate::steering::EQUATIONS;

/// Lists of letters, which must occur in the spec.
const LETTERS: [(&str, &str); 4] = [
    ("coordinates_of_the_wheel", "rolling_wheel"),
    ("state_of_the_wheel", "rolling_wheel"),
    ("coordinates_of_the_unicycle", "unicycle"),
    ("state_of_the_unicycle", "unicycle"),
];

/// The equations in the order of their numbers.
pub(super) fn section(_: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("equations.toml"))?;
    part.claims.extend(EQUATIONS.iter().map(typed));
    part.define("the spec says the same; used in");
    for (key, mechanism) in LETTERS {
        letters(&mut part, key, mechanism)?;
    }
    // Errata of a figure are listed with it.
    let of_equations =
        |e: &&Erratum| e.source == Source::Steering && !e.equation.contains("figure");
    let errata = ERRATA.iter().filter(of_equations);
    part.claims.extend(errata.map(misprint));
    part.claims.sort_by_key(|claim| first_number(&claim.place));
    Ok(part.section())
}

/// The first number in a reference; references without one come last.
fn first_number(place: &str) -> u32 {
    if place.starts_with("appendix C") {
        return 48;
    }
    let number = place.split_once('(').and_then(|(_, rest)| {
        let digits = rest.split(|c: char| !c.is_ascii_digit()).next();
        digits?.parse().ok()
    });
    number.unwrap_or(u32::MAX)
}

fn letters(part: &mut Part, key: &str, mechanism: &str) -> Result<()> {
    let info = shipped(mechanism)?.model.info();
    let statement = part.statement(key)?;
    let (_, names) = statement.published.split_once(": ").unwrap_or_default();
    let names: Vec<&str> = names.split(", ").collect();
    let lengths = [info.coordinate_quantities().len(), info.state_len()];
    let has = |name: &&str| info.state_index(name).is_some();
    let holds = names.iter().all(has) && lengths.contains(&names.len());
    part.found(key, "the spec has the same", holds)
}

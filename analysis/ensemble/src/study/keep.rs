//! `[keep]` and `[rare]`: the kept quantities of each motion, and the rare event.

use appell_spec::{Code, shown};
use toml::de::DeTable;

use super::lacks;
use super::read::{Placed, Reader, Text};
use crate::limits::MAX_PARTICLES;

/// An entry of `[keep]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Keep {
    /// Its name, that of a column.
    pub name: Text,
    /// The statistic of the quantity that is kept.
    pub kept: Kept,
    /// The quantity: a name of the spec, or an expression; of an event a comparison such as `theta > 20[deg]`.
    pub of: Text,
    /// Display unit, instead of that of the quantity.
    pub unit: Option<Text>,
    /// A sentence; may be empty.
    pub about: String,
}

/// The statistic of a quantity that is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kept {
    /// Its last value.
    End,
    /// Its value at a time in s.
    At(f64),
    /// Its largest value, and when.
    Max,
    /// Its smallest value, and when.
    Min,
    /// Its mean over time.
    Mean,
    /// Whether a comparison becomes true, and when for the first time.
    When {
        /// Whether the motion ends there.
        stop: bool,
    },
    /// Its values over time, of which bands are drawn.
    Course,
}

/// A rare event, whose probability importance splitting finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Rare {
    /// Name of the event, an entry of `[keep]`.
    pub event: Text,
    /// Particles.
    pub particles: Placed<u64>,
}

const FORMS: [&str; 6] = ["end", "max", "min", "mean", "when", "course"];
const OTHERS: [&str; 4] = ["at_s", "stop", "unit", "about"];
/// Particles of a splitting.
const PARTICLES: u64 = 1000;

pub(super) fn read(read: &mut Reader<'_>, table: &DeTable<'_>) -> Vec<Keep> {
    let mut all: Vec<Keep> = Vec::new();
    for (name, value) in read.items(table, "keep") {
        let wanted = "a table such as { max = \"abs(theta)\" }";
        let Some(entry) = read.table(value, wanted) else {
            continue;
        };
        read.fields.only(entry, &[&FORMS[..], &OTHERS].concat());
        let about = read.sentence(entry, "about");
        let unit = read.text(entry, "unit");
        let at = read.number(entry, "at_s");
        let stop = read.fields.flag(entry, "stop");
        let wrong = ["names no quantity to keep", "keeps two things"];
        let Some(form) = read.only_one(&name, entry, [&FORMS, &OTHERS], wrong) else {
            continue;
        };
        let Some(of) = entry.get(form).and_then(|value| read.value(value)) else {
            continue;
        };
        let kept = match (form, at) {
            ("end", Some(at)) => Kept::At(at.value),
            ("end", None) => Kept::End,
            ("max", None) => Kept::Max,
            ("min", None) => Kept::Min,
            ("mean", None) => Kept::Mean,
            ("when", None) => Kept::When { stop },
            ("course", None) => Kept::Course,
            _ => {
                let place = entry.get("at_s").map_or(0..0, toml::Spanned::span);
                let message =
                    "`at_s` belongs to `end`: the value at that time instead of the last one";
                read.tell(Code::ConflictingKeys, message, place, "leave `at_s` out");
                continue;
            }
        };
        if stop && !matches!(kept, Kept::When { .. }) {
            let place = entry.get("stop").map_or(0..0, toml::Spanned::span);
            let message = "`stop` belongs to `when`";
            read.tell(Code::ConflictingKeys, message, place, "leave `stop` out");
        }
        all.push(Keep {
            name,
            kept,
            of,
            unit,
            about,
        });
    }
    if lacks(table, "keep") {
        let help =
            "write the quantities to keep under `[keep]`, such as `reached = { end = \"x\" }`";
        read.tell(Code::MissingSection, "nothing is kept", 0..0, help);
    }
    all
}

pub(super) fn rare(read: &mut Reader<'_>, table: &DeTable<'_>, keep: &[Keep]) -> Option<Rare> {
    let section = read.fields.section(table, "rare")?;
    read.fields.only(section, &["event", "particles"]);
    let place = table.get("rare").map_or(0..0, toml::Spanned::span);
    let particles = read.count(section, "particles", MAX_PARTICLES);
    let Some(event) = read.text(section, "event") else {
        let help = "write `event = \"…\"`, a name of `[keep]` with `when`";
        let message = "a rare event needs `event`";
        if section.get("event").is_none() {
            read.tell(Code::MissingKey, message, place, help);
        }
        return None;
    };
    let is_event = |k: &&Keep| matches!(k.kept, Kept::When { .. });
    let mut events = keep.iter().filter(is_event);
    if !events.any(|keep| keep.name.text == event.text) {
        let message = format!("`[keep]` has no event `{}`", shown(&event.text));
        let help = "name an entry with `when`";
        read.tell(Code::UnknownReference, message, event.at, help);
        return None;
    }
    Some(Rare {
        particles: particles.unwrap_or(Placed {
            value: PARTICLES,
            at: event.at.clone(),
        }),
        event,
    })
}

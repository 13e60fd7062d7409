//! The study file: the motion, its factors, the kept quantities.
//!
//! ```toml
//! [study]
//! model = "my_rig.toml"             # name or path of a spec
//! cases = 1000
//!
//! [motion]
//! t_end_s = 5
//!
//! [vary]
//! m = { normal = [5, 0.2] }         # a parameter, an initial state, or a quantity defined by the study
//!
//! [keep]
//! reached = { end = "x" }
//! ```
//!
//! Values are texts here: their names belong to specs, which this crate does not read.

mod keep;
mod motion;
mod read;
mod vary;

use appell_recordings::fields::Fields;
use appell_spec::{Code, Report};
use toml::de::DeTable;

use crate::design::Sampling;
use crate::limits::MAX_CASES;

pub use keep::{Keep, Kept, Rare};
pub use motion::{Method, Motion};
pub use read::{Correlation, Entry, Placed, Text};
pub use vary::{FEEDBACK, MODEL, Noise, Varied, Vary};

/// A study as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name of the file.
    pub file: String,
    /// Its text.
    pub text: String,
    /// Title of figures and pages; may be empty.
    pub title: String,
    /// Name or path of a spec; none where `[vary]` chooses between several.
    pub model: Option<Text>,
    /// Points, or points for each node of the grids.
    pub count: Placed<u64>,
    /// How points are chosen.
    pub sampling: Placed<Sampling>,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Cases of a chunk.
    pub chunk: Option<Placed<u64>>,
    /// A file whose columns are factors.
    pub table: Option<Text>,
    /// Pairs of factors with the correlation of their normal scores.
    pub correlations: Vec<Correlation>,
    /// The motion of each case.
    pub motion: Motion,
    /// Factors.
    pub vary: Vec<Vary>,
    /// Noise over time.
    pub noise: Vec<Noise>,
    /// Kept quantities.
    pub keep: Vec<Keep>,
    /// The rare event, if requested.
    pub rare: Option<Rare>,
}

/// The keys of the sections.
const SECTIONS: [&str; 6] = ["study", "motion", "vary", "noise", "keep", "rare"];
const STUDY: [&str; 9] = [
    "title",
    "model",
    "cases",
    "sampling",
    "seed",
    "chunk",
    "table",
    "correlations",
    "about",
];

impl Study {
    /// Reads a study file; `file` is its name in messages. All errors are reported at once.
    pub fn parse(file: &str, text: &str) -> Result<Self, Report> {
        let (mut fields, table) = Fields::new(file, text);
        let table = table.get_ref();
        fields.only(table, &SECTIONS);
        let study = fields.section(table, "study");
        let mut read = read::Reader {
            fields,
            document: text,
        };
        read.characters();
        if table.get("study").is_none() {
            let help = "begin with `[study]` and `model = \"…\"`, the name of a shipped mechanism or the path of a spec";
            read.tell(Code::MissingSection, "there is no `[study]`", 0..0, help);
        }
        let empty = DeTable::new();
        let study = study.unwrap_or(&empty);
        let place = table.get("study").map_or(0..0, toml::Spanned::span);
        read.fields.only(study, &STUDY);
        let model = read.text(study, "model");
        let count = read.count(study, "cases", MAX_CASES);
        let sampling = read.sampling(study);
        let seed = read.whole(study, "seed").map_or(1, |seed| seed.value);
        let chunk = read.count(study, "chunk", u64::MAX);
        let title = read.sentence(study, "title");
        let points = read.text(study, "table");
        let correlations = read.correlations(study);
        let vary = vary::read(&mut read, table);
        let noise = vary::noise(&mut read, table);
        let keep = keep::read(&mut read, table);
        let rare = keep::rare(&mut read, table, &keep);
        let motion = motion::read(&mut read, table);
        let chosen = vary.iter().any(|vary| vary.name.text == MODEL);
        if model.is_none()
            && !chosen
            && table.get("study").is_some()
            && study.get("model").is_none()
        {
            let help =
                "write `model = \"…\"`, the name of a shipped mechanism or the path of a spec";
            read.tell(
                Code::MissingKey,
                "the key `model` is missing",
                place.clone(),
                help,
            );
        }
        let has_nodes = study.contains_key("table") || has_grid(table);
        if let Some(model) = model.as_ref().filter(|_| chosen) {
            let message = "`model` stands here and in `[vary]`";
            read.tell(
                Code::ConflictingKeys,
                message,
                model.at.clone(),
                "remove one of them",
            );
        }
        if count.is_none() && !has_nodes && study.get("cases").is_none() {
            let help = "write how many, such as `cases = 1000`, under `[study]`";
            let message = "the key `cases` is missing";
            read.tell(Code::MissingKey, message, place.clone(), help);
        }
        if lacks(table, "vary") && lacks(table, "noise") && !study.contains_key("table") {
            let help = "write what varies under `[vary]`, such as `m = { normal = [5, 0.2] }`";
            read.tell(Code::MissingSection, "nothing varies", 0..0, help);
        }
        if read.fields.is_wrong() {
            return Err(read.fields.report());
        }
        Ok(Self {
            file: file.to_owned(),
            text: text.to_owned(),
            title,
            model,
            count: count.unwrap_or(Placed {
                value: 1,
                at: place.clone(),
            }),
            sampling: sampling.unwrap_or(Placed {
                value: Sampling::Random,
                at: place,
            }),
            seed,
            chunk,
            table: points,
            correlations,
            motion: motion.unwrap_or_default(),
            vary,
            noise,
            keep,
            rare,
        })
    }
}

/// Whether a factor has grid values, even if its entry is otherwise invalid.
fn has_grid(table: &DeTable<'_>) -> bool {
    let entries = table.get("vary").and_then(|vary| vary.get_ref().as_table());
    let mut entries = entries.into_iter().flatten();
    entries.any(|(_, entry)| {
        let entry = entry.get_ref().as_table();
        entry.is_some_and(|entry| entry.contains_key("grid") || entry.contains_key("range"))
    })
}

/// Whether a section is not there, or empty.
fn lacks(table: &DeTable<'_>, section: &str) -> bool {
    let section = table
        .get(section)
        .map(|section| section.get_ref().as_table());
    section.is_none_or(|section| section.is_some_and(DeTable::is_empty))
}

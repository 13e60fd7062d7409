//! The study file: what is moved, what varies, what is kept.
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
//! m = { normal = [5, 0.2] }         # a parameter, a state at the start, or a quantity of the study's own
//!
//! [keep]
//! reached = { end = "x" }
//! ```
//!
//! Values are texts here: their names belong to specs, which this crate does not know.

mod keep;
mod motion;
mod read;
mod value;
mod vary;

use appell_recordings::fields::Fields;
use appell_spec::{Code, Report};

use crate::design::Sampling;

pub use keep::{Keep, Kept, Rare};
pub use motion::{Method, Motion};
pub use value::{Entry, Text};
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
    pub count: u64,
    /// How points are chosen.
    pub sampling: Sampling,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Cases of a chunk.
    pub chunk: Option<u64>,
    /// A file whose columns are factors.
    pub table: Option<Text>,
    /// Pairs of factors with the correlation of their normal scores.
    pub correlations: Vec<(Text, Text, f64)>,
    /// The motion of each case.
    pub motion: Motion,
    /// What varies.
    pub vary: Vec<Vary>,
    /// Noise over time.
    pub noise: Vec<Noise>,
    /// What is kept.
    pub keep: Vec<Keep>,
    /// The rare event, if that is what is asked for.
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
    /// Reads a study file; `file` is its name in messages. All mistakes are told at once.
    pub fn parse(file: &str, text: &str) -> Result<Self, Report> {
        let (mut fields, table) = Fields::new(file, text);
        let table = table.get_ref();
        fields.only(table, &SECTIONS);
        let study = fields.section(table, "study");
        let mut read = read::Reader {
            fields,
            document: text,
        };
        if table.get("study").is_none() {
            let help = "begin with `[study]` and `model = \"…\"`, the name of a shipped mechanism or the path of a spec";
            read.tell(Code::MissingSection, "there is no `[study]`", 0..0, help);
        }
        let empty = toml::de::DeTable::new();
        let study = study.unwrap_or(&empty);
        read.fields.only(study, &STUDY);
        let model = read.text(study, "model");
        let count = read.count(study, "cases");
        let sampling = read.sampling(study);
        let seed = read.whole(study, "seed").unwrap_or(1);
        let chunk = read.count(study, "chunk");
        let title = read.text(study, "title");
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
            read.tell(Code::MissingKey, "the key `model` is missing", 0..0, help);
        }
        let has_nodes = points.is_some() || vary.iter().any(|vary| vary.varied.is_grid());
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
            read.tell(Code::MissingKey, "the key `cases` is missing", 0..0, help);
        }
        if vary.is_empty() && noise.is_empty() && points.is_none() {
            let help = "write what varies under `[vary]`, such as `m = { normal = [5, 0.2] }`";
            read.tell(Code::MissingSection, "nothing varies", 0..0, help);
        }
        if read.fields.is_wrong() {
            return Err(read.fields.report());
        }
        Ok(Self {
            file: file.to_owned(),
            text: text.to_owned(),
            title: title.map_or_else(String::new, |title| title.text),
            model,
            count: count.unwrap_or(1),
            sampling: sampling.unwrap_or(Sampling::Random),
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

//! Ensembles: many motions whose parameters, starts, inputs, laws or specs vary, from a study file.
//!
//! ```
//! use appell::ensemble::{Ensemble, Folder};
//!
//! let study = r#"
//! [study]
//! model = "pendulum"
//! cases = 20
//! [motion]
//! t_end_s = 1
//! [vary]
//! theta = { normal = ["20deg", "2deg"] }
//! [keep]
//! reached = { end = "theta" }
//! "#;
//! let ensemble = Ensemble::parse("study.toml", study, std::path::Path::new("."))?;
//! let rows = ensemble.rows(0..20);
//! assert_eq!(rows.len(), 20);
//! # Ok::<(), appell::Error>(())
//! ```

#[cfg(feature = "cuda")]
mod card;
mod cases;
mod engine;
mod factors;
mod kernel;
mod layout;
mod noise;
mod observer;
mod rare;
mod reading;
mod spec;
mod variant;

use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

use appell_ensemble::TAKEN;
use appell_ensemble::design::Design;
use appell_ensemble::digest::Digest;
use appell_ensemble::limits::{MAX_CHUNKS, MAX_JOBS, MAX_NUMBERS, MAX_VARIANTS};
use appell_ensemble::run::{self, Engine};
use appell_ensemble::study::{FEEDBACK, MODEL, Text, Varied};
use appell_ensemble::summary::{See, Wanted};
use appell_spec::{Code, shown};

pub use appell_ensemble::chunk::{Chunk, Chunks, Missing, Shard};
#[cfg(feature = "object-store")]
pub use appell_ensemble::objects::Objects;
pub use appell_ensemble::rows::{Column, Role, Rows};
pub use appell_ensemble::run::{Ended, Watch};
pub use appell_ensemble::store::{Folder, Memory, Store, StoreError};
pub use appell_ensemble::study::Study;
pub use appell_ensemble::summary::Summary;
pub use appell_report::ensemble::{About, figures, page, text};

use crate::source::Source;
use crate::{Error, Field, files};
use cases::{Cases, Task};
use factors::Table;
use reading::Reading;

/// A compiled study.
pub struct Ensemble {
    cases: Cases,
    /// Evaluation of the rare event in each motion.
    rare: Option<Task>,
    /// Hash of everything that the rows depend on.
    hash: String,
    /// The motions on a graphics card, if it computes them.
    #[cfg(feature = "cuda")]
    card: Option<card::OnCard>,
}

/// Options for running the missing chunks of a study.
#[derive(Debug, Clone, Copy, Default)]
pub struct Running {
    /// Threads; by default one for each processor.
    pub jobs: Option<usize>,
    /// The shard of the chunks; all of them by default.
    pub shard: Option<Shard>,
    /// Cases of a chunk; by default set by the study, or by their number.
    pub chunk: Option<u64>,
}

impl Running {
    /// The number of threads, if requested and valid.
    fn threads(&self) -> Result<Option<usize>, Error> {
        match self.jobs {
            Some(jobs) if !(1..=MAX_JOBS).contains(&jobs) => {
                let message = format!("from 1 to {MAX_JOBS} threads are possible");
                Err(Error::request(Field::Jobs, message))
            }
            jobs => Ok(jobs),
        }
    }
}

/// Limits on the cases of a chunk, which is a file and is held in memory.
fn chunk_sizes(cases: u64, columns: usize) -> [u64; 2] {
    let own = columns + TAKEN.len();
    [
        cases.div_ceil(MAX_CHUNKS).max(1),
        (MAX_NUMBERS / own as u64).max(1),
    ]
}

/// Reports a number or a size of chunks beyond the limits.
fn sizes(reading: &mut Reading<'_>, design: &Design, columns: usize) {
    let study = reading.study;
    let (cases, own) = (design.cases(), study.chunk.as_ref());
    let [least, most] = chunk_sizes(cases, columns);
    if least > most {
        let message = format!("{cases} rows of {columns} columns are too many numbers");
        let help = format!("at most {} cases are possible", most * MAX_CHUNKS);
        reading.tell(Code::LimitExceeded, message, &study.count, &help);
        return;
    }
    match own {
        Some(own) if own.value < least => {
            let chunks = cases.div_ceil(own.value);
            let message =
                format!("{chunks} chunks are too many files; at most {MAX_CHUNKS} are possible");
            let help = format!("write `chunk = {least}` or more, or leave it out");
            reading.tell(Code::LimitExceeded, message, own, &help);
        }
        Some(own) if own.value.min(cases) > most => {
            let message = format!(
                "a chunk of {} rows of {columns} columns is too large",
                own.value
            );
            let help = format!("write `chunk = {most}` or less, or leave it out");
            reading.tell(Code::LimitExceeded, message, own, &help);
        }
        _ => {}
    }
}

/// Default number of chunks of a study, and limits on their default size.
const CHUNKS: u64 = 64;
const LEAST_PER_CHUNK: u64 = 16;
const MOST_PER_CHUNK: u64 = 4096;

impl Ensemble {
    /// The ensemble of a study file. Specs, laws and tables that it names are in the same folder.
    pub fn from_file(path: &Path) -> Result<Self, Error> {
        let text = files::read(path, appell_spec::limits::MAX_FILE as u64)?;
        let folder = path.parent().unwrap_or(Path::new("."));
        Self::parse(&path.to_string_lossy(), &text, folder)
    }

    /// The ensemble of the text of a study file; `folder` has the files that it names.
    pub fn parse(file: &str, text: &str, folder: &Path) -> Result<Self, Error> {
        let study = Study::parse(file, text)?;
        let mut reading = Reading::new(&study);
        let table = Table::read(&mut reading, folder)?;
        let mut digest = Digest::default();
        let mut models = Vec::new();
        for name in chosen(&study, MODEL).iter().chain(&study.model) {
            let source = source(&mut reading, name, folder)?;
            let Some(source) = source else { continue };
            digest.add(source.text.as_bytes());
            models.extend(spec::extended(&mut reading, &source)?);
        }
        reading.check()?;
        let Some(first) = models.first() else {
            return Err(Error::data(file, "there is no model"));
        };
        let (setup, _) = variant::nominal(&mut reading, &first.model)?;
        let targets = factors::targets(&mut reading, &setup, &table);
        reading.check()?;
        let design = factors::design(&mut reading, &setup, &targets, &table);
        let Some((design, columns, choices)) = design else {
            reading.check()?;
            return Err(Error::data(file, "there is no design"));
        };
        let info = first.model.info();
        let task = Task {
            layout: layout::layout(
                &mut reading,
                columns.clone(),
                &study.keep,
                info,
                &first.kept,
            ),
            which: (0..study.keep.len()).collect(),
            keep: study.keep.clone(),
        };
        let rare = study
            .rare
            .as_ref()
            .and_then(|rare| rare::task(&mut reading, rare, &design, columns, info, &first.kept));
        sizes(&mut reading, &design, task.layout.columns.len());
        reading.check()?;
        drop(setup);
        let laws = chosen(&study, FEEDBACK);
        if let Some(law) = laws
            .first()
            .filter(|_| models.len() * laws.len() > MAX_VARIANTS)
        {
            let message = format!(
                "{} specs under {} laws are too many",
                models.len(),
                laws.len()
            );
            let help = format!("at most {MAX_VARIANTS} pairs are possible");
            reading.tell(Code::LimitExceeded, message, law, &help);
            reading.check()?;
        }
        let mut variants = Vec::new();
        let choices_of_law = match &laws[..] {
            [] => vec![None],
            laws => laws.iter().map(Some).collect(),
        };
        for extended in &models {
            let (setup, _) = variant::nominal(&mut reading, &extended.model)?;
            let targets = factors::targets(&mut reading, &setup, &table);
            drop(setup);
            for &law in &choices_of_law {
                let variant = variant::variant(&mut reading, extended, law, folder, &targets)?;
                variants.extend(variant);
            }
            reading.check()?;
        }
        for law in study.motion.feedback.iter().chain(&laws) {
            let path = folder.join(&law.text);
            digest.add(files::read(&path, appell_spec::limits::MAX_FILE as u64)?.as_bytes());
        }
        digest.add(table.hash.as_bytes());
        digest.add(meaning(&study, &design).as_bytes());
        let laws = laws.len().max(1);
        Ok(Self {
            hash: digest.text(),
            cases: Cases {
                study,
                design,
                choices,
                task,
                variants,
                laws,
            },
            rare,
            #[cfg(feature = "cuda")]
            card: None,
        })
    }

    /// The same study with its motions on the first graphics card of this machine. Its rows agree with those of
    /// processors within the tolerances of the study, and have chunks of their own.
    #[cfg(feature = "cuda")]
    pub fn on_card(mut self) -> Result<Self, Error> {
        self.card = Some(card::OnCard::new(&self.cases)?);
        self.hash.push_str("-card");
        Ok(self)
    }

    /// An error: this library is built without graphics cards.
    #[cfg(not(feature = "cuda"))]
    pub fn on_card(self) -> Result<Self, Error> {
        let message =
            "this program was built without graphics cards; build it with the feature `cuda`";
        Err(Error::request(Field::Device, message))
    }

    /// The sources in CUDA C++ of its motions, one for each spec and law, laws varying fastest.
    pub fn cuda(&self) -> Result<Vec<String>, Error> {
        let variants = self.cases.variants.iter();
        variants
            .map(|variant| kernel::source(&self.cases, variant))
            .collect()
    }

    /// The study.
    pub fn study(&self) -> &Study {
        &self.cases.study
    }

    /// The values of the factors in all cases.
    pub fn design(&self) -> &Design {
        &self.cases.design
    }

    /// The columns of a row.
    pub fn columns(&self) -> &[Column] {
        &self.cases.task.layout.columns
    }

    /// All chunks of cases, of the requested size.
    pub fn chunks(&self, size: Option<u64>) -> Result<Chunks, Error> {
        let [least, most] = chunk_sizes(self.cases.design.cases(), self.columns().len());
        match size {
            Some(size) if size < least || size.min(self.cases.design.cases()) > most => {
                let message = format!("a chunk has {least} to {most} cases in this study");
                Err(Error::request(Field::Chunk, message))
            }
            size => Ok(self.sized(size)),
        }
    }

    /// All chunks of cases, of the size set by the study or by their number.
    fn sized(&self, size: Option<u64>) -> Chunks {
        let cases = self.cases.design.cases();
        let [least, most] = chunk_sizes(cases, self.columns().len());
        let usual = cases
            .div_ceil(CHUNKS)
            .clamp(LEAST_PER_CHUNK, MOST_PER_CHUNK);
        // A card computes many at once.
        #[cfg(feature = "cuda")]
        let usual = match &self.card {
            Some(_) => usual.max(card::TOGETHER.min(cases)),
            None => usual,
        };
        let own = self.cases.study.chunk.as_ref().map(|chunk| chunk.value);
        Chunks {
            study: self.hash.clone(),
            cases,
            size: size.or(own).unwrap_or(usual).max(least).min(most),
        }
    }

    /// Rows of cases, without a store; computed by processors.
    pub fn rows(&self, cases: Range<u64>) -> Rows {
        let room = usize::try_from(cases.end.saturating_sub(cases.start)).unwrap_or(0);
        let mut rows = Rows::new(cases.start, self.columns().len(), room);
        let watch = Watch {
            go_on: &|| true,
            done: &|_| {},
        };
        self.cases.run(cases, &watch, &mut rows);
        rows
    }

    /// The missing and damaged chunks of a store.
    pub fn missing(&self, store: &dyn Store, running: Running) -> Result<Missing, Error> {
        let chunks = self.chunks(running.chunk)?;
        let missing = chunks.unsound_or_missing(store, self.columns(), running.shard);
        missing.map_err(Error::computation)
    }

    /// Numbers of missing chunks in a store and of all chunks, those of the rare event included.
    pub fn left(&self, store: &dyn Store, chunk: Option<u64>) -> Result<[u64; 2], Error> {
        let mut counts = [0; 2];
        for chunks in [Some(self.chunks(chunk)?), self.replicates()]
            .into_iter()
            .flatten()
        {
            let there = chunks.there(store).map_err(Error::computation)?;
            counts[0] += chunks.missing(&there, None).len() as u64;
            counts[1] += chunks.count();
        }
        Ok(counts)
    }

    /// Chunks by their names, those of the rare event included; an unknown name is an error.
    pub fn named(&self, names: &[String]) -> Result<[Vec<Chunk>; 2], Error> {
        let (cases, replicates) = (self.sized(None), self.replicates());
        let [mut own, mut rare] = [Vec::new(), Vec::new()];
        for name in names {
            let replicate = replicates.as_ref().and_then(|all| all.named(name));
            match (cases.named(name), replicate) {
                (Some(chunk), _) if chunk.cases.end <= cases.cases => own.push(chunk),
                (_, Some(chunk)) => rare.push(chunk),
                _ => {
                    let message =
                        format!("`{name}` is no chunk of this study; it may have changed");
                    return Err(Error::request(Field::Study, message));
                }
            }
        }
        Ok([own, rare])
    }

    /// Runs chunks and writes each to the store when it is complete. Existing ones are not read.
    pub fn fill(
        &self,
        store: &dyn Store,
        missing: &[Chunk],
        running: Running,
        watch: Watch<'_>,
    ) -> Result<Ended, Error> {
        let chunks = self.chunks(running.chunk)?;
        let jobs = running.threads()?;
        #[cfg(feature = "cuda")]
        if let Some(card) = &self.card {
            card.start();
        }
        #[cfg(feature = "cuda")]
        let go_on = || {
            (watch.go_on)()
                && self
                    .card
                    .as_ref()
                    .is_none_or(|card| card.failure().is_none())
        };
        #[cfg(feature = "cuda")]
        let watch = Watch {
            go_on: &go_on,
            ..watch
        };
        let ended = run::run(self, &chunks, missing, store, jobs, watch);
        #[cfg(feature = "cuda")]
        if let Some(failure) = self.card.as_ref().and_then(card::OnCard::failure) {
            return Err(Error::computation(failure));
        }
        ended.map_err(Error::computation)
    }

    /// The statistics of the rows in a store.
    pub fn summary(&self, store: &dyn Store) -> Result<Summary, Error> {
        let chunks = self.sized(None);
        let there = chunks.there(store).map_err(Error::computation)?;
        let columns = self.columns();
        let scan = |wanted: Wanted<'_>, see: See<'_>| {
            run::scan(store, &chunks, &there, columns, wanted, see)
        };
        let summary = Summary::new(columns, &self.cases.design, self.cases.study.seed, scan);
        let event = self
            .cases
            .study
            .rare
            .as_ref()
            .map(|rare| rare.event.text.clone());
        Ok(Summary {
            rare: event.zip(self.probability(store)?),
            ..summary.map_err(Error::computation)?
        })
    }

    /// Title of figures and pages.
    pub fn title(&self) -> &str {
        if self.cases.study.title.is_empty() {
            &self.cases.variants[0].model.info().title
        } else {
            &self.cases.study.title
        }
    }

    /// Subject of a statistics report.
    pub fn about<'a>(&'a self, summary: &'a Summary) -> About<'a> {
        About {
            title: self.title(),
            study: &self.cases.study.text,
            columns: self.columns(),
            summary,
        }
    }

    /// Reads the rows of a store in the order of the cases.
    pub fn scan(&self, store: &dyn Store, mut see: impl FnMut(&Rows)) -> Result<(), Error> {
        let chunks = self.sized(None);
        let there = chunks.there(store).map_err(Error::computation)?;
        run::scan(store, &chunks, &there, self.columns(), &|_| true, &mut see)
            .map_err(Error::computation)
    }
}

impl Engine for Ensemble {
    fn columns(&self) -> &[Column] {
        self.columns()
    }

    fn run(&self, cases: Range<u64>, watch: &Watch<'_>, rows: &mut Rows) {
        #[cfg(feature = "cuda")]
        if let Some(card) = &self.card {
            return card.run(&self.cases, cases, watch, rows);
        }
        self.cases.run(cases, watch, rows);
    }
}

/// The files among which an entry of `[vary]` chooses.
fn chosen(study: &Study, name: &str) -> Vec<Text> {
    let vary = study.vary.iter().find(|vary| vary.name.text == name);
    match vary.map(|vary| &vary.varied) {
        Some(Varied::Choice(items, _) | Varied::Grid(items)) => items.clone(),
        _ => Vec::new(),
    }
}

/// A shipped spec, or a file in the folder of the study.
fn source(reading: &mut Reading<'_>, name: &Text, folder: &Path) -> Result<Option<Source>, Error> {
    if crate::source::Shipped::find(&name.text).is_some() {
        return Source::shipped(&name.text).map(Some);
    }
    if folder.join(&name.text).exists() {
        let study = reading.study;
        let set = study.motion.set.iter().map(|entry| &entry.name);
        let given = set.chain(study.vary.iter().map(|vary| &vary.name));
        let numbers: Vec<&str> = given.map(|name| name.text.as_str()).collect();
        return match reading.file(folder, name) {
            Some(path) => reading.at(name, Source::read_with(&path, &numbers)),
            None => Ok(None),
        };
    }
    let similar = appell_spec::did_you_mean(&name.text, crate::source::names(), || {
        "write the name of a shipped mechanism, or the path of a spec from the folder of the study"
            .to_owned()
    });
    let message = format!(
        "there is no shipped mechanism and no file `{}`",
        shown(&name.text)
    );
    reading.tell(Code::UnknownReference, message, name, &similar);
    Ok(None)
}

/// Version of the computation and format of rows, to be changed with either.
const ROWS: u32 = 3;

/// The parts of a study that determine its rows, as a text.
fn meaning(study: &Study, design: &Design) -> String {
    let mut text = format!(
        "{} {ROWS} {:?} {} {:?} {:?} {:?} {:?} {:?}",
        env!("CARGO_PKG_VERSION"),
        study.sampling,
        study.seed,
        study.correlations,
        study.motion,
        study.vary,
        study.noise,
        study.keep,
    );
    if design.depends_on_count() {
        // Writing to a string cannot fail.
        let _ = write!(text, " {}", study.count.value);
    }
    text
}

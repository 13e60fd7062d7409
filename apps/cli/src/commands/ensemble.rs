//! `appell ensemble`

mod on_ray;

use std::path::{Path, PathBuf};

use appell::ensemble::{
    self, Ended, Ensemble, Folder, Missing, Running, Shard, Store, Summary, Watch,
};
use appell::{files, json};

use crate::failure::{Error, note};
use crate::{interrupt, output, progress};

/// Runs many motions whose parameters, starts, inputs, laws or specs vary, and computes their statistics.
///
/// A study file defines the motion, its factors and the kept quantities (docs/ensembles.md). The rows of the cases go to
/// the folder as Parquet, in chunks that are written atomically: the same command resumes an interrupted study.
/// No result depends on the number of threads, on chunks or shards.
#[derive(Debug, clap::Args)]
#[command(name = "ensemble")]
#[command(after_long_help = "\
Examples:
  appell ensemble study/rider.toml -o study/results
  appell ensemble study/rider.toml -o study/results --json -")]
pub(crate) struct EnsembleCommand {
    /// The study file
    study: PathBuf,
    /// Folder for chunks, statistics, figures and the page, or the address of an object store, such as
    /// `s3://bucket/study`
    #[arg(long, short, value_name = "FOLDER")]
    out: PathBuf,
    /// Threads [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// What computes the motions: the processors, or the first NVIDIA graphics card of this machine, which `cuda` compiles
    /// them for
    #[arg(long, value_enum, default_value_t, conflicts_with = "ray")]
    device: Device,
    /// Run the K-th of N parts, as on a cluster; the last one prints the statistics
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,
    /// Cases of a chunk [default: the study's, or a 64th of the cases, at most 4096]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    chunk: Option<u64>,
    /// Run on the Ray cluster of this address, which sees study and folder under their paths; `auto` is the one that
    /// this machine belongs to. Needs the Python package and Ray
    #[arg(long, value_name = "ADDRESS", conflicts_with = "jobs")]
    ray: Option<String>,
    /// Write the statistics as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What computes motions.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum Device {
    #[default]
    Cpu,
    Cuda,
}

impl EnsembleCommand {
    pub(super) fn run(&self) -> Result<(), Error> {
        if files::is_stdout(&self.out) {
            let message = "`--out` is a folder: rows and figures do not go to standard output";
            return Err(Error::Usage(message.to_owned()));
        }
        let ensemble = progress::during("deriving the equations of motion", |_| {
            Ensemble::from_file(&self.study)
        })?;
        let ensemble = match self.device {
            Device::Cpu => ensemble,
            Device::Cuda => {
                progress::during("compiling for the graphics card", |_| ensemble.on_card())?
            }
        };
        ensemble.chunks(self.chunk)?;
        let store = store_at(&self.out)?;
        let store = store.as_ref();
        let running = Running {
            jobs: self.jobs.map(usize::from),
            shard: self.shard,
            chunk: self.chunk,
        };
        let ended = match &self.ray {
            Some(address) => self.spread(&ensemble, store, address, running)?,
            None => self.fill(&ensemble, store, running)?,
        };
        let [left, chunks] = ensemble.left(store, self.chunk)?;
        let there = chunks - left;
        if ended == Ended::Stopped {
            return Err(Error::Computation(format!(
                "stopped; {there} of {chunks} chunks are there, and the same command goes on with the others"
            )));
        }
        if left > 0 {
            return output::print(&format!(
                "{there} of {chunks} chunks are there; the others belong to other shards\n"
            ));
        }
        store.tidy().map_err(appell::Error::computation)?;
        let summary = progress::during("computing statistics", |_| ensemble.summary(store))?;
        self.tell(&ensemble, store, &summary)
    }

    /// Runs the missing chunks until Ctrl-C, with a progress bar.
    fn fill(
        &self,
        ensemble: &Ensemble,
        store: &dyn Store,
        running: Running,
    ) -> Result<Ended, Error> {
        let Missing {
            chunks: missing,
            mut damaged,
        } = ensemble.missing(store, running)?;
        let replicates = ensemble.missing_replicates(store, running)?;
        damaged.extend(replicates.damaged);
        let replicates = replicates.chunks;
        if !damaged.is_empty() {
            let (count, first) = (damaged.len(), &damaged[0]);
            note(&format!(
                "chunks are damaged and computed again: {count}, the first is {first}"
            ));
        }
        let cases: u64 = missing.iter().map(|c| c.cases.end - c.cases.start).sum();
        let whole = ensemble.design().cases();
        if cases < whole && self.shard.is_none() {
            note(&format!(
                "{} of {whole} cases are there already",
                whole - cases
            ));
        }
        // Completed chunks are preserved.
        let go_on = || !interrupt::has_come();
        // Installed before the first chunk: from here on a signal does not end the process.
        go_on();
        let mut ended = Ended::Done;
        if cases > 0 {
            ended = under_bar(cases, "cases", &go_on, |watch| {
                ensemble.fill(store, &missing, running, watch)
            })?;
        }
        if !replicates.is_empty() && ended == Ended::Done {
            let (count, kind) = (replicates.len() as u64, "replicates of the rare event");
            ended = under_bar(count, kind, &go_on, |watch| {
                ensemble.fill_replicates(store, &replicates, running, watch)
            })?;
        }
        Ok(ended)
    }

    /// Runs the missing chunks on a cluster.
    fn spread(
        &self,
        ensemble: &Ensemble,
        store: &dyn Store,
        address: &str,
        running: Running,
    ) -> Result<Ended, Error> {
        let left = ensemble.missing(store, running)?.chunks.len();
        if left > 0 && is_address(&self.out) {
            let message =
                "a cluster writes to a folder that all its machines see, not to an address";
            return Err(Error::Usage(message.to_owned()));
        }
        if left > 0 {
            on_ray::run(&self.study, &self.out, address, running, left as u64)?;
        }
        // The few replicates of a rare event are run here.
        self.fill(ensemble, store, running)
    }

    /// Writes statistics, figures and the page.
    fn tell(&self, ensemble: &Ensemble, store: &dyn Store, summary: &Summary) -> Result<(), Error> {
        let about = ensemble.about(summary);
        let told = json::ensemble(ensemble.columns(), summary);
        let write = |name: &str, text: String| {
            let written = store.write(name, text.into_bytes());
            written.map_err(appell::Error::computation)
        };
        write("statistics.json", files::json_text(&told)?)?;
        write("report.html", ensemble::page(&about))?;
        for figure in ensemble::figures(&about) {
            write(&format!("{}.svg", figure.name), figure.svg)?;
        }
        output::json(self.json.as_deref(), || told)?;
        let page = self.out.join("report.html");
        let text = format!("{}\nfigures: {}\n", ensemble::text(&about), page.display());
        output::print_beside(&text, &[&self.json])
    }
}

/// Runs with a progress bar.
fn under_bar(
    count: u64,
    kind: &str,
    go_on: &(dyn Fn() -> bool + Sync),
    run: impl FnOnce(Watch<'_>) -> Result<Ended, appell::Error>,
) -> Result<Ended, Error> {
    let bar = progress::cases(count, kind);
    let done = |some| bar.inc(some);
    let ended = run(Watch { go_on, done: &done })?;
    bar.finish_and_clear();
    Ok(ended)
}

/// Whether a path is the address of an object store.
fn is_address(place: &Path) -> bool {
    place.to_str().is_some_and(|place| place.contains("://"))
}

/// Where the rows go: a folder, or an object store.
fn store_at(place: &Path) -> Result<Box<dyn Store>, Error> {
    if !is_address(place) {
        let folder = Folder::new(place).map_err(appell::Error::computation)?;
        return Ok(Box::new(folder));
    }
    objects_at(&place.to_string_lossy())
}

#[cfg(feature = "object-store")]
fn objects_at(address: &str) -> Result<Box<dyn Store>, Error> {
    let objects = ensemble::Objects::at(address).map_err(appell::Error::computation)?;
    Ok(Box::new(objects))
}

#[cfg(not(feature = "object-store"))]
fn objects_at(_: &str) -> Result<Box<dyn Store>, Error> {
    Err(Error::Usage(
        "this program was built without object stores: name a folder, or build with `--features object-store`"
            .to_owned(),
    ))
}

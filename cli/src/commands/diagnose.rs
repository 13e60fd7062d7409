//! `appell diagnose`

use std::path::{Path, PathBuf};
use std::str::FromStr;

use appell_gap::data::{DataSet, Spec};
use appell_gap::diagnose::{self, Limit, Options};
use appell_gap::effects;
use serde_json::Value;

use crate::output;
use crate::{diagnosed, progress};
use appell::Error;
use appell::files;
use appell::source::Source;

/// Name of the table of the next experiment.
const EXPERIMENT: &str = "experiment.csv";

/// Tells where a model falls short of recordings, which effect it lacks, and how far the effect closes
/// the gap.
///
/// Every effect of the library is tried at every place of the mechanism where it makes sense. Test runs
/// are used only in the final step. The exit status is 0 whatever the verdict.
#[derive(Debug, clap::Args)]
pub(crate) struct Diagnose {
    /// Name of a shipped mechanism or path of a spec, instead of the one that the data set names
    model: Option<String>,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Files of effects of your own, which are tried beside those of the library
    #[arg(long, num_args = 1.., value_name = "FILE.toml")]
    effects: Vec<PathBuf>,
    /// Other specs of the same thing, each a hypothesis of its own; names of quantities join them to the
    /// recordings
    #[arg(long, num_args = 1.., value_name = "SPEC")]
    alternative: Vec<String>,
    /// Kinds of the library that are left out, such as `coulomb_friction`
    #[arg(long, num_args = 1.., value_name = "KIND")]
    without: Vec<String>,
    /// Write the gap report; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a page with drawings, laws over data and traces; it needs no network
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Where the next experiment goes if hypotheses are tied [default: experiment.csv beside the
    /// gap report, or experiment-2.csv where a file of yours has that name]
    #[arg(long, value_name = "FILE.csv")]
    experiment: Option<PathBuf>,
    /// Limits of an input or of a measured channel in that experiment, in the unit of its column
    /// [default: those of the recordings]
    #[arg(long, value_name = "NAME=FROM..TO", allow_hyphen_values = true)]
    limit: Vec<Span>,
}

/// `NAME=FROM..TO` in the unit of a column.
#[derive(Debug, Clone)]
struct Span {
    name: String,
    ends: [f64; 2],
}

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let read = || {
            let (name, span) = text.split_once('=')?;
            let (from, to) = span.split_once("..")?;
            let end = |text: &str| text.trim().parse().ok().filter(|end: &f64| end.is_finite());
            Some((name.trim().to_owned(), [end(from)?, end(to)?]))
        };
        let help = || "write NAME=FROM..TO with two numbers, such as F=-10..10".to_owned();
        let (name, ends) = read().ok_or_else(help)?;
        if ends[0] >= ends[1] {
            return Err(format!("{} is not less than {}", ends[0], ends[1]));
        }
        Ok(Self { name, ends })
    }
}

impl Diagnose {
    pub(super) fn run(&self) -> Result<(), Error> {
        let set = appell::recording::read(&self.data, self.model.as_deref())?;
        appell::recording::refuse_slow(&set)?;
        let (library, replaced) = self.library()?;
        let spinner = progress::spinner("reading");
        let options = Options {
            pictures: self.html.is_some(),
            limits: self.limits(&set)?,
            alternatives: self.alternatives()?,
        };
        let stage = |stage| spinner.set_message(stage);
        let report = diagnose::diagnose(&set, &library, &options, stage);
        spinner.finish_and_clear();
        let report = report.map_err(diagnosed::failure)?;
        let warnings = appell::recording::warnings(&set);
        let mut next = None;
        if let Some(experiment) = &report.experiment {
            let table = diagnosed::csv(&set, experiment);
            next = self.next(&table);
            if let Some(path) = &next {
                files::write(path, &table)?;
            }
        }
        if let Some(path) = &self.json {
            let mut json = diagnosed::json(&report, next.as_deref());
            json["data"] = [replaced.as_slice(), &warnings].concat().into();
            files::write_json(path, &json)?;
        }
        if let Some(path) = &self.html {
            files::write(path, &appell_report::gap::page(&set, &report))?;
        }
        let outputs = [&self.json, &self.html, &next];
        let mut text = diagnosed::text(&report, next.as_deref());
        text.extend(self.stepped_aside(next.as_deref()));
        for warning in &replaced {
            text.extend(["  effects   ", warning, "\n"]);
        }
        for warning in &warnings {
            text.extend(["  data      ", warning, "\n"]);
        }
        output::print_beside(&text, &outputs)
    }

    /// Where the table of the next experiment goes: beside the gap report, if that is a file, and over no
    /// file but the one that the gap report before has proposed. A recording of that experiment, under its
    /// name, has more columns.
    fn next(&self, table: &str) -> Option<PathBuf> {
        if self.experiment.is_some() {
            return self.experiment.clone();
        }
        let report = self.json.as_ref().filter(|path| !files::is_stdout(path))?;
        let before = files::read(report, files::MAX_DATA).ok();
        let before = before.and_then(|text| serde_json::from_str::<Value>(&text).ok());
        let proposed = before
            .as_ref()
            .and_then(|r| r["experiment"]["file"].as_str());
        let is_own = |name: &str, path: &Path| {
            let there = files::read(path, files::MAX_DATA).unwrap_or_default();
            proposed == Some(name) && there.lines().next() == table.lines().next()
        };
        let mut names = (1..).map(|number| match number {
            1 => EXPERIMENT.to_owned(),
            _ => EXPERIMENT.replace('.', &format!("-{number}.")),
        });
        let free = names.find(|name| {
            let path = report.with_file_name(name);
            path.symlink_metadata().is_err() || is_own(name, &path)
        });
        free.map(|name| report.with_file_name(name))
    }

    /// That a file was in the way of the next experiment, if one was.
    fn stepped_aside(&self, next: Option<&Path>) -> Option<String> {
        let name = next.filter(|_| self.experiment.is_none())?.file_name()?;
        (name != EXPERIMENT).then(|| {
            format!(
                "  next      {EXPERIMENT} is not from the gap report before and stays as it is\n"
            )
        })
    }

    /// The other specs.
    fn alternatives(&self) -> Result<Vec<Spec>, Error> {
        let specs = self.alternative.iter().map(|model| {
            let source = Source::find(model)?;
            Ok(Spec {
                file: source.file,
                text: source.text,
            })
        });
        specs.collect()
    }

    /// The limits in SI.
    fn limits(&self, set: &DataSet) -> Result<Vec<Limit>, Error> {
        let limit = |span: &Span| {
            let channel = set
                .channels
                .iter()
                .find(|channel| channel.column == span.name);
            let channel = channel.ok_or_else(|| {
                let columns: Vec<&str> = set.channels.iter().map(|c| c.column.as_str()).collect();
                Error::Usage(format!(
                    "`--limit {}`: there is no such column; there are {}",
                    span.name,
                    columns.join(", ")
                ))
            })?;
            let limits = span.ends.map(|end| end * channel.unit.scale);
            Ok((span.name.clone(), limits))
        };
        self.limit.iter().map(limit).collect()
    }

    /// The shipped effects and those of the user, and what is told of these.
    fn library(&self) -> Result<(Vec<effects::Effect>, Vec<String>), Error> {
        let wrong = |effects::EffectError(report)| Error::Report(report);
        let mut library = effects::shipped().map_err(wrong)?;
        for kind in &self.without {
            let before = library.len();
            library.retain(|effect| effect.name != *kind);
            if library.len() == before {
                let mut kinds: Vec<&str> = library.iter().map(|e| e.name.as_str()).collect();
                kinds.dedup();
                return Err(Error::Usage(format!(
                    "`--without {kind}`: the library has {}",
                    kinds.join(", ")
                )));
            }
        }
        let mut own = Vec::new();
        for path in &self.effects {
            let text = files::read(path, appell_spec::limits::MAX_FILE as u64)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let file = path.to_string_lossy();
            own.push(effects::Effect::read(&name, &file, &text).map_err(wrong)?);
        }
        let mut told = Vec::new();
        for (effect, path) in own.iter().zip(&self.effects) {
            if library.iter().any(|shipped| shipped.name == effect.name) {
                told.push(format!(
                    "warning: {}: the effect `{}` stands in place of that of the library",
                    path.display(),
                    effect.name
                ));
            }
        }
        library.retain(|shipped| own.iter().all(|effect| effect.name != shipped.name));
        library.append(&mut own);
        Ok((library, told))
    }
}

//! `appell diagnose`

use std::path::{Path, PathBuf};
use std::str::FromStr;

use appell::diagnosis::Library;
use appell::fleet::{self, Fleet, Rig};
use appell_gap::diagnose::{Limit, Options};
use appell_recordings::DataSet;
use serde_json::Value;

use crate::diagnosed;
use crate::failure::Error;
use crate::output::{self, shell};
use crate::progress;
use appell::files;

/// Default file name of the proposed experiment.
const EXPERIMENT: &str = "experiment.csv";
/// Default folder of the reports of several rigs.
const REPORTS: &str = "gap-reports";

/// Finds where a model deviates from recordings, and which effect closes the gap.
///
/// Every effect of the library is tried at every admissible site of the mechanism. Test runs are used
/// only in the final step. The exit status is 0 whatever the verdict.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell diagnose --data rig --json report.json --html gap.html")]
pub(crate) struct Diagnose {
    /// Name of a shipped mechanism, or path of a spec or a robot file, instead of the one that the data set names
    model: Option<String>,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names; several folders are
    /// diagnosed one by one and give a table
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Earlier recordings of the same rig: the report states the changes since then
    #[arg(long, num_args = 1.., value_name = "DIR")]
    against: Vec<PathBuf>,
    /// Files with additional effects, tried together with those of the library
    #[arg(long, num_args = 1.., value_name = "FILE.toml")]
    effects: Vec<PathBuf>,
    /// Alternative specs of the same mechanism, each a hypothesis; quantities are matched to the
    /// recordings by name
    #[arg(long, num_args = 1.., value_name = "SPEC")]
    alternative: Vec<String>,
    /// Effects of the library to leave out, such as `coulomb_friction`
    #[arg(long, num_args = 1.., value_name = "KIND")]
    without: Vec<String>,
    /// Write the gap report as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the report as a self-contained HTML page with drawings, force laws and traces
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
    /// Output file of the proposed experiment if hypotheses are tied [default: experiment.csv in
    /// the folder of the gap report, or experiment-2.csv if another file has that name]
    #[arg(long, value_name = "FILE.csv")]
    experiment: Option<PathBuf>,
    /// Limits of an input or measured channel in that experiment, in the unit of its column [default:
    /// those of the recordings]
    #[arg(long, value_name = "NAME=FROM..TO", allow_hyphen_values = true)]
    limit: Vec<Span>,
    /// Horizon of the predictions by which the gap is divided, in s [default: 1, or the longest that the
    /// held-out runs allow]
    #[arg(long, value_name = "S")]
    horizon_s: Option<f64>,
    /// Share of the gap of the re-fitted model below which an effect is immaterial [default: 0.02]
    #[arg(long, value_name = "PART", value_parser = part)]
    tolerance: Option<f64>,
    /// Folder for the reports of several rigs; rigs with a report there and unchanged data are not
    /// diagnosed again [default: gap-reports]
    #[arg(long, value_name = "DIR")]
    reports: Option<PathBuf>,
    /// Table of several rigs as CSV; `-` is standard output
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
    /// Rigs that are diagnosed at a time [default: one per processor]
    #[arg(long, value_name = "N")]
    jobs: Option<usize>,
}

/// `NAME=FROM..TO`, in the unit of a column.
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

/// A part of one.
fn part(text: &str) -> Result<f64, String> {
    let part = text.parse().ok().filter(|part| (0.0..1.0).contains(part));
    part.ok_or_else(|| "write a part of one, such as 0.02".to_owned())
}

impl Diagnose {
    pub(super) fn run(&self) -> Result<(), Error> {
        if self.data.len() > 1 && self.data.iter().all(|path| path.is_dir()) {
            return self.fleet();
        }
        let set = appell::recording::read(&self.data, self.model.as_deref())?;
        appell::recording::check(&set)?;
        let before = match self.against.as_slice() {
            [] => None,
            paths => Some(appell::recording::read(paths, self.model.as_deref())?),
        };
        let library = Library::of(&self.without, &self.effects)?;
        let replaced = &library.warnings;
        let options = Options {
            pictures: self.html.is_some(),
            limits: self.limits(&set)?,
            alternatives: appell::recording::specs(&self.alternative)?,
            horizon: self.horizon()?,
            tolerance: self.tolerance,
            present: Vec::new(),
        };
        let report = progress::during("reading", |spinner| {
            let stage = |stage| spinner.set_message(stage);
            library.diagnose(before.as_ref(), &set, &options, stage)
        })?;
        let warnings = appell::recording::warnings(&set);
        let mut next = None;
        if let Some(experiment) = &report.experiment {
            let table = appell::diagnosis::experiment_inputs(&set, experiment);
            next = self.next(&table);
            if let Some(path) = &next {
                files::write(path, &table)?;
            }
        }
        if let Some(path) = &self.json {
            let findings = [replaced.as_slice(), &warnings].concat();
            let json = appell::json::diagnosis(&report, next.as_deref(), &findings);
            files::write_json(path, &appell::json::in_names_of(&set, json))?;
        }
        if let Some(path) = &self.html {
            files::write(path, &appell::diagnosis::page(&set, &report))?;
        }
        let outputs = [&self.json, &self.html, &next];
        let mut text = diagnosed::text(&report, next.as_deref(), &self.apply(&set));
        text.extend(self.stepped_aside(next.as_deref()));
        for warning in replaced {
            text.extend(["  effects   ", warning, "\n"]);
        }
        for warning in &warnings {
            text.extend(["  data      ", warning, "\n"]);
        }
        output::print_beside(&set.named(&text), &outputs)
    }

    /// Several rigs: a report for each, and one table.
    fn fleet(&self) -> Result<(), Error> {
        let given = [
            ("--json", self.json.is_some()),
            ("--html", self.html.is_some()),
            ("--experiment", self.experiment.is_some()),
            ("--horizon-s", self.horizon_s.is_some()),
            ("--tolerance", self.tolerance.is_some()),
            ("--against", !self.against.is_empty()),
            ("--limit", !self.limit.is_empty()),
            ("--alternative", !self.alternative.is_empty()),
        ];
        if let Some((flag, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
            let message = format!(
                "`{flag}` belongs to one data set, and several are given\n  `--reports DIR` gets a report and a \
                 page for each, `--table FILE.csv` the table"
            );
            return Err(Error::Usage(message));
        }
        let folder = PathBuf::from(REPORTS);
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let library = Library::of(&self.without, &self.effects)?;
        let fleet = Fleet {
            folders: &self.data,
            model: self.model.as_deref(),
            library: &library,
            reports: self.reports.as_ref().unwrap_or(&folder),
            with_pages: true,
            workers: self.jobs.unwrap_or(processors),
        };
        let bar = progress::parts();
        bar.set_length(self.data.len() as u64);
        let done = |rig: &Rig| {
            bar.set_message(rig.name.clone());
            bar.inc(1);
        };
        let rigs = fleet.diagnose(done)?;
        bar.finish_and_clear();
        if let Some(path) = &self.table {
            files::write(path, &fleet::csv(&rigs))?;
        }
        output::print_beside(&diagnosed::table(&rigs, fleet.reports), &[&self.table])
    }

    /// The file of the proposed experiment: in the folder of the gap report, if that is a file. Only the table
    /// proposed by the previous gap report is overwritten; a recording of that experiment under the same name is
    /// recognised by its additional columns.
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

    /// The command that writes the diagnosed effect into the spec, after the one that writes the report if none was
    /// written.
    fn apply(&self, set: &DataSet) -> Vec<String> {
        let mut shipped = appell_models::ALL.iter();
        let is_shipped = shipped.any(|shipped| shipped.spec == set.spec.text);
        let model = match &self.model {
            Some(model) => model,
            None if is_shipped => &set.mechanism.name,
            None => &set.spec.file,
        };
        let model = shell(model);
        let apply = |report: &str| format!("appell apply {model} --report {report}");
        let written = self.json.as_deref();
        if let Some(report) = written.filter(|path| !files::is_stdout(path)) {
            return vec![apply(&shell(&report.to_string_lossy()))];
        }
        let data = self.data.iter().map(|path| shell(&path.to_string_lossy()));
        let data = data.collect::<Vec<_>>().join(" ");
        let given = (self.model.as_ref()).map(|model| format!("{} ", shell(model)));
        let given = given.unwrap_or_default();
        let diagnose = format!("appell diagnose {given}--data {data} --json gap.json");
        vec![diagnose, apply("gap.json")]
    }

    /// A note if an existing file was kept.
    fn stepped_aside(&self, next: Option<&Path>) -> Option<String> {
        let name = next.filter(|_| self.experiment.is_none())?.file_name()?;
        (name != EXPERIMENT).then(|| {
            format!(
                "  next      {EXPERIMENT} does not belong to the previous gap report and is not overwritten\n"
            )
        })
    }

    fn horizon(&self) -> Result<Option<f64>, Error> {
        match self.horizon_s {
            Some(horizon) if !(horizon.is_finite() && horizon > 0.0) => Err(Error::Usage(format!(
                "`--horizon-s {horizon}` is not a positive number of seconds"
            ))),
            horizon => Ok(horizon),
        }
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
                    "`--limit {}`: there is no such column; the columns are {}",
                    span.name,
                    columns.join(", ")
                ))
            })?;
            let limits = span.ends.map(|end| end * channel.unit.scale);
            Ok((span.name.clone(), limits))
        };
        self.limit.iter().map(limit).collect()
    }
}

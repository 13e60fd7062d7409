//! `appell identify`

use std::path::PathBuf;

use appell_gap::identify::{Begin, Options};

use crate::failure::Error;
use crate::output;
use crate::{engine, picture, progress};
use appell::files;
use appell_report::identification;

/// Estimates parameters from recordings by maximum likelihood.
///
/// The result includes confidence intervals and prediction errors on held-out runs. Parameters with a
/// tolerance in the data set are free, with the tolerance as prior; `--free` selects others. Levels of
/// measurement and process noise are estimated too, so that model errors do not narrow the intervals.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell identify rig/my_rig.toml --data rig --plot predicted.svg
  appell identify --data rig --free m")]
pub(crate) struct Identify {
    /// Mechanism of the recordings: a shipped one, a spec or a robot file [default: the one that a data set names]
    model: Option<String>,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Parameters to estimate
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    free: Option<Vec<String>>,
    /// Further unknowns: `tau.lag` and `tau.delay` of an input, `theta.bias`, `theta.scale` and
    /// `theta.delay` of a channel
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    also: Vec<String>,
    /// Parameters that drift as a random walk, each with the standard deviation of its change in one second
    #[arg(long, value_delimiter = ',', value_name = "NAME=RATE", value_parser = drift)]
    drifting: Vec<(String, f64)>,
    /// Start of the optimisation: the nominal values, or, if these are far from the truth, the result
    /// of multiple shooting
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Start::Nominal)]
    start: Start,
    /// Write the results as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the held-out runs with their predictions
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write a self-contained HTML report
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
}

/// `k=0.01`
fn drift(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=');
    let parts = parts.and_then(|(name, rate)| Some((name.to_owned(), rate.parse().ok()?)));
    parts.ok_or_else(|| "write a name and a rate, such as `k=0.01`".to_owned())
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Start {
    Nominal,
    Shooting,
}

impl Identify {
    pub(super) fn run(&self) -> Result<(), Error> {
        let set = appell::recording::read(&self.data, self.model.as_deref())?;
        appell::recording::check(&set)?;
        let model = engine::model_of(appell::recording::source(&set))?;
        let options = Options {
            free: self.free.clone(),
            additional: self.also.clone(),
            drifting: self.drifting.clone(),
            allow_none: false,
            begin: match self.start {
                Start::Nominal => Begin::Nominal,
                Start::Shooting => Begin::Shooting,
            },
            rough: false,
        };
        let answer = progress::during("reading", |spinner| {
            model.identify(&set, &options, |stage| spinner.set_message(stage))
        })?;
        output::json(self.json.as_deref(), || {
            let own = appell::json::identification(&set, &answer);
            appell::json::in_names_of(&set, own)
        })?;
        if let Some(path) = &self.plot {
            picture::write(path, &identification::figure(&set, &answer).to_svg())?;
        }
        if let Some(path) = &self.html {
            files::write(path, &set.named(&identification::page(&set, &answer)))?;
        }
        let outputs = [&self.json, &self.plot, &self.html];
        output::print_beside(&set.named(&identification::text(&set, &answer)), &outputs)
    }
}

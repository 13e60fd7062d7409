//! `appell identify`

use std::path::PathBuf;

use appell_gap::identify::{self, Begin, Options};

use crate::output;
use crate::{identified, picture, progress};
use appell::Error;
use appell::files;
use appell::source::Source;
use appell_report::identification;

/// Finds the parameters that make recordings most likely, with intervals, and tells how well the
/// model then predicts the runs that were held out.
///
/// Parameters with a tolerance in the data set are free, within it; `--free` chooses others. Levels of
/// noise and of disturbing forces are estimated too, so that what the model lacks does not narrow the
/// intervals.
#[derive(Debug, clap::Args)]
pub(crate) struct Identify {
    /// Name of a shipped mechanism or path of a spec
    model: String,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Parameters to look for
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    free: Option<Vec<String>>,
    /// What to look for besides: `tau.lag` and `tau.delay` of an input, `theta.bias`, `theta.scale` and
    /// `theta.delay` of a channel
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    also: Vec<String>,
    /// Parameters that change on the way, each with the standard deviation of its change in one second
    #[arg(long, value_delimiter = ',', value_name = "NAME=RATE", value_parser = drift)]
    drifting: Vec<(String, f64)>,
    /// Where the search begins: at the values of the rig, or, if these are far from the truth, where
    /// multiple shooting leads from them
    #[arg(long, value_name = "WHERE", value_enum, default_value_t = Start::Nominal)]
    start: Start,
    /// Write everything in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the runs that were held out beside predictions of them
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
    /// Write a page with all of it
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
        let set = appell::recording::read(&self.data, Some(&self.model))?;
        appell::recording::refuse_slow(&set)?;
        let equations = crate::engine::equations_for_estimation(&Source::find(&self.model)?)?;
        let spinner = progress::spinner("reading");
        let options = Options {
            free: self.free.clone(),
            also: self.also.clone(),
            drifting: self.drifting.clone(),
            none_will_do: false,
            begin: match self.start {
                Start::Nominal => Begin::Nominal,
                Start::Shooting => Begin::Shooting,
            },
        };
        let answer = identify::identify(&set, equations.model(), &options, |stage| {
            spinner.set_message(stage);
        });
        spinner.finish_and_clear();
        let answer = answer.map_err(|error| identified::failure(&error))?;
        if let Some(path) = &self.json {
            files::write_json(path, &identified::json(&set, &answer))?;
        }
        if let Some(path) = &self.plot {
            picture::write(path, &identification::figure(&set, &answer).to_svg())?;
        }
        if let Some(path) = &self.html {
            files::write(path, &identification::page(&set, &answer))?;
        }
        let outputs = [&self.json, &self.plot, &self.html];
        output::print_beside(&identification::text(&set, &answer), &outputs)
    }
}

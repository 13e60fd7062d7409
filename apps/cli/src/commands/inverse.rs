//! `appell inverse`

use std::path::PathBuf;

use appell::inverse::Options;
use appell_report::figure::Figure;

use crate::failure::Error;
use crate::output;
use crate::{engine, picture, progress, relations};

/// Computes the inputs of recorded motions, and parameters from input-free equations.
///
/// If a mechanism has more equations of motion than inputs, some combinations of them hold whatever
/// the inputs were. They are weighted by the noise of the recordings, through splines and exact
/// derivatives. All coordinates that enter the equations must be measured; inputs need not be.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell motion capture/skeleton.toml capture/ride_1.csv capture/ride_2.csv --out rides
  appell inverse euc_3dof --data rides --free h --bias phi --plot torque.svg")]
pub(crate) struct Inverse {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Parameters to estimate
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    free: Vec<String>,
    /// Columns that may have a constant bias
    #[arg(long, value_delimiter = ',', value_name = "COLUMNS")]
    bias: Vec<String>,
    /// Write the results as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draw the inputs of the first runs with 95 % bands
    #[arg(long, value_name = "FILE.svg|png")]
    plot: Option<PathBuf>,
}

impl Inverse {
    pub(super) fn run(&self) -> Result<(), Error> {
        let set = appell::recording::read(&self.data, Some(&self.model))?;
        let model = engine::model_of(appell::recording::source(&set))?;
        let options = Options {
            free: self.free.clone(),
            biased: self.bias.clone(),
        };
        let answer = progress::during("evaluating the equations of motion", |_| {
            model.inverse(&set, &options)
        })?;
        let info = model.info();
        output::json(self.json.as_deref(), || {
            appell::json::inverse(info, &answer)
        })?;
        if let Some(path) = &self.plot {
            picture::write(path, &Figure::of_inputs(info, &answer).to_svg())?;
        }
        output::print_beside(&relations::text(&answer), &[&self.json, &self.plot])
    }
}

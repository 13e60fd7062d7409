//! `appell base`

use std::path::PathBuf;

use crate::failure::Error;
use crate::{engine, output, progress};

/// Finds the identifiable combinations of masses, inertias and load parameters, and estimates them.
///
/// Inverse dynamics is linear in these parameters. Those with linearly dependent effects in every motion are
/// combined into a base parameter; some parameters affect no motion. With recordings of a motion and of all
/// inputs, weighted least squares give the values with intervals, and the residual forces in training and test
/// runs.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell base double_pendulum
  appell base rig/my_rig.toml --data rig --json base.json
  appell derive double_pendulum --regressor --out regressor.py")]
pub(crate) struct Base {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Write the results as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Base {
    pub(super) fn run(&self) -> Result<(), Error> {
        let set = match self.data.as_slice() {
            [] => None,
            data => Some(appell::recording::read(data, Some(&self.model))?),
        };
        let model = engine::model(&self.model, &[], None)?;
        let found = progress::during("finding combinations of parameters", |_| {
            model.base_parameters(set.as_ref())
        })?;
        output::json(self.json.as_deref(), || found.to_json())?;
        output::print_beside(&found.to_text(), &[&self.json])
    }
}

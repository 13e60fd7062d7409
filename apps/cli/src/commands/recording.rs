//! `appell recording`

use std::path::PathBuf;

use crate::failure::Error;
use crate::output;
use appell::files;
use appell_report::recording::text;

/// Summarises recordings: runs, sampling, noise of each channel, suspected errors.
///
/// A data set is a folder with a `recording.toml`. CSV files alone need `--model`, and columns with
/// the names and units of the spec.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell recording rig")]
pub(crate) struct Recording {
    /// Folder of a data set, or CSV files
    #[arg(required = true)]
    data: Vec<PathBuf>,
    /// Mechanism of CSV files, or instead of the one that a data set names
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Write the summary as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Recording {
    pub(super) fn run(&self) -> Result<(), Error> {
        let set = appell::recording::read(&self.data, self.model.as_deref())?;
        if let Some(path) = &self.json {
            files::write_json(path, &appell::json::recording(&set))?;
        }
        output::print_beside(&text(&set), &[&self.json])
    }
}

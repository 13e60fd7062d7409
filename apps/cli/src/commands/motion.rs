//! `appell motion`

use std::fmt::Write as _;
use std::path::PathBuf;

use appell::capture;

use crate::failure::Error;
use crate::output;

/// Converts motion capture of a vehicle and its rider to recordings of a model.
///
/// A skeleton file defines the captured rigid bodies, the mass distribution of the rider, and the
/// coordinates of the model. The data set contains these coordinates, for `appell inverse`, `identify`
/// and `recording`, and all intermediate quantities.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell motion capture/skeleton.toml capture/ride_1.csv capture/ride_2.csv --out rides")]
pub(crate) struct Motion {
    /// The skeleton file
    skeleton: PathBuf,
    /// Captures, one CSV file for each run
    #[arg(required = true, value_name = "CSV")]
    captures: Vec<PathBuf>,
    /// Output folder of the data set
    #[arg(long, short, value_name = "DIR", default_value = "recording")]
    out: PathBuf,
    /// Write a summary as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Motion {
    pub(super) fn run(&self) -> Result<(), Error> {
        let converted = capture::convert(&self.skeleton, &self.captures)?;
        let manifest = converted.write(&self.out)?;
        output::json(self.json.as_deref(), || converted.to_json())?;
        let skeleton = &converted.skeleton;
        let mut text = format!(
            "{}\n  {} bodies, {} segments of {} kg by {}\n  derivatives over {} frames\n",
            skeleton.description,
            skeleton.bodies.len(),
            skeleton.rider.segments.len(),
            skeleton.rider.mass,
            skeleton.rider.table.source,
            converted.window,
        );
        // Writing to a string cannot fail.
        for finding in &converted.findings {
            let _ = writeln!(text, "  {finding}");
        }
        let _ = writeln!(text, "  {}", manifest.display());
        output::print_beside(&text, &[&self.json])
    }
}

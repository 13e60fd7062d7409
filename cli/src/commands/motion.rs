//! `appell motion`

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use appell_gap::data::MANIFEST;
use appell_gap::motion_capture::{self, Capture, Ride, Skeleton, Smoothed};
use serde_json::json;

use crate::output;
use appell::Error;
use appell::files;

/// Largest skeleton file in bytes.
const MAX_SKELETON: u64 = 1 << 20;

/// Converts motion capture of a vehicle and its rider to recordings of a model.
///
/// A skeleton file defines the captured rigid bodies, the mass distribution of the rider, and the
/// coordinates of the model. The data set contains these coordinates, for `appell inverse`, `identify`
/// and `recording`, and all intermediate quantities.
#[derive(Debug, clap::Args)]
pub(crate) struct Motion {
    /// The skeleton file
    skeleton: PathBuf,
    /// Captures, one CSV file for each run
    #[arg(required = true, value_name = "CSV")]
    captures: Vec<PathBuf>,
    /// Output folder of the data set
    #[arg(long, value_name = "DIR", default_value = "recording")]
    out: PathBuf,
    /// Write a summary as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl Motion {
    pub(super) fn run(&self) -> Result<(), Error> {
        let text = files::read(&self.skeleton, MAX_SKELETON)?;
        let name = self.skeleton.to_string_lossy();
        let skeleton = Skeleton::parse(&name, &text)?;
        let mut names = Vec::new();
        let mut rides = Vec::new();
        let mut findings = Vec::new();
        for path in &self.captures {
            let file = file_name(path, &names)?;
            let (capture, found) = Capture::read(path, &skeleton)?;
            findings.extend(
                found.iter().map(|finding| {
                    format!("{file}: {}", appell_report::recording::sentence(finding))
                }),
            );
            rides.push(Ride::of(&skeleton, &capture));
            names.push(file);
        }
        let wrong =
            |error: appell_estimate::smoothing::SamplesError| Error::Data(error.to_string());
        let filter = motion_capture::filter(&rides).map_err(wrong)?;
        for (name, ride) in names.iter().zip(&rides) {
            let smoothed = Smoothed::of(ride, filter).map_err(wrong)?;
            let table = motion_capture::table(&skeleton, ride, &smoothed);
            files::write(&self.out.join(name), &table)?;
        }
        let manifest = motion_capture::manifest(&skeleton, &names);
        files::write(&self.out.join(MANIFEST), &manifest)?;
        if let Some(path) = &self.json {
            let told = json!({
                "schema": "motion/1", "mechanism": skeleton.mechanism, "runs": names,
                "bodies": skeleton.bodies, "window": filter.count(), "findings": findings,
                "rider": { "mass": skeleton.rider.mass, "table": skeleton.rider.table.source },
            });
            files::write_json(path, &told)?;
        }
        let mut text = format!(
            "{}\n  {} bodies, {} segments of {} kg by {}\n  derivatives over {} frames\n",
            skeleton.description,
            skeleton.bodies.len(),
            skeleton.rider.segments.len(),
            skeleton.rider.mass,
            skeleton.rider.table.source,
            filter.count(),
        );
        // Writing to a string cannot fail.
        for finding in &findings {
            let _ = writeln!(text, "  {finding}");
        }
        let _ = writeln!(text, "  {}", self.out.join(MANIFEST).display());
        output::print_beside(&text, &[&self.json])
    }
}

/// The name of a run: the file name of its capture.
fn file_name(path: &Path, taken: &[String]) -> Result<String, Error> {
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    if taken.contains(&name) {
        let message = format!("two captures are named {name}; each run needs a unique name");
        return Err(Error::Usage(message));
    }
    Ok(name)
}

//! Motion capture, converted to recordings of a model.

use std::path::{Path, PathBuf};

use appell_recordings::MANIFEST;
pub use appell_recordings::motion_capture::Skeleton;
use appell_recordings::motion_capture::{self, Capture, Ride, Smoothed};
use serde_json::{Value, json};

use crate::{Error, Field, files};

/// Largest skeleton file in bytes.
const MAX_SKELETON: u64 = 1 << 20;

/// A data set made of captures.
pub struct Converted {
    /// The captures, which are never overwritten.
    originals: Vec<PathBuf>,
    /// Captured bodies, rider and channels.
    pub skeleton: Skeleton,
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Number of frames over which derivatives are taken.
    pub window: usize,
    /// Findings about the captures, one sentence each.
    pub findings: Vec<String>,
    tables: Vec<String>,
}

/// Converts captures, one CSV file for each run, by a skeleton file: the captured bodies, the mass
/// distribution of the rider and the coordinates of the model.
pub fn convert(skeleton: &Path, captures: &[PathBuf]) -> Result<Converted, Error> {
    let text = files::read(skeleton, MAX_SKELETON)?;
    let skeleton = Skeleton::parse(&skeleton.to_string_lossy(), &text)?;
    let (mut runs, mut rides, mut findings) = (Vec::new(), Vec::new(), Vec::new());
    let originals: Vec<PathBuf> = (captures.iter())
        .filter_map(|path| path.canonicalize().ok())
        .collect();
    for path in captures {
        let run = file_name(path, &runs)?;
        let (capture, found) = Capture::read(path, &skeleton)?;
        let found = appell_report::recording::sentences(&found);
        findings.extend(found.iter().map(|finding| format!("{run}: {finding}")));
        rides.push(Ride::of(&skeleton, &capture));
        runs.push(run);
    }
    let unusable = |error| Error::data(&skeleton.mechanism, format!("{error}"));
    let filter = motion_capture::filter(&rides).map_err(unusable)?;
    let table = |ride: &Ride| {
        let smoothed = Smoothed::of(ride, filter).map_err(unusable)?;
        Ok(motion_capture::table(&skeleton, ride, &smoothed))
    };
    let tables = rides.iter().map(table).collect::<Result<_, Error>>()?;
    Ok(Converted {
        originals,
        window: filter.count(),
        skeleton,
        runs,
        findings,
        tables,
    })
}

impl Converted {
    /// Writes the data set to a folder; returns the path of its manifest.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, Error> {
        let path = |run: &String| folder.join(run);
        let is_original = |path: &PathBuf| {
            let path = path.canonicalize();
            path.is_ok_and(|path| self.originals.contains(&path))
        };
        if let Some(path) = self.runs.iter().map(path).find(is_original) {
            let message = format!(
                "{} is a capture and would be overwritten; choose another folder",
                path.display()
            );
            return Err(Error::request(Field::Recordings, message));
        }
        files::make_folder(folder)?;
        for (run, table) in self.runs.iter().zip(&self.tables) {
            files::write(&path(run), table)?;
        }
        let manifest = folder.join(MANIFEST);
        files::write(
            &manifest,
            &motion_capture::manifest(&self.skeleton, &self.runs),
        )?;
        Ok(manifest)
    }

    /// The summary as JSON.
    pub fn to_json(&self) -> Value {
        let skeleton = &self.skeleton;
        json!({
            "schema": "motion/1", "mechanism": skeleton.mechanism, "runs": self.runs,
            "bodies": skeleton.bodies, "window": self.window, "findings": self.findings,
            "rider": { "mass": skeleton.rider.mass, "table": skeleton.rider.table.source },
        })
    }
}

/// The name of a run: the file name of its capture.
fn file_name(path: &Path, taken: &[String]) -> Result<String, Error> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if taken.iter().any(|other| *other == name) {
        let message = format!("two captures are named {name}; each run needs a unique name");
        return Err(Error::request(Field::Recordings, message));
    }
    Ok(name.into_owned())
}

//! Many rigs diagnosed: a report for each, and one table.
//!
//! Rigs are independent and run in parallel. A report has a fingerprint of its inputs: if the folder, its spec and the
//! library are unchanged, the report is reused, so that an interrupted fleet can be resumed. A rig without a diagnosis
//! is a row with the reason.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Component, Path, PathBuf};

use appell_gap::diagnose::{ENGINE, Options};
use rayon::ThreadPoolBuilder;
use rayon::prelude::*;
use serde_json::Value;

use crate::diagnosis::Library;
use crate::gap_report::GapReport;
use crate::json::in_names_of;
use crate::{Error, Field, diagnosis, files, gap_report, recording};

/// Folders to be diagnosed with the same options.
#[derive(Debug)]
pub struct Fleet<'a> {
    /// A data set each.
    pub folders: &'a [PathBuf],
    /// The mechanism, instead of those that the folders name.
    pub model: Option<&'a str>,
    /// The effects.
    pub library: &'a Library,
    /// Folder of the reports.
    pub reports: &'a Path,
    /// Whether pages are written with them.
    pub with_pages: bool,
    /// Number of rigs diagnosed in parallel.
    pub workers: usize,
}

/// A rig after its diagnosis.
#[derive(Debug)]
pub struct Rig {
    /// Name of the folder, with parent folders if ambiguous.
    pub name: String,
    /// Its report, or why there is none.
    pub outcome: Result<GapReport, String>,
    /// Whether its report was reused.
    pub is_known: bool,
}

impl Fleet<'_> {
    /// Diagnoses all folders; `done` is called with each rig as it is finished.
    pub fn diagnose(&self, done: impl Fn(&Rig) + Sync) -> Result<Vec<Rig>, Error> {
        if self.folders.is_empty() {
            return Err(Error::request(Field::Recordings, "there are no folders"));
        }
        let names = names(self.folders);
        let workers = self.workers.clamp(1, self.folders.len());
        let pool = ThreadPoolBuilder::new().num_threads(workers).build();
        let rigs = self.folders.par_iter().zip(&names).with_max_len(1);
        let rigs = rigs.map(|(folder, name)| {
            let rig = self.rig(folder, name);
            done(&rig);
            rig
        });
        Ok(pool.map_err(Error::computation)?.install(|| rigs.collect()))
    }

    fn rig(&self, folder: &Path, name: &str) -> Rig {
        // One rig must not take the others with it, whatever happens.
        let diagnosed = catch_unwind(AssertUnwindSafe(|| self.report(folder, name)));
        let failed = || Err("the diagnosis ended unexpectedly: please report it".to_owned());
        let outcome =
            diagnosed.map_or_else(|_| failed(), |told| told.map_err(|error| error.to_string()));
        let is_known = matches!(outcome, Ok((_, true)));
        Rig {
            name: name.to_owned(),
            outcome: outcome.map(|(report, _)| report),
            is_known,
        }
    }

    /// The report of a folder, and whether it was there.
    fn report(&self, folder: &Path, name: &str) -> Result<(GapReport, bool), Error> {
        let path = self.reports.join(format!("{name}.json"));
        let set = recording::read(&[folder.to_owned()], self.model)?;
        let of = self.fingerprint(folder, &set.spec.text)?;
        let known = files::read(&path, files::MAX_DATA).ok();
        let known = known.and_then(|text| serde_json::from_str::<Value>(&text).ok());
        files::make_folder(self.reports)?;
        let page_path = self.reports.join(format!("{name}.html"));
        let has_page = !self.with_pages || page_path.is_file();
        if let Some(known) = known.filter(|known| known["of"] == of.as_str() && has_page) {
            return Ok((serde_json::from_value(known)?, true));
        }
        let options = Options {
            pictures: self.with_pages,
            ..Options::default()
        };
        let report = self.library.diagnose(None, &set, &options, |_| {})?;
        let warnings = recording::warnings(&set);
        let findings = [self.library.warnings.as_slice(), &warnings].concat();
        let json = gap_report::json(&report, None, &findings);
        let mut json = in_names_of(&set, json);
        json["of"] = of.into();
        if self.with_pages {
            files::write(&page_path, &diagnosis::page(&set, &report))?;
        }
        files::write_json(&path, &json)?;
        Ok((serde_json::from_value(json)?, false))
    }

    /// Fingerprint of the inputs of a report: the files of the folder, the spec, the library, the engine.
    fn fingerprint(&self, folder: &Path, spec: &str) -> Result<String, Error> {
        let mut hash = Fnv::new();
        hash.add(&ENGINE.to_le_bytes());
        hash.add(spec.as_bytes());
        hash.add(self.library.fingerprint().as_bytes());
        let folder = if folder.is_dir() {
            folder
        } else {
            folder.parent().unwrap_or(folder)
        };
        let entries = std::fs::read_dir(folder).map_err(Error::reading(folder))?;
        let mut paths = Vec::new();
        for entry in entries {
            let path = entry.map_err(Error::reading(folder))?.path();
            let is_report = path.extension().is_some_and(|own| own == "json");
            if path.is_file() && !is_report {
                paths.push(path);
            }
        }
        paths.sort();
        for path in paths {
            hash.add(path.file_name().unwrap_or_default().as_encoded_bytes());
            hash.add(&std::fs::read(&path).map_err(Error::reading(&path))?);
        }
        Ok(format!("{:016x}", hash.0))
    }
}

/// The table as CSV; a rig without a diagnosis has its reason in the last column.
pub fn csv(rigs: &[Rig]) -> String {
    let mut text = "rig,mechanism,verdict,which,probability,horizon_s,nominal,with_effect,closed,budget,error\n"
        .to_owned();
    for rig in rigs {
        let cells = match &rig.outcome {
            Ok(report) => cells(report),
            Err(reason) => {
                let mut cells = vec![String::new(); 9];
                cells.push(reason.clone());
                cells
            }
        };
        let cells = std::iter::once(rig.name.clone()).chain(cells);
        let quoted: Vec<String> = cells.map(|cell| quoted(&cell)).collect();
        text += &quoted.join(",");
        text.push('\n');
    }
    text
}

fn cells(report: &GapReport) -> Vec<String> {
    let (first, probability) = report.first();
    let far = report.how_far.as_ref();
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.6e}"));
    vec![
        report.mechanism.clone(),
        report.verdict.clone(),
        first,
        number(Some(probability)),
        number(far.and_then(|far| far.horizon_s)),
        number(far.and_then(|far| far.nominal)),
        number(far.and_then(|far| far.with_effect)),
        number(far.and_then(|far| far.closed)),
        report.budget(),
        String::new(),
    ]
}

/// A cell of a CSV file.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\"").replace('\n', " "))
    } else {
        text.to_owned()
    }
}

/// The shortest trailing parts of the paths that distinguish them.
fn names(folders: &[PathBuf]) -> Vec<String> {
    let parts: Vec<Vec<String>> = folders
        .iter()
        .map(|folder| {
            let folder = match folder.file_name() {
                Some(name) if name == appell_recordings::MANIFEST => {
                    folder.parent().unwrap_or(folder)
                }
                _ => folder,
            };
            let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
            let parts = whole.components().rev();
            // The root has no name, and `..` is not one.
            let parts = parts.filter(|part| matches!(part, Component::Normal(_)));
            let own = parts.map(|part| part.as_os_str().to_string_lossy().into_owned());
            own.collect()
        })
        .collect();
    let name = |own: &Vec<String>, length: usize| {
        let last = own.iter().take(length).rev();
        last.cloned().collect::<Vec<_>>().join("_")
    };
    let shortest = |own: &Vec<String>| {
        let is_own = |length: &usize| {
            let same = parts
                .iter()
                .filter(|other| name(other, *length) == name(own, *length));
            same.count() == 1
        };
        let length = (1..=own.len()).find(is_own);
        name(own, length.unwrap_or(own.len()))
    };
    let mut names: Vec<String> = parts.iter().map(shortest).collect();
    // A folder that is given twice.
    for place in 1..names.len() {
        if names[..place].contains(&names[place]) {
            names[place] = format!("{}_{}", names[place], place + 1);
        }
    }
    names
}

/// The hash of Fowler, Noll and Vo: the same in every run and on every machine.
struct Fnv(u64);

impl Fnv {
    const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
        // Separator between parts.
        self.0 = (self.0 ^ 0x1ff).wrapping_mul(0x0100_0000_01b3);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigs_are_named_by_as_much_as_tells_them_apart() {
        let folders = ["a/x", "b/x", "b/y"].map(PathBuf::from);
        assert_eq!(names(&folders), ["a_x", "b_x", "y"]);
        let twice = ["a/x", "a/x"].map(PathBuf::from);
        let names = names(&twice);
        assert_ne!(names[0], names[1]);
    }

    #[test]
    fn a_reason_with_commas_stays_one_cell() {
        let rig = Rig {
            name: "rig".to_owned(),
            outcome: Err("no \"run\", no gap".to_owned()),
            is_known: false,
        };
        let table = csv(&[rig]);
        assert!(
            table.ends_with("rig,,,,,,,,,,\"no \"\"run\"\", no gap\"\n"),
            "{table}"
        );
    }
}

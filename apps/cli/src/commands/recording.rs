//! `appell recording`

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::failure::Error;
use crate::output;
use appell::files;
use appell_report::recording::text;

/// Summarises recordings: runs, sampling, noise of each channel, suspected errors.
///
/// A data set is a folder with a `recording.toml`. CSV files alone need `--model`, and columns with
/// the names and units of the spec.
///
/// `--write` drafts a `recording.toml` for recordings of a spec or a robot file: it assigns columns to positions, rates,
/// torques and commands of joints, finds units, signs, noise and delays of commands, and asks for missing facts.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell recording rig
  appell recording rig/my_rig.toml rig/run1.csv rig/run2.csv rig/run3.csv --write rig/drafted.toml")]
pub(crate) struct Recording {
    /// Folder of a data set, or CSV files; with `--write` the spec or robot file, then recordings of any format
    #[arg(required = true)]
    data: Vec<PathBuf>,
    /// Mechanism of CSV files, or instead of the one that a data set names
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,
    /// Write the summary as JSON, in SI; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Draft the description of recordings; `-` is standard output
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Overwrite the description
    #[arg(long, requires = "write")]
    force: bool,
    /// Rows per second of recordings without a column of the times
    #[arg(long, value_name = "HZ", requires = "write")]
    rate_hz: Option<f64>,
}

impl Recording {
    pub(super) fn run(&self) -> Result<(), Error> {
        if let Some(path) = &self.write {
            return self.draft(path);
        }
        if let (None, [first, _, ..]) = (&self.model, &self.data[..])
            && first.is_file()
            && !first.ends_with("recording.toml")
            && !appell::recording::is_recording(first)
        {
            let mechanism = first.display();
            return Err(Error::Usage(format!(
                "`{mechanism}` comes before its recordings where a description is drafted: add --write recording.toml; or \
                 summarise files with the names of its spec by --model {mechanism}"
            )));
        }
        let set = appell::recording::read(&self.data, self.model.as_deref())?;
        output::json(self.json.as_deref(), || appell::json::recording(&set))?;
        output::print_beside(&text(&set), &[&self.json])
    }

    /// Drafts the description of recordings.
    fn draft(&self, path: &Path) -> Result<(), Error> {
        let is_stdout = files::is_stdout(path);
        if !is_stdout && !self.force && path.exists() {
            let message = format!("`{}` exists already; --force overwrites it", path.display());
            return Err(Error::Usage(message));
        }
        let same = |own: &PathBuf| match (own.canonicalize(), path.canonicalize()) {
            (Ok(own), Ok(path)) => own == path,
            _ => false,
        };
        if self.data.iter().any(same) {
            let message = format!("`{}` is what the draft is made from", path.display());
            return Err(Error::Usage(message));
        }
        let (mechanism, runs) = match (&self.model, &self.data[..]) {
            (Some(model), runs) => (model.clone(), runs),
            (None, [mechanism, runs @ ..]) => (mechanism.to_string_lossy().into_owned(), runs),
            (None, []) => (String::new(), &[][..]),
        };
        let drafted = appell::recording::draft(&mechanism, runs, path, self.rate_hz)?;
        if let (Some(to), Some(set)) = (&self.json, &drafted.set) {
            files::write_json(to, &appell::json::recording(set))?;
        }
        files::write(path, &drafted.text)?;
        let mut told = drafted.set.as_ref().map(text).unwrap_or_default();
        if !told.is_empty() {
            told.push('\n');
        }
        if !is_stdout {
            let _ = writeln!(told, "wrote {}", path.display());
        }
        match drafted.questions.len() {
            0 => told.push_str("no questions: units, signs and joints are certain\n"),
            _ => told.push_str("questions:\n"),
        }
        for question in &drafted.questions {
            let _ = writeln!(told, "  ? {question}");
        }
        told.push_str("next: write under [parameters] how well you know the numbers of the model; those of the draft are usual ones\n");
        output::print_beside(&told, &[&self.json, &self.write])
    }
}

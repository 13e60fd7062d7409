//! `appell apply`

use std::fs;
use std::path::{Path, PathBuf};

use appell::correction::{self, Correction};
use appell::difference::unified;
use appell::gap_report::GapReport;
use appell::source::Source;
use appell::{files, robot};

use crate::failure::Error;
use crate::output;

/// Writes the spec with the effect identified by a gap report.
///
/// Comments and layout of the spec are kept. Parameters fitted together with the effect are updated,
/// within their tolerances. Effects that a spec cannot express, such as an actuator delay or a sensor
/// bias, are listed with the place where they belong. Of an MJCF or URDF file only the numbers change; what it
/// cannot express stands in a comment at its head.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell apply rig/my_rig.toml --report report.json --out better.toml
  appell apply rig/my_rig.toml --report report.json --dry-run")]
pub(crate) struct Apply {
    /// Name of a shipped mechanism, or path of a spec or of an MJCF or URDF file, as diagnosed
    model: String,
    /// Gap report of `appell diagnose --json`
    #[arg(long, value_name = "FILE.json")]
    report: PathBuf,
    /// Number of the hypothesis in the report [default: the most probable one]
    #[arg(long, value_name = "N")]
    hypothesis: Option<usize>,
    /// Output file, `-` is standard output [default: name of the mechanism with `_improved.toml`; an
    /// existing file is not overwritten]
    #[arg(long, short, value_name = "FILE.toml")]
    out: Option<PathBuf>,
    /// Shows the changes of the file as a diff, and writes nothing
    #[arg(long)]
    dry_run: bool,
    /// Writes the list of changes as JSON, `-` is standard output
    #[arg(long, value_name = "FILE.json")]
    json: Option<PathBuf>,
}

impl Apply {
    pub(super) fn run(&self) -> Result<(), Error> {
        let path = Path::new(&self.model);
        if path.is_file() {
            let text = files::read(path, files::MAX_DATA)?;
            if robot::Format::of(&text).is_some() {
                return self.robot(path, &text);
            }
        }
        let source = Source::find(&self.model)?;
        let report = GapReport::read(&self.report)?;
        let out = self.out(|| PathBuf::from(format!("{}_improved.toml", report.mechanism)));
        let file = out.to_string_lossy();
        let improved = source.improved(&report, self.hypothesis, &file)?;
        if improved.text == source.text && !self.dry_run && self.json.is_none() {
            return output::print(&improved.summary("nothing to write"));
        }
        self.deliver(&out, &source.text, &improved)
    }

    /// Corrects a robot file.
    fn robot(&self, path: &Path, text: &str) -> Result<(), Error> {
        let report = GapReport::read(&self.report)?;
        let correction = correction::correct(path, text, &report, self.hypothesis)?;
        let out = self.out(|| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            let end = path.extension().unwrap_or_default().to_string_lossy();
            path.with_file_name(format!("{stem}_improved.{end}"))
        });
        self.deliver(&out, text, &correction)
    }

    fn out(&self, default: impl FnOnce() -> PathBuf) -> PathBuf {
        self.out.clone().unwrap_or_else(default)
    }

    /// Writes the changed text, or shows how it differs.
    fn deliver(&self, out: &Path, before: &str, corrected: &Correction) -> Result<(), Error> {
        let (file, after) = (out.to_string_lossy(), &corrected.text);
        let difference = unified(&self.model, &file, before, after);
        if !self.dry_run {
            self.may_replace(out, after)?;
            files::write(out, after)?;
        }
        if let Some(path) = &self.json {
            let mut edits = corrected.json();
            edits["schema"] = "apply/1".into();
            edits["diff"] = difference.as_str().into();
            files::write_json(path, &edits)?;
        }
        if self.dry_run {
            return output::print_beside(&difference, &[&self.json]);
        }
        let outputs = [&Some(out.to_owned()), &self.json];
        output::print_beside(&corrected.summary(&file), &outputs)
    }

    /// Refuses to overwrite a file that was not named.
    fn may_replace(&self, out: &Path, text: &str) -> Result<(), Error> {
        if self.out.is_none() && fs::read(out).is_ok_and(|there| there != text.as_bytes()) {
            let file = out.to_string_lossy();
            return Err(Error::Usage(format!(
                "{file} exists with other contents; to replace it, name it with `-o {file}`"
            )));
        }
        Ok(())
    }
}

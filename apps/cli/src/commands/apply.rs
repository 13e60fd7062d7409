//! `appell apply`

use std::fs;
use std::path::{Path, PathBuf};

use appell::gap_report::GapReport;
use appell::source::Source;
use appell::{files, robot};

use crate::failure::Error;
use crate::output;

/// Writes the spec with the effect identified by a gap report.
///
/// Comments and layout of the spec are kept. Parameters fitted together with the effect are updated,
/// within their tolerances. Effects that a spec cannot express, such as an actuator delay or a sensor
/// bias, are listed with the place where they belong. Of an MJCF file only the numbers change; what it cannot
/// express stands in a comment at its head.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell apply rig/my_rig.toml --report report.json --out better.toml")]
pub(crate) struct Apply {
    /// Name of a shipped mechanism, or path of a spec or of an MJCF file, as diagnosed
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
        let default = PathBuf::from(format!("{}_improved.toml", report.mechanism));
        let out = self.out.as_ref().unwrap_or(&default);
        let file = out.to_string_lossy();
        let improved = source.improved(&report, self.hypothesis, &file)?;
        if improved.spec == source.text {
            return output::print(&improved.summary("nothing to write"));
        }
        self.may_replace(out, &improved.spec)?;
        files::write(out, &improved.spec)?;
        output::print_beside(&improved.summary(&file), &[&Some(out.clone())])
    }

    /// Corrects a robot file.
    fn robot(&self, path: &Path, text: &str) -> Result<(), Error> {
        let report = GapReport::read(&self.report)?;
        let correction = appell::correction::correct(path, text, &report, self.hypothesis)?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let default = path.with_file_name(format!("{stem}_improved.xml"));
        let out = self.out.as_ref().unwrap_or(&default);
        let file = out.to_string_lossy();
        self.may_replace(out, &correction.text)?;
        files::write(out, &correction.text)?;
        let text = format!(
            "{file}: {} corrected\n{}",
            path.display(),
            correction.summary
        );
        output::print_beside(&text, &[&Some(out.clone())])
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

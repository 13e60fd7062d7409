//! `appell apply`

use std::fs;
use std::path::PathBuf;

use appell_spec::load;

use crate::applied::Report;
use crate::output;
use appell::Error;
use appell::files;
use appell::source::Source;

/// Writes the spec with the effect identified by a gap report.
///
/// Comments and layout of the spec are kept. Parameters fitted together with the effect are updated,
/// within their tolerances. Effects that a spec cannot express, such as an actuator delay or a sensor
/// bias, are listed with the place where they belong.
#[derive(Debug, clap::Args)]
pub(crate) struct Apply {
    /// Name of a shipped mechanism or path of a spec, as diagnosed
    model: String,
    /// Gap report of `appell diagnose --json`
    #[arg(long, value_name = "FILE.json")]
    report: PathBuf,
    /// Number of the hypothesis in the report [default: the most probable one]
    #[arg(long, value_name = "N")]
    hypothesis: Option<usize>,
    /// Output file, `-` is standard output [default: name of the mechanism with `_improved.toml`; an
    /// existing file is not overwritten]
    #[arg(long, short = 'o', value_name = "FILE.toml")]
    out: Option<PathBuf>,
}

impl Apply {
    pub(super) fn run(&self) -> Result<(), Error> {
        let source = Source::find(&self.model)?;
        let name = load(&source.file, &source.text)?.mechanism.name;
        let report = Report::read(&self.report)?;
        if report.mechanism != name {
            return Err(Error::Data(format!(
                "the report is about `{}`, but the spec describes `{name}`",
                report.mechanism
            )));
        }
        let hypothesis = report.hypothesis(self.hypothesis)?;
        let changes = hypothesis.changes();
        let note = format!("Found by `appell diagnose`: {}", hypothesis.name());
        let improved = changes.improved(&source.text, &note);
        let improved = improved.map_err(|error| Error::Data(error.to_string()))?;
        let default = PathBuf::from(format!("{name}_improved.toml"));
        let out = self.out.as_ref().unwrap_or(&default);
        let file = out.to_string_lossy();
        // Check that the improved text is a valid spec before it is written.
        load(&file, &improved)?;
        if improved == source.text {
            let summary = hypothesis.summary(&report, &changes, "nothing to write");
            return output::print(&summary);
        }
        if self.out.is_none() && fs::read(out).is_ok_and(|there| there != improved.as_bytes()) {
            return Err(Error::Usage(format!(
                "{file} exists with other contents; to replace it, name it with `-o {file}`"
            )));
        }
        files::write(out, &improved)?;
        let summary = hypothesis.summary(&report, &changes, &file);
        output::print_beside(&summary, &[&Some(out.clone())])
    }
}

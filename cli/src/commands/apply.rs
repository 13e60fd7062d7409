//! `appell apply`

use std::fs;
use std::path::PathBuf;

use appell_spec::load;

use crate::applied::Report;
use crate::output;
use appell::Error;
use appell::files;
use appell::source::Source;

/// Writes the spec with the effect that a gap report found, and with its values.
///
/// Comments and layout of the spec stay. The parameters that were fitted beside the effect change too,
/// within their tolerances. Effects that no spec can hold, such as a delay of an actuator or the bias
/// of a sensor, are told with the place where they belong.
#[derive(Debug, clap::Args)]
pub(crate) struct Apply {
    /// Name of a shipped mechanism or path of a spec: the one that was diagnosed
    model: String,
    /// Gap report of `appell diagnose --json`
    #[arg(long, value_name = "FILE.json")]
    report: PathBuf,
    /// Number of the hypothesis in the report; default is the most probable one
    #[arg(long, value_name = "N")]
    hypothesis: Option<usize>,
    /// Write to this file, `-` is standard output; default is the name of the mechanism with
    /// `_improved.toml`, if no other file stands there
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
                "the report is about `{}`, and the spec describes `{name}`",
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
        // What the report brings has to be a spec again before it is written.
        load(&file, &improved)?;
        if improved == source.text {
            let told = hypothesis.told(&report, &changes, "nothing to write");
            return output::print(&told);
        }
        if self.out.is_none() && fs::read(out).is_ok_and(|there| there != improved.as_bytes()) {
            return Err(Error::Usage(format!(
                "{file} is there and says something else: it is replaced if you name it with `-o {file}`"
            )));
        }
        files::write(out, &improved)?;
        let told = hypothesis.told(&report, &changes, &file);
        output::print_beside(&told, &[&Some(out.clone())])
    }
}

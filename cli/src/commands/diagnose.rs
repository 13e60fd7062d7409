//! `appell diagnose`

use std::path::PathBuf;

use appell_gap::diagnose::{self, Options};
use appell_gap::effects;

use crate::failure::Failure;
use crate::{diagnosed, files, progress, recording};

/// Tells where a model falls short of recordings, which effect it lacks, and how far the effect closes
/// the gap.
///
/// Every effect of the library is tried at every place of the mechanism where it makes sense. Runs to test are read by the last step alone. The exit status is 0
/// whatever the verdict.
#[derive(Debug, clap::Args)]
pub(crate) struct Diagnose {
    /// Name of a shipped mechanism or path of a spec, instead of the one that the data set names
    model: Option<String>,
    /// Folder with a `recording.toml`, or CSV files with columns of the spec's names
    #[arg(long, required = true, num_args = 1.., value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Files of effects of your own, which are tried beside those of the library
    #[arg(long, num_args = 1.., value_name = "FILE.toml")]
    effects: Vec<PathBuf>,
    /// Write the gap report; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write a page with drawings, laws over data and traces; it needs no network
    #[arg(long, value_name = "FILE.html")]
    html: Option<PathBuf>,
}

impl Diagnose {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let set = recording::read(&self.data, self.model.as_deref())?;
        let library = self.library()?;
        let spinner = progress::spinner("reading");
        let options = Options {
            pictures: self.html.is_some(),
        };
        let stage = |stage| spinner.set_message(stage);
        let report = diagnose::diagnose(&set, &library, &options, stage);
        spinner.finish_and_clear();
        let report = report.map_err(diagnosed::failure)?;
        if let Some(path) = &self.json {
            files::write_json(path, &diagnosed::json(&report))?;
        }
        if let Some(path) = &self.html {
            files::write(path, &diagnosed::page(&set, &report))?;
        }
        files::print_beside(&diagnosed::text(&report), &[&self.json, &self.html])
    }

    /// The shipped effects and those of the user.
    fn library(&self) -> Result<Vec<effects::Effect>, Failure> {
        let data = |error: effects::EffectError| Failure::Data(error.to_string());
        let mut library = effects::shipped().map_err(data)?;
        for path in &self.effects {
            let text = files::read(path, appell_spec::limits::MAX_FILE as u64)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            library.push(effects::Effect::read(&name, &text).map_err(data)?);
        }
        Ok(library)
    }
}

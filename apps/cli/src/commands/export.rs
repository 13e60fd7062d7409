//! `appell export`

use std::path::PathBuf;

use appell::files;
use appell::fmu::{Fmu, InputsOfStep, Options};

use crate::destinations::extension;
use crate::engine;
use crate::failure::Error;
use crate::{output, progress};

/// Writes the model as a package for other simulation tools.
///
/// An FMU of FMI 3.0 holds the equations of motion for model exchange and co-simulation, as machine code of this
/// platform and as C.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell export unicycle --fmu
  appell export my_pendulum.toml --fmu --sources-only --out pendulum_sources.fmu")]
pub(crate) struct Export {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// The package is an FMU
    #[arg(long, required = true)]
    fmu: bool,
    /// Leave out the machine code: the importing tool compiles the C
    #[arg(long)]
    sources_only: bool,
    /// Inputs within a communication step of co-simulation: held from its start, or extrapolated linearly from their
    /// values at the starts of this and the last step
    #[arg(
        long,
        value_enum,
        default_value = "hold",
        hide_possible_values = true,
        value_name = "hold|linear"
    )]
    interpolation: WithinStep,
    /// The file [default: NAME.fmu, with the name of the mechanism]
    #[arg(long, short, value_name = "NAME.fmu")]
    out: Option<PathBuf>,
}

/// Inputs within a communication step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum WithinStep {
    Hold,
    Linear,
}

impl Export {
    pub(super) fn run(&self) -> Result<(), Error> {
        let is_fmu = |path: &PathBuf| {
            files::is_stdout(path) || extension(path).is_some_and(|end| end == "fmu")
        };
        if let Some(path) = self.out.as_ref().filter(|path| !is_fmu(path)) {
            let instead = path.with_extension("fmu");
            return Err(Error::Usage(format!(
                "tools know an FMU by its extension: write `--out {}`",
                output::shell(&instead.to_string_lossy())
            )));
        }
        let source = engine::source(&self.model)?;
        let options = Options {
            sources_only: self.sources_only,
            inputs: match self.interpolation {
                WithinStep::Hold => InputsOfStep::Held,
                WithinStep::Linear => InputsOfStep::Lines,
            },
        };
        let compiling = "deriving and compiling the equations of motion";
        let fmu = progress::during(compiling, |_| source.fmu(&options))?;
        let file = self.out.clone();
        let file = file.unwrap_or_else(|| PathBuf::from(format!("{}.fmu", fmu.name)));
        files::write_with(&file, |to| to.write_all(&fmu.bytes))?;
        let told = format!("wrote {}: {}\n", file.display(), about(&fmu));
        output::print_beside(&told, &[&Some(file)])
    }
}

/// Contents of an FMU.
fn about(fmu: &Fmu) -> String {
    let count = |count: usize, what: &str| {
        let end = if count == 1 { "" } else { "s" };
        format!("{count} {what}{end}")
    };
    let info = &fmu.info;
    let code = fmu.platform.as_deref();
    format!(
        "{}, {}, {}, {}; {}",
        count(info.states.len(), "state"),
        count(info.declared_inputs, "input"),
        count(info.outputs.len(), "output"),
        count(info.parameters.len(), "parameter"),
        code.map_or_else(
            || "sources only".to_owned(),
            |code| format!("machine code for {code}, and sources")
        )
    )
}

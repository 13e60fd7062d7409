//! `appell evaluate`

use std::path::PathBuf;

use appell_runtime::model::Quantity;

use crate::engine::{self, Engine};
use crate::failure::Error;
use appell::cases::{Case, Cases, MAX_BYTES};
use appell::files;

/// Evaluates the equations at given states.
///
/// Computes rates, Appell's equations, Jacobians, energies, constraint forces and outputs, in SI. A
/// case reads {"state": {"theta": 0.1, …}, "inputs": {…}, "parameters": {…}, "t": 0}; only the state
/// must be complete. A list "quantities" beside the cases limits what is derived and written.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  echo '{\"cases\": [{\"state\": {\"v\": 0, \"omega\": 1, \"x\": 0.1, \"theta\": 0.2}}]}' > cases.json
  appell evaluate my_pendulum.toml --cases cases.json --json values.json")]
pub(crate) struct Evaluate {
    /// Name of a shipped mechanism, or path of a spec or a robot file
    model: String,
    /// JSON file with states, inputs and parameters; `-` is standard input
    #[arg(long, value_name = "IN.json")]
    cases: PathBuf,
    /// Output file; `-` is standard output
    #[arg(long, value_name = "OUT.json", default_value = "-")]
    json: PathBuf,
    /// How the equations are evaluated
    #[arg(long, value_enum, default_value_t = Engine::Jit)]
    engine: Engine,
}

impl Evaluate {
    pub(super) fn run(&self) -> Result<(), Error> {
        let text = files::read(&self.cases, MAX_BYTES)?;
        let model = engine::model(&self.model, &[], Some(self.engine))?;
        let cases = Cases::read(&self.cases.to_string_lossy(), &text, model.info())?;
        let evaluation = model.evaluation(cases.quantities())?;
        let (mut singular, mut count) = (Vec::new(), 0_usize);
        files::write_with(&self.json, |to| {
            evaluation.write(cases.iter(), to, |index, case, values| {
                if !values.is_finite {
                    count += 1;
                    if count <= MOST_SHOWN {
                        singular.push(describe(index, case, &model.info().states));
                    }
                }
            })
        })?;
        if count == 0 {
            return Ok(());
        }
        if count > MOST_SHOWN {
            singular.push(format!("  … and {} more", count - MOST_SHOWN));
        }
        Err(Error::Computation(format!(
            "the equations are not finite at these cases; the numbers affected are written as `null`\n{}",
            singular.join("\n")
        )))
    }
}

/// Cases without finite values that are shown.
const MOST_SHOWN: usize = 20;

fn describe(index: usize, case: &Case, states: &[Quantity]) -> String {
    let state: Vec<String> = states
        .iter()
        .zip(&case.x)
        .map(|(state, value)| format!("{} = {value}", state.name))
        .collect();
    format!("  case {index}, t = {} s: {}", case.t, state.join(", "))
}

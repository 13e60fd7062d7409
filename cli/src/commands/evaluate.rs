//! `appell evaluate`

use std::path::PathBuf;

use appell_runtime::model::Quantity;

use crate::engine::{self, Engine};
use crate::failure::Error;
use appell::cases::{Case, read_cases};
use appell::files;

/// Evaluates the equations at given states.
///
/// Computes rates, Appell's equations, Jacobians, energies, constraint forces and outputs, in SI. A
/// case reads {"state": {"theta": 0.1, …}, "inputs": {…}, "parameters": {…}, "t": 0}; only the state
/// must be complete.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  echo '{\"cases\": [{\"state\": {\"v\": 0, \"omega\": 1, \"x\": 0.1, \"theta\": 0.2}}]}' > cases.json
  appell evaluate my_pendulum.toml --cases cases.json --json values.json")]
pub(crate) struct Evaluate {
    /// Name of a shipped mechanism or path of a spec
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
        let text = files::read(&self.cases, files::MAX_DATA)?;
        let model = engine::model(&self.model, Some(self.engine))?;
        let cases = read_cases(&self.cases.to_string_lossy(), &text, model.info())?;
        let evaluation = model.evaluate(&cases)?;
        files::write_json(&self.json, &appell::json::evaluation(&evaluation))?;
        let values = cases.iter().zip(&evaluation.values).enumerate();
        let singular: Vec<String> = values
            .filter(|(_, (_, values))| !values.is_finite())
            .map(|(index, (case, _))| describe(index, case, &model.info().states))
            .collect();
        if singular.is_empty() {
            return Ok(());
        }
        Err(Error::Computation(format!(
            "the equations are not finite at these cases; the numbers affected are written as `null`\n{}",
            singular.join("\n")
        )))
    }
}

fn describe(index: usize, case: &Case, states: &[Quantity]) -> String {
    let state: Vec<String> = states
        .iter()
        .zip(&case.x)
        .map(|(state, value)| format!("{} = {value}", state.name))
        .collect();
    format!("  case {index}, t = {} s: {}", case.t, state.join(", "))
}

//! `appell check`

use std::path::PathBuf;
use std::time::Duration;

use appell::check::{self, Checked, Thorough};
use appell::setup::Assignment;
use appell::{Source, files};
use serde_json::{Value, json};

use crate::failure::{self, Error};
use crate::{engine, output, progress};

/// Validates specs and summarises the mechanisms they describe.
///
/// Names, units, frames, constraints, pseudo-velocities and inertias are checked; all errors are
/// reported at once, each with its line and a remedy. An audit of the equations warns of valid
/// but probably wrong entries, and adds notes.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  appell check my_pendulum.toml
  appell check unicycle --thorough
  appell check pendulum --equation 'dot(omega) = (tau - m*g*l*sin(theta))/(I + m*l^2)'")]
pub(crate) struct Check {
    /// Names of shipped mechanisms or paths of specs
    #[arg(required = true, value_name = "MODEL")]
    models: Vec<String>,
    /// Write the findings as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Compare the equations with Kane's equations and with Lagrange's equations with multipliers
    ///
    /// Equality is proved by an identity test with a bounded error probability where that applies,
    /// and checked at random points in the declared ranges elsewhere.
    #[arg(long)]
    thorough: bool,
    /// Compare an equation of motion that you derived with appell's: `dot(NAME) = EXPRESSION`
    ///
    /// The name is that of a pseudo-velocity or coordinate; the expression may use time, states, inputs and
    /// parameters. Spelling does not matter: the two are compared as functions, as by `--thorough`.
    #[arg(long = "equation", value_name = "EQUATION", value_parser = equation)]
    equations: Vec<Assignment>,
    /// Time limit of this comparison for one mechanism, in s
    ///
    /// Quantities not compared by then are listed, and the check fails.
    #[arg(long, value_name = "S", default_value = "60", requires = "thorough", value_parser = seconds)]
    time_limit_s: Duration,
}

impl Check {
    pub(super) fn run(&self) -> Result<(), Error> {
        let quiet = self.json.as_deref().is_some_and(files::is_stdout);
        let mut failed = Vec::new();
        let mut found = Vec::new();
        for model in &self.models {
            match self.check(model, quiet) {
                Ok((entry, disagreement)) => {
                    found.push(entry);
                    failed.extend(disagreement);
                }
                Err(failure) => {
                    if let Error::Library(error) = &failure {
                        found.push(check::failed(model, error));
                    }
                    failed.push(failure);
                }
            }
        }
        output::json(
            self.json.as_deref(),
            || json!({ "schema": "check/1", "specs": found }),
        )?;
        if failed.is_empty() {
            Ok(())
        } else {
            Err(Error::Several(failed))
        }
    }

    /// Checks one spec. Returns its JSON entry, and a failure if equations disagree.
    fn check(&self, model: &str, quiet: bool) -> Result<(Value, Option<Error>), Error> {
        let source = engine::source(model)?;
        let deriving = format!("deriving {}", source.file);
        let checked = progress::during(&deriving, |_| source.check())?;
        let thorough = self.thorough.then(|| self.compare(&checked, &source));
        let thorough = thorough.transpose()?;
        if !quiet {
            output::print(&checked.text())?;
            if let Some(thorough) = &thorough {
                output::print(&thorough.text())?;
            }
        }
        if !checked.warnings().diagnostics().is_empty() {
            failure::report(checked.warnings());
        }
        let typed = (!self.equations.is_empty()).then(|| source.compare(&self.equations));
        let typed = typed.transpose()?;
        if let (Some(typed), false) = (&typed, quiet) {
            output::print(&typed.to_string())?;
        }
        let mut entry = checked.to_json();
        let mut disagreements = Vec::new();
        if let Some(thorough) = thorough {
            disagreements.extend(thorough.failure());
            entry["thorough"] = thorough.to_json();
        }
        if let Some(typed) = typed {
            disagreements.extend(typed.failure());
            entry["typed"] = typed.json();
        }
        if disagreements.is_empty() {
            return Ok((entry, None));
        }
        entry["ok"] = false.into();
        let disagreements = disagreements.into_iter().map(Error::from);
        Ok((entry, Some(Error::Several(disagreements.collect()))))
    }

    fn compare(&self, checked: &Checked, source: &Source) -> Result<Thorough, Error> {
        let comparing = format!("comparing formulations of {}", source.file);
        Ok(progress::during(&comparing, |_| {
            checked.thorough(self.time_limit_s)
        })?)
    }
}

fn equation(text: &str) -> Result<Assignment, String> {
    let written = |_| "write `dot(NAME) = EXPRESSION`".to_owned();
    text.parse().map_err(written)
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok();
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    limit.ok_or_else(|| "it must be a non-negative number of seconds".to_owned())
}

//! `appell check`

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use appell_codegen::mechanics::motion::independent_blocks;
use appell_codegen::{Derived, audited};
use appell_spec::mechanism::CoordinateId;
use appell_spec::{Report, Severity};
use serde_json::{Value, json};

use crate::failure::{shown, tell};
use crate::output;
use crate::progress;
use crate::thorough::Thorough;
use appell::Error;
use appell::files;
use appell::source::Source;

/// Validates specs and summarises the mechanisms they describe.
///
/// Names, units, frames, constraints, pseudo-velocities and inertias are checked; all errors are
/// reported at once, each with its line and a remedy. An audit of the equations warns of what is valid
/// but probably a mistake, and notes what is worth knowing.
#[derive(Debug, clap::Args)]
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
    /// Time limit of this comparison for one mechanism, in s
    ///
    /// Quantities not compared by then are listed, and the check fails.
    #[arg(long, value_name = "S", default_value_t = 60.0, requires = "thorough")]
    time_limit_s: f64,
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
                    found.push(entry(model, &failure));
                    failed.push(failure);
                }
            }
        }
        if let Some(path) = &self.json {
            files::write_json(path, &json!({ "specs": found }))?;
        }
        if failed.is_empty() {
            Ok(())
        } else {
            Err(Error::Several(failed))
        }
    }

    /// Checks one spec. Returns its JSON entry, and a failure if the formulations disagree.
    fn check(&self, model: &str, quiet: bool) -> Result<(Value, Option<Error>), Error> {
        let source = Source::find(model)?;
        let spinner = progress::spinner(&format!("deriving {}", source.file));
        let derived = audited(&source.file, &source.text);
        spinner.finish_and_clear();
        let derived = derived?;
        let summary = Summary::of(&derived);
        let limit = Duration::try_from_secs_f64(self.time_limit_s).map_err(|_| {
            Error::Usage("`--time-limit-s` must be a non-negative number of seconds".to_owned())
        })?;
        let thorough = self
            .thorough
            .then(|| Thorough::new(&source, &derived, limit));
        let thorough = thorough.transpose()?;
        if !quiet {
            output::print(&summary.text(&source))?;
            if let Some(thorough) = &thorough {
                output::print(&thorough.text())?;
            }
        }
        let warnings = Report::new(source.file.as_str(), source.text.as_str(), derived.warnings);
        if !warnings.diagnostics().is_empty() {
            tell(&shown(&warnings));
        }
        let mut entry = summary.json(&source, &warnings);
        let Some(thorough) = thorough else {
            return Ok((entry, None));
        };
        let disagreement = thorough.failure(&source);
        entry["ok"] = disagreement.is_none().into();
        entry["thorough"] = thorough.json();
        Ok((entry, disagreement))
    }
}

/// The JSON entry of a spec that is wrong or cannot be read.
fn entry(model: &str, failure: &Error) -> Value {
    match failure {
        Error::Report(report) => {
            json!({ "file": report.file(), "ok": false, "findings": findings(report) })
        }
        other => json!({
            "file": model, "ok": false,
            "findings": [{ "code": null, "message": other.to_string() }],
        }),
    }
}

fn findings(report: &Report) -> Vec<Value> {
    let finding = |diagnostic: &appell_spec::Diagnostic| {
        let at = diagnostic.labels.first().map_or(0, |(span, _)| span.start);
        let (line, column) = report.line_column(at);
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        json!({
            "severity": severity, "code": diagnostic.code.text(), "message": diagnostic.message, "help": diagnostic.help,
            "line": line, "column": column,
        })
    };
    report.diagnostics().iter().map(finding).collect()
}

/// Summary of a derivation.
struct Summary {
    title: String,
    speeds: Vec<String>,
    coordinates: usize,
    rows: Vec<String>,
    embedded: Vec<String>,
    blocks: Vec<Vec<String>>,
    solved_numerically: Vec<String>,
}

impl Summary {
    fn of(derived: &Derived) -> Self {
        let Derived {
            mechanism,
            derivation,
            ..
        } = derived;
        let speeds: Vec<String> = mechanism
            .pseudo_velocities
            .iter()
            .map(|w| w.label.name.clone())
            .collect();
        let rows = |embedded: bool| {
            let rows = derivation
                .constraints
                .rows
                .iter()
                .filter(|row| row.is_embedded() == embedded);
            rows.map(|row| row.name.clone()).collect()
        };
        let blocks = independent_blocks(&derivation.gibbs.mass_matrix);
        let names = |block: &Vec<usize>| block.iter().map(|&speed| speeds[speed].clone()).collect();
        let blocks = blocks.iter().map(names).collect();
        let coordinate = |&q: &usize| {
            mechanism.coordinates[CoordinateId::new(q)]
                .label
                .name
                .clone()
        };
        Self {
            title: mechanism.title.clone(),
            coordinates: mechanism.coordinates.len(),
            rows: rows(false),
            embedded: rows(true),
            blocks,
            solved_numerically: derivation
                .velocities
                .solved_numerically
                .iter()
                .map(coordinate)
                .collect(),
            speeds,
        }
    }

    fn text(&self, source: &Source) -> String {
        let mut text = format!("{}: {}\n", source.file, self.title);
        // Writing to a string cannot fail.
        let mut line = |label: &str, what: String| {
            let _ = writeln!(text, "  {label:<22}{what}");
        };
        line(
            "degrees of freedom",
            format!("{}: {}", self.speeds.len(), self.speeds.join(", ")),
        );
        let rows = |rows: &[String]| {
            if rows.is_empty() {
                "none".to_owned()
            } else {
                format!("{}: {}", rows.len(), rows.join(", "))
            }
        };
        line("coordinates", self.coordinates.to_string());
        line("constraint rows", rows(&self.rows));
        if !self.embedded.is_empty() {
            line("embedded in geometry", rows(&self.embedded));
        }
        let blocks: Vec<String> = self
            .blocks
            .iter()
            .map(|block| format!("{{{}}}", block.join(", ")))
            .collect();
        line("blocks of M", blocks.join(" "));
        line(
            "coordinate rates",
            if self.solved_numerically.is_empty() {
                "in closed form, without division by a quantity that can vanish".to_owned()
            } else {
                format!(
                    "in closed form, except for {} (solved with pivoting)",
                    self.solved_numerically.join(", ")
                )
            },
        );
        text
    }

    fn json(&self, source: &Source, warnings: &Report) -> Value {
        json!({
            "file": source.file, "ok": true, "findings": findings(warnings), "title": self.title,
            "degrees_of_freedom": self.speeds.len(), "pseudo_velocities": self.speeds,
            "coordinates": self.coordinates, "constraint_rows": self.rows,
            "embedded_rows": self.embedded, "mass_matrix_blocks": self.blocks,
            "solved_numerically": self.solved_numerically,
        })
    }
}

//! Validation of specs: a summary of the mechanism, warnings, and the comparison of formulations.

mod thorough;

use std::fmt::Write as _;
use std::time::Duration;

use appell_codegen::mechanics::motion::independent_blocks;
use appell_codegen::{Derived, audited};
use appell_spec::mechanism::CoordinateId;
use appell_spec::{Diagnostic, Report, Severity};
use serde_json::{Value, json};

pub use thorough::Thorough;

use crate::Error;
use crate::source::Source;

/// A valid spec.
pub struct Checked {
    file: String,
    derived: Derived,
    summary: Summary,
    warnings: Report,
}

impl Source {
    /// Validates the spec and derives its equations. All errors are reported at once.
    ///
    /// ```
    /// let checked = appell::Source::shipped("unicycle")?.check()?;
    /// assert!(checked.text().contains("degrees of freedom"));
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn check(&self) -> Result<Checked, Error> {
        let mut derived = audited(&self.file, &self.text)?;
        let warnings = std::mem::take(&mut derived.warnings);
        Ok(Checked {
            file: self.file.clone(),
            summary: Summary::of(&derived),
            warnings: Report::new(self.file.as_str(), self.text.as_str(), warnings),
            derived,
        })
    }
}

impl Checked {
    /// Warnings about valid but probably wrong entries, and notes.
    pub fn warnings(&self) -> &Report {
        &self.warnings
    }

    /// Compares the equations with Kane's and with Lagrange's equations with multipliers, until a time
    /// limit.
    pub fn thorough(&self, limit: Duration) -> Result<Thorough, Error> {
        Thorough::new(&self.file, &self.derived, limit)
    }

    /// The summary as text.
    pub fn text(&self) -> String {
        self.summary.text(&self.file)
    }

    /// The summary and the warnings as JSON.
    pub(crate) fn to_json(&self) -> Value {
        self.summary.json(&self.warnings)
    }
}

/// The JSON entry of a spec that is wrong or cannot be read.
pub fn failed(model: &str, failure: &Error) -> Value {
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

/// The findings of a report as JSON, each with its line and column.
pub fn findings(report: &Report) -> Vec<Value> {
    let finding = |diagnostic: &Diagnostic| {
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

/// Summary of a spec.
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

    fn text(&self, file: &str) -> String {
        let mut text = format!("{file}: {}\n", self.title);
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

    fn json(&self, warnings: &Report) -> Value {
        json!({
            "file": warnings.file(), "ok": true, "findings": findings(warnings), "title": self.title,
            "degrees_of_freedom": self.speeds.len(), "pseudo_velocities": self.speeds,
            "coordinates": self.coordinates, "constraint_rows": self.rows,
            "embedded_rows": self.embedded, "mass_matrix_blocks": self.blocks,
            "solved_numerically": self.solved_numerically,
        })
    }
}

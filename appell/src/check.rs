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
    derived: Derived,
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
        Thorough::new(self.warnings.file(), &self.derived, limit)
    }

    fn speeds(&self) -> Vec<&str> {
        let speeds = self.derived.mechanism.pseudo_velocities.iter();
        speeds.map(|speed| speed.label.name.as_str()).collect()
    }

    /// Constraint rows, those that are embedded in the geometry or the others.
    fn rows(&self, embedded: bool) -> Vec<&str> {
        let rows = self.derived.derivation.constraints.rows.iter();
        let rows = rows.filter(|row| row.is_embedded() == embedded);
        rows.map(|row| row.name.as_str()).collect()
    }

    /// The speeds of each independent block of the mass matrix.
    fn blocks(&self) -> Vec<Vec<&str>> {
        let speeds = self.speeds();
        let blocks = independent_blocks(&self.derived.derivation.gibbs.mass_matrix);
        let names = |block: &Vec<usize>| block.iter().map(|&speed| speeds[speed]).collect();
        blocks.iter().map(names).collect()
    }

    /// The coordinates whose rates are solved with pivoting.
    fn solved_numerically(&self) -> Vec<&str> {
        let coordinates = &self.derived.mechanism.coordinates;
        let solved = self.derived.derivation.velocities.solved_numerically.iter();
        solved
            .map(|&q| coordinates[CoordinateId::new(q)].label.name.as_str())
            .collect()
    }

    /// The summary as text.
    pub fn text(&self) -> String {
        let Derived { mechanism, .. } = &self.derived;
        let mut text = format!("{}: {}\n", self.warnings.file(), mechanism.title);
        // Writing to a string cannot fail.
        let mut line = |label: &str, what: String| {
            let _ = writeln!(text, "  {label:<22}{what}");
        };
        let counted = |names: &[&str]| match names {
            [] => "none".to_owned(),
            names => format!("{}: {}", names.len(), names.join(", ")),
        };
        let speeds = self.speeds();
        line(
            "degrees of freedom",
            format!("{}: {}", speeds.len(), speeds.join(", ")),
        );
        line("coordinates", mechanism.coordinates.len().to_string());
        line("constraint rows", counted(&self.rows(false)));
        let embedded = self.rows(true);
        if !embedded.is_empty() {
            line("embedded in geometry", counted(&embedded));
        }
        let blocks = self.blocks().into_iter();
        let blocks = blocks.map(|block| format!("{{{}}}", block.join(", ")));
        line("blocks of M", blocks.collect::<Vec<_>>().join(" "));
        let rates = match &self.solved_numerically()[..] {
            [] => "in closed form, without division by a quantity that can vanish".to_owned(),
            solved => format!(
                "in closed form, except for {} (solved with pivoting)",
                solved.join(", ")
            ),
        };
        line("coordinate rates", rates);
        text
    }

    /// The summary and the warnings as JSON.
    pub fn to_json(&self) -> Value {
        let Derived { mechanism, .. } = &self.derived;
        let speeds = self.speeds();
        json!({
            "file": self.warnings.file(), "ok": true, "findings": findings(&self.warnings),
            "title": mechanism.title,
            "degrees_of_freedom": speeds.len(), "pseudo_velocities": speeds,
            "coordinates": mechanism.coordinates.len(), "constraint_rows": self.rows(false),
            "embedded_rows": self.rows(true), "mass_matrix_blocks": self.blocks(),
            "solved_numerically": self.solved_numerically(),
        })
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

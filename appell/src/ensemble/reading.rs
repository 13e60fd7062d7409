//! Values of a study file with the names of a spec, and its findings.

use std::path::{Path, PathBuf};

use appell_ensemble::study::{Placed, Study, Text};
use appell_runtime::model::Quantity;
use appell_spec::expr::{Expr, Span};
use appell_spec::units::Unit;
use appell_spec::{Code, Diagnostic, Report, Scope, Snippet, did_you_mean, formula, shown};

use crate::Error;
use crate::setup::{Setup, bracketed};

/// An entry of a study file with its position.
pub(super) trait Place {
    /// Its position.
    fn span(&self) -> Span;
}

impl Place for Text {
    fn span(&self) -> Span {
        self.at.clone()
    }
}

impl<T> Place for Placed<T> {
    fn span(&self) -> Span {
        self.at.clone()
    }
}

/// A study file with its findings.
pub(super) struct Reading<'s> {
    pub(super) study: &'s Study,
    pub(super) findings: Vec<Diagnostic>,
}

impl<'s> Reading<'s> {
    pub(super) fn new(study: &'s Study) -> Self {
        Self {
            study,
            findings: Vec::new(),
        }
    }

    pub(super) fn tell(
        &mut self,
        code: Code,
        message: impl Into<String>,
        at: &impl Place,
        help: &str,
    ) {
        let diagnostic = Diagnostic::error(code, message).at(at.span(), "");
        let help = (!help.is_empty()).then(|| help.to_owned());
        self.add(diagnostic.maybe_help(help));
    }

    /// Adds a finding once: several specs cause the same.
    pub(super) fn add(&mut self, finding: Diagnostic) {
        if !self.findings.contains(&finding) {
            self.findings.push(finding);
        }
    }

    /// Reports an error of a value at its position in the study; a report about another file is returned as an error.
    pub(super) fn at<T>(
        &mut self,
        at: &impl Place,
        result: Result<T, Error>,
    ) -> Result<Option<T>, Error> {
        match result {
            Ok(value) => Ok(Some(value)),
            Err(error @ Error::Report(_)) => Err(error),
            Err(error) => {
                let message = match error {
                    Error::Request { message, .. } | Error::Data { message, .. } => message,
                    error => error.to_string(),
                };
                self.tell(Code::NotAllowedHere, message, at, "");
                Ok(None)
            }
        }
    }

    /// The path of a regular file that the study names, in the folder of the study or below.
    pub(super) fn file(&mut self, folder: &Path, name: &Text) -> Option<PathBuf> {
        let path = appell_files::below(folder, &name.text);
        let opened = path.and_then(|path| appell_files::open(&path, u64::MAX).map(|_| path));
        match opened {
            Ok(path) => Some(path),
            Err(error) => {
                self.tell(Code::UnknownReference, error.to_string(), name, "");
                None
            }
        }
    }

    /// Index of the quantity of a name; an unknown one is reported.
    pub(super) fn known(
        &mut self,
        name: &Text,
        setup: &Setup<'_>,
        what: &str,
        among: &[Quantity],
    ) -> Option<usize> {
        let names = among.iter().map(|quantity| quantity.name.as_ref());
        let own = setup.in_spec(&name.text);
        let found = names.clone().position(|other| other == own);
        if found.is_none() {
            let help = did_you_mean(&name.text, names, String::new);
            let message = format!("there is no {what} `{}`", name.text);
            self.tell(Code::UnknownName, message, name, &help);
        }
        found
    }

    /// The value of a quantity.
    pub(super) fn expr(
        &mut self,
        setup: &Setup<'_>,
        text: &Text,
        what: &'static str,
        scope: Scope,
        unit: &Unit,
    ) -> Option<Expr> {
        let bracketed = bracketed(text.text.trim());
        let snippet = Snippet {
            document: &self.study.text,
            text: &bracketed,
            whole: text.at.clone(),
        };
        match formula(setup.spec, &snippet, what, scope, unit) {
            Ok(expr) => Some(expr),
            Err(findings) => {
                for finding in findings {
                    self.add(finding);
                }
                None
            }
        }
    }

    /// The finite value of a quantity in SI.
    pub(super) fn constant(&mut self, setup: &Setup<'_>, text: &Text, unit: &Unit) -> Option<f64> {
        let expr = self.expr(setup, text, "the value", Scope::Constant, unit)?;
        let value = setup.constant(&expr);
        if value.is_none() {
            let message = format!("`{}` is not a finite number", shown(&text.text));
            self.tell(Code::NotFinite, message, text, "");
        }
        value
    }

    /// Reports a negative standard deviation.
    pub(super) fn not_negative(&mut self, text: &Text, value: f64) -> Option<()> {
        if value < 0.0 {
            let message = "a standard deviation is not negative";
            self.tell(Code::ValueOutsideLimits, message, text, "");
            return None;
        }
        Some(())
    }

    /// An error with all findings, if there are any.
    pub(super) fn check(&mut self) -> Result<(), Error> {
        if self.findings.is_empty() {
            return Ok(());
        }
        let findings = std::mem::take(&mut self.findings);
        Err(Report::new(self.study.file.as_str(), self.study.text.as_str(), findings).into())
    }
}

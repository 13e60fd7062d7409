//! Findings of the spec and of its derivation, as an editor shows them.

use appell_spec::diagnostic::MAX_SHOWN;
use appell_spec::{Diagnostic, Severity, visible};
use lsp_types::{
    Diagnostic as Shown, DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString,
};

use crate::document::Document;

/// The findings about a document.
pub(crate) fn shown(document: &Document, findings: &[Diagnostic]) -> Vec<Shown> {
    let first = findings.iter().take(MAX_SHOWN);
    first.map(|finding| one(document, finding)).collect()
}

fn one(document: &Document, finding: &Diagnostic) -> Shown {
    let (span, words) = finding.labels.first().cloned().unwrap_or_default();
    let words = match words.as_str() {
        "" => String::new(),
        words => format!(" ({words})"),
    };
    let help = finding.help.iter().map(|help| format!("\nhelp: {help}"));
    let message = format!("{}{words}{}", finding.message, help.collect::<String>());
    let message = visible(&message).into_owned();
    let others = finding.labels.iter().skip(1);
    let others = others.map(|(span, words)| DiagnosticRelatedInformation {
        location: Location::new(document.uri.clone(), document.text.range(span)),
        message: visible(words).into_owned(),
    });
    let others: Vec<_> = others.collect();
    Shown {
        range: document.text.range(&span),
        severity: Some(match finding.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
            Severity::Note => DiagnosticSeverity::INFORMATION,
        }),
        code: Some(NumberOrString::String(finding.code.text().to_owned())),
        source: Some("appell".to_owned()),
        message,
        related_information: (!others.is_empty()).then_some(others),
        ..Shown::default()
    }
}

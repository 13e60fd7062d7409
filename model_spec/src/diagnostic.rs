//! Diagnostics of a spec: message, positions and suggested correction.

mod codes;
mod render;

use crate::expr::Span;

pub use codes::{CODES, Code, CodeInfo, Stage};

/// Maximum number of diagnostics shown for one file.
pub const MAX_SHOWN: usize = 100;

/// Severity of a diagnostic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The spec cannot be used.
    Error,
    /// The spec can be used, but something looks unintended.
    Warning,
    /// A remark; the spec is valid.
    Note,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// The violated rule, from the table of codes.
    pub code: Code,
    /// Its severity.
    pub severity: Severity,
    /// The message, in one line.
    pub message: String,
    /// Labelled positions in the spec text; the first is the primary one.
    pub labels: Vec<(Span, String)>,
    /// The suggested correction.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error.
    pub fn error(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            help: None,
        }
    }

    /// A warning.
    pub fn warning(code: Code, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// A note.
    pub fn note(code: Code, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Note,
            ..Self::error(code, message)
        }
    }

    /// Adds a position; the first one is primary.
    #[must_use]
    pub fn at(mut self, span: Span, words: impl Into<String>) -> Self {
        self.labels.push((span, words.into()));
        self
    }

    /// Sets the suggested correction.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Sets the suggested correction, if there is one.
    #[must_use]
    pub fn maybe_help(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }

    fn start(&self) -> usize {
        self.labels.first().map_or(0, |(span, _)| span.start)
    }
}

/// All findings in one file, with its text.
#[derive(Debug, Clone)]
pub struct Report {
    file: String,
    text: String,
    /// Line of the file at which the text begins, from 1.
    first_line: usize,
    diagnostics: Vec<Diagnostic>,
}

impl Report {
    /// A report on `text`, read from `file`; the order becomes that of the text.
    pub fn new(
        file: impl Into<String>,
        text: impl Into<String>,
        mut diagnostics: Vec<Diagnostic>,
    ) -> Self {
        diagnostics.sort_by_key(Diagnostic::start);
        Self {
            file: file.into(),
            text: text.into(),
            first_line: 1,
            diagnostics,
        }
    }

    /// Sets the line of the file, from 1, at which `text` starts, for reports that hold only an
    /// excerpt of a large file.
    #[must_use]
    pub fn from_line(mut self, first_line: usize) -> Self {
        self.first_line = first_line;
        self
    }

    /// Name of the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The findings, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Whether one of the findings is an error.
    pub fn has_errors(&self) -> bool {
        self.diagnostics
            .iter()
            .any(|d| d.severity == Severity::Error)
    }

    /// Line and column of a position, both from 1; the column counts characters.
    pub fn line_column(&self, at: usize) -> (usize, usize) {
        let (line, column) = line_column(&self.text, at);
        (line - 1 + self.first_line, column)
    }

    /// The report as plain text.
    pub fn plain(&self) -> String {
        render::render(self, false)
    }

    /// The report with terminal colours.
    pub fn coloured(&self) -> String {
        render::render(self, true)
    }
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.plain())
    }
}

impl std::error::Error for Report {}

/// Line and column of a byte of `text`, both from 1.
pub(crate) fn line_column(text: &str, at: usize) -> (usize, usize) {
    let at = text.floor_char_boundary(at);
    let before = &text[..at];
    let line = before.bytes().filter(|b| *b == b'\n').count() + 1;
    let start = before.rfind('\n').map_or(0, |i| i + 1);
    (line, before[start..].chars().count() + 1)
}

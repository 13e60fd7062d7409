//! Reports as text, in the manner of a compiler.

use annotate_snippets::{
    AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str,
};

use super::{Diagnostic, MAX_SHOWN, Report, Severity};
use crate::expr::Span;

pub(super) fn render(report: &Report, colour: bool) -> String {
    let renderer = if colour {
        Renderer::styled()
    } else {
        Renderer::plain()
    };
    let mut shown: Vec<String> = report
        .diagnostics
        .iter()
        .take(MAX_SHOWN)
        .map(|diagnostic| render_one(&renderer, report, diagnostic))
        .collect();
    let hidden = report.diagnostics.len().saturating_sub(MAX_SHOWN);
    if hidden > 0 {
        shown.push(format!("… and {hidden} more"));
    }
    shown.join("\n\n")
}

fn render_one(renderer: &Renderer, report: &Report, diagnostic: &Diagnostic) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let title = level
        .primary_title(diagnostic.message.as_str())
        .id(diagnostic.code.text());
    let mut group = Group::with_title(title);
    group = if diagnostic.labels.is_empty() {
        group.element(Origin::path(report.file.as_str()))
    } else {
        group.element(snippet(report, diagnostic))
    };
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(normalize_untrusted_str(help)));
    }
    let text = renderer.render(&[group]);
    // Padding at the ends of lines only disturbs diffs.
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_end().to_owned()
}

/// Most bytes of a line that are shown behind what is marked.
const MOST_BEHIND: usize = 1000;

/// The lines that the labels touch, and no others: a large file costs nothing.
fn snippet<'a>(
    report: &'a Report,
    diagnostic: &'a Diagnostic,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let text = report.text.as_str();
    let spans: Vec<Span> = diagnostic
        .labels
        .iter()
        .map(|(span, _)| clamp(text, span))
        .collect();
    let first = spans.iter().map(|s| s.start).min().unwrap_or(0);
    let last = spans.iter().map(|s| s.end).max().unwrap_or(0);
    let from = text[..first].rfind('\n').map_or(0, |i| i + 1);
    let end = text.ceil_char_boundary(text.len().min(last + MOST_BEHIND));
    let to = text[last..end].find('\n').map_or(end, |i| last + i);
    let annotations =
        spans
            .iter()
            .zip(&diagnostic.labels)
            .enumerate()
            .map(|(i, (span, (_, words)))| {
                let kind = if i == 0 {
                    AnnotationKind::Primary
                } else {
                    AnnotationKind::Context
                };
                let annotation = kind.span(span.start - from..span.end - from);
                if words.is_empty() {
                    annotation
                } else {
                    annotation.label(words.as_str())
                }
            });
    // A carriage return would be shown as a symbol; a blank keeps the places.
    Snippet::source(text[from..to].replace('\r', " "))
        .line_start(report.line_column(from).0)
        .path(report.file.as_str())
        .annotations(annotations)
}

/// A span inside the text, on character boundaries, on one line.
fn clamp(text: &str, span: &Span) -> Span {
    let start = text.floor_char_boundary(span.start.min(text.len()));
    let end = text.ceil_char_boundary(span.end.min(text.len())).max(start);
    let line_end = text[start..end].find('\n').map_or(end, |i| start + i);
    start..line_end
}

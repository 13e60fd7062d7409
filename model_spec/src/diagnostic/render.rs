//! Reports as text, in the manner of a compiler.

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use super::{Diagnostic, MAX_SHOWN, Report, Severity};
use crate::expr::Span;
use crate::visible::{visible, visible_line};

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
        .primary_title(visible(&diagnostic.message))
        .id(diagnostic.code.text());
    let mut group = Group::with_title(title);
    group = if diagnostic.labels.is_empty() {
        group.element(Origin::path(visible_line(&report.file)))
    } else {
        group.element(snippet(report, diagnostic))
    };
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(visible(help)));
    }
    let text = renderer.render(&[group]);
    // Padding at the ends of lines only disturbs diffs.
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    lines.join("\n").trim_end().to_owned()
}

/// Maximum number of bytes shown after the marked part of a line.
const MOST_BEHIND: usize = 1000;

/// Only the lines that the labels touch, so that the cost does not depend on the size of the file.
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
    // Column after hidden characters have been escaped.
    let column = |at: usize| shown(&text[from..at]).len();
    let annotations = spans.iter().zip(&diagnostic.labels).enumerate();
    let annotations = annotations.map(|(i, (span, (_, words)))| {
        let kind = if i == 0 {
            AnnotationKind::Primary
        } else {
            AnnotationKind::Context
        };
        let annotation = kind.span(column(span.start)..column(span.end));
        if words.is_empty() {
            annotation
        } else {
            annotation.label(visible_line(words))
        }
    });
    Snippet::source(shown(&text[from..to]))
        .line_start(report.line_column(from).0)
        .path(visible_line(&report.file))
        .annotations(annotations)
}

/// A carriage return would end a line; a blank in its place preserves the columns.
fn shown(text: &str) -> String {
    visible(&text.replace('\r', " ")).into_owned()
}

/// A span inside the text, on character boundaries, on one line.
fn clamp(text: &str, span: &Span) -> Span {
    let start = text.floor_char_boundary(span.start.min(text.len()));
    let end = text.ceil_char_boundary(span.end.min(text.len())).max(start);
    let line_end = text[start..end].find('\n').map_or(end, |i| start + i);
    start..line_end
}

#[cfg(test)]
mod tests {
    use super::super::Code;
    use super::*;

    /// Clears the screen, reorders, hides, returns to the beginning of the line.
    const EVIL: &str = "\u{1b}[2Ja\u{202e}b\u{200b}c\u{9b}d\u{7}";

    #[test]
    fn nothing_of_a_foreign_text_commands_the_terminal() {
        let text = format!("first\n{EVIL}x = 1\r\n");
        let at = text.find("x =").unwrap_or_default();
        let finding = Diagnostic::error(Code::UnknownName, format!("`{EVIL}`"))
            .at(at..at + 1, EVIL)
            .help(EVIL);
        let report = Report::new(format!("{EVIL}.toml"), text, vec![finding]);
        let own = |c: char| c == '\n' || c == '\u{1b}';
        let coloured = report.coloured();
        for shown in [report.plain(), coloured.clone(), report.to_string()] {
            let hidden = shown
                .chars()
                .find(|c| crate::visible::is_hidden(*c) && !own(*c));
            assert_eq!(hidden, None, "{shown:?}");
            assert_eq!(shown.matches("\\u{202e}").count(), 5, "{shown}");
        }
        assert!(!report.plain().contains('\u{1b}'));
        // The remaining escape sequences are colours.
        let commands = coloured.split('\u{1b}').skip(1);
        for command in commands {
            let end = command.find(|c: char| c.is_ascii_alphabetic());
            assert_eq!(end.map(|end| &command[end..=end]), Some("m"), "{command}");
        }
        // The mark is below the marked text.
        let plain = report.plain();
        let lines: Vec<&str> = plain.lines().collect();
        let line = lines.iter().position(|line| line.contains("x = 1"));
        let line = line.unwrap_or_default();
        assert_eq!(
            lines[line].find("x = 1"),
            lines[line + 1].find('^'),
            "{plain}"
        );
    }
}

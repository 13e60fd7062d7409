//! A file with its includes as one text, whose positions are mapped back to the files.
//!
//! As in `MuJoCo`, `<include file="…"/>` is replaced by the children of the root of the included file. Each file is
//! included at most once. Paths are relative to the folder of the first file, or else to that of the including file.

use appell_spec::{Code, Diagnostic, Report, Severity, shown};

use crate::xml::{Element, Span, begun, inside, parse};

/// Largest size of a file with its includes, in bytes.
pub const MAX_FILE: u64 = 1 << 24;
/// Deepest nesting of files.
const MOST_NESTED: usize = 16;

/// Reads a file by its path relative to the folder of the first one; errors are messages.
pub(crate) type Others<'f> = &'f dyn Fn(&str) -> Result<Vec<u8>, String>;

/// A file with its includes.
pub(crate) struct Whole<'f> {
    /// The combined text.
    pub(crate) text: String,
    /// Name and text of each, the first one includes the others.
    files: Vec<(String, String)>,
    /// Where the lines of each file begin.
    lines: Vec<Vec<usize>>,
    pieces: Vec<Piece>,
    others: Others<'f>,
}

/// A contiguous part of a file in the combined text.
struct Piece {
    /// Where it begins in the combined text.
    start: usize,
    file: usize,
    /// Where it begins in its file.
    from: usize,
}

/// A part of another text.
pub(crate) enum Edit {
    /// A part of the text as it is.
    Keep(Span),
    /// Inserted text, with the position to which errors in it refer.
    Insert(String, usize),
}

/// `<include>`
struct Include {
    place: Span,
    /// The path, with its position.
    named: Option<(String, Span)>,
}

impl<'f> Whole<'f> {
    /// Reads a file with all its includes. The error is a report on the XML of one of the files.
    pub(crate) fn read(file: &str, text: &str, others: Others<'f>) -> Result<Self, Box<Report>> {
        let mut whole = Self {
            text: String::new(),
            files: Vec::new(),
            lines: Vec::new(),
            pieces: Vec::new(),
            others,
        };
        whole.add(file.to_owned(), text);
        let (_, includes) = whole.parsed(0)?;
        whole.append(0, &(0..text.len()), includes, 0)?;
        Ok(whole)
    }

    /// A report on one file.
    fn report(&self, file: usize, findings: Vec<Diagnostic>) -> Report {
        let (name, text) = &self.files[file];
        Report::new(name.as_str(), text.as_str(), findings)
    }

    /// Span of the contents of the root of a file, and its includes.
    fn parsed(&self, file: usize) -> Result<(Span, Vec<Include>), Box<Report>> {
        let text = &self.files[file].1;
        let document = parse(text).map_err(|error| self.report(file, vec![error]))?;
        let root = document.root_element();
        let named = |element: Element<'_>| {
            let named = element.attribute_node("file")?;
            Some((named.value().to_owned(), named.range_value()))
        };
        let all = root.descendants();
        let is_mjcf = file > 0 || root.has_tag_name("mujoco");
        let includes = all.filter(|element| is_mjcf && element.has_tag_name("include"));
        let includes = includes.map(|element| Include {
            place: element.range(),
            named: named(element),
        });
        Ok((inside(root), includes.collect()))
    }

    /// Appends a part of a file with its includes.
    fn append(
        &mut self,
        file: usize,
        part: &Span,
        includes: Vec<Include>,
        depth: usize,
    ) -> Result<(), Box<Report>> {
        let mut from = part.start;
        for include in includes {
            // Nested in another include.
            if include.place.start < from {
                continue;
            }
            self.push(file, from..include.place.start);
            from = include.place.end;
            let next = self.found(file, &include, depth);
            let next = next.map_err(|finding| self.report(file, vec![finding]))?;
            let (part, includes) = self.parsed(next)?;
            self.append(next, &part, includes, depth + 1)?;
        }
        self.push(file, from..part.end);
        Ok(())
    }

    fn push(&mut self, file: usize, part: Span) {
        self.pieces.push(Piece {
            start: self.text.len(),
            file,
            from: part.start,
        });
        self.text.push_str(&self.files[file].1[part]);
    }

    /// The same files with an edited text; places in it are those of the parts that it consists of.
    pub(crate) fn edited(self, edits: &[Edit]) -> Self {
        let (mut text, mut pieces) = (String::new(), Vec::new());
        for edit in edits {
            let place = match edit {
                Edit::Keep(part) => part.clone(),
                Edit::Insert(_, at) => *at..*at + 1,
            };
            let first = self
                .pieces
                .partition_point(|piece| piece.start <= place.start);
            let first = first.saturating_sub(1);
            let overlaps = self.pieces[first..]
                .iter()
                .take_while(|piece| piece.start < place.end);
            for piece in overlaps {
                let from = place.start.max(piece.start);
                pieces.push(Piece {
                    start: text.len() + from - place.start,
                    file: piece.file,
                    from: piece.from + from - piece.start,
                });
            }
            text.push_str(match edit {
                Edit::Keep(part) => &self.text[part.clone()],
                Edit::Insert(words, _) => words,
            });
        }
        Self {
            text,
            pieces,
            ..self
        }
    }

    /// The bytes of a file that a file names, and its path; `within` is a folder for files of its kind. The error says why
    /// it cannot be read.
    fn named(
        &self,
        by: usize,
        within: Option<&str>,
        name: &str,
    ) -> Result<(String, Vec<u8>), String> {
        let folder = match by {
            0 => None,
            _ => self.files[by].0.rsplit_once('/').map(|(folder, _)| folder),
        };
        let path = |folder: Option<&str>| {
            let parts = [within, folder, Some(name)].into_iter().flatten();
            parts.collect::<Vec<_>>().join("/")
        };
        let read = |path: String| (self.others)(&path).map(|bytes| (path, bytes));
        read(path(None)).or_else(|why| match folder {
            Some(_) => read(path(folder)),
            None => Err(why),
        })
    }

    /// The bytes of a file that is named at a place, and its path.
    pub(crate) fn beside(
        &self,
        place: &Span,
        within: Option<&str>,
        name: &str,
    ) -> Result<(String, Vec<u8>), String> {
        self.named(self.origin(place).0, within, name)
    }

    /// Reads an included file; the result is its index.
    fn found(&mut self, by: usize, include: &Include, depth: usize) -> Result<usize, Diagnostic> {
        let Some((named, place)) = &include.named else {
            let error = Diagnostic::error(Code::MissingKey, "`include` names no file");
            let help = "write `<include file=\"…\"/>`";
            return Err(error.at(include.place.clone(), "").help(help));
        };
        let fail = |code: Code, message: String, help: &str| {
            Err(Diagnostic::error(code, message)
                .at(place.clone(), "")
                .help(help))
        };
        let name = shown(named);
        if depth >= MOST_NESTED {
            let message = format!("files include each other more than {MOST_NESTED} deep");
            return fail(Code::LimitExceeded, message, "put them together");
        }
        let twice = |named: &str| self.files.iter().any(|(other, _)| other == named);
        let found = self.named(by, None, named);
        if found
            .as_ref()
            .map_or_else(|_| twice(named), |(path, _)| twice(path))
        {
            let message = format!("`{name}` is included twice");
            return fail(Code::DuplicateName, message, "remove one of the two");
        }
        let (path, bytes) = match found {
            Ok(found) => found,
            Err(why) => {
                let message = format!("the file `{name}` cannot be read: {why}");
                let help = "paths are those from the folder of the file that is imported, or of that which includes";
                return fail(Code::UnknownReference, message, help);
            }
        };
        let Ok(text) = String::from_utf8(bytes) else {
            let message = format!("`{name}` is not UTF-8 text");
            return fail(Code::WrongType, message, "save it as UTF-8");
        };
        if crate::format::first_element(&text).is_none() {
            // Its contents are not quoted, as it may be any file.
            let message = format!("`{name}` is no XML file");
            return fail(Code::WrongType, message, "name a file of MuJoCo");
        }
        let all: usize = self.files.iter().map(|(_, text)| text.len()).sum();
        if (all + text.len()) as u64 > MAX_FILE {
            let message = format!("all files have more than {} MiB together", MAX_FILE >> 20);
            return fail(Code::LimitExceeded, message, "remove unused parts");
        }
        Ok(self.add(path, &text))
    }

    /// Adds a file; the result is its index.
    fn add(&mut self, name: String, text: &str) -> usize {
        let text = begun(text);
        let ends = text.match_indices('\n').map(|(at, _)| at + 1);
        self.lines.push([0].into_iter().chain(ends).collect());
        self.files.push((name, text));
        self.files.len() - 1
    }

    /// File and position for a position in the combined text.
    fn origin(&self, place: &Span) -> (usize, Span) {
        let next = self
            .pieces
            .partition_point(|piece| piece.start <= place.start);
        let piece = &self.pieces[next.saturating_sub(1)];
        let end = self
            .pieces
            .get(next)
            .map_or(self.text.len(), |next| next.start);
        let at = |byte: usize| piece.from + byte.min(end) - piece.start;
        (piece.file, at(place.start)..at(place.end))
    }

    /// The place in the first file for a place in the combined text. The error is the name of another file that has it.
    pub(crate) fn in_first(&self, place: &Span) -> Result<Span, &str> {
        match self.origin(place) {
            (0, place) => Ok(place),
            (file, _) => Err(&self.files[file].0),
        }
    }

    /// Name of the file and line for a position in the combined text.
    pub(crate) fn line(&self, place: &Span) -> (&str, usize) {
        let (file, place) = self.origin(place);
        let line = self.lines[file].partition_point(|start| *start <= place.start);
        (&self.files[file].0, line)
    }

    /// Findings as reports, one for each file that has any.
    pub(crate) fn reports(&self, findings: Vec<Diagnostic>) -> Vec<Report> {
        let mut all: Vec<Vec<Diagnostic>> = vec![Vec::new(); self.files.len()];
        for mut finding in findings {
            let labels = std::mem::take(&mut finding.labels).into_iter();
            let labels = labels.map(|(place, words)| (self.origin(&place), words));
            let labels: Vec<_> = labels.collect();
            let file = labels.first().map_or(0, |((file, _), _)| *file);
            let own = labels.into_iter().filter(|((of, _), _)| *of == file);
            finding.labels = own.map(|((_, place), words)| (place, words)).collect();
            all[file].push(finding);
        }
        let all = all.into_iter().enumerate();
        let all = all.filter(|(_, findings)| !findings.is_empty());
        all.map(|(file, findings)| self.report(file, findings))
            .collect()
    }

    /// The report on the first file with an error.
    pub(crate) fn first_error(&self, findings: Vec<Diagnostic>) -> Report {
        let is_wrong = |report: &Report| {
            let mut all = report.diagnostics().iter();
            all.any(|finding| finding.severity == Severity::Error)
        };
        let mut reports = self.reports(findings).into_iter();
        let first = reports.find(is_wrong);
        first.unwrap_or_else(|| self.report(0, Vec::new()))
    }
}

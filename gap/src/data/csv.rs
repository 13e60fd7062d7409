//! CSV files, line by line: memory for the numbers and for one line.

use std::fs::File;
use std::io::{BufRead, BufReader, Read as _};
use std::ops::Range;
use std::path::Path;

use appell_spec::expr::Span;
use appell_spec::{Code, Diagnostic, Report, closest, shown};

use super::channel::Channel;
use super::clock::Clock;
use super::finding::listed;
use super::limits::{MAX_LINE, MAX_MISTAKES};
use super::table::{TIME, Table, checked, regular, too_many};
use super::{DataError, Finding, FindingKind, motive};

/// Reads the columns of the channels and the times, whose unit is `time_unit` s. `budget` counts down the
/// numbers that may still come.
pub(super) fn read(
    path: &Path,
    time_unit: f64,
    channels: &[Channel],
    budget: &mut usize,
) -> Result<Table, DataError> {
    open(path)?.table(time_unit, channels, budget)
}

/// The names of the columns.
pub(super) fn header(path: &Path) -> Result<Vec<String>, DataError> {
    Ok(open(path)?.header)
}

fn open(path: &Path) -> Result<CsvFile<BufReader<File>>, DataError> {
    let failed = |cause| DataError::File {
        path: path.to_owned(),
        cause,
    };
    regular(path)?;
    let file = File::open(path).map_err(failed)?;
    CsvFile::new(path, BufReader::new(file))
}

struct CsvFile<R> {
    lines: Lines<R>,
    separator: char,
    header: Vec<String>,
    mistakes: Vec<DataError>,
}

impl<R: BufRead> CsvFile<R> {
    /// Reads the header.
    fn new(path: &Path, reader: R) -> Result<Self, DataError> {
        let mut lines = Lines::new(path, reader);
        if !lines.next()? {
            let message = "the file is empty; begin with a header: `t`, then the channels";
            return Err(DataError::whole(&*lines.file, message));
        }
        // Tables from other programs use what is not a decimal comma.
        let separator = [',', ';', '\t']
            .into_iter()
            .find(|c| lines.text.contains(*c));
        let separator = separator.unwrap_or(',');
        let header = if motive::begins(&lines.text) {
            motive::header(&mut lines, separator)?
        } else {
            texts(&lines.text, separator)
        };
        Ok(Self {
            lines,
            separator,
            header,
            mistakes: Vec::new(),
        })
    }

    fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: Option<String>) {
        if self.mistakes.len() < MAX_MISTAKES {
            let diagnostic = Diagnostic::error(code, message).at(at, "").maybe_help(help);
            self.mistakes.push(self.lines.report(diagnostic));
        }
    }

    fn table(
        mut self,
        time_unit: f64,
        channels: &[Channel],
        budget: &mut usize,
    ) -> Result<Table, DataError> {
        let mut findings = Vec::new();
        let places = self.places(channels, &mut findings);
        if !self.mistakes.is_empty() {
            return Err(DataError::several(self.mistakes));
        }
        let count = self.header.len();
        let mut clock = Clock::default();
        let mut times = Vec::new();
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); channels.len()];
        let (mut row, mut read): (Vec<Range<usize>>, Vec<f64>) = (Vec::new(), Vec::new());
        while self.mistakes.len() < MAX_MISTAKES && self.lines.next()? {
            row.clear();
            row.extend(cells(&self.lines.text, self.separator));
            if row.len() != count {
                if self.lines.breaks_off && row.len() < count {
                    let message = "the last line breaks off; it is left out";
                    let finding = Finding::new(FindingKind::CutOff, message);
                    findings.push(finding.on_line(self.lines.number));
                    continue;
                }
                let message = format!("{} cells under {count} columns", row.len());
                let line = 0..self.lines.text.len();
                self.tell(Code::WrongType, message, line, None);
                continue;
            }
            let t = self.number(row[places.time].clone(), time_unit);
            read.clear();
            for (place, channel) in places.channels.iter().zip(channels) {
                read.push(self.number(row[*place].clone(), channel.unit.scale));
            }
            if !clock.accept(t, self.lines.number, &self.lines.text) {
                continue;
            }
            let left = budget.checked_sub(1 + channels.len());
            *budget = left.ok_or_else(|| too_many(self.lines.place()))?;
            times.push(t);
            for (column, value) in columns.iter_mut().zip(&read) {
                column.push(*value);
            }
        }
        if !self.mistakes.is_empty() {
            return Err(DataError::several(self.mistakes));
        }
        let file = &*self.lines.file;
        findings.extend(clock.findings(file)?);
        checked(file, channels, times, columns, findings)
    }

    /// Where the time and the channels stand.
    fn places(&mut self, channels: &[Channel], findings: &mut Vec<Finding>) -> Places {
        let header = self.header.clone();
        let line = 0..self.lines.text.len();
        let mut place = |name: &str, help: &str| {
            let mut at = (0..header.len()).filter(|&i| header[i] == name);
            match (at.next(), at.next()) {
                (Some(place), None) => place,
                (Some(_), Some(second)) => {
                    let message = format!("the column `{}` stands here twice", shown(name));
                    let at = cells(&self.lines.text, self.separator).nth(second);
                    self.tell(Code::DuplicateName, message, at.unwrap_or(0..0), None);
                    0
                }
                (None, _) => {
                    let message = format!("there is no column `{}`", shown(name));
                    let similar = closest(name, header.iter().map(String::as_str));
                    let help = similar.map_or(help.to_owned(), |s| format!("did you mean `{s}`?"));
                    self.tell(Code::MissingKey, message, line.clone(), Some(help));
                    0
                }
            }
        };
        let time = place(TIME, "name the column of times in seconds `t`");
        let about = "every run has a column for each line of `[channels]`";
        let channels: Vec<usize> = channels.iter().map(|c| place(&c.column, about)).collect();
        let unknown = (0..header.len()).filter(|i| *i != time && !channels.contains(i));
        let unknown: Vec<String> = unknown.map(|i| shown(&header[i])).collect();
        if !unknown.is_empty() {
            let message = format!(
                "columns that nobody describes are left aside: {}",
                listed(&unknown)
            );
            findings.push(Finding::new(FindingKind::UnknownColumn, message));
        }
        Places { time, channels }
    }

    /// The number in a cell in SI, NaN where it is missing; tells where there is something else.
    fn number(&mut self, cell: Range<usize>, scale: f64) -> f64 {
        let text = &self.lines.text[cell.clone()];
        match text.parse::<f64>().map(|number| number * scale) {
            Ok(number) if !number.is_infinite() => number,
            _ if MISSING.iter().any(|word| text.eq_ignore_ascii_case(word)) => f64::NAN,
            _ => {
                let message = format!("`{}` is not a finite number", shown(text));
                let help = if text.contains(',') {
                    "write numbers with a decimal point"
                } else {
                    "leave the cell empty where a value is missing"
                };
                self.tell(Code::WrongType, message, cell, Some(help.to_owned()));
                f64::NAN
            }
        }
    }
}

/// What stands for a missing value, besides `nan`.
const MISSING: [&str; 4] = ["", "na", "n/a", "null"];

struct Places {
    time: usize,
    channels: Vec<usize>,
}

/// The lines of a file that hold something.
pub(super) struct Lines<R> {
    reader: R,
    /// Name of the file.
    file: String,
    /// Number of the line, from 1.
    number: usize,
    /// The line, without its end.
    pub(super) text: String,
    /// Whether the file ends within the line.
    breaks_off: bool,
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    fn new(path: &Path, reader: R) -> Self {
        Self {
            reader,
            file: path.to_string_lossy().into_owned(),
            number: 0,
            text: String::new(),
            breaks_off: false,
            bytes: Vec::new(),
        }
    }

    /// Goes to the next line that is neither empty nor a comment; whether there is one.
    pub(super) fn next(&mut self) -> Result<bool, DataError> {
        loop {
            self.bytes.clear();
            let mut limited = self.reader.by_ref().take(MAX_LINE as u64 + 1);
            let read = limited.read_until(b'\n', &mut self.bytes);
            read.map_err(|cause| DataError::File {
                path: (&self.file).into(),
                cause,
            })?;
            if self.bytes.is_empty() {
                return Ok(false);
            }
            self.number += 1;
            if self.bytes.len() > MAX_LINE {
                let message = format!("the line has more than {MAX_LINE} bytes");
                return Err(DataError::whole(self.place(), message));
            }
            self.breaks_off = self.bytes.last() != Some(&b'\n');
            let Ok(text) = str::from_utf8(&self.bytes) else {
                return Err(DataError::whole(self.place(), "the line is not UTF-8 text"));
            };
            let text = text.strip_prefix('\u{feff}').unwrap_or(text).trim_end();
            if !text.is_empty() && !text.starts_with('#') {
                self.text.clear();
                self.text.push_str(text);
                return Ok(true);
            }
        }
    }

    /// File and line.
    pub(super) fn place(&self) -> String {
        format!("{}:{}", self.file, self.number)
    }

    /// A mistake on this line.
    fn report(&self, diagnostic: Diagnostic) -> DataError {
        let report = Report::new(&*self.file, &*self.text, vec![diagnostic]);
        report.from_line(self.number).into()
    }
}

/// The cells of a line.
pub(super) fn texts(line: &str, separator: char) -> Vec<String> {
    let cells = cells(line, separator);
    cells.map(|cell| line[cell].to_owned()).collect()
}

/// Where the cells of a line stand, without blanks and quotes around them.
fn cells(line: &str, separator: char) -> impl Iterator<Item = Range<usize>> {
    let mut quoted = false;
    line.split(move |c| {
        quoted ^= c == '"';
        c == separator && !quoted
    })
    .map(move |cell| {
        let inner = cell.trim();
        let unquoted = inner
            .strip_prefix('"')
            .and_then(|rest| rest.strip_suffix('"'));
        let inner = unquoted.unwrap_or(inner).trim();
        let start = inner.as_ptr() as usize - line.as_ptr() as usize;
        start..start + inner.len()
    })
}

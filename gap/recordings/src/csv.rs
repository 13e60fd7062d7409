//! CSV files, line by line: memory for the numbers and for one line.

use std::fs::File;
use std::io::{BufRead, BufReader, Read as _};
use std::ops::Range;
use std::path::Path;

use appell_files::FileError;
use appell_spec::expr::Span;
use appell_spec::{Code, Diagnostic, Report, closest, shown};

use crate::channel::Channel;
use crate::clock::Clock;
use crate::limits::{MAX_FILE, MAX_LINE, MAX_MISTAKES};
use crate::table::{Table, checked, ignored, too_many};
use crate::time::{NoTime, Stated, TimeColumn, Times, origin};
use crate::{DataError, Finding, FindingKind, episode, motive};

/// Reads the columns of the channels and the times. `budget` counts down the numbers that may still come.
pub(crate) fn read(
    path: &Path,
    time: &Stated,
    channels: &[Channel],
    episode: Option<u64>,
    budget: &mut usize,
) -> Result<Table, DataError> {
    let file = CsvFile {
        rows: open(path)?,
        mistakes: Vec::new(),
    };
    file.table(time, channels, episode, budget)
}

/// The names of the columns.
pub(crate) fn header(path: &Path) -> Result<Vec<String>, DataError> {
    Ok(open(path)?.header)
}

fn open(path: &Path) -> Result<Rows<BufReader<File>>, DataError> {
    Rows::new(path, BufReader::new(appell_files::open(path, MAX_FILE)?))
}

/// A CSV file read row by row, with the position of every cell; memory holds one line.
///
/// Cells are separated by commas, semicolons or tabs; empty lines and comments, which begin with `#`, are
/// skipped.
pub struct Rows<R> {
    lines: Lines<R>,
    separator: char,
    header: Vec<String>,
    /// Positions of the cells in the line.
    cells: Vec<Range<usize>>,
}

impl<R: BufRead> Rows<R> {
    /// Reads the header, whose cells are then those of the row.
    pub fn new(path: &Path, reader: R) -> Result<Self, DataError> {
        let mut lines = Lines::new(path, reader);
        if !lines.next()? {
            let message =
                "the file is empty; begin with a header: `t`, then the name of each column";
            return Err(DataError::whole(&*lines.file, message));
        }
        // With a decimal comma, other programs separate cells by semicolons or tabs.
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
            cells: cells(&lines.text, separator).collect(),
            lines,
            separator,
            header,
        })
    }

    /// The names of the columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// Goes to the next row; whether there is one.
    pub fn advance(&mut self) -> Result<bool, DataError> {
        let there = self.lines.next()?;
        self.cells.clear();
        if there {
            self.cells.extend(cells(&self.lines.text, self.separator));
        }
        Ok(there)
    }

    /// How many cells the row has.
    pub fn count(&self) -> usize {
        self.cells.len()
    }

    /// The text in a cell of the row.
    pub fn cell(&self, column: usize) -> &str {
        &self.lines.text[self.place(column)]
    }

    /// Position of a cell in the line.
    pub fn place(&self, column: usize) -> Span {
        self.cells.get(column).cloned().unwrap_or(0..0)
    }

    /// The whole line.
    pub fn line(&self) -> Span {
        0..self.lines.text.len()
    }

    /// The error for a part of the line.
    pub fn mistake(
        &self,
        code: Code,
        message: impl Into<String>,
        at: Span,
        help: Option<String>,
    ) -> DataError {
        let diagnostic = Diagnostic::error(code, message).at(at, "").maybe_help(help);
        self.lines.report(diagnostic)
    }

    /// The error if the row and the header differ in length.
    pub fn uneven(&self) -> Option<DataError> {
        let (cells, columns) = (self.count(), self.header.len());
        let message = || format!("{cells} cells under {columns} columns");
        (cells != columns).then(|| self.mistake(Code::WrongType, message(), self.line(), None))
    }
}

struct CsvFile<R> {
    rows: Rows<R>,
    mistakes: Vec<DataError>,
}

impl<R: BufRead> CsvFile<R> {
    fn tell(&mut self, code: Code, message: impl Into<String>, at: Span, help: Option<String>) {
        if self.mistakes.len() < MAX_MISTAKES {
            self.mistakes
                .push(self.rows.mistake(code, message, at, help));
        }
    }

    fn table(
        mut self,
        time: &Stated,
        channels: &[Channel],
        episode: Option<u64>,
        budget: &mut usize,
    ) -> Result<Table, DataError> {
        let mut findings = Vec::new();
        let Some((times_at, places)) = self.places(time, channels, &mut findings) else {
            return Err(DataError::several(self.mistakes));
        };
        let of_episodes = match episode {
            Some(episode) => Some((
                episode::column(&self.rows.header, &self.rows.lines.file)?,
                episode,
            )),
            None => None,
        };
        let mut start = None;
        let mut row = 0_usize;
        let mut clock = Clock::default();
        let mut times = Vec::new();
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); channels.len()];
        let mut read: Vec<f64> = Vec::new();
        while self.mistakes.len() < MAX_MISTAKES && self.rows.advance()? {
            if let Some(uneven) = self.rows.uneven() {
                let lines = &self.rows.lines;
                if lines.breaks_off && self.rows.count() < self.rows.header.len() {
                    let message = "the last line breaks off; it is left out";
                    let finding = Finding::new(FindingKind::CutOff, message);
                    findings.push(finding.on_line(lines.number));
                } else {
                    self.mistakes.push(uneven);
                }
                continue;
            }
            if let Some((column, chosen)) = of_episodes
                && episode::number(self.number(column, |number| number)) != Some(chosen)
            {
                continue;
            }
            let t = match times_at.times {
                Times::Column(index) => {
                    let (t, scale) = (self.number(index, |t| t), times_at.scale());
                    if start.is_none() && t.is_finite() {
                        start = Some(origin(t, scale));
                    }
                    scale * (t - start.unwrap_or(0.0))
                }
                Times::Parts([seconds, nanoseconds]) => {
                    let seconds = self.number(seconds, |t| t);
                    let start = *start.get_or_insert(seconds);
                    seconds - start + self.number(nanoseconds, |t| 1e-9 * t)
                }
                Times::Rate(rate) => row as f64 / rate,
            };
            row += 1;
            read.clear();
            for (place, channel) in places.iter().zip(channels) {
                read.push(self.number(*place, |number| channel.in_si(number)));
            }
            let lines = &self.rows.lines;
            if !clock.accept(t, lines.number, &lines.text) {
                continue;
            }
            let left = budget.checked_sub(1 + channels.len());
            *budget = left.ok_or_else(|| too_many(lines.place()))?;
            times.push(t);
            for (column, value) in columns.iter_mut().zip(&read) {
                column.push(*value);
            }
        }
        if !self.mistakes.is_empty() {
            return Err(DataError::several(self.mistakes));
        }
        let file = &*self.rows.lines.file;
        findings.extend(clock.findings(file)?);
        checked(file, &times_at, times, channels, columns, findings)
    }

    /// Columns of the time and of the channels; `None` if one is missing.
    fn places(
        &mut self,
        time: &Stated,
        channels: &[Channel],
        findings: &mut Vec<Finding>,
    ) -> Option<(TimeColumn, Vec<usize>)> {
        let header = self.rows.header.clone();
        let line = self.rows.line();
        let time = match time.find(&header, channels) {
            Ok(time) => Some(time),
            Err(NoTime { message, help }) => {
                self.tell(Code::MissingKey, message, line.clone(), Some(help));
                None
            }
        };
        let mut place = |name: &str, help: &str| {
            let mut at = (0..header.len()).filter(|&i| header[i] == name);
            match (at.next(), at.next()) {
                (Some(place), None) => place,
                (Some(_), Some(second)) => {
                    let message = format!("the column `{}` stands here twice", shown(name));
                    let at = self.rows.place(second);
                    self.tell(Code::DuplicateName, message, at, None);
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
        if let Some(time) = &time
            && matches!(time.times, Times::Column(_))
        {
            place(&time.name, "");
        }
        let about = "every run has a column for each line of `[channels]`";
        let channels: Vec<usize> = channels.iter().map(|c| place(&c.column, about)).collect();
        let time = time.filter(|_| self.mistakes.is_empty())?;
        findings.extend(ignored(&header, &time, &channels));
        Some((time, channels))
    }

    /// The number in a cell in SI, NaN if it is missing; other contents are reported.
    fn number(&mut self, column: usize, in_si: impl Fn(f64) -> f64) -> f64 {
        let text = self.rows.cell(column);
        match text.parse::<f64>().map(in_si) {
            Ok(number) if !number.is_infinite() => number,
            _ if MISSING.iter().any(|word| text.eq_ignore_ascii_case(word)) => f64::NAN,
            _ => {
                let message = format!("`{}` is not a finite number", shown(text));
                let help = instead(text);
                let at = self.rows.place(column);
                self.tell(Code::WrongType, message, at, Some(help));
                f64::NAN
            }
        }
    }
}

/// The correction to suggest for a text that is not a number.
fn instead(text: &str) -> String {
    let with_point = text.replace(',', ".");
    if with_point.parse::<f64>().is_ok() {
        return format!("write numbers with a decimal point: `{with_point}`");
    }
    let is_part = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    if text.contains(['-', ':']) && text.split(['-', ':', '.', 'T', ' ', 'Z', '+']).any(is_part) {
        return "write times as numbers, such as seconds since the first row; the Python package also reads the dates \
                of a data frame"
            .to_owned();
    }
    "leave the cell empty where a value is missing".to_owned()
}

/// Texts for a missing value, in addition to `nan`.
const MISSING: [&str; 4] = ["", "na", "n/a", "null"];

/// The lines of a file that hold something.
pub(crate) struct Lines<R> {
    reader: R,
    /// Name of the file.
    file: String,
    /// Number of the line, from 1.
    number: usize,
    /// The line, without its end.
    pub(crate) text: String,
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
    pub(crate) fn next(&mut self) -> Result<bool, DataError> {
        loop {
            self.bytes.clear();
            let mut limited = self.reader.by_ref().take(MAX_LINE as u64 + 1);
            let read = limited.read_until(b'\n', &mut self.bytes);
            read.map_err(|cause| FileError::System {
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
    pub(crate) fn place(&self) -> String {
        format!("{}:{}", self.file, self.number)
    }

    /// A mistake on this line.
    fn report(&self, diagnostic: Diagnostic) -> DataError {
        let report = Report::new(&*self.file, &*self.text, vec![diagnostic]);
        report.from_line(self.number).into()
    }
}

/// The cells of a line.
pub(crate) fn texts(line: &str, separator: char) -> Vec<String> {
    let cells = cells(line, separator);
    cells.map(|cell| line[cell].to_owned()).collect()
}

/// Positions of the cells of a line, without surrounding blanks and quotes.
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

//! Runs as tables of numbers, whatever the format of their files.

use std::path::Path;

use appell_spec::units::Unit;
use appell_spec::{closest, shown};

use super::channel::Channel;
use super::clock::Clock;
use super::finding::{counted, listed};
use super::limits::{MAX_BYTES, MAX_NUMBERS, MAX_VALUE, MIN_ROWS};
use super::{DataError, Finding, FindingKind, c3d, csv};

/// The column of the times.
pub(super) const TIME: &str = "t";

/// The numbers of a run.
pub(crate) struct Table {
    /// Times in s, strictly increasing.
    pub(crate) times: Vec<f64>,
    /// Values in SI, a column for each channel; NaN where one is missing.
    pub(crate) columns: Vec<Vec<f64>>,
    /// What was left out.
    pub(crate) findings: Vec<Finding>,
}

/// How the numbers of a file are written, by the end of its name.
#[derive(Clone, Copy)]
enum Format {
    Csv,
    C3d,
    Mcap,
    Parquet,
}

impl Format {
    fn of(path: &Path) -> Self {
        let is = |end: &str| {
            path.extension()
                .is_some_and(|own| own.eq_ignore_ascii_case(end))
        };
        match () {
            () if is("c3d") => Self::C3d,
            () if is("mcap") => Self::Mcap,
            () if is("parquet") => Self::Parquet,
            () => Self::Csv,
        }
    }
}

/// Reads the columns of the channels, and the times, which are in seconds where no unit is stated.
/// `budget` counts down the numbers that may still come.
pub(crate) fn read(
    path: &Path,
    time: Option<&Unit>,
    channels: &[Channel],
    budget: &mut usize,
) -> Result<Table, DataError> {
    let named = |name: &str| name == TIME || channels.iter().any(|c| c.column == name);
    let columns = match Format::of(path) {
        Format::Csv => {
            let scale = time.map_or(1.0, |unit| unit.scale);
            return csv::read(path, scale, channels, budget);
        }
        // These formats say themselves when a row was recorded.
        _ if time.is_some_and(|unit| !unit.is_si()) => {
            let message = "the times of such a file are in seconds; only those of a CSV file may have \
                           another unit";
            return Err(DataError::whole(path.to_string_lossy(), message));
        }
        format => Columns::of(path, format, &named, *budget)?,
    };
    columns.table(&path.to_string_lossy(), channels, budget)
}

/// The names of the columns.
pub(super) fn header(path: &Path) -> Result<Vec<String>, DataError> {
    match Format::of(path) {
        Format::Csv => csv::header(path),
        format => Ok(Columns::of(path, format, &|_| false, MAX_NUMBERS)?.names),
    }
}

/// The length of a regular file: a pipe would keep everybody waiting.
pub(super) fn regular(path: &Path) -> Result<u64, DataError> {
    let about = std::fs::metadata(path).map_err(|cause| DataError::File {
        path: path.to_owned(),
        cause,
    })?;
    let message = "a run is a regular file";
    let refused = || DataError::whole(path.to_string_lossy(), message);
    about.is_file().then_some(about.len()).ok_or_else(refused)
}

/// The bytes of a regular file that is not too large.
pub(super) fn bytes(path: &Path) -> Result<Vec<u8>, DataError> {
    if regular(path)? > MAX_BYTES {
        let message = format!("the file has more than {MAX_BYTES} bytes");
        return Err(DataError::whole(path.to_string_lossy(), message));
    }
    std::fs::read(path).map_err(|cause| DataError::File {
        path: path.to_owned(),
        cause,
    })
}

/// Named columns in the units of the file.
pub(super) struct Columns {
    /// Names of all columns of the file.
    pub(super) names: Vec<String>,
    /// Values of those that are wanted; the others are empty. NaN where a value is missing.
    pub(super) values: Vec<Vec<f64>>,
    /// What was left out.
    pub(super) findings: Vec<Finding>,
}

/// Which columns are wanted.
pub(super) type Wanted<'w> = &'w dyn Fn(&str) -> bool;

impl Columns {
    fn of(
        path: &Path,
        format: Format,
        wanted: Wanted<'_>,
        budget: usize,
    ) -> Result<Self, DataError> {
        match format {
            Format::C3d => c3d::read(path, wanted, budget),
            #[cfg(feature = "mcap")]
            Format::Mcap => super::mcap::read(path, wanted, budget),
            #[cfg(feature = "parquet")]
            Format::Parquet => super::parquet::read(path, wanted, budget),
            _ => {
                let message = "this build does not read the format; build with the feature of its \
                               name, `mcap` or `parquet`, or write the run as CSV";
                Err(DataError::whole(path.to_string_lossy(), message))
            }
        }
    }

    /// The columns of the channels in SI, in rows of increasing times.
    fn table(
        mut self,
        file: &str,
        channels: &[Channel],
        budget: &mut usize,
    ) -> Result<Table, DataError> {
        let place = |name: &str| {
            let place = self.names.iter().position(|own| own == name);
            place.ok_or_else(|| {
                let similar = closest(name, self.names.iter().map(String::as_str));
                let similar = similar.map_or(String::new(), |s| format!("; did you mean `{s}`?"));
                let message = format!("there is no column `{}`{similar}", shown(name));
                DataError::whole(file, message)
            })
        };
        let time = place(TIME)?;
        let places: Result<Vec<usize>, _> = channels.iter().map(|c| place(&c.column)).collect();
        let places = places?;
        let is_known = |i: &usize| *i == time || places.contains(i);
        let unknown = (0..self.names.len()).filter(|i| !is_known(i));
        let unknown: Vec<String> = unknown.map(|i| shown(&self.names[i])).collect();
        if !unknown.is_empty() {
            let message = format!(
                "columns that nobody describes are left aside: {}",
                listed(&unknown)
            );
            let finding = Finding::new(FindingKind::UnknownColumn, message);
            self.findings.push(finding);
        }
        let mut clock = Clock::default();
        let times = &self.values[time];
        // Formats in columns may be damaged so that these differ.
        if let Some(place) = places
            .iter()
            .find(|&&i| self.values[i].len() != times.len())
        {
            let message = format!(
                "the file is damaged: {} times, but {} values of `{}`",
                times.len(),
                self.values[*place].len(),
                shown(&self.names[*place])
            );
            return Err(DataError::whole(file, message));
        }
        let rows: Vec<usize> = (0..times.len())
            .filter(|&row| clock.accept(times[row], row + 1, &format!("row {}", row + 1)))
            .collect();
        self.findings.extend(clock.findings(file)?);
        let numbers = rows.len().saturating_mul(1 + channels.len());
        *budget = budget
            .checked_sub(numbers)
            .ok_or_else(|| too_many(file.to_owned()))?;
        let column = |(place, channel): (&usize, &Channel)| {
            let values = &self.values[*place];
            let in_si = |&row: &usize| finite(values[row] * channel.unit.scale);
            rows.iter().map(in_si).collect()
        };
        let columns = places.iter().zip(channels).map(column).collect();
        let times = rows.iter().map(|&row| times[row]).collect();
        checked(file, channels, times, columns, self.findings)
    }
}

/// What is not finite is missing.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// The error of a data set that is too large.
pub(super) fn too_many(place: String) -> DataError {
    let message =
        format!("the data set holds more than {MAX_NUMBERS} numbers; leave out rows or channels");
    DataError::whole(place, message)
}

/// A table with enough rows, and something in every column.
pub(super) fn checked(
    file: &str,
    channels: &[Channel],
    times: Vec<f64>,
    columns: Vec<Vec<f64>>,
    findings: Vec<Finding>,
) -> Result<Table, DataError> {
    if times.len() < MIN_ROWS {
        let rows = counted(times.len(), "row");
        let message =
            format!("the file has {rows}; a run needs {MIN_ROWS} to tell a rate and a noise level");
        return Err(DataError::whole(file, message));
    }
    for (channel, values) in channels.iter().zip(&columns) {
        if values.iter().all(|value| value.is_nan()) {
            let message = format!("the column `{}` holds no value", channel.column);
            return Err(DataError::whole(file, message));
        }
        if let Some(row) = values.iter().position(|value| value.abs() > MAX_VALUE) {
            let message = format!(
                "the column `{}` holds {:e} at t = {} s, which no rig measures; leave the cell empty \
                 where nothing was measured",
                channel.column,
                channel.unit.from_si(values[row]),
                times[row]
            );
            return Err(DataError::whole(file, message));
        }
    }
    Ok(Table {
        times,
        columns,
        findings,
    })
}

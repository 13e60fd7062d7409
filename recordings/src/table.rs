//! The numbers of a run: columns as in the file, and the table in SI.

use std::path::Path;

use appell_spec::{closest, shown};

use crate::channel::Channel;
use crate::clock::{Clock, TIME};
use crate::finding::{counted, listed};
use crate::limits::{MAX_BYTES, MAX_NUMBERS, MAX_VALUE, MIN_ROWS};
use crate::{DataError, Finding, FindingKind};

/// The numbers of a run.
pub(crate) struct Table {
    /// Times in s, strictly increasing.
    pub(crate) times: Vec<f64>,
    /// Values in SI, a column for each channel; NaN where one is missing.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Omitted rows.
    pub(crate) findings: Vec<Finding>,
}

/// The length of a regular file; pipes are rejected, as they may block.
pub(crate) fn regular(path: &Path) -> Result<u64, DataError> {
    let about = std::fs::metadata(path).map_err(|cause| DataError::File {
        path: path.to_owned(),
        cause,
    })?;
    let message = "a run is a regular file";
    let refused = || DataError::whole(path.to_string_lossy(), message);
    about.is_file().then_some(about.len()).ok_or_else(refused)
}

/// The bytes of a regular file that is not too large.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, DataError> {
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
pub(crate) struct Columns {
    /// Names of all columns of the file.
    pub(crate) names: Vec<String>,
    /// Values of the requested ones; the others are empty. NaN where a value is missing.
    pub(crate) values: Vec<Vec<f64>>,
    /// Omitted rows.
    pub(crate) findings: Vec<Finding>,
}

/// The requested columns.
pub(crate) type Wanted<'w> = &'w dyn Fn(&str) -> bool;

impl Columns {
    /// The columns of the channels in SI, in rows of increasing times.
    pub(crate) fn table(
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

/// Non-finite values count as missing.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value } else { f64::NAN }
}

/// The error of a data set that is too large.
pub(crate) fn too_many(place: String) -> DataError {
    let message =
        format!("the data set holds more than {MAX_NUMBERS} numbers; leave out rows or channels");
    DataError::whole(place, message)
}

/// A table with enough rows, and something in every column.
pub(crate) fn checked(
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

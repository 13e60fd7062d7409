//! Runs from files of any format.

use std::path::Path;

use crate::channel::Channel;
use crate::episode::is_episode;
use crate::limits::{MAX_BYTES, MAX_NUMBERS};
use crate::table::{Columns, Table, Wanted};
use crate::time::{Stated, is_part, may_be_needed};
use crate::{DataError, c3d, csv, npz};

/// Format of a file, by its extension.
#[derive(Clone, Copy)]
enum Format {
    Csv,
    C3d,
    Mcap,
    Npz,
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
            () if is("npz") => Self::Npz,
            () if is("parquet") => Self::Parquet,
            () => Self::Csv,
        }
    }
}

/// Reads the columns of the channels, and the times. `budget` counts down the numbers that may still come.
pub(crate) fn read(
    path: &Path,
    time: &Stated,
    channels: &[Channel],
    episode: Option<u64>,
    budget: &mut usize,
) -> Result<Table, DataError> {
    let is_channel = |name: &str| channels.iter().any(|c| c.column == name);
    let is_time = |name: &str| match &time.column {
        Some(column) => column == name || is_part(name, column),
        None => time.rate.is_none() && may_be_needed(name),
    };
    let is_episode = |name: &str| episode.is_some() && is_episode(name);
    let wanted = |name: &str| is_time(name) || is_channel(name) || is_episode(name);
    match Format::of(path) {
        Format::Csv => csv::read(path, time, channels, episode, budget),
        format => {
            let columns = columns(path, format, &wanted, *budget)?;
            columns.table(&path.to_string_lossy(), time, channels, episode, budget)
        }
    }
}

/// The names of the columns.
pub(crate) fn header(path: &Path) -> Result<Vec<String>, DataError> {
    match Format::of(path) {
        Format::Csv => csv::header(path),
        format => Ok(columns(path, format, &|_| false, MAX_NUMBERS)?.names),
    }
}

/// The columns of a file in another format than CSV.
fn columns(
    path: &Path,
    format: Format,
    wanted: Wanted<'_>,
    budget: usize,
) -> Result<Columns, DataError> {
    match format {
        Format::C3d => c3d::read(path, wanted, budget),
        Format::Npz => npz::read(path, wanted, budget),
        #[cfg(feature = "mcap")]
        Format::Mcap => crate::mcap::read(path, wanted, budget),
        #[cfg(feature = "parquet")]
        Format::Parquet => crate::parquet::read(path, wanted, budget),
        _ => {
            let message = "this build does not read the format; build with the feature of its \
                           name, `mcap` or `parquet`, or write the run as CSV";
            Err(DataError::whole(path.to_string_lossy(), message))
        }
    }
}

/// Names and values of all columns of a table in any format; values that are no numbers are NaN.
pub fn columns_of(path: &Path) -> Result<(Vec<String>, Vec<Vec<f64>>), DataError> {
    let format = Format::of(path);
    if !matches!(format, Format::Csv) {
        let columns = columns(path, format, &|_| true, MAX_NUMBERS)?;
        return Ok(columns.in_seconds());
    }
    let text = appell_files::read(path, MAX_BYTES)?;
    let mut rows = csv::Rows::new(path, text.as_slice())?;
    let names = rows.header().to_vec();
    let mut values = vec![Vec::new(); names.len()];
    while rows.advance()? {
        if let Some(uneven) = rows.uneven() {
            return Err(uneven);
        }
        for (column, values) in values.iter_mut().enumerate() {
            values.push(rows.cell(column).parse().unwrap_or(f64::NAN));
        }
    }
    Ok((names, values))
}

//! Parquet, the format of tables in data stores: columns of numbers in compressed pages.
//!
//! Columns of the file are columns of the run. Times may be time stamps, which count from the first row on. Text,
//! and tables inside tables, are ignored.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use parquet::basic::{LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::{ParquetError, Result};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::DataError;
use crate::limits::MAX_FILE;
use crate::table::{Columns, OwnClock, Wanted, too_many};

/// Rows that are read at once.
const BATCH: usize = 1 << 16;

/// Reads a file; `budget` is the most numbers of all columns together.
pub(crate) fn read(path: &Path, wanted: Wanted<'_>, budget: usize) -> Result<Columns, DataError> {
    let place = path.to_string_lossy();
    let file = appell_files::open(path, MAX_FILE)?;
    // A file from strangers may show a slip of the library; it is an error of the file here.
    let read = catch_unwind(AssertUnwindSafe(|| columns(file, wanted, budget)));
    match read {
        Ok(Ok(Some(columns))) => Ok(columns),
        Ok(Ok(None)) => Err(too_many(place.into_owned())),
        Ok(Err(error)) => {
            let message = format!("this is no Parquet file, or it is damaged: {error}");
            Err(DataError::whole(place, message))
        }
        Err(_) => Err(DataError::whole(place, "the Parquet file is damaged")),
    }
}

/// The wanted columns; `None` if they exceed the budget.
fn columns(file: File, wanted: Wanted<'_>, budget: usize) -> Result<Option<Columns>> {
    let reader = SerializedFileReader::new(file)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns = Columns {
        names: Vec::new(),
        values: Vec::new(),
        clock: OwnClock::None,
        findings: Vec::new(),
    };
    let mut stamps = Vec::new();
    let mut left = budget;
    for (index, column) in schema.columns().iter().enumerate() {
        let name = column.path().string();
        let mut values = Vec::new();
        if wanted(&name) && column.max_rep_level() == 0 {
            for group in 0..reader.num_row_groups() {
                let group = reader.get_row_group(group)?;
                let rows = usize::try_from(group.metadata().num_rows()).unwrap_or(usize::MAX);
                let Some(rest) = left.checked_sub(rows) else {
                    return Ok(None);
                };
                left = rest;
                append(group.get_column_reader(index)?, column, &mut values)?;
            }
        }
        stamps.push(unit_of_stamps(column));
        columns.names.push(name);
        columns.values.push(values);
    }
    columns.clock = OwnClock::Stamps(stamps);
    Ok(Some(columns))
}

/// Appends the numbers of a column of a group of rows.
fn append(reader: ColumnReader, column: &ColumnDescriptor, to: &mut Vec<f64>) -> Result<()> {
    match reader {
        ColumnReader::BoolColumnReader(reader) => {
            numbers(reader, column, |&value| f64::from(u8::from(value)), to)
        }
        ColumnReader::Int32ColumnReader(reader) => {
            numbers(reader, column, |&value| f64::from(value), to)
        }
        ColumnReader::Int64ColumnReader(reader) => {
            numbers(reader, column, |&value| value as f64, to)
        }
        ColumnReader::FloatColumnReader(reader) => {
            numbers(reader, column, |&value| f64::from(value), to)
        }
        ColumnReader::DoubleColumnReader(reader) => numbers(reader, column, |&value| value, to),
        _ => {
            let message = format!("the column `{}` holds no numbers", column.path().string());
            Err(ParquetError::General(message))
        }
    }
}

/// Values where the level of definition is that of a value; NaN elsewhere.
fn numbers<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    column: &ColumnDescriptor,
    number: impl Fn(&T::T) -> f64,
    to: &mut Vec<f64>,
) -> Result<()> {
    let there = column.max_def_level();
    let (mut levels, mut values) = (Vec::new(), Vec::new());
    loop {
        levels.clear();
        values.clear();
        let (rows, ..) = reader.read_records(BATCH, Some(&mut levels), None, &mut values)?;
        if rows == 0 {
            return Ok(());
        }
        let mut values = values.iter().map(&number);
        if there == 0 {
            to.extend(values);
        } else {
            to.extend(levels.iter().map(|&level| {
                let value = (level == there).then(|| values.next()).flatten();
                value.unwrap_or(f64::NAN)
            }));
        }
    }
}

/// The unit of the time stamps of a column in s.
fn unit_of_stamps(column: &ColumnDescriptor) -> Option<f64> {
    let Some(LogicalType::Timestamp(stamp)) = column.logical_type_ref() else {
        return None;
    };
    Some(match stamp.unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    })
}

//! Parquet, the format of tables in data stores: columns of numbers in compressed pages.
//!
//! Columns of the file are columns of the run. A list of numbers in each row, of one length as in `observation.state`, is
//! the columns `observation.state[0]`, `observation.state[1]` …. Times may be time stamps, which count from the first row
//! on. Text, and tables inside tables, are ignored.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use parquet::basic::{LogicalType, TimeUnit, Type};
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
/// Rows of lists that are read at once.
const ROWS_OF_LISTS: usize = 1 << 10;

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
    };
    let mut stamps = Vec::new();
    let mut left = budget;
    for (index, column) in schema.columns().iter().enumerate() {
        if let Some(name) = list(column) {
            let width = width(&reader, index, column)?;
            let names: Vec<String> = (0..width).map(|own| format!("{name}[{own}]")).collect();
            let mut values = vec![Vec::new(); width];
            if names.iter().any(|name| wanted(name)) {
                let rows = usize::try_from(reader.metadata().file_metadata().num_rows());
                let count = rows.ok().and_then(|rows| rows.checked_mul(width));
                let Some(rest) = count.and_then(|count| left.checked_sub(count)) else {
                    return Ok(None);
                };
                left = rest;
                for group in 0..reader.num_row_groups() {
                    let reader = reader.get_row_group(group)?.get_column_reader(index)?;
                    lists(reader, column, &mut values)?;
                }
            }
            stamps.extend(names.iter().map(|_| None));
            columns.names.extend(names);
            columns.values.extend(values);
            continue;
        }
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
                let reader = group.get_column_reader(index)?;
                let mut add = |_: &[i16], batch: &[Option<f64>]| {
                    values.extend(batch.iter().map(|value| value.unwrap_or(f64::NAN)));
                    Ok(())
                };
                if !visit(reader, column, usize::MAX, BATCH, &mut add)? {
                    let message = format!("the column `{name}` holds no numbers");
                    return Err(ParquetError::General(message));
                }
            }
        }
        stamps.push(unit_of_stamps(column));
        columns.names.push(name);
        columns.values.push(values);
    }
    columns.clock = OwnClock::Stamps(stamps);
    Ok(Some(columns))
}

/// Most numbers of a list.
const MOST_COLUMNS: usize = 4096;

/// The name of a column of lists of numbers: that of its outermost field.
fn list(column: &ColumnDescriptor) -> Option<&str> {
    let is_number = !matches!(
        column.physical_type(),
        Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY | Type::INT96
    );
    let parts = column.path().parts();
    // `name`, `name.list.element` and older forms of it; other parts are tables inside tables.
    let is_plain = column.max_rep_level() == 1 && matches!(parts.len(), 1..=3) && is_number;
    parts.first().map(String::as_str).filter(|_| is_plain)
}

/// The number of values in the first list, which all lists have.
fn width(
    reader: &SerializedFileReader<File>,
    index: usize,
    column: &ColumnDescriptor,
) -> Result<usize> {
    for group in 0..reader.num_row_groups() {
        let mut count = 0;
        let mut add = |levels: &[i16], values: &[Option<f64>]| {
            let pairs = levels.iter().zip(values);
            let own = pairs.filter(|(level, value)| **level > 0 || value.is_some());
            count += own.count();
            if count > MOST_COLUMNS {
                let message = format!("a list has more than {MOST_COLUMNS} numbers");
                return Err(ParquetError::General(message));
            }
            Ok(())
        };
        let reader = reader.get_row_group(group)?.get_column_reader(index)?;
        visit(reader, column, 1, ROWS_OF_LISTS, &mut add)?;
        if count > 0 {
            return Ok(count);
        }
    }
    Ok(0)
}

/// Appends the lists of a group of rows to one column for each of their places.
fn lists(reader: ColumnReader, column: &ColumnDescriptor, to: &mut [Vec<f64>]) -> Result<()> {
    let (mut count, mut is_open) = (0, false);
    let mut add = |levels: &[i16], values: &[Option<f64>]| {
        for (level, value) in levels.iter().zip(values) {
            let is_repeated = *level > 0;
            if !is_repeated {
                fill(to, count, is_open);
                count = 0;
            }
            is_open = true;
            if value.is_some() || is_repeated {
                let most = to.len();
                let Some(column) = to.get_mut(count) else {
                    let message = format!("a list has more than the {most} numbers of the first");
                    return Err(ParquetError::General(message));
                };
                column.push(value.unwrap_or(f64::NAN));
                count += 1;
            }
        }
        Ok(())
    };
    visit(reader, column, usize::MAX, ROWS_OF_LISTS, &mut add)?;
    // A list that breaks off ends here.
    fill(to, count, is_open);
    Ok(())
}

/// Fills a list with fewer numbers than the first one, if one is open.
fn fill(to: &mut [Vec<f64>], count: usize, is_open: bool) {
    if is_open {
        for column in &mut to[count..] {
            column.push(f64::NAN);
        }
    }
}

/// Takes levels of repetition, above zero for a value of the list before, and as many values, `None` where one is
/// missing. Columns without lists have no levels.
type Take<'t> = &'t mut dyn FnMut(&[i16], &[Option<f64>]) -> Result<()>;

/// Passes the numbers of a group of rows on, up to a number of rows, in batches; whether the column holds numbers.
fn visit(
    reader: ColumnReader,
    column: &ColumnDescriptor,
    rows: usize,
    batch: usize,
    to: Take<'_>,
) -> Result<bool> {
    let size = [rows, batch];
    match reader {
        ColumnReader::BoolColumnReader(reader) => numbers(
            reader,
            column,
            size,
            |&value| f64::from(u8::from(value)),
            to,
        ),
        ColumnReader::Int32ColumnReader(reader) => {
            numbers(reader, column, size, |&value| f64::from(value), to)
        }
        ColumnReader::Int64ColumnReader(reader) => {
            numbers(reader, column, size, |&value| value as f64, to)
        }
        ColumnReader::FloatColumnReader(reader) => {
            numbers(reader, column, size, |&value| f64::from(value), to)
        }
        ColumnReader::DoubleColumnReader(reader) => {
            numbers(reader, column, size, |&value| value, to)
        }
        _ => return Ok(false),
    }?;
    Ok(true)
}

/// The numbers of up to `rows` rows, `batch` at once. There is one where the level of definition is that of a value.
fn numbers<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    column: &ColumnDescriptor,
    [rows, batch]: [usize; 2],
    number: impl Fn(&T::T) -> f64,
    to: Take<'_>,
) -> Result<()> {
    let there = column.max_def_level();
    let (mut defined, mut repeated, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let (mut left, mut found) = (rows, Vec::new());
    while left > 0 {
        defined.clear();
        repeated.clear();
        values.clear();
        let (read, ..) = reader.read_records(
            left.min(batch),
            Some(&mut defined),
            Some(&mut repeated),
            &mut values,
        )?;
        if read == 0 {
            return Ok(());
        }
        left -= read.min(left);
        let mut numbers = values.iter().map(&number);
        found.clear();
        if there == 0 {
            found.extend(numbers.map(Some));
        } else {
            let is_there = defined.iter().map(|&level| level == there);
            found.extend(is_there.map(|is| is.then(|| numbers.next()).flatten()));
        }
        to(&repeated, &found)?;
    }
    Ok(())
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

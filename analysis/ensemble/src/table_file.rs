//! Rows as Parquet: `case`, the columns in SI, `t_end_s` and `reason`.

use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};
use sha2::{Digest as _, Sha256};

use crate::chunk::{Chunk, Chunks};
use crate::digest::hex;
use crate::rows::{Column, Rows};

/// Columns in addition to those of the study.
const CASE: &str = "case";
const END: &str = "t_end_s";
const REASON: &str = "reason";
/// Names that no column of a study may have.
pub const TAKEN: [&str; 3] = [CASE, END, REASON];

/// Metadata of a file: the hash of its study, and the checksum of all other bytes.
const STUDY: &str = "appell.study";
const CHECKSUM: &str = "appell.sha256";
/// Digits of the checksum.
const DIGITS: usize = 64;

/// Rows as the bytes of a file.
pub(crate) fn written(rows: &Rows, columns: &[Column], study: &str) -> Result<Vec<u8>> {
    let units = columns.iter().map(|column| {
        let unit = format!("{} [{}]", column.about, column.unit);
        KeyValue::new(format!("appell.{}", column.name), unit)
    });
    let about = [KeyValue::new(STUDY.to_owned(), study.to_owned())];
    // The last of all, so that it is found from the end.
    let own = [KeyValue::new(CHECKSUM.to_owned(), "0".repeat(DIGITS))];
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_column_dictionary_enabled(ColumnPath::from(REASON), true)
        .set_key_value_metadata(Some(about.into_iter().chain(units).chain(own).collect()))
        .build();
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, schema(columns)?, Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    let cases: Vec<i64> = (rows.first..)
        .take(rows.len())
        .map(|case| i64::try_from(case).unwrap_or(i64::MAX))
        .collect();
    put::<Int64Type>(&mut group, &cases)?;
    for values in rows.values.iter().chain([&rows.ends]) {
        put::<DoubleType>(&mut group, values)?;
    }
    let reasons: Vec<ByteArray> = rows.reasons.iter().map(|r| r.as_str().into()).collect();
    put::<ByteArrayType>(&mut group, &reasons)?;
    group.close()?;
    file.close()?;
    let place = place_of_checksum(&bytes)?;
    let digits = checksum(&bytes, &place);
    bytes[place].copy_from_slice(digits.as_bytes());
    Ok(bytes)
}

/// Writes the next column.
fn put<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, &mut Vec<u8>>,
    values: &[T::T],
) -> Result<()> {
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(values, None, None)?;
        column.close()?;
    }
    Ok(())
}

/// Where a file has the digits of its checksum.
fn place_of_checksum(bytes: &[u8]) -> Result<Range<usize>> {
    let key = CHECKSUM.as_bytes();
    let at = bytes.windows(key.len()).rposition(|window| window == key);
    // Kind and length of the value are a byte each.
    let start = at.map(|at| at + key.len() + 2);
    let place = start.map(|start| start..start + DIGITS);
    let place = place.filter(|place| place.end <= bytes.len());
    place.ok_or_else(|| damaged("there is no checksum"))
}

/// SHA-256 of a file with the checksum set to zeros.
fn checksum(bytes: &[u8], place: &Range<usize>) -> String {
    let mut hash = Sha256::new();
    hash.update(&bytes[..place.start]);
    hash.update([b'0'; DIGITS]);
    hash.update(&bytes[place.end..]);
    hex(&hash.finalize())
}

fn damaged(reason: impl Into<String>) -> ParquetError {
    ParquetError::General(reason.into())
}

fn schema(columns: &[Column]) -> Result<TypePtr> {
    let field = |name: &str, physical, logical| -> Result<TypePtr> {
        let field = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()?;
        Ok(Arc::new(field))
    };
    let mut fields = vec![field(CASE, Physical::INT64, None)?];
    for column in columns {
        fields.push(field(&column.name, Physical::DOUBLE, None)?);
    }
    fields.push(field(END, Physical::DOUBLE, None)?);
    let text = Some(LogicalType::String);
    fields.push(field(REASON, Physical::BYTE_ARRAY, text)?);
    let group = Type::group_type_builder("cases").with_fields(fields);
    Ok(Arc::new(group.build()?))
}

/// Rows of a chunk of a study as they were [written]; columns that are not wanted are empty. A file is damaged if a
/// bit of it has changed, or if it belongs to another study or to other cases.
pub(crate) fn read(
    bytes: Bytes,
    columns: &[Column],
    chunks: &Chunks,
    chunk: &Chunk,
    wanted: &dyn Fn(usize) -> bool,
) -> Result<Rows> {
    let place = place_of_checksum(&bytes)?;
    if bytes[place.clone()] != *checksum(&bytes, &place).as_bytes() {
        return Err(damaged("the checksum is another one"));
    }
    // The Parquet library may panic on a foreign file; here this is an error of the file.
    let read = catch_unwind(AssertUnwindSafe(|| {
        let file = SerializedFileReader::new(bytes)?;
        belongs(&file, columns, &chunks.study)?;
        rows(&file, columns.len(), chunk, wanted)
    }));
    read.unwrap_or_else(|_| Err(damaged("the file is no table")))
}

/// Whether a file has the columns of a study.
fn belongs(file: &SerializedFileReader<Bytes>, columns: &[Column], study: &str) -> Result<()> {
    let about = file.metadata().file_metadata();
    let written = about.key_value_metadata().into_iter().flatten();
    let mut written = written.filter(|pair| pair.key == STUDY);
    if written.next().and_then(|pair| pair.value.as_deref()) != Some(study) {
        return Err(damaged("it belongs to another study"));
    }
    if *about.schema_descr().root_schema() != *schema(columns)? {
        return Err(damaged("it has other columns"));
    }
    Ok(())
}

fn rows(
    file: &SerializedFileReader<Bytes>,
    columns: usize,
    chunk: &Chunk,
    wanted: &dyn Fn(usize) -> bool,
) -> Result<Rows> {
    let mut cases = Vec::new();
    let mut rows = Rows::new(chunk.cases.start, columns, 0);
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group)?;
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        if let ColumnReader::Int64ColumnReader(mut reader) = group.get_column_reader(0)? {
            reader.read_records(count, None, None, &mut cases)?;
        }
        let lists = rows.values.iter_mut().chain([&mut rows.ends]).enumerate();
        for (column, list) in lists.filter(|(column, _)| *column == columns || wanted(*column)) {
            let reader = group.get_column_reader(1 + column)?;
            if let ColumnReader::DoubleColumnReader(mut reader) = reader {
                reader.read_records(count, None, None, list)?;
            }
        }
        let last = group.get_column_reader(columns + 2)?;
        if let ColumnReader::ByteArrayColumnReader(mut reader) = last {
            let mut reasons = Vec::new();
            reader.read_records(count, None, None, &mut reasons)?;
            for reason in reasons {
                rows.reasons.push(reason.as_utf8()?.to_owned());
            }
        }
    }
    let own = chunk
        .cases
        .clone()
        .map(|case| i64::try_from(case).unwrap_or(i64::MAX));
    if !own.eq(cases) {
        return Err(damaged("it has other cases"));
    }
    Ok(rows)
}

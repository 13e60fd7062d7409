//! Rows as Parquet: `case`, the columns in SI, `t_end_s` and `reason`.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::column::reader::ColumnReader;
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type, TypePtr};

use crate::rows::{Column, Rows};

/// Columns besides those of the study.
const CASE: &str = "case";
const END: &str = "t_end_s";
const REASON: &str = "reason";
/// Names that no column of a study may have.
pub const TAKEN: [&str; 3] = [CASE, END, REASON];

/// Rows as the bytes of a file.
pub(crate) fn written(rows: &Rows, columns: &[Column], study: &str) -> Result<Vec<u8>> {
    let units = columns.iter().map(|column| {
        let unit = format!("{} [{}]", column.about, column.unit);
        KeyValue::new(format!("appell.{}", column.name), unit)
    });
    let about = [KeyValue::new("appell.study".to_owned(), study.to_owned())];
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_column_dictionary_enabled(ColumnPath::from(REASON), true)
        .set_key_value_metadata(Some(about.into_iter().chain(units).collect()))
        .build();
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, schema(columns)?, Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    let cases: Vec<i64> = (rows.first..)
        .take(rows.len())
        .map(|case| i64::try_from(case).unwrap_or(i64::MAX))
        .collect();
    if let Some(mut column) = group.next_column()? {
        column
            .typed::<Int64Type>()
            .write_batch(&cases, None, None)?;
        column.close()?;
    }
    for values in rows.values.iter().chain([&rows.ends]) {
        if let Some(mut column) = group.next_column()? {
            column
                .typed::<DoubleType>()
                .write_batch(values, None, None)?;
            column.close()?;
        }
    }
    let reasons: Vec<ByteArray> = rows.reasons.iter().map(|r| r.as_str().into()).collect();
    if let Some(mut column) = group.next_column()? {
        column
            .typed::<ByteArrayType>()
            .write_batch(&reasons, None, None)?;
        column.close()?;
    }
    group.close()?;
    file.close()?;
    Ok(bytes)
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

/// Rows of a file as it was [written].
pub(crate) fn read(bytes: Bytes, columns: usize, first: u64) -> Result<Rows> {
    // A damaged file may show a slip of the library; it is an error of the file here.
    let read = catch_unwind(AssertUnwindSafe(|| rows(bytes, columns, first)));
    read.unwrap_or_else(|_| Err(ParquetError::General("the file is damaged".to_owned())))
}

fn rows(bytes: Bytes, columns: usize, first: u64) -> Result<Rows> {
    let file = SerializedFileReader::new(bytes)?;
    let mut rows = Rows::new(first, columns, 0);
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group)?;
        if group.num_columns() != columns + TAKEN.len() {
            let message = format!(
                "{} columns instead of {}",
                group.num_columns(),
                columns + TAKEN.len()
            );
            return Err(ParquetError::General(message));
        }
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or(0);
        let lists = rows.values.iter_mut().chain([&mut rows.ends]);
        for (index, list) in (1..).zip(lists) {
            let ColumnReader::DoubleColumnReader(mut reader) = group.get_column_reader(index)?
            else {
                return Err(ParquetError::General(
                    "a column of other numbers".to_owned(),
                ));
            };
            reader.read_records(count, None, None, list)?;
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
    Ok(rows)
}

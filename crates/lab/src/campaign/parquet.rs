//! Results as a Parquet file: one row for each flight, written as they come.
//!
//! Columns are `index`, `seed`, `input.<name>`, `outcome`, `failure.time` and the metrics under their
//! flat names. A metric that a flight does not have is null. The bytes depend on the rows and on
//! nothing else: no clock, no version of a library.

use std::io::{self, Write};
use std::sync::Arc;

use ::parquet::basic::{Encoding, LogicalType, Repetition, Type as Physical};
use ::parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::{EnabledStatistics, WriterProperties, WriterPropertiesPtr};
use ::parquet::file::writer::{
    SerializedColumnWriter, SerializedFileWriter, SerializedRowGroupWriter,
};
use ::parquet::schema::types::{ColumnPath, Type, TypePtr};

use super::result::{Columns, Input, Row};

/// Flights in one row group: what is held in memory before it is written.
pub const GROUP: usize = 16_384;
/// Flights that are handed over at once.
const BATCH: usize = 1024;
/// Named in the file in place of the library and its version, which would change the bytes.
const CREATED_BY: &str = "stormpetrel";

/// Writes flights into a Parquet file; holds at most one row group, 16,384 flights, in memory.
#[derive(Debug)]
pub struct Writer<W: Write + Send> {
    /// Present until the first row group tells the type of each input.
    out: Option<W>,
    file: Option<SerializedFileWriter<W>>,
    about: Vec<KeyValue>,
    rows: usize,
    columns: Vec<Column>,
}

/// A column of the row group in the making.
#[derive(Debug)]
struct Column {
    name: String,
    values: Values,
}

#[derive(Debug)]
enum Values {
    /// Never null, unsigned.
    Count(Vec<i64>),
    /// Never null.
    Number(Vec<f64>),
    /// Never null. Each text once, and for every row which.
    Text(Vec<ByteArray>, Vec<usize>),
    /// NaN stands for null.
    Optional(Vec<f64>),
    /// An input of which no value has been seen.
    Unknown,
}

impl<W: Write + Send> Writer<W> {
    /// Begins a file; `about` is kept in it as key-value metadata. Nothing is written before the first
    /// row group is full.
    pub fn new(out: W, columns: &Columns, about: &[(String, String)]) -> Self {
        let about = about.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone()));
        Self {
            out: Some(out),
            file: None,
            about: about.collect(),
            rows: 0,
            columns: table(columns),
        }
    }

    /// Adds a flight. After an error the file must be given up.
    ///
    /// # Errors
    /// Where the row does not fit the columns, an input is text in one row and a number in another, or
    /// the file cannot be written.
    pub fn push(&mut self, row: &Row) -> io::Result<()> {
        let cells = cells(row);
        if cells.len() != self.columns.len() {
            return Err(misfit(format!(
                "flight {} has {} values for {} columns",
                row.index,
                cells.len(),
                self.columns.len()
            )));
        }
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            column.push(cell)?;
        }
        self.rows += 1;
        if self.rows == GROUP { self.flush() } else { Ok(()) }
    }

    /// Writes the rest and the foot of the file, and gives back what it was written to.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn finish(mut self) -> io::Result<W> {
        // A file without rows has its columns all the same.
        if self.rows > 0 || self.file.is_none() {
            self.flush()?;
        }
        let file = self.file.ok_or_else(|| io::Error::other("no file"))?;
        let mut out = file.into_inner().map_err(failed)?;
        out.flush()?;
        Ok(out)
    }

    /// Writes the row group.
    fn flush(&mut self) -> io::Result<()> {
        if let Some(out) = self.out.take() {
            let about = std::mem::take(&mut self.about);
            let file = SerializedFileWriter::new(
                out,
                schema(&self.columns).map_err(failed)?,
                properties(&self.columns, about),
            );
            self.file = Some(file.map_err(failed)?);
        }
        let file = self.file.as_mut().ok_or_else(|| io::Error::other("no file"))?;
        if self.rows > 0 {
            let mut group = file.next_row_group().map_err(failed)?;
            for column in &mut self.columns {
                column.values.write(&mut group).map_err(failed)?;
            }
            group.close().map_err(failed)?;
        }
        self.rows = 0;
        Ok(())
    }
}

/// One value of a row.
enum Cell<'a> {
    Count(u64),
    Number(f64),
    Text(&'a str),
    Optional(f64),
}

/// The columns of a file, empty.
fn table(columns: &Columns) -> Vec<Column> {
    let column = |name: &str, values| Column { name: name.to_owned(), values };
    let optional = || Values::Optional(Vec::new());
    let mut all =
        vec![column("index", Values::Count(Vec::new())), column("seed", Values::Count(Vec::new()))];
    all.extend(columns.inputs.iter().map(|n| column(&format!("input.{n}"), Values::Unknown)));
    all.push(column("outcome", Values::Text(Vec::new(), Vec::new())));
    all.push(column("failure.time", optional()));
    all.extend(columns.metrics.iter().map(|name| column(name, optional())));
    all
}

/// The values of a row, in the order of [`table`].
fn cells(row: &Row) -> Vec<Cell<'_>> {
    let mut cells = vec![Cell::Count(row.index), Cell::Count(row.seed)];
    cells.extend(row.inputs.iter().map(|input| match input {
        Input::Number(x) => Cell::Number(*x),
        Input::Text(text) => Cell::Text(text),
    }));
    cells.push(Cell::Text(row.failure.map_or("flown", |failure| failure.cause.describe())));
    cells.push(Cell::Optional(row.failure.map_or(f64::NAN, |failure| failure.time)));
    cells.extend(row.metrics.iter().map(|x| Cell::Optional(*x)));
    cells
}

impl Column {
    fn push(&mut self, cell: Cell<'_>) -> io::Result<()> {
        if let Values::Unknown = self.values {
            self.values = match cell {
                Cell::Text(_) => Values::Text(Vec::new(), Vec::new()),
                _ => Values::Number(Vec::new()),
            };
        }
        match (&mut self.values, cell) {
            (Values::Count(values), Cell::Count(n)) => values.push(n.cast_signed()),
            (Values::Number(values), Cell::Number(x))
            | (Values::Optional(values), Cell::Optional(x)) => values.push(x),
            (Values::Text(texts, values), Cell::Text(text)) => {
                let known = texts.iter().position(|one| one.data() == text.as_bytes());
                values.push(known.unwrap_or_else(|| {
                    texts.push(text.into());
                    texts.len() - 1
                }));
            }
            _ => return Err(misfit(format!("column {} mixes text and numbers", self.name))),
        }
        Ok(())
    }

    /// The column in the schema.
    fn describe(&self) -> Result<Type, ParquetError> {
        let (physical, logical, repetition) = match self.values {
            Values::Count(_) => {
                let unsigned = LogicalType::integer(64, false);
                (Physical::INT64, Some(unsigned), Repetition::REQUIRED)
            }
            Values::Text(..) => {
                (Physical::BYTE_ARRAY, Some(LogicalType::String), Repetition::REQUIRED)
            }
            Values::Optional(..) => (Physical::DOUBLE, None, Repetition::OPTIONAL),
            Values::Number(_) | Values::Unknown => (Physical::DOUBLE, None, Repetition::REQUIRED),
        };
        Type::primitive_type_builder(&self.name, physical)
            .with_logical_type(logical)
            .with_repetition(repetition)
            .build()
    }
}

impl Values {
    /// Writes the values as the next column of the row group and forgets them.
    fn write<W: Write + Send>(
        &mut self,
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else {
            return Err(ParquetError::General("more columns than the schema has".into()));
        };
        match self {
            Self::Count(values) => write::<Int64Type, _>(&mut column, values, |n| Some(*n)),
            Self::Number(values) => write::<DoubleType, _>(&mut column, values, |x| Some(*x)),
            Self::Text(texts, values) => {
                write::<ByteArrayType, _>(&mut column, values, |at| texts.get(*at).cloned())
            }
            Self::Optional(values) => {
                write::<DoubleType, _>(&mut column, values, |x| (!x.is_nan()).then_some(*x))
            }
            Self::Unknown => Ok(()),
        }?;
        column.close()
    }
}

/// Writes what `value` makes of each of these, null where it makes nothing, and forgets them.
fn write<D: DataType, R>(
    column: &mut SerializedColumnWriter<'_>,
    rows: &mut Vec<R>,
    value: impl Fn(&R) -> Option<D::T>,
) -> Result<(), ParquetError> {
    for batch in rows.chunks(BATCH) {
        let values: Vec<Option<D::T>> = batch.iter().map(&value).collect();
        let present: Vec<i16> = values.iter().map(|x| i16::from(x.is_some())).collect();
        let values: Vec<D::T> = values.into_iter().flatten().collect();
        column.typed::<D>().write_batch(&values, Some(&present), None)?;
    }
    rows.clear();
    Ok(())
}

fn schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
    let fields = columns.iter().map(|column| column.describe().map(Arc::new));
    let fields = fields.collect::<Result<Vec<_>, _>>()?;
    Ok(Arc::new(Type::group_type_builder("flights").with_fields(fields).build()?))
}

/// Measured numbers hardly repeat, so a dictionary is kept for inputs and texts alone. Bounds of each row
/// group would not help a search, as flights come in no order of their values; they would only have to be
/// kept in memory until the end.
fn properties(columns: &[Column], about: Vec<KeyValue>) -> WriterPropertiesPtr {
    let mut properties = WriterProperties::builder()
        .set_created_by(CREATED_BY.to_owned())
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true)
        .set_key_value_metadata((!about.is_empty()).then_some(about))
        .set_max_row_group_row_count(Some(GROUP));
    for column in columns {
        let path = ColumnPath::new(vec![column.name.clone()]);
        properties = match column.values {
            // Indices rise by one: their differences take a bit or none.
            Values::Count(_) if column.name == "index" => properties
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, Encoding::DELTA_BINARY_PACKED),
            Values::Count(_) | Values::Optional(..) => {
                properties.set_column_dictionary_enabled(path, false)
            }
            _ => properties,
        };
    }
    Arc::new(properties.build())
}

fn misfit(text: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, text)
}

/// The error of the file where there was one, else what the library says.
fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}

#[cfg(test)]
#[path = "parquet_tests.rs"]
mod tests;

//! Results as a Parquet file: one row for each flight, written as they come.
//!
//! Columns are `index`, `seed`, `input.<name>`, `outcome`, `failure.time` and the metrics under their
//! flat names. A metric that a flight does not have is null. The bytes depend on the rows and on
//! nothing else: no clock, no version of a library.

use std::io::{self, Read, Seek, Write};
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
use super::spool::Spool;

/// Flights in one row group. What a group takes in the foot of the file stays in memory until the end, so
/// there should be few of them.
pub const GROUP: usize = 1 << 18;
/// Bytes of the distinct values of a column in a group, beyond which they are not gathered any more.
const DICTIONARY: usize = 1 << 14;
/// Bytes of a page of a column, which is put together in memory.
const DATA: usize = 1 << 15;
/// Named in the file in place of the library and its version, which would change the bytes.
const CREATED_BY: &str = "stormpetrel";

/// Writes flights into a Parquet file. The row group in the making is in a file `F`, a page of it in
/// memory.
#[derive(Debug)]
pub struct Writer<W: Write + Send, F> {
    /// Present until the first row group tells the type of each input.
    out: Option<W>,
    file: Option<SerializedFileWriter<W>>,
    about: Vec<KeyValue>,
    columns: Vec<Column>,
    rows: Spool<F>,
}

/// A column of the file.
#[derive(Debug)]
struct Column {
    name: String,
    kind: Kind,
}

/// What the words of a column are.
#[derive(Debug)]
enum Kind {
    /// Never null, unsigned.
    Count,
    /// Never null.
    Number,
    /// Never null: which of these texts.
    Text(Vec<ByteArray>),
    /// NaN stands for null.
    Optional,
    /// An input of which no value has been seen.
    Unknown,
}

impl<W: Write + Send, F: Read + Write + Seek> Writer<W, F> {
    /// Begins a file; `about` is kept in it as key-value metadata. Nothing is written to `out` before the
    /// first row group is full; `scratch` is empty and used by nobody else.
    pub fn new(out: W, scratch: F, columns: &Columns, about: &[(String, String)]) -> Self {
        let about = about.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone()));
        let columns = table(columns);
        Self {
            out: Some(out),
            file: None,
            about: about.collect(),
            rows: Spool::new(scratch, columns.len()),
            columns,
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
        let words = self.columns.iter_mut().zip(cells).map(|(column, cell)| column.word(cell));
        self.rows.push(words.collect::<io::Result<Vec<_>>>()?)?;
        if self.rows.rows() == GROUP { self.flush() } else { Ok(()) }
    }

    /// Writes the rest and the foot of the file, and gives back what it was written to.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn finish(mut self) -> io::Result<W> {
        // A file without rows has its columns all the same.
        if self.rows.rows() > 0 || self.file.is_none() {
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
        if self.rows.rows() > 0 {
            let mut group = file.next_row_group().map_err(failed)?;
            for (at, column) in self.columns.iter().enumerate() {
                column.kind.write(&mut self.rows, at, &mut group).map_err(failed)?;
            }
            group.close().map_err(failed)?;
        }
        self.rows.clear();
        Ok(())
    }
}

/// Bytes that the scratch file takes at most while so many flights are written.
pub fn scratch_size(flights: u64, columns: &Columns) -> u64 {
    let group = if flights < GROUP as u64 { flights } else { GROUP as u64 };
    group * 8 * table(columns).len() as u64
}

/// One value of a row.
enum Cell<'a> {
    Count(u64),
    Number(f64),
    Text(&'a str),
    Optional(f64),
}

/// The columns of a file.
fn table(columns: &Columns) -> Vec<Column> {
    let column = |name: &str, kind| Column { name: name.to_owned(), kind };
    let mut all = vec![column("index", Kind::Count), column("seed", Kind::Count)];
    all.extend(columns.inputs.iter().map(|n| column(&format!("input.{n}"), Kind::Unknown)));
    all.push(column("outcome", Kind::Text(Vec::new())));
    all.push(column("failure.time", Kind::Optional));
    all.extend(columns.metrics.iter().map(|name| column(name, Kind::Optional)));
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
    /// The word that stands for this value.
    fn word(&mut self, cell: Cell<'_>) -> io::Result<u64> {
        if let Kind::Unknown = self.kind {
            self.kind = match cell {
                Cell::Text(_) => Kind::Text(Vec::new()),
                _ => Kind::Number,
            };
        }
        match (&mut self.kind, cell) {
            (Kind::Count, Cell::Count(n)) => Ok(n),
            (Kind::Number, Cell::Number(x)) | (Kind::Optional, Cell::Optional(x)) => {
                Ok(x.to_bits())
            }
            (Kind::Text(texts), Cell::Text(text)) => {
                let known = texts.iter().position(|one| one.data() == text.as_bytes());
                let at = known.unwrap_or_else(|| {
                    texts.push(text.into());
                    texts.len() - 1
                });
                Ok(at as u64)
            }
            _ => Err(misfit(format!("column {} mixes text and numbers", self.name))),
        }
    }

    /// The column in the schema.
    fn describe(&self) -> Result<Type, ParquetError> {
        let (physical, logical, repetition) = match self.kind {
            Kind::Count => {
                let unsigned = LogicalType::integer(64, false);
                (Physical::INT64, Some(unsigned), Repetition::REQUIRED)
            }
            Kind::Text(_) => {
                (Physical::BYTE_ARRAY, Some(LogicalType::String), Repetition::REQUIRED)
            }
            Kind::Optional => (Physical::DOUBLE, None, Repetition::OPTIONAL),
            Kind::Number | Kind::Unknown => (Physical::DOUBLE, None, Repetition::REQUIRED),
        };
        Type::primitive_type_builder(&self.name, physical)
            .with_logical_type(logical)
            .with_repetition(repetition)
            .build()
    }
}

impl Kind {
    /// Writes column `at` of `rows` as the next column of the row group.
    fn write<W: Write + Send, F: Read + Write + Seek>(
        &self,
        rows: &mut Spool<F>,
        at: usize,
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else {
            return Err(ParquetError::General("more columns than the schema has".into()));
        };
        rows.column(at, |words| match self {
            Self::Count => write::<Int64Type>(&mut column, words, |n| Some(n.cast_signed())),
            Self::Number => write::<DoubleType>(&mut column, words, |x| Some(f64::from_bits(x))),
            Self::Text(texts) => write::<ByteArrayType>(&mut column, words, |at| {
                texts.get(usize::try_from(at).ok()?).cloned()
            }),
            Self::Optional => write::<DoubleType>(&mut column, words, |x| {
                Some(f64::from_bits(x)).filter(|x| !x.is_nan())
            }),
            Self::Unknown => Ok(()),
        })?;
        column.close()
    }
}

/// Writes what `value` makes of each of these words, null where it makes nothing.
fn write<D: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    words: &[u64],
    value: impl Fn(u64) -> Option<D::T>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<D::T>> = words.iter().map(|word| value(*word)).collect();
    let present: Vec<i16> = values.iter().map(|x| i16::from(x.is_some())).collect();
    let values: Vec<D::T> = values.into_iter().flatten().collect();
    column.typed::<D>().write_batch(&values, Some(&present), None)?;
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
        .set_dictionary_page_size_limit(DICTIONARY)
        .set_data_page_size_limit(DATA)
        .set_write_batch_size(256)
        .set_key_value_metadata((!about.is_empty()).then_some(about))
        .set_max_row_group_row_count(Some(GROUP));
    for column in columns {
        let path = ColumnPath::new(vec![column.name.clone()]);
        properties = match column.kind {
            // Indices rise by one: their differences take a bit or none.
            Kind::Count if column.name == "index" => properties
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, Encoding::DELTA_BINARY_PACKED),
            Kind::Count | Kind::Optional => properties.set_column_dictionary_enabled(path, false),
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

//! Files read back.

use ::parquet::basic::LogicalType;
use ::parquet::file::metadata::RowGroupMetaData;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::{Field, RowAccessor};
use bytes::Bytes;
use std::io::Cursor;

use super::*;
use crate::fly::Failure;
use stormpetrel_plant::flight::Cause;

fn columns() -> Columns {
    Columns {
        inputs: vec!["wind".into(), "law".into()],
        metrics: vec!["position.iae".into(), "tilt.inverted_at".into()],
    }
}

fn row(index: u64) -> Row {
    let failure =
        (index % 3 == 1).then_some(Failure { time: 0.25 * index as f64, cause: Cause::Tilt });
    Row {
        index,
        // Beyond the signed range: the column must say that it is unsigned.
        seed: u64::MAX - index,
        inputs: vec![
            Input::Number(0.5 * index as f64),
            Input::Text(if index.is_multiple_of(2) {
                "rate/pid".into()
            } else {
                "rate/indi".into()
            }),
        ],
        failure,
        metrics: vec![1.0 / (1.0 + index as f64), if failure.is_some() { 0.125 } else { f64::NAN }],
    }
}

fn about() -> Vec<(String, String)> {
    vec![("scenario".into(), "hover".into())]
}

fn scratch() -> Cursor<Vec<u8>> {
    Cursor::new(Vec::new())
}

fn file(rows: impl Iterator<Item = Row>) -> io::Result<Vec<u8>> {
    let mut writer = Writer::new(Vec::new(), scratch(), &columns(), &about());
    rows.for_each(|row| assert!(writer.push(&row).is_ok(), "{row:?}"));
    writer.finish()
}

fn reader(bytes: Vec<u8>) -> SerializedFileReader<Bytes> {
    SerializedFileReader::new(Bytes::from(bytes)).expect("a Parquet file")
}

#[test]
fn rows_come_back_as_they_were() {
    let reader = reader(file((0..10).map(row)).expect("written"));
    let names = ["index", "seed", "input.wind", "input.law", "outcome", "failure.time"];
    let names: Vec<_> = names.into_iter().chain(["position.iae", "tilt.inverted_at"]).collect();
    let mut seen = 0;
    for (found, index) in reader.get_row_iter(None).expect("rows").zip(0..) {
        let (found, wanted) = (found.expect("a row"), row(index));
        let have: Vec<_> = found.get_column_iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(have, names);
        assert_eq!(found.get_ulong(0).ok(), Some(wanted.index));
        assert_eq!(found.get_ulong(1).ok(), Some(wanted.seed));
        assert_eq!(found.get_double(2).ok().map(Input::Number).as_ref(), wanted.inputs.first());
        let law = found.get_string(3).ok().cloned().map(Input::Text);
        assert_eq!(law.as_ref(), wanted.inputs.get(1));
        let outcome = wanted.failure.map_or("flown", |f| f.cause.describe());
        assert_eq!(found.get_string(4).map(String::as_str).ok(), Some(outcome));
        let fields: Vec<_> = found.get_column_iter().map(|(_, field)| field.clone()).collect();
        let optional = |x: Option<f64>| x.map_or(Field::Null, Field::Double);
        assert_eq!(fields[5], optional(wanted.failure.map(|f| f.time)));
        assert_eq!(fields[6], Field::Double(wanted.metrics[0]));
        assert_eq!(fields[7], optional(wanted.failure.map(|_| 0.125)));
        seen += 1;
    }
    assert_eq!(seen, 10);
}

#[test]
fn the_file_says_what_it_is() {
    let reader = reader(file((0..3).map(row)).expect("written"));
    let file = reader.metadata().file_metadata();
    assert_eq!(file.created_by(), Some("stormpetrel"));
    let about = file.key_value_metadata().expect("metadata");
    assert_eq!(about, &vec![KeyValue::new("scenario".into(), "hover".to_owned())]);
    let index = file.schema_descr().column(0);
    assert_eq!(index.logical_type_ref(), Some(&LogicalType::integer(64, false)));
}

#[test]
fn a_full_group_is_written_and_forgotten() {
    let mut waiting = scratch();
    let mut writer = Writer::new(Vec::new(), &mut waiting, &columns(), &about());
    let count = GROUP as u64 + 5;
    for index in 0..count {
        writer.push(&row(index)).expect("pushed");
    }
    assert_eq!(writer.rows.rows(), 5);
    let bytes = writer.finish().expect("written");
    assert_eq!(waiting.get_ref().len() as u64, scratch_size(count, &columns()));
    assert_eq!(bytes, file((0..count).map(row)).expect("written"));
    let reader = reader(bytes);
    let groups = reader.metadata().row_groups().iter().map(RowGroupMetaData::num_rows);
    assert_eq!(groups.collect::<Vec<_>>(), [i64::try_from(GROUP).expect("small"), 5]);
}

#[test]
fn no_flight_is_a_file_too() {
    let reader = reader(file(std::iter::empty()).expect("written"));
    assert_eq!(reader.metadata().file_metadata().num_rows(), 0);
    assert_eq!(reader.metadata().file_metadata().schema_descr().num_columns(), 8);
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut writer = Writer::new(Vec::new(), scratch(), &columns(), &[]);
    writer.push(&row(0)).expect("pushed");
    let mut mixed = row(1);
    mixed.inputs[1] = Input::Number(1.0);
    let error = writer.push(&mixed).expect_err("mixed");
    assert_eq!(error.to_string(), "column input.law mixes text and numbers");
    let mut short = row(2);
    short.metrics.pop();
    let error = writer.push(&short).expect_err("short");
    assert_eq!(error.to_string(), "flight 2 has 7 values for 8 columns");
}

#[test]
fn a_full_disk_is_named() {
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::Error::new(io::ErrorKind::StorageFull, "no space left"))
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let mut writer = Writer::new(Full, scratch(), &columns(), &[]);
    writer.push(&row(0)).expect("kept in memory");
    let error = writer.finish().map(|_| ()).expect_err("full");
    assert_eq!(error.kind(), io::ErrorKind::StorageFull);
}

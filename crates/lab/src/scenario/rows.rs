//! Tables in a scenario: rows written in the file, or the name of a CSV file beside it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use stormpetrel_control::options::{Cells, Column, Shape};

use super::document::{Node, Value};
use super::fault::{Fault, Place, Source};
use super::read::{refuse, wrong_type};
use super::source::{MOST_BYTES_OF_TABLE, table};

/// A numbered row and the place of each of its cells.
type Row = Vec<(Place, f64)>;

/// Reads a table that stands under `field`.
pub(super) fn read(
    field: &str,
    node: &Node,
    shape: &Shape,
    faults: &mut Vec<Fault>,
) -> Option<Cells> {
    let before = faults.len();
    let (rows, file) = match &node.value {
        Value::List(items) => (inline(field, items, shape, faults), ""),
        Value::Text(name) => (from_file(field, name, &node.place, shape, faults), name.as_str()),
        other => {
            let fault = wrong_type(&node.place, field, other, "rows");
            faults.push(fault.help(how(field, shape)));
            return None;
        }
    };
    let (fewest, most) = shape.rows;
    if faults.len() == before && !(fewest..=most).contains(&rows.len()) {
        let message = format!("`{field}` has {} rows: must have {fewest} to {most}", rows.len());
        faults.push(Fault::new(&node.place, message));
    }
    for (i, row) in rows.iter().enumerate() {
        check_row(field, i, row, shape.columns, faults);
    }
    if shape.grows && faults.len() == before {
        check_growth(field, &rows, shape, faults);
    }
    if faults.len() > before {
        return None;
    }
    let cells: Vec<f64> = rows.iter().flatten().map(|(_, x)| *x).collect();
    Some(Cells { cells: kept(cells), file: kept_name(file) })
}

pub(super) fn how(field: &str, shape: &Shape) -> String {
    let names: Vec<&str> = shape.columns.iter().map(|column| column.name).collect();
    let names = names.join(", ");
    let key = field.rsplit('.').next().unwrap_or(field);
    format!("write {key} = [[{names}], ...], or the name of a CSV file with the head {names}")
}

fn inline(field: &str, items: &[Node], shape: &Shape, faults: &mut Vec<Fault>) -> Vec<Row> {
    let mut rows = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let Value::List(cells) = &item.value else {
            let fault = wrong_type(&item.place, &format!("{field}.{i}"), &item.value, "row");
            faults.push(fault.help(how(field, shape)));
            return rows;
        };
        if cells.len() != shape.columns.len() {
            let message = format!(
                "`{field}.{i}` has {} numbers: must have {}",
                cells.len(),
                shape.columns.len()
            );
            faults.push(Fault::new(&item.place, message).help(how(field, shape)));
            return rows;
        }
        let mut row = Row::new();
        for (cell, column) in cells.iter().zip(shape.columns) {
            match &cell.value {
                Value::Number(x, _) => row.push((cell.place.clone(), *x)),
                other => {
                    let name = format!("{field}.{i}");
                    faults.push(wrong_type(&cell.place, &name, other, column.unit));
                }
            }
        }
        rows.push(row);
    }
    rows
}

/// Reads a CSV file whose name is relative to the folder of the scenario.
fn from_file(
    field: &str,
    name: &str,
    place: &Place,
    shape: &Shape,
    faults: &mut Vec<Fault>,
) -> Vec<Row> {
    let folder = Path::new(&place.source.name).parent().unwrap_or(Path::new(""));
    let path = folder.join(name);
    let shown = path.display().to_string();
    let text = match table(&path) {
        Ok(text) => text,
        Err(why) => {
            let message = format!("`{field}` = \"{name}\": {shown}: {why}");
            faults.push(Fault::new(place, message).help(format!(
                "{}; a table has at most {MOST_BYTES_OF_TABLE} bytes",
                how(field, shape)
            )));
            return Vec::new();
        }
    };
    parse(&Arc::new(Source { name: shown, text }), shape, faults)
}

/// The rows of a CSV text. The first line names the columns; empty lines and lines that begin with `#`
/// do not count.
fn parse(source: &Arc<Source>, shape: &Shape, faults: &mut Vec<Fault>) -> Vec<Row> {
    let wanted: Vec<&str> = shape.columns.iter().map(|column| column.name).collect();
    let mut rows = Vec::new();
    let (mut start, mut head) = (0, false);
    for line in source.text.split_inclusive('\n') {
        let span = start..start + line.trim_end().len();
        start += line.len();
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let place = |span| Place { source: Arc::clone(source), span };
        let cells: Vec<&str> = line.trim_end().split(',').collect();
        if !head {
            head = true;
            if cells.iter().map(|cell| cell.trim()).ne(wanted.iter().copied()) {
                let message = format!("the first line must be {}", wanted.join(","));
                let help = "it names the columns, in SI units, separated by commas";
                faults.push(Fault::new(&place(span), message).help(help));
                return rows;
            }
            continue;
        }
        if cells.len() != wanted.len() {
            let message = format!("{} values: this table has {}", cells.len(), wanted.len());
            let help = format!("one value for each of {}, with a point", wanted.join(", "));
            faults.push(Fault::new(&place(span), message).help(help));
            return rows;
        }
        let mut row = Row::new();
        let mut at = span.start;
        for (cell, column) in cells.iter().zip(&wanted) {
            let here = place(at..at + cell.len());
            at += cell.len() + 1;
            let Ok(x) = cell.trim().parse::<f64>() else {
                let message = format!("`{column}` = {:?}: must be a number", cell.trim());
                let help = "a gap in a recording must be filled or cut out";
                faults.push(Fault::new(&here, message).help(help));
                return rows;
            };
            row.push((here, x));
        }
        rows.push(row);
        if rows.len() > shape.rows.1 {
            break;
        }
    }
    rows
}

fn check_row(field: &str, i: usize, row: &Row, columns: &[Column], faults: &mut Vec<Fault>) {
    for ((place, x), column) in row.iter().zip(columns) {
        let name = format!("{field}.{i}.{}", column.name);
        if let Some((message, help)) = refuse(&name, *x, false, column.unit, column.range) {
            faults.push(Fault { help, ..Fault::new(place, message) });
        }
    }
}

fn check_growth(field: &str, rows: &[Row], shape: &Shape, faults: &mut Vec<Fault>) {
    let name = shape.columns.first().map_or("", |column| column.name);
    for pair in rows.windows(2) {
        let [before, after] = pair else { continue };
        let (Some((_, a)), Some((place, b))) = (before.first(), after.first()) else { continue };
        if b <= a {
            let message =
                format!("`{field}`: `{name}` = {b} does not grow: the row before has {a}");
            faults.push(Fault::new(place, message).help("sort the rows and take out repetitions"));
            return;
        }
    }
}

/// Keeps a table as long as the program lives. A flight is a plain value that cannot own memory; equal
/// tables are kept once, so a campaign over one recording holds one copy.
fn kept(cells: Vec<f64>) -> &'static [f64] {
    static TABLES: Mutex<BTreeMap<Vec<u64>, &'static [f64]>> = Mutex::new(BTreeMap::new());
    let bits = cells.iter().map(|x| x.to_bits()).collect();
    let mut tables = TABLES.lock().unwrap_or_else(PoisonError::into_inner);
    tables.entry(bits).or_insert_with(|| Vec::leak(cells))
}

/// Keeps the name of a file, for the same reason.
fn kept_name(name: &str) -> &'static str {
    static NAMES: Mutex<BTreeMap<String, &'static str>> = Mutex::new(BTreeMap::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    names.entry(name.to_owned()).or_insert_with(|| String::leak(name.to_owned()))
}

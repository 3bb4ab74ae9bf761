//! Tables in a scenario: rows written in the file, or the name of a CSV file beside it.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use stormpetrel_control::options::{Cells, Column, Shape};

use super::document::{Node, Value};
use super::fault::{Fault, Place, Source};
use super::read::{fits, refuse, wrong_type};
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
    if faults.len() == before
        && let Some(message) = check_count(rows.len(), file, shape.rows)
    {
        faults.push(Fault::new(&node.place, format!("`{field}`{message}")));
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

/// What is wrong with a number of rows. Of a file that is too long only the first rows are counted.
fn check_count(count: usize, file: &str, (fewest, most): (usize, usize)) -> Option<String> {
    if count > 0 && (fewest..=most).contains(&count) {
        return None;
    }
    let of = if file.is_empty() { String::new() } else { format!(" = \"{file}\"") };
    let plural = if count == 1 { "row" } else { "rows" };
    Some(match count {
        0 if fewest == 0 => format!("{of} has 0 rows: leave it out for none"),
        _ if count > most && !file.is_empty() => {
            format!("{of} has more than {most} rows: must have {fewest} to {most}")
        }
        _ => format!("{of} has {count} {plural}: must have {fewest} to {most}"),
    })
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

/// What some programs write before a text in UTF-8.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// Which other separator than the comma a line has, if it has no comma.
fn separated(line: &str) -> Option<String> {
    let other = [(';', "`;`"), ('\t', "tabs")].into_iter().find(|(c, _)| line.trim().contains(*c));
    let (_, shown) = other.filter(|_| !line.contains(','))?;
    Some(format!("values are separated by {shown}: a table is separated by commas"))
}

/// A first line that does not name the columns.
fn strange_head(place: &Place, line: &str, wanted: &[&str]) -> Fault {
    let must = format!("the first line must be {}", wanted.join(","));
    if let Some(message) = separated(line) {
        return Fault::new(place, message).help(must);
    }
    if line.contains(['"', '\'']) {
        let message = "names are in quotes: a table has them without";
        return Fault::new(place, message).help(must);
    }
    Fault::new(place, must).help("it names the columns, in SI units, separated by commas")
}

/// The rows of a CSV text. The first line names the columns; empty lines and lines that begin with `#`
/// do not count.
fn parse(source: &Arc<Source>, shape: &Shape, faults: &mut Vec<Fault>) -> Vec<Row> {
    let wanted: Vec<&str> = shape.columns.iter().map(|column| column.name).collect();
    let mut rows = Vec::new();
    let mut head = false;
    let text = source.text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(&source.text);
    let mut start = source.text.len() - text.len();
    for line in text.split_inclusive('\n') {
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
                faults.push(strange_head(&place(span), line, &wanted));
                return rows;
            }
            continue;
        }
        if cells.len() != wanted.len() {
            let message = separated(line).unwrap_or_else(|| {
                let plural = if cells.len() == 1 { "value" } else { "values" };
                format!("{} {plural}: this table has {}", cells.len(), wanted.len())
            });
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
                let help = if cell.contains('"') {
                    "write numbers without quotes"
                } else {
                    "a gap in a recording must be filled or cut out"
                };
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
        if !fits(*x, false, column.unit, column.range) {
            let name = format!("{field}.{i}.{}", column.name);
            let (message, help) = refuse(&name, *x, false, column.unit, column.range);
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

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMN: Column = Column { name: "x", unit: "m", range: (0.0, 9.0) };
    const SHAPE: Shape = Shape { columns: &[COLUMN, COLUMN], rows: (1, 2), grows: false };

    fn parsed(text: &str) -> (usize, Vec<String>) {
        let source = Source { name: "t.csv".into(), text: text.into() };
        let mut faults = Vec::new();
        let rows = parse(&Arc::new(source), &SHAPE, &mut faults);
        (rows.len(), faults.into_iter().map(|fault| fault.message).collect())
    }

    #[test]
    fn a_byte_order_mark_counts_for_nothing() {
        assert_eq!(parsed("\u{feff}x,x\n1,2\n"), (1, Vec::new()));
        let (_, faults) = parsed("\u{feff}x,y\n1,2\n");
        assert_eq!(faults, ["the first line must be x,x"]);
    }

    #[test]
    fn other_separators_and_quotes_are_named() {
        let commas = ": a table is separated by commas";
        let first = |text: &str| parsed(text).1.into_iter().next().unwrap_or_default();
        assert_eq!(first("x;x\n"), format!("values are separated by `;`{commas}"));
        assert_eq!(first("x\tx\n"), format!("values are separated by tabs{commas}"));
        assert_eq!(first("x,x\n1;2\n"), format!("values are separated by `;`{commas}"));
        assert_eq!(first("x,x\n1\n"), "1 value: this table has 2");
        assert_eq!(first("'x','x'\n"), "names are in quotes: a table has them without");
    }

    #[test]
    fn a_wrong_number_of_rows_is_told_as_it_is() {
        let wrong = |count, file, rows| check_count(count, file, rows).unwrap_or_default();
        assert_eq!(wrong(1, "", (2, 9)), " has 1 row: must have 2 to 9");
        assert_eq!(wrong(300, "", (2, 9)), " has 300 rows: must have 2 to 9");
        assert_eq!(wrong(10, "a", (2, 9)), " = \"a\" has more than 9 rows: must have 2 to 9");
        assert_eq!(wrong(0, "", (0, 9)), " has 0 rows: leave it out for none");
        assert_eq!(wrong(0, "", (2, 9)), " has 0 rows: must have 2 to 9");
        assert_eq!(check_count(9, "", (0, 9)), None);
    }
}

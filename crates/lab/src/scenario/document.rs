//! A TOML text as a tree in which every key and value knows its place.

use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{Fault, Faults, Place, Source};

/// Longest scenario file that is read, in bytes.
pub const LONGEST: usize = 1 << 20;

/// A value and its place.
#[derive(Clone, Debug)]
pub struct Node {
    /// Where it stands.
    pub place: Place,
    /// What it is.
    pub value: Value,
}

/// What a TOML value may be here.
#[derive(Clone, Debug)]
pub enum Value {
    /// A number; whether it is written as a whole one.
    Number(f64, bool),
    /// A string.
    Text(String),
    /// `true` or `false`.
    Flag(bool),
    /// An array.
    List(Vec<Node>),
    /// A table.
    Table(Table),
}

/// A key, its place, and what it holds.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub place: Place,
    /// What it holds.
    pub node: Node,
}

/// Keys and values in the order of the file.
#[derive(Clone, Debug, Default)]
pub struct Table(pub Vec<Entry>);

impl Table {
    /// What the key holds.
    pub fn get(&self, key: &str) -> Option<&Node> {
        self.0.iter().find(|entry| entry.key == key).map(|entry| &entry.node)
    }

    fn get_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.0.iter_mut().find(|entry| entry.key == key).map(|entry| &mut entry.node)
    }

    /// Lays `over` on top: tables are merged key by key, everything else is replaced. A table that
    /// names another law (`law`, `kind`, `shape`, `model`) replaces the whole block: settings of one law
    /// mean nothing to another.
    pub fn overlay(&mut self, over: &Table) {
        if over.renames(self) {
            *self = over.clone();
            return;
        }
        for entry in &over.0 {
            if let Some(below) = self.get_mut(&entry.key) {
                spread(below, &entry.node.value);
            }
            match (self.get_mut(&entry.key), &entry.node.value) {
                (Some(Node { value: Value::Table(below), .. }), Value::Table(above)) => {
                    below.overlay(above);
                }
                (Some(Node { value: Value::List(below), .. }), Value::Table(above))
                    if above.0.iter().all(|e| place_of(&e.key, below.len()).is_some()) =>
                {
                    overlay_items(below, above);
                }
                (Some(node), _) => *node = entry.node.clone(),
                (None, _) => self.0.push(entry.clone()),
            }
        }
    }

    /// Whether both name a law and the names differ.
    fn renames(&self, below: &Table) -> bool {
        ["law", "kind", "shape", "model"].iter().any(|key| {
            matches!(
                (self.get(key).map(|n| &n.value), below.get(key).map(|n| &n.value)),
                (Some(Value::Text(new)), Some(Value::Text(old))) if new != old
            )
        })
    }
}

/// The axes of a vector, by which the items of a list of three can be named.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The item of a list that a key names: by its position, or by its axis.
fn place_of(key: &str, length: usize) -> Option<usize> {
    let axis = || AXES.iter().position(|axis| *axis == key).filter(|_| length == AXES.len());
    key.parse().ok().or_else(axis).filter(|at| *at < length)
}

/// One number for all axes becomes one for each where a single axis is about to be changed.
fn spread(below: &mut Node, above: &Value) {
    let Value::Table(above) = above else { return };
    let axes = !above.0.is_empty() && above.0.iter().all(|e| AXES.contains(&e.key.as_str()));
    if axes && matches!(below.value, Value::Number(..)) {
        below.value = Value::List(vec![below.clone(); AXES.len()]);
    }
}

/// `disturbance.0.force = ...` or `start.offset.x = ...`: a list item by its position or axis.
fn overlay_items(below: &mut [Node], above: &Table) {
    for entry in &above.0 {
        let place = place_of(&entry.key, below.len());
        let Some(item) = place.and_then(|place| below.get_mut(place)) else {
            continue;
        };
        match (&mut item.value, &entry.node.value) {
            (Value::Table(item), Value::Table(over)) => item.overlay(over),
            _ => *item = entry.node.clone(),
        }
    }
}

/// The text as a tree, and as the source that its places point into.
///
/// # Errors
/// A text that is too long or is not TOML, with the place where reading stopped.
pub fn parse(name: &str, text: String) -> Result<(Table, Arc<Source>), Faults> {
    if text.len() > LONGEST {
        let size = text.len();
        return Err(Fault::general(format!(
            "{name}: {size} bytes: a scenario has at most {LONGEST}"
        ))
        .help("is this a scenario file?")
        .into());
    }
    let source = Arc::new(Source { name: name.into(), text });
    let table = DeTable::parse(&source.text).map_err(|error| {
        let end = source.text.len();
        let span = error.span().unwrap_or(end..end);
        let place = Place { source: Arc::clone(&source), span };
        let message = error.message().lines().next().unwrap_or_default().to_owned();
        let fault = Fault::new(&place, format!("not TOML: {message}"));
        Faults::from(match decimal_comma(&place) {
            Some(number) => fault.help(format!("write a point in numbers: {number}")),
            None => fault,
        })
    })?;
    let table = read_table(&source, table.get_ref())?;
    Ok((table, source))
}

/// The number with a point, where reading stopped in a line with a comma inside a number: `kp = 6,5`.
fn decimal_comma(place: &Place) -> Option<String> {
    let (before, after) = place.source.text.split_at_checked(place.span.start)?;
    let start = before.rsplit('\n').next()?;
    let line = format!("{start}{}", after.split('\n').next()?);
    line.split('=').skip(1).find_map(|value| {
        let (whole, rest) = value.split_once(',')?;
        let whole = whole.trim();
        let digits = rest.split([',', '}', '#']).next()?.trim();
        let is_number = |text: &str| text.chars().all(|c| c.is_ascii_digit()) && !text.is_empty();
        (is_number(whole.trim_start_matches(['+', '-'])) && is_number(digits))
            .then(|| format!("{whole}.{digits}"))
    })
}

fn place(source: &Arc<Source>, span: Range<usize>) -> Place {
    Place { source: Arc::clone(source), span }
}

fn read_table(source: &Arc<Source>, table: &DeTable<'_>) -> Result<Table, Fault> {
    let mut entries = Vec::with_capacity(table.len());
    for (key, value) in table {
        entries.push(Entry {
            key: key.get_ref().to_string(),
            place: place(source, key.span()),
            node: read_value(source, value)?,
        });
    }
    entries.sort_by_key(|entry| entry.place.span.start);
    Ok(Table(entries))
}

fn read_value(source: &Arc<Source>, value: &Spanned<DeValue<'_>>) -> Result<Node, Fault> {
    let here = place(source, value.span());
    let number = |text: &str, whole: bool| {
        text.replace('_', "")
            .parse::<f64>()
            .map(|x| Value::Number(x, whole))
            .map_err(|_| Fault::new(&here, format!("{text}: only decimal numbers are understood")))
    };
    let value = match value.get_ref() {
        DeValue::Integer(x) if x.radix() == 10 => number(x.as_str(), true)?,
        DeValue::Integer(_) => {
            let written = source.text.get(value.span()).unwrap_or_default();
            return Err(Fault::new(&here, format!("{written}: write the number in decimal")));
        }
        DeValue::Float(x) => number(x.as_str(), false)?,
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Array(items) => Value::List(
            items.iter().map(|item| read_value(source, item)).collect::<Result<_, _>>()?,
        ),
        DeValue::Table(table) => Value::Table(read_table(source, table)?),
        DeValue::Datetime(_) => {
            return Err(Fault::new(&here, "a date: no scenario field takes one"));
        }
    };
    Ok(Node { place: here, value })
}

/// A `--set dotted.path=value` argument as a tree to lay over a scenario. A value that is not TOML is
/// taken as a string, so `--set observer.law=hosm` needs no quotes.
///
/// # Errors
/// An argument without `=` or without a path.
pub fn parse_set(argument: &str) -> Result<Table, Faults> {
    let Some((path, value)) = argument.split_once('=') else {
        return Err(Fault::general(format!("--set {argument}: no `=`")).help(EXAMPLE).into());
    };
    let (path, value) = (path.trim(), value.trim());
    dotted(path).map_err(|message| bad_path(argument, &message))?;
    let tree = parse("--set", format!("{path} = {value}"));
    // A list, a table or a number that begins well and ends badly is no text.
    let begun = value.starts_with(['[', '{', '"', '\'', '+', '-', '.'])
        || value.starts_with(|c: char| c.is_ascii_digit());
    let (table, source) = match tree {
        Err(faults) if begun => return Err(faults),
        Err(_) => {
            let quoted = value.replace('\\', "\\\\").replace('"', "\\\"");
            parse("--set", format!("{path} = \"{quoted}\""))?
        }
        Ok(tree) => tree,
    };
    if !is_one(&table, path) {
        let end = source.text.len();
        let place = Place { source, span: 0..end };
        return Err(Fault::new(&place, "--set changes one setting at a time").help(EXAMPLE).into());
    }
    not_to_set(&table).map(|()| table)
}

/// What [`parse_set`] makes of `path=x`, without a text to be read; `whole` where it is written as a whole
/// number.
///
/// # Errors
/// As [`parse_set`].
pub fn set_number(path: &str, x: f64, whole: bool) -> Result<Table, Faults> {
    let text = format!("{path} = {x:?}");
    dotted(path).map_err(|message| bad_path(&text, &message))?;
    let end = text.len();
    let source = Arc::new(Source { name: "--set".into(), text });
    let here = place(&source, 0..path.len());
    let number =
        Node { place: place(&source, path.len() + 3..end), value: Value::Number(x, whole) };
    let entry = |key: &str, node| Table(vec![Entry { key: key.into(), place: here.clone(), node }]);
    let mut keys = path.rsplit('.');
    let last = keys.next().map_or_else(Table::default, |key| entry(key, number));
    let table = keys.fold(last, |table, key| {
        entry(key, Node { place: here.clone(), value: Value::Table(table) })
    });
    not_to_set(&table).map(|()| table)
}

/// Whether there is one entry at each part of the path.
fn is_one(table: &Table, path: &str) -> bool {
    let mut table = Some(table);
    path.split('.').all(|_| {
        let Some([entry]) = table.map(|table| table.0.as_slice()) else { return false };
        table = match &entry.node.value {
            Value::Table(inner) => Some(inner),
            _ => None,
        };
        true
    })
}

/// How a `--set` argument is written.
const EXAMPLE: &str = "write it as --set position.kp=6.0";

/// Most parts of a dotted path.
const DEEPEST: usize = 32;

/// Refuses a path that is none.
///
/// # Errors
/// What is wrong with it.
pub fn dotted(path: &str) -> Result<(), String> {
    let plain = |part: &str| {
        !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
    };
    match path.split('.').count() {
        _ if !path.split('.').all(plain) => Err(format!("`{path}` is not a dotted path")),
        parts if parts > DEEPEST => Err(format!("a path of {parts} parts: at most {DEEPEST}")),
        _ => Ok(()),
    }
}

fn bad_path(argument: &str, message: &str) -> Faults {
    Fault::general(format!("--set {argument}: {message}")).help(EXAMPLE).into()
}

/// Refuses settings that say which flights there are: they cannot be changed from outside.
///
/// # Errors
/// A table with a variant in it.
pub fn not_to_set(table: &Table) -> Result<(), Faults> {
    match table.0.iter().find(|entry| entry.key == "variant") {
        None => Ok(()),
        Some(entry) => Err(Fault::new(&entry.place, "`variant` cannot be set")
            .help("--variant NAME chooses one; a new one is a [[variant]] of the file")
            .into()),
    }
}

/// What `over` would do to items that are not there.
pub fn missing_items(below: &Table, over: &Table, path: &str, faults: &mut Vec<Fault>) {
    for entry in &over.0 {
        let field =
            if path.is_empty() { entry.key.clone() } else { format!("{path}.{}", entry.key) };
        let Value::Table(above) = &entry.node.value else { continue };
        match below.get(&entry.key).map(|node| &node.value) {
            Some(Value::Table(below)) => missing_items(below, above, &field, faults),
            Some(Value::List(items)) => missing_in_list(items, above, &field, faults),
            None => missing_in_list(&[], above, &field, faults),
            _ => {}
        }
    }
}

fn missing_in_list(items: &[Node], over: &Table, field: &str, faults: &mut Vec<Fault>) {
    for entry in &over.0 {
        let Ok(number) = entry.key.parse::<usize>() else { continue };
        match (items.get(number).map(|item| &item.value), &entry.node.value) {
            (Some(Value::Table(below)), Value::Table(over)) => {
                missing_items(below, over, &format!("{field}.{number}"), faults);
            }
            (Some(_), _) => {}
            (None, _) => faults.push(
                Fault::new(&entry.place, format!("there is no `{field}` number {number}"))
                    .help(numbers(field, items.len())),
            ),
        }
    }
}

fn numbers(field: &str, count: usize) -> String {
    match count {
        0 => format!("there is no {field} at all"),
        1 => format!("there is 1 {field}, number 0"),
        n => format!("there are {n} of {field}, numbers 0 to {}", n - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers under `key` after an argument was laid over the text.
    fn after(text: &str, argument: &str, key: &str) -> Vec<f64> {
        let (mut tree, _) = parse("test", text.to_owned()).expect("TOML");
        tree.overlay(&parse_set(argument).expect("an argument"));
        match &tree.get(key).expect("the key").value {
            Value::List(items) => items
                .iter()
                .filter_map(|item| match item.value {
                    Value::Number(x, _) => Some(x),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        }
    }

    #[test]
    fn one_axis_leaves_the_others_as_they_are() {
        assert_eq!(after("kp = [1.0, 2.0, 3.0]", "kp.y=9", "kp"), [1.0, 9.0, 3.0]);
        assert_eq!(after("kp = 6.0", "kp.z=9", "kp"), [6.0, 6.0, 9.0]);
        assert_eq!(after("kp = [1.0, 2.0, 3.0]", "kp=[4, 5, 6]", "kp"), [4.0, 5.0, 6.0]);
    }
}

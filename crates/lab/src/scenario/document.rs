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
            match (self.get_mut(&entry.key), &entry.node.value) {
                (Some(Node { value: Value::Table(below), .. }), Value::Table(above)) => {
                    below.overlay(above);
                }
                (Some(Node { value: Value::List(below), .. }), Value::Table(above))
                    if above
                        .0
                        .iter()
                        .all(|e| e.key.parse::<usize>().is_ok_and(|i| i < below.len())) =>
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

/// `disturbance.0.force = ...`: a list item by its position.
fn overlay_items(below: &mut [Node], above: &Table) {
    for entry in &above.0 {
        let Some(item) = entry.key.parse::<usize>().ok().and_then(|i| below.get_mut(i)) else {
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
        .help("put long tables of numbers into a file of their own")
        .into());
    }
    let source = Arc::new(Source { name: name.into(), text });
    let table = DeTable::parse(&source.text).map_err(|error| {
        let end = source.text.len();
        let span = error.span().unwrap_or(end..end);
        let place = Place { source: Arc::clone(&source), span };
        let message = error.message().lines().next().unwrap_or_default().to_owned();
        Faults::from(Fault::new(&place, format!("not TOML: {message}")))
    })?;
    let table = read_table(&source, table.get_ref())?;
    Ok((table, source))
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
        DeValue::Integer(x) => {
            return Err(Fault::new(&here, format!("{}: write the number in decimal", x.as_str())));
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
    let example = "write it as --set position.kp=6.0";
    let Some((path, value)) = argument.split_once('=') else {
        return Err(Fault::general(format!("--set {argument}: no `=`")).help(example).into());
    };
    let (path, value) = (path.trim(), value.trim());
    let plain = |part: &str| {
        !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
    };
    if !path.split('.').all(plain) {
        return Err(Fault::general(format!("--set {argument}: `{path}` is not a dotted path"))
            .help(example)
            .into());
    }
    let tree = parse("--set", format!("{path} = {value}")).or_else(|_| {
        let quoted = value.replace('\\', "\\\\").replace('"', "\\\"");
        parse("--set", format!("{path} = \"{quoted}\""))
    });
    tree.map(|(table, _)| table)
}

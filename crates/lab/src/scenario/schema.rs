//! The JSON schema of scenario files, from the same declarations that the laws are made of.

use serde_json::{Map, Value, json};
use stormpetrel_control::options::{Cells, OptionVisitor, Options, Shape};
use stormpetrel_control::record::{Meta, Path, Record, VisitorMut};
use stormpetrel_control::registry::Settings;

use super::{BlockVisitor, Scenario};
use crate::campaign::plan;

/// JSON schema (draft 2020-12) of a scenario file: editors complete and check with it.
pub fn schema() -> Value {
    let mut writer = Writer::default();
    Scenario::defaults().blocks(&mut writer);
    let mut properties = Map::new();
    properties.insert("title".into(), json!({ "type": "string", "description": "One line." }));
    properties.insert("about".into(), json!({ "type": "string", "description": "What it shows." }));
    properties.extend(writer.properties);
    properties.insert("expect".into(), expect());
    properties.insert(
        "variant".into(),
        json!({
            "type": "array",
            "description": "Flights that differ from the rest of the file by what `set` says.",
            "items": {
                "type": "object",
                "additionalProperties": false,
                "required": ["name"],
                "properties": {
                    "name": { "type": "string", "pattern": "^[A-Za-z0-9_-]{1,64}$" },
                    "title": { "type": "string" },
                    "set": { "type": "object" },
                    "expect": expect(),
                },
            },
        }),
    );
    properties.insert("campaign".into(), campaign());
    properties.insert("sweep".into(), sweep());
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Stormpetrel scenario",
        "type": "object",
        "additionalProperties": false,
        "required": ["vehicle", "reference", "position", "actuation"],
        "properties": properties,
    })
}

/// The block `campaign`, from its declaration.
fn campaign() -> Value {
    let mut writer = Writer::default();
    let doc = "How many flights `stormpetrel sweep` draws, and how.";
    writer.plain("campaign", doc, &mut plan::Size::default(), &mut plan::Choices::default());
    writer.properties.remove("campaign").unwrap_or_default()
}

/// The tables `[[sweep]]`.
fn sweep() -> Value {
    let numbers = |count: usize, doc: &str| {
        json!({
            "type": "array", "description": doc, "items": { "type": "number" },
            "minItems": count, "maxItems": count,
        })
    };
    json!({
        "type": "array",
        "description": "What `stormpetrel sweep` varies.",
        "items": {
            "type": "object",
            "additionalProperties": false,
            "required": ["path"],
            "properties": {
                "path": {
                    "type": ["string", "array"], "items": { "type": "string" },
                    "description": "Dotted path of the setting, or several that take the same value.",
                },
                "name": { "type": "string", "description": "Name of the column; the path unless given." },
                "relative": {
                    "type": "boolean",
                    "description": "Whether the value multiplies the file's own number.",
                },
                "uniform": numbers(2, "Evenly between low and high."),
                "log_uniform": numbers(2, "Evenly in the logarithm between low and high."),
                "normal": numbers(2, "Mean and standard deviation, cut at four of them."),
                "grid": numbers(3, "Low, high, and how many values."),
                "list": {
                    "type": "array", "description": "These values, numbers or names.", "minItems": 1,
                },
            },
        },
    })
}

fn expect() -> Value {
    json!({
        "type": "object",
        "description": "Numbers that the flight must show, by the flat name of the metric.",
        "additionalProperties": { "type": "object" },
    })
}

#[derive(Default)]
struct Writer {
    properties: Map<String, Value>,
}

/// Collects the settings of one block as schema properties.
#[derive(Default)]
struct Block(Map<String, Value>);

impl Block {
    fn closed(self, doc: &str) -> Value {
        json!({
            "type": "object",
            "description": doc,
            "additionalProperties": false,
            "properties": self.0,
        })
    }
}

fn describe(meta: &Meta) -> String {
    let frame = if meta.frame.is_empty() { String::new() } else { format!(", {}", meta.frame) };
    format!("{} [{}{frame}]", meta.doc.trim(), meta.unit)
}

impl VisitorMut<f64> for Block {
    fn vector(&mut self, path: &Path<'_>, meta: &Meta, components: &'static [&'static str]) {
        let (lo, hi) = meta.range;
        let number = json!({ "type": "number", "minimum": lo, "maximum": hi });
        let axes: Map<_, _> =
            components.iter().map(|name| ((*name).to_owned(), number.clone())).collect();
        self.0.insert(
            path.name().to_owned(),
            json!({
                "description": describe(meta),
                "oneOf": [
                    number,
                    { "type": "array", "items": number, "minItems": 3, "maxItems": 3 },
                    { "type": "object", "additionalProperties": false, "properties": axes },
                ],
            }),
        );
    }

    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
        let dotted = path.to_string();
        if let Some((vector, axis)) = dotted.split_once('.') {
            if let Some(Value::Object(entry)) = self.0.get_mut(vector) {
                let default = entry.entry("default").or_insert_with(|| json!({}));
                default[axis] = json!(*value);
            }
            return;
        }
        let (lo, hi) = meta.range;
        let kind = if meta.unit == "count" { "integer" } else { "number" };
        self.0.insert(
            dotted,
            json!({
                "type": kind,
                "description": describe(meta),
                "minimum": lo,
                "maximum": hi,
                "default": *value,
            }),
        );
    }
}

impl OptionVisitor for Block {
    fn choice(
        &mut self,
        name: &'static str,
        doc: &'static str,
        names: &'static [&'static str],
        docs: &'static [&'static str],
        current: usize,
    ) -> usize {
        let lines: Vec<_> =
            names.iter().zip(docs).map(|(name, doc)| format!("{name}: {}", doc.trim())).collect();
        // A choice between false and true may be written as a TOML boolean.
        let mut values: Vec<Value> = names.iter().map(|name| json!(name)).collect();
        if names == ["false", "true"] {
            values.extend([json!(false), json!(true)]);
        }
        self.0.insert(
            name.to_owned(),
            json!({
                "description": format!("{} {}", doc.trim(), lines.join(" ")),
                "enum": values,
                "default": names.get(current),
            }),
        );
        current
    }

    fn rows(
        &mut self,
        name: &'static str,
        doc: &'static str,
        shape: &Shape,
        current: Cells,
    ) -> Cells {
        let columns = shape.columns.iter();
        let head: Vec<_> = columns.map(|c| format!("{} [{}]", c.name, c.unit)).collect();
        let cells: Vec<_> = (shape.columns.iter().map(|c| c.range))
            .map(|(lo, hi)| json!({ "type": "number", "minimum": lo, "maximum": hi }))
            .collect();
        let count = cells.len();
        self.0.insert(
            name.to_owned(),
            json!({
                "description": format!(
                    "{} Rows of {}, or the name of a CSV file with these columns.",
                    doc.trim(),
                    head.join(", "),
                ),
                "oneOf": [
                    {
                        "type": "array", "minItems": shape.rows.0, "maxItems": shape.rows.1,
                        "items": {
                            "type": "array", "prefixItems": cells, "minItems": count, "maxItems": count,
                        },
                    },
                    { "type": "string" },
                ],
            }),
        );
        current
    }
}

fn laws<S: Settings>(doc: &str) -> Value {
    let one = |name: &&str| {
        let mut block = Block::default();
        block.0.insert(S::KEY.to_owned(), json!({ "const": name }));
        if let Some(mut settings) = S::named(name) {
            settings.settings(&mut block);
        }
        let mut law = block.closed(doc);
        law["required"] = json!([S::KEY]);
        law
    };
    json!({ "description": doc, "oneOf": S::NAMES.iter().map(one).collect::<Vec<_>>() })
}

impl BlockVisitor for Writer {
    fn block<S: Settings>(&mut self, key: &'static str, doc: &'static str, _: &mut S) {
        self.properties.insert(key.to_owned(), laws::<S>(doc));
    }

    fn list<S: Settings>(&mut self, key: &'static str, doc: &'static str, _: &mut Vec<S>) {
        let value = json!({ "type": "array", "description": doc, "items": laws::<S>(doc) });
        self.properties.insert(key.to_owned(), value);
    }

    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        key: &'static str,
        doc: &'static str,
        numbers: &mut R,
        options: &mut O,
    ) {
        let mut block = Block::default();
        options.visit(&mut block);
        numbers.visit_mut(&Path::ROOT, &Meta::signal("", ""), &mut block);
        self.properties.insert(key.to_owned(), block.closed(doc));
    }
}

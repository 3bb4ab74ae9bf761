//! Reading a scenario file: base, variants, command-line overrides.

use std::path::Path;
use std::sync::Arc;

use stormpetrel_control::options::Options;
use stormpetrel_control::record::{Meta, Path as Name, Record};
use stormpetrel_control::registry::Settings;
use stormpetrel_plant::disturbance::MOST;

use super::document::{Entry, Node, Table, Value, missing_items, not_to_set, parse, parse_set};
use super::fault::{Fault, Faults, Place, Source};
use super::read::{Reader, unknown, wrong_type};
use super::{ATTITUDE_LEVELS, BlockVisitor, Scenario, expect, expectations, layout, whole};
use crate::campaign::{plan, sweep};
use crate::curve;

/// A scenario file: one flight, or several variants of one.
#[derive(Clone, Debug)]
pub struct File {
    /// One line on the file.
    pub title: String,
    /// What it shows.
    pub about: String,
    /// The flights, in the order of the file.
    pub scenarios: Vec<Scenario>,
}

/// Most variants of a file.
const MOST_VARIANTS: usize = 1000;
/// Faults after which no further variant is read.
const ENOUGH: usize = 1000;

/// Reads a file from disk and lays the `--set` arguments over it.
///
/// # Errors
/// Everything that is wrong with it, each with its place.
pub fn load(path: &Path, sets: &[String]) -> Result<File, Faults> {
    let (name, shown, text) = read_text(path)?;
    load_text(&name, &shown, text, sets)
}

/// Name of the scenario, the file as messages name it, its text.
pub(super) fn read_text(path: &Path) -> Result<(String, String, String), Faults> {
    let shown = path.display().to_string();
    let text = super::source::read(path, &shown)?;
    let name = path.with_extension("").display().to_string();
    let name = name.rsplit_once("scenarios/").map_or(name.as_str(), |(_, tail)| tail).to_owned();
    Ok((name, shown, text))
}

/// Reads a scenario from a text; `name` is the scenario's, `shown` the file's in messages.
///
/// # Errors
/// Everything that is wrong with it, each with its place.
pub fn load_text(name: &str, shown: &str, text: String, sets: &[String]) -> Result<File, Faults> {
    let (base, source) = parse(shown, text)?;
    let sets = sets.iter().map(|set| parse_set(set)).collect::<Result<Vec<_>, _>>()?;
    let mut faults = Vec::new();
    let mut scenarios = Vec::new();
    let variants = variants(&base, &mut faults);
    for variant in &variants {
        if faults.len() > ENOUGH {
            break;
        }
        let mut tree = Table(base.0.iter().filter(|e| e.key != "variant").cloned().collect());
        let before = faults.len();
        for set in variant.set.into_iter().chain(&sets) {
            missing_items(&tree, set, "", &mut faults);
            tree.overlay(set);
        }
        if faults.len() > before {
            continue;
        }
        let full = variant.name.map_or_else(|| name.to_owned(), |v| format!("{name}:{v}"));
        match read_scenario(full, &tree, &source, variant) {
            Ok(scenario) => scenarios.push(scenario),
            Err(found) => faults.extend(found),
        }
    }
    // A fault of the base shows in every variant: say it once.
    faults.sort_by_cached_key(|f: &Fault| {
        f.place.as_ref().map_or((String::new(), 0), |p| (p.source.name.clone(), p.span.start))
    });
    faults.dedup_by(|a, b| {
        a.message == b.message
            && a.place.as_ref().map(|p| &p.span) == b.place.as_ref().map(|p| &p.span)
    });
    Faults(faults).check()?;
    let text = |key| match base.get(key) {
        Some(Node { value: Value::Text(text), .. }) => text.clone(),
        _ => String::new(),
    };
    Ok(File { title: text("title"), about: text("about"), scenarios })
}

/// A row of `[[variant]]`.
#[derive(Default)]
pub(super) struct Variant<'a> {
    /// Its name.
    pub name: Option<&'a str>,
    /// Its one line.
    pub title: Option<&'a str>,
    /// What it changes.
    pub set: Option<&'a Table>,
    /// What it must show beside the rest.
    pub expect: Option<&'a Table>,
}

pub(super) fn variants<'a>(base: &'a Table, faults: &mut Vec<Fault>) -> Vec<Variant<'a>> {
    const KEYS: [&str; 4] = ["name", "title", "set", "expect"];
    let Some(node) = base.get("variant") else { return vec![Variant::default()] };
    let Value::List(items) = &node.value else {
        let fault = wrong_type(&node.place, "variant", &node.value, "tables");
        faults.push(fault.help("write [[variant]], with two brackets"));
        return Vec::new();
    };
    if items.is_empty() {
        let fault = Fault::new(&node.place, "`variant` is empty: there is nothing to fly");
        faults.push(fault.help("take it out, or write [[variant]] for each flight"));
        return Vec::new();
    }
    if items.len() > MOST_VARIANTS {
        let message = format!("{} variants: a file has at most {MOST_VARIANTS}", items.len());
        let help = "split the file, or let `stormpetrel sweep` draw the flights";
        faults.push(Fault::new(&node.place, message).help(help));
        return Vec::new();
    }
    let mut rows: Vec<Variant<'a>> = Vec::new();
    for item in items {
        let Value::Table(table) = &item.value else {
            faults.push(wrong_type(&item.place, "variant", &item.value, ""));
            continue;
        };
        let mut row = Variant::default();
        for entry in &table.0 {
            match (entry.key.as_str(), &entry.node.value) {
                ("name", Value::Text(text)) if is_name(text) => row.name = Some(text),
                ("name", _) => faults.push(
                    Fault::new(&entry.node.place, "`variant.name` must be a short name")
                        .help("letters, digits, `-` and `_` only: it names a folder"),
                ),
                ("title", Value::Text(text)) => row.title = Some(text),
                ("set", Value::Table(set)) => match not_to_set(set) {
                    Ok(()) => row.set = Some(set),
                    Err(found) => faults.extend(found.0),
                },
                ("expect", Value::Table(expect)) => row.expect = Some(expect),
                ("title", other) => {
                    faults.push(wrong_type(&entry.node.place, "variant.title", other, "text"));
                }
                ("set" | "expect", other) => {
                    let field = format!("variant.{}", entry.key);
                    faults.push(wrong_type(&entry.node.place, &field, other, ""));
                }
                (key, _) => {
                    faults.push(unknown(
                        &entry.place,
                        "field",
                        &format!("variant.{key}"),
                        key,
                        &KEYS,
                    ));
                }
            }
        }
        if row.name.is_none() && !table.0.iter().any(|e| e.key == "name") {
            faults
                .push(Fault::new(&item.place, "a variant has no name").help("add name = \"...\""));
        }
        if row.name.is_some() && rows.iter().any(|other| other.name == row.name) {
            let name = row.name.unwrap_or_default();
            faults.push(Fault::new(&item.place, format!("variant `{name}` stands twice")));
        }
        rows.push(row);
    }
    rows
}

fn is_name(text: &str) -> bool {
    !text.is_empty()
        && text.len() <= 64
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

pub(super) fn read_scenario(
    name: String,
    tree: &Table,
    source: &Arc<Source>,
    variant: &Variant<'_>,
) -> Result<Scenario, Vec<Fault>> {
    let mut scenario = Scenario::blank(name);
    scenario.variant = variant.name.map(str::to_owned);
    let mut loader = Loader {
        tree,
        source,
        known: vec!["title", "about", "expect", "variant", "campaign", "sweep"],
        faults: Vec::new(),
        broken: Vec::new(),
    };
    scenario.blocks(&mut loader);
    let Loader { known, mut faults, mut broken, .. } = loader;
    layout::check(&scenario.vehicle.vehicle, tree, &mut broken, &mut faults);
    if !broken.contains(&"reference") {
        faults.extend(curve::prepare(&mut scenario.reference).err().map(|why| unfit(&why, tree)));
    }
    for entry in &tree.0 {
        match (entry.key.as_str(), &entry.node.value) {
            ("title", Value::Text(text)) => scenario.title.clone_from(text),
            ("about", Value::Text(text)) => scenario.about.clone_from(text),
            (key @ ("title" | "about"), other) => {
                faults.push(wrong_type(&entry.node.place, key, other, "text"));
            }
            ("expect", Value::Table(table)) => {
                expect::read(table, "", &mut scenario.expect, &mut faults);
            }
            ("expect", other) => faults.push(wrong_type(&entry.node.place, "expect", other, "")),
            ("campaign" | "sweep", _) => plan_faults(entry, &mut faults),
            (key, _) if !known.contains(&key) => {
                faults.push(unknown(&entry.place, "block", key, key, &known));
            }
            _ => {}
        }
    }
    scenario.entitle(variant.title, variant.name);
    if let Some(table) = variant.expect {
        expect::read(table, "", &mut scenario.expect, &mut faults);
    }
    expectations::check(&scenario, &broken, &mut faults);
    whole::check(&scenario, tree, &broken, &mut faults);
    if faults.is_empty() { Ok(scenario) } else { Err(faults) }
}

/// A table of the reference through which there is no curve.
fn unfit(why: &curve::Unfit, tree: &Table) -> Fault {
    let place = match tree.get("reference").map(|node| &node.value) {
        Some(Value::Table(table)) => table.get(why.key).map(|node| node.place.clone()),
        _ => None,
    };
    let message = format!("`reference.{}` {}", why.key, why.message);
    Fault { place, message, help: Some(why.help.to_owned()) }
}

/// What is wrong with the shape of a campaign; whether its paths exist is seen when it is loaded.
fn plan_faults(entry: &Entry, faults: &mut Vec<Fault>) {
    if entry.key == "sweep" {
        sweep::read(&entry.node, faults);
    } else {
        plan::settings(&entry.node, faults);
    }
}

struct Loader<'a> {
    tree: &'a Table,
    source: &'a Arc<Source>,
    known: Vec<&'static str>,
    faults: Vec<Fault>,
    /// Blocks with a fault.
    broken: Vec<&'static str>,
}

impl Loader<'_> {
    fn table(&mut self, key: &str, node: &'_ Node) -> Option<Table> {
        if let Value::Table(table) = &node.value {
            return Some(table.clone());
        }
        self.faults.push(wrong_type(&node.place, key, &node.value, ""));
        None
    }

    fn law<S: Settings>(&mut self, field: &str, place: &Place, table: &Table) -> Option<S> {
        let names = S::NAMES.join(", ");
        let Some(node) = table.get(S::KEY) else {
            self.faults.push(
                Fault::new(place, format!("`{field}` does not say its `{}`", S::KEY))
                    .help(format!("add {} = \"...\"; known: {names}", S::KEY)),
            );
            return None;
        };
        let Value::Text(name) = &node.value else {
            self.faults.push(wrong_type(
                &node.place,
                &format!("{field}.{}", S::KEY),
                &node.value,
                "text",
            ));
            return None;
        };
        let Some(mut settings) = S::named(name) else {
            let shown = format!("{field}.{} = \"{name}\"", S::KEY);
            self.faults.push(unknown(&node.place, "value", &shown, name, S::NAMES));
            return None;
        };
        let mut reader = Reader::new(field, table);
        reader.knows(S::KEY);
        settings.settings(&mut reader);
        self.faults.extend(reader.finish(place));
        Some(settings)
    }

    /// A block written as the name of its law alone.
    fn bare<S: Settings>(&mut self, key: &str, node: &Node) -> bool {
        let Value::Text(name) = &node.value else { return false };
        let name = if S::NAMES.contains(&name.as_str()) { name.as_str() } else { "..." };
        let help = format!("write {key} = {{ {} = \"{name}\" }}", S::KEY);
        self.faults.push(wrong_type(&node.place, key, &node.value, "").help(help));
        true
    }

    /// Remembers the block if it brought a fault.
    fn judge(&mut self, key: &'static str, before: usize) {
        if self.faults.len() > before {
            self.broken.push(key);
        }
    }

    fn required<S: Settings>(&self, key: &str) -> bool {
        let point_mass = matches!(
            self.tree.get("actuation").map(|n| &n.value),
            Some(Value::Table(t)) if matches!(t.get("kind").map(|n| &n.value), Some(Value::Text(k)) if k == "thrust-vector")
        );
        key != "observer" && !(point_mass && ATTITUDE_LEVELS.contains(&key)) && !S::NAMES.is_empty()
    }
}

impl BlockVisitor for Loader<'_> {
    fn fills(&self) -> bool {
        true
    }

    fn block<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut S) {
        self.known.push(key);
        let tree = self.tree;
        let Some(node) = tree.get(key) else {
            if self.required::<S>(key) {
                let help = format!(
                    "add {key} = {{ {} = \"{}\" }}; known: {}",
                    S::KEY,
                    S::NAMES.first().copied().unwrap_or_default(),
                    S::NAMES.join(", ")
                );
                let place = Some(Place { source: Arc::clone(self.source), span: 0..0 });
                let message = format!("block `{key}` is missing");
                self.faults.push(Fault { place, message, help: Some(help) });
                self.broken.push(key);
            }
            return;
        };
        let before = self.faults.len();
        if !self.bare::<S>(key, node)
            && let Some(table) = self.table(key, node)
            && let Some(found) = self.law(key, &node.place, &table)
        {
            *settings = found;
        }
        self.judge(key, before);
    }

    fn list<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut Vec<S>) {
        self.known.push(key);
        let tree = self.tree;
        let Some(node) = tree.get(key) else { return };
        let Value::List(items) = &node.value else {
            let help = format!("write [[{key}]] above its lines");
            self.faults.push(
                Fault::new(&node.place, format!("`{key}` must be a list of blocks")).help(help),
            );
            return;
        };
        if items.len() > MOST {
            let message = format!("{} blocks `{key}`: at most {MOST} can be combined", items.len());
            self.faults.push(Fault::new(&node.place, message));
        }
        for (i, item) in items.iter().enumerate() {
            let field = format!("{key}.{i}");
            if let Some(table) = self.table(&field, item)
                && let Some(found) = self.law(&field, &item.place, &table)
            {
                settings.push(found);
            }
        }
    }

    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        key: &'static str,
        _: &'static str,
        numbers: &mut R,
        options: &mut O,
    ) {
        self.known.push(key);
        let tree = self.tree;
        let Some(node) = tree.get(key) else { return };
        let before = self.faults.len();
        let Some(table) = self.table(key, node) else { return self.judge(key, before) };
        let mut reader = Reader::new(key, &table);
        options.visit(&mut reader);
        numbers.visit_mut(&Name::ROOT, &Meta::signal("", ""), &mut reader);
        self.faults.extend(reader.finish(&node.place));
        self.judge(key, before);
    }
}

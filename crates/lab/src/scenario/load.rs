//! Reading a scenario file: base, variants, command-line overrides.

use std::path::Path;
use std::sync::Arc;

use stormpetrel_control::options::Options;
use stormpetrel_control::record::{Meta, Path as Name, Record};
use stormpetrel_control::registry::Settings;
use stormpetrel_plant::disturbance::MOST;

use crate::campaign::{plan, sweep};
use crate::curve;
use crate::metric::{names, of_attitude};

use super::document::{Entry, Node, Table, Value, missing_items, not_to_set, parse, parse_set};
use super::expect::Rule;
use super::fault::{Fault, Faults, Place, Source};
use super::read::{Reader, scientific, unknown, wrong_type};
use super::{ATTITUDE_LEVELS, BlockVisitor, Scenario, expect};

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

/// Most control ticks of one flight.
const MOST_TICKS: f64 = 1e8;
/// Most integration steps of one flight: some minutes.
const MOST_STEPS: f64 = 1e9;
/// Most variants of a file.
const MOST_VARIANTS: usize = 1000;
/// Most rows of one log.
const MOST_ROWS: f64 = 5e6;
/// Most rows of the logs of one command.
const MOST_ROWS_OF_ALL: f64 = 2e7;
/// Bytes of a row of the log, about.
const ROW: f64 = 800.0;
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

/// One flight of a file as a tree, to be flown with other settings again and again.
#[derive(Clone, Debug)]
pub struct Base {
    name: String,
    variant: Option<String>,
    tree: Table,
    source: Arc<Source>,
}

impl Base {
    /// Reads a file with its `--set` arguments, and the variant if it has several.
    ///
    /// # Errors
    /// Everything that is wrong with the file; a variant that is missing or unknown.
    pub fn load(path: &Path, sets: &[String], variant: Option<&str>) -> Result<Self, Faults> {
        let (name, shown, text) = read_text(path)?;
        load_text(&name, &shown, text.clone(), sets)?;
        let (base, source) = parse(&shown, text)?;
        let mut faults = Vec::new();
        let variants = variants(&base, &mut faults);
        Faults(faults).check()?;
        let Some(chosen) = variants.iter().find(|v| v.name == variant) else {
            let known: Vec<&str> = variants.iter().filter_map(|v| v.name).collect();
            let (message, help) = match variant {
                _ if known.is_empty() => {
                    (format!("{shown}: the file has no variants"), "leave out --variant".into())
                }
                Some(name) => {
                    (format!("unknown variant `{name}`"), format!("known: {}", known.join(", ")))
                }
                None => (
                    format!("{shown}: the file has {} variants", known.len()),
                    format!("choose one with --variant: {}", known.join(", ")),
                ),
            };
            return Err(Fault::general(message).help(help).into());
        };
        let mut tree = Table(base.0.iter().filter(|e| e.key != "variant").cloned().collect());
        if let Some(set) = chosen.set {
            tree.overlay(set);
        }
        for set in sets {
            tree.overlay(&parse_set(set)?);
        }
        let variant = chosen.name.map(str::to_owned);
        let name = chosen.name.map_or_else(|| name.clone(), |v| format!("{name}:{v}"));
        Ok(Self { name, variant, tree, source })
    }

    /// The block of this name, as the file has it.
    pub fn block(&self, key: &str) -> Option<&Node> {
        self.tree.get(key)
    }

    /// The flight with these `--set` arguments laid over it.
    ///
    /// # Errors
    /// Everything that is wrong with them.
    pub fn scenario(&self, sets: &[String]) -> Result<Scenario, Faults> {
        let mut tree = self.tree.clone();
        let mut faults = Vec::new();
        for set in sets {
            let set = parse_set(set)?;
            missing_items(&tree, &set, "", &mut faults);
            tree.overlay(&set);
        }
        Faults(faults).check()?;
        let read = read_scenario(self.name.clone(), &tree, &self.source, &Variant::default());
        let mut scenario = read.map_err(Faults)?;
        scenario.variant.clone_from(&self.variant);
        Ok(scenario)
    }
}

/// Name of the scenario, the file as messages name it, its text.
fn read_text(path: &Path) -> Result<(String, String, String), Faults> {
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
struct Variant<'a> {
    name: Option<&'a str>,
    title: Option<&'a str>,
    set: Option<&'a Table>,
    expect: Option<&'a Table>,
}

fn variants<'a>(base: &'a Table, faults: &mut Vec<Fault>) -> Vec<Variant<'a>> {
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

fn read_scenario(
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
    let Loader { known, mut faults, broken, .. } = loader;
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
    if let Some(title) = variant.title {
        title.clone_into(&mut scenario.title);
    }
    if let Some(table) = variant.expect {
        expect::read(table, "", &mut scenario.expect, &mut faults);
    }
    check_metrics(&scenario, &broken, &mut faults);
    check_whole(&scenario, tree, &broken, &mut faults);
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

/// Every expectation must name a metric that the flight has.
fn check_metrics(scenario: &Scenario, broken: &[&str], faults: &mut Vec<Fault>) {
    let mut known = names();
    if !scenario.has_attitude() && !broken.contains(&"actuation") {
        known.retain(|name| !of_attitude(name));
    }
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    for expectation in &scenario.expect {
        let name = expectation.metric.as_str();
        if !known.contains(&name) {
            faults.push(unknown(&expectation.place, "metric", name, name, &known));
        } else if !broken.contains(&"run") {
            faults.extend(impossible(expectation, scenario));
        }
    }
}

/// What is wrong with an expectation that no flight can meet.
fn impossible(expectation: &expect::Expectation, scenario: &Scenario) -> Option<Fault> {
    let (name, run) = (expectation.metric.as_str(), &scenario.run);
    let fault = |message: String| Fault::new(&expectation.place, message);
    if name.ends_with(".late_max") && run.late >= run.duration {
        let (late, duration) = (scientific(run.late), scientific(run.duration));
        let message =
            format!("`expect.{name}`: no sample after run.late = {late} s in {duration} s");
        return Some(fault(message).help("lower run.late or raise run.duration"));
    }
    let (least, most) = bounds(name, run.duration);
    if expectation.possible(least, most) {
        return None;
    }
    let bound = match expectation.rule {
        Rule::Min(_) => format!("never more than {}", scientific(most)),
        Rule::Max(_) => format!("never less than {}", scientific(least)),
        Rule::Within { .. } => {
            format!("never outside {} to {}", scientific(least), scientific(most))
        }
    };
    let message =
        format!("`expect.{name}` must be {}: the metric is {bound}", expectation.describe());
    Some(fault(message).help("no flight can meet it: correct the number"))
}

/// Least and greatest value that a metric can have.
fn bounds(name: &str, duration: f64) -> (f64, f64) {
    match name {
        "estimate.lag" => (f64::NEG_INFINITY, f64::INFINITY),
        "saturation.share" => (0.0, 1.0),
        "time.flown" | "tilt.inverted_at" => (0.0, duration),
        _ => (0.0, f64::INFINITY),
    }
}

/// Why these flights cannot be logged.
pub fn too_long(scenarios: &[Scenario]) -> Option<Fault> {
    let rows = |scenario: &Scenario| scenario.ticks() as f64 / scenario.run.log_every;
    let fault = |who: &str, rows: f64, most: f64, help: &str| {
        let size = rows * ROW / 1e9;
        let message =
            format!("{who} would have {rows:.1e} rows, about {size:.0} GB: at most {most:e}");
        Some(Fault::general(message).help(help))
    };
    if let Some(long) = scenarios.iter().find(|scenario| rows(scenario) > MOST_ROWS) {
        let who = format!("{}: the log", long.name);
        return fault(&who, rows(long), MOST_ROWS, "raise run.log_every");
    }
    let sum: f64 = scenarios.iter().map(rows).sum();
    if sum <= MOST_ROWS_OF_ALL {
        return None;
    }
    let who = format!("the logs of {} flights", scenarios.len());
    fault(&who, sum, MOST_ROWS_OF_ALL, "raise run.log_every, or fly fewer variants at once")
}

/// Rules that look at more than one field.
fn check_whole(scenario: &Scenario, tree: &Table, broken: &[&str], faults: &mut Vec<Fault>) {
    let place = |block: &str| tree.get(block).map(|node| node.place.clone());
    // A block with a fault of its own has defaults in it: nothing can be said about the whole.
    let mut say = |block: &str, message: String, help: &str| {
        if broken.contains(&block) {
            return;
        }
        faults.push(Fault { place: place(block), message, help: Some(help.to_owned()) });
    };
    if !scenario.has_attitude() && !broken.contains(&"actuation") {
        for block in ATTITUDE_LEVELS.into_iter().filter(|block| tree.get(block).is_some()) {
            let message = format!("`{block}` is never asked: actuation is `thrust-vector`");
            say(block, message, "take the block out, or choose another actuation");
        }
    }
    let run = &scenario.run;
    let ticks = run.duration / run.control_step;
    if ticks > MOST_TICKS {
        let message =
            format!("`run`: {ticks:.3e} control steps: a flight has at most {MOST_TICKS:e}");
        say("run", message, "shorten run.duration or lengthen run.control_step");
    } else if (ticks - ticks.round()).abs() > 1e-6 * ticks || ticks < 1.0 {
        let message = format!(
            "`run.duration` = {} is not a multiple of `run.control_step` = {}",
            run.duration, run.control_step
        );
        say("run", message, "a flight is a whole number of control steps");
    }
    let steps = ticks * run.substeps;
    if steps > MOST_STEPS && ticks <= MOST_TICKS {
        let message = format!(
            "`run`: {steps:.1e} integration steps, about {:.0} min: a flight has at most {MOST_STEPS:e}",
            steps / 2e6 / 60.0
        );
        say(
            "run",
            message,
            "lower run.substeps, shorten run.duration or lengthen run.control_step",
        );
    }
    let inertia = scenario.vehicle.vehicle.inertia;
    for (a, b, c) in [
        (inertia.x, inertia.y, inertia.z),
        (inertia.y, inertia.z, inertia.x),
        (inertia.z, inertia.x, inertia.y),
    ] {
        if a > (b + c) * (1.0 + 1e-12) {
            let message = format!(
                "`vehicle.inertia` = [{}, {}, {}]: one moment exceeds the sum of the others",
                inertia.x, inertia.y, inertia.z
            );
            say("vehicle", message, "no rigid body has such moments: check their order and units");
        }
    }
    let vehicle = &scenario.vehicle.vehicle;
    if vehicle.rotor_speed_min >= vehicle.rotor_speed_max {
        let message = format!(
            "`vehicle.rotor_speed_min` = {} is not below `vehicle.rotor_speed_max` = {}",
            vehicle.rotor_speed_min, vehicle.rotor_speed_max
        );
        say("vehicle", message, "are the two swapped?");
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

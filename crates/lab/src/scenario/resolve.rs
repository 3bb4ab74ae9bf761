//! A scenario written out with every default, and the part of it that a batch must share.

use serde_json::{Map, Value, json};
use stormpetrel_control::options::{Cells, OptionVisitor, Options, Shape};
use stormpetrel_control::record::{Meta, Path, Record, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_plant::vehicle::VehicleSettings;

use super::{ATTITUDE_LEVELS, BlockVisitor, FailureOptions, Run, Scenario, Start, StartOptions};

impl Scenario {
    /// The scenario before its file is read: defaults everywhere, still air.
    pub(super) fn blank(name: String) -> Self {
        /// The first of a registry is its default.
        #[allow(clippy::expect_used)] // a registry names its own laws
        fn first<S: Settings>() -> S {
            S::named(S::NAMES[0]).expect("a registry knows its first name")
        }
        let vehicle: VehicleSettings = first();
        Self {
            name,
            variant: None,
            title: String::new(),
            about: String::new(),
            run: Run::default(),
            model: vehicle.vehicle.model(),
            vehicle,
            reference: first(),
            start: Start::default(),
            start_options: StartOptions::default(),
            position: first(),
            observer: first(),
            attitude_reference: first(),
            attitude: first(),
            rate: first(),
            actuation: first(),
            sensor: Vec::new(),
            estimator: Default::default(),
            rates: Default::default(),
            timing: Default::default(),
            disturbance: Vec::new(),
            failure: Default::default(),
            failure_options: FailureOptions::default(),
            expect: Vec::new(),
        }
    }

    /// Takes the title of a variant; without one its name beside the file's tells it apart from the others.
    pub(super) fn entitle(&mut self, title: Option<&str>, name: Option<&str>) {
        match (title, name) {
            (Some(title), _) => title.clone_into(&mut self.title),
            (None, Some(name)) if self.title.is_empty() => name.clone_into(&mut self.title),
            (None, Some(name)) => self.title = format!("{} ({name})", self.title),
            (None, None) => {}
        }
    }

    /// A scenario with every default, flown by nobody: what catalogue and schema walk over.
    pub fn defaults() -> Self {
        Self::blank(String::new())
    }

    /// Every setting by block, defaults included.
    pub fn resolved(&self) -> Value {
        let mut writer = Writer { skip: !self.has_attitude(), ..Writer::default() };
        self.clone().blocks(&mut writer);
        let mut all = Map::new();
        all.insert("title".into(), json!(self.title));
        all.extend(writer.all);
        Value::Object(all)
    }

    /// Names and choices, without numbers: equal in all flights of a batch.
    pub fn structure(&self) -> String {
        let mut writer = Writer { skip: !self.has_attitude(), ..Writer::default() };
        self.clone().blocks(&mut writer);
        let flight = self.flight();
        format!(
            "{} ticks={} substeps={} every={:?} cares={:?} late={} drops={}",
            writer.structure,
            self.ticks(),
            self.run.substeps,
            flight.stack.every,
            flight.cares,
            flight.timing.late,
            flight.timing.drops,
        )
    }
}

#[derive(Default)]
struct Writer {
    all: Map<String, Value>,
    structure: String,
    skip: bool,
}

/// The settings of one block.
#[derive(Default)]
struct Block {
    values: Map<String, Value>,
    choices: String,
}

impl VisitorMut<f64> for Block {
    fn number(&mut self, path: &Path<'_>, _: &Meta, value: &mut f64) {
        let dotted = path.to_string();
        let mut parts = dotted.split('.').collect::<Vec<_>>();
        let Some(last) = parts.pop() else { return };
        let mut map = &mut self.values;
        for part in parts {
            let inner = map.entry(part).or_insert_with(|| Value::Object(Map::new()));
            let Value::Object(inner) = inner else { return };
            map = inner;
        }
        map.insert(last.to_owned(), json!(*value));
    }
}

impl OptionVisitor for Block {
    fn choice(
        &mut self,
        name: &'static str,
        _: &'static str,
        names: &'static [&'static str],
        _: &'static [&'static str],
        current: usize,
    ) -> usize {
        let chosen = names.get(current).copied().unwrap_or_default();
        self.values.insert(name.to_owned(), json!(chosen));
        self.choices += &format!(" {name}={chosen}");
        current
    }

    fn rows(
        &mut self,
        name: &'static str,
        _: &'static str,
        shape: &Shape,
        current: Cells,
    ) -> Cells {
        let rows: Vec<_> = current.cells.chunks(shape.columns.len()).collect();
        let value = if current.file.is_empty() { json!(rows) } else { json!(current.file) };
        self.values.insert(name.to_owned(), value);
        // Equal tables are kept once, so their place tells them apart.
        self.choices += &format!(" {name}={:p}", current.cells);
        current
    }
}

fn write<S: Settings>(settings: &mut S) -> (Value, String) {
    let mut block = Block::default();
    block.values.insert(S::KEY.to_owned(), json!(settings.name()));
    settings.settings(&mut block);
    (Value::Object(block.values), format!("{}{}", settings.name(), block.choices))
}

impl BlockVisitor for Writer {
    fn block<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut S) {
        if self.skip && ATTITUDE_LEVELS.contains(&key) {
            return;
        }
        let (value, structure) = write(settings);
        self.all.insert(key.to_owned(), value);
        // Presets of a vehicle differ in numbers and choices only.
        let structure = match key {
            "vehicle" => structure.trim_start_matches(settings.name()).to_owned(),
            _ => structure,
        };
        self.structure += &format!("{key}: {structure}; ");
    }

    fn list<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut Vec<S>) {
        let (values, structures): (Vec<_>, Vec<_>) = settings.iter_mut().map(write).unzip();
        self.all.insert(key.to_owned(), Value::Array(values));
        self.structure += &format!("{key}: {}; ", structures.join(", "));
    }

    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        key: &'static str,
        _: &'static str,
        numbers: &mut R,
        options: &mut O,
    ) {
        let mut block = Block::default();
        options.visit(&mut block);
        numbers.visit_mut(&Path::ROOT, &Meta::signal("", ""), &mut block);
        self.all.insert(key.to_owned(), Value::Object(block.values));
        // How a flight starts and ends changes its numbers, not its structure.
    }
}

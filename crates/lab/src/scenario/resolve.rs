//! A scenario written out with every default.

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
}

#[derive(Default)]
struct Writer {
    all: Map<String, Value>,
    skip: bool,
}

/// The settings of one block.
#[derive(Default)]
struct Block(Map<String, Value>);

impl VisitorMut<f64> for Block {
    fn number(&mut self, path: &Path<'_>, _: &Meta, value: &mut f64) {
        let dotted = path.to_string();
        let mut parts = dotted.split('.').collect::<Vec<_>>();
        let Some(last) = parts.pop() else { return };
        let mut map = &mut self.0;
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
        self.0.insert(name.to_owned(), json!(chosen));
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
        self.0.insert(name.to_owned(), value);
        current
    }
}

fn write<S: Settings>(settings: &mut S) -> Value {
    let mut block = Block::default();
    block.0.insert(S::KEY.to_owned(), json!(settings.name()));
    settings.settings(&mut block);
    Value::Object(block.0)
}

impl BlockVisitor for Writer {
    fn block<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut S) {
        if !(self.skip && ATTITUDE_LEVELS.contains(&key)) {
            self.all.insert(key.to_owned(), write(settings));
        }
    }

    fn list<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut Vec<S>) {
        let values = settings.iter_mut().map(write).collect();
        self.all.insert(key.to_owned(), Value::Array(values));
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
        self.all.insert(key.to_owned(), Value::Object(block.0));
    }
}

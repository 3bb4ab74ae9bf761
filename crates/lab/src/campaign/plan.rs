//! The plan of a campaign: which flights, with which inputs.
//!
//! Inputs and seed of a flight follow from the master seed and the flight's index alone, so any part
//! of a plan can be flown anywhere, in any order.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::{Value as Json, json};
use stormpetrel_control::options::Options as _;
use stormpetrel_control::record::{Meta, Path as Name, Record as _};
use stormpetrel_control::{choice, options, record};

use super::random::{key, named, permuted, unit};
use super::replay;
use super::result::{Columns, Input};
use super::sweep::{self, Sweep};
use super::{tables, units};
use crate::metric;
use crate::scenario::document::{Node, Table, Value, parse_set, set_number};
use crate::scenario::fault::{Fault, Faults};
use crate::scenario::read::{Reader, wrong_type};
use crate::scenario::{Base, Scenario};

record! {
    /// The block `campaign`.
    pub struct Size {
        /// Number of flights; 0 means one for each combination of grids and lists.
        flights: T [count] = 0.0, in 0.0 => 1e8;
    }
}

choice! {
    /// How the inputs of different flights hang together.
    pub enum Sampling {
        /// Each input meets every one of `flights` equal shares of its distribution once.
        "latin-hypercube" => LatinHypercube,
        /// Every flight draws for itself.
        "independent" => Independent,
    }
}

choice! {
    /// Which metrics are taken.
    pub enum Metrics {
        /// All.
        "all" => All,
        /// Those that need no attitude: a third faster.
        "position" => Position,
    }
}

options! {
    /// Choices of a campaign.
    pub struct Choices {
        /// How the inputs of different flights hang together.
        sampling: Sampling;
        /// Which metrics are taken.
        metrics: Metrics;
    }
}

/// Reads the block `campaign`; what is wrong goes to `faults`.
pub fn settings(node: &Node, faults: &mut Vec<Fault>) -> (Size<f64>, Choices) {
    let (mut size, mut choices) = (Size::default(), Choices::default());
    let Value::Table(table) = &node.value else {
        faults.push(wrong_type(&node.place, "campaign", &node.value, ""));
        return (size, choices);
    };
    let mut reader = Reader::new("campaign", table);
    size.visit_mut(&Name::ROOT, &Meta::signal("", ""), &mut reader);
    choices.visit(&mut reader);
    faults.extend(reader.finish(&node.place));
    (size, choices)
}

/// A scenario and what is varied in it.
#[derive(Clone, Debug)]
pub struct Campaign {
    base: Base,
    /// The flight as the file has it.
    pub scenario: Scenario,
    /// What is varied.
    pub sweeps: Vec<Sweep>,
    /// Choices.
    pub choices: Choices,
    flights: u64,
    /// Seeds and inputs read from a plan, in place of drawn ones.
    replayed: Option<Vec<(u64, Vec<Input>)>>,
    /// For each sweep, the paths that take its value and the number that multiplies it.
    targets: Vec<Vec<(String, f64)>>,
    /// Files that tables of the flights come from, with a hash of their numbers.
    tables: BTreeMap<String, u64>,
}

impl Campaign {
    /// Reads the file, and checks the extreme values of every input.
    ///
    /// # Errors
    /// Everything that is wrong with file and plan.
    pub fn load(path: &Path, sets: &[String], variant: Option<&str>) -> Result<Self, Faults> {
        let base = Base::load(path, sets, variant)?;
        let scenario = base.scenario(&[])?;
        let mut faults = Vec::new();
        let sweeps = base.block("sweep").map_or_else(Vec::new, |n| sweep::read(n, &mut faults));
        let (size, choices) = base
            .block("campaign")
            .map_or_else(Default::default, |node| settings(node, &mut faults));
        let resolved = scenario.resolved();
        let targets = sweeps.iter().map(|sweep| targets(sweep, &resolved, &mut faults)).collect();
        let flights = count(&sweeps, size, base.block("campaign"), &mut faults);
        let tables = tables::contents(&scenario).into_iter().collect();
        let replayed = None;
        let mut campaign =
            Self { base, scenario, sweeps, choices, flights, replayed, targets, tables };
        campaign.check_extremes(&mut faults);
        Faults(faults).check()?;
        Ok(campaign)
    }

    /// Number of flights.
    pub fn flights(&self) -> u64 {
        self.flights
    }

    /// Whether grids and lists are counted through once at most: the first flights are a corner of them then.
    pub fn counts_through(&self) -> bool {
        self.replayed.is_none()
            && self.sweeps.iter().any(|sweep| sweep.draw.count().is_some())
            && self.flights <= combinations(&self.sweeps)
    }

    /// Seed of flight `index`: 52 bits, so that a scenario file can hold it.
    pub fn seed(&self, index: u64) -> u64 {
        self.replay_of(index).map_or_else(|| key(self.master(), index) >> 12, |(seed, _)| *seed)
    }

    fn replay_of(&self, index: u64) -> Option<&(u64, Vec<Input>)> {
        self.replayed.as_ref()?.get(usize::try_from(index).ok()?)
    }

    /// Takes seeds and inputs from a plan, `index,seed,name,...` and one row for each flight, in place of
    /// drawn ones. The whole plan is held in memory.
    ///
    /// # Errors
    /// What is wrong with the plan, with its line.
    pub fn replay(&mut self, plan: &str) -> Result<(), String> {
        let input = |sweep: &Sweep| (sweep.name.clone(), sweep.draw.is_named());
        let inputs: Vec<_> = self.sweeps.iter().map(input).collect();
        let rows = replay::rows(plan, &inputs)?;
        self.keep_tables(&rows);
        self.flights = rows.len() as u64;
        self.replayed = Some(rows);
        Ok(())
    }

    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a whole number by rule
    fn master(&self) -> u64 {
        self.scenario.run.seed as u64
    }

    /// Inputs of flight `index`, one for each sweep.
    pub fn inputs(&self, index: u64) -> Vec<Input> {
        if let Some((_, inputs)) = self.replay_of(index) {
            return inputs.clone();
        }
        // Grids and lists count through their combinations, the last one fastest.
        let mut cell = index;
        let mut inputs: Vec<Input> = Vec::with_capacity(self.sweeps.len());
        for sweep in self.sweeps.iter().rev() {
            inputs.push(match sweep.draw.count() {
                Some(count) => {
                    let input = sweep.draw.cell(cell % count);
                    cell /= count;
                    input
                }
                None => Input::Number(sweep.draw.at(self.probability(index, &sweep.name))),
            });
        }
        inputs.reverse();
        inputs
    }

    fn probability(&self, index: u64, name: &str) -> f64 {
        let share = unit(named(key(self.master(), index), name));
        match self.choices.sampling {
            Sampling::Independent => share,
            Sampling::LatinHypercube => {
                let row = permuted(index, self.flights, named(self.master(), name));
                (row as f64 + share) / self.flights as f64
            }
        }
    }

    /// The `--set` arguments that give a flight these inputs and this seed.
    pub fn sets(&self, inputs: &[Input], seed: u64) -> Vec<String> {
        let mut sets = vec![format!("run.seed={seed}")];
        for (input, targets) in inputs.iter().zip(&self.targets) {
            for (path, factor) in targets {
                sets.push(match input {
                    Input::Number(x) => format!("{path}={:?}", x * factor),
                    Input::Text(text) => format!("{path}={text}"),
                });
            }
        }
        sets
    }

    /// The flight with these inputs.
    ///
    /// # Errors
    /// Where they make no vehicle that can exist, such as moments of inertia that no body has.
    pub fn flight(&self, inputs: &[Input], seed: u64) -> Result<Scenario, Faults> {
        let mut sets = vec![set_number("run.seed", seed as f64, true)?];
        for (input, targets) in inputs.iter().zip(&self.targets) {
            for target in targets {
                sets.push(set(target, input)?);
            }
        }
        self.base.scenario(&sets)
    }

    /// The columns of its results.
    pub fn columns(&self) -> Columns {
        let all = self.choices.metrics == Metrics::All && self.scenario.has_attitude();
        let metrics = metric::names().iter().filter(|name| all || !metric::of_attitude(name));
        let inputs = self.sweeps.iter().map(|sweep| sweep.name.clone());
        Columns { inputs: inputs.collect(), metrics: metrics.cloned().collect() }
    }

    /// Each input with its distribution in words.
    pub fn describe(&self) -> Vec<(String, String)> {
        let describe = |sweep: &Sweep| {
            let of = if sweep.relative { ", times the nominal value" } else { "" };
            let paths = if sweep.paths == [sweep.name.clone()] {
                String::new()
            } else {
                format!(" ({})", sweep.paths.join(", "))
            };
            (sweep.name.clone(), format!("{}{of}{paths}", sweep.draw.describe()))
        };
        self.sweeps.iter().map(describe).collect()
    }

    /// Name of the scenario without its folder: the results must not depend on where the file stands.
    pub fn name(&self) -> &str {
        let name = &self.scenario.name;
        name.rsplit_once(['/', '\\']).map_or(name.as_str(), |(_, name)| name)
    }

    /// The unit of each input; `1` for a factor or a name.
    pub fn units(&self) -> Vec<String> {
        let of = |sweep: &Sweep| match sweep.paths.first() {
            Some(path) if !sweep.relative => units::unit(&self.scenario, path).to_owned(),
            _ => "1".to_owned(),
        };
        self.sweeps.iter().map(of).collect()
    }

    /// Everything that the results depend on.
    pub fn identity(&self) -> Json {
        let choices = match self.choices.sampling {
            Sampling::LatinHypercube => "latin-hypercube",
            Sampling::Independent => "independent",
        };
        let mut identity = json!({
            "scenario": self.name(),
            "resolved": self.scenario.resolved(),
            "flights": self.flights,
            "sampling": choices,
            "inputs": self.describe(),
            "metrics": self.columns().metrics,
            "replayed": self.replayed.as_ref().map(|rows| replay::hash(rows)),
        });
        if !self.tables.is_empty() {
            identity["tables"] = json!(self.tables);
        }
        identity
    }

    /// Keeps in mind what is in the tables that these inputs name.
    fn keep_tables(&mut self, rows: &[(u64, Vec<Input>)]) {
        let mut seen = BTreeSet::new();
        for (seed, inputs) in rows {
            let texts = inputs.iter().filter(|input| matches!(input, Input::Text(_)));
            let new = texts.filter(|text| seen.insert(text.to_string())).count() > 0;
            // One that cannot be built is told of before it is flown.
            if let Some(scenario) = new.then(|| self.flight(inputs, *seed)).and_then(Result::ok) {
                self.tables.extend(tables::contents(&scenario));
            }
        }
    }

    /// Whether every combination of the inputs' extreme values, and of all those of grids and lists, makes a
    /// flight; not if there are too many to try, nor for a plan that was read.
    pub(super) fn corners_fly(&self) -> bool {
        const MOST: usize = 4096;
        let inputs = self.sweeps.iter().map(|sweep| sweep.draw.corners(MOST as u64));
        let Some(inputs) = inputs.collect::<Option<Vec<_>>>() else { return false };
        let corners = inputs.iter().map(Vec::len).fold(1, usize::saturating_mul);
        let flies = |corner: usize| {
            let mut rest = corner;
            let inputs = inputs.iter().map(|values| {
                let at = rest % values.len();
                rest /= values.len();
                values[at].clone()
            });
            self.flight(&inputs.collect::<Vec<_>>(), self.seed(0)).is_ok()
        };
        self.replayed.is_none() && corners <= MOST && (0..corners).all(flies)
    }

    /// Every extreme of every input must make a flight; what is in its tables is kept in mind.
    fn check_extremes(&mut self, faults: &mut Vec<Fault>) {
        for (sweep, targets) in self.sweeps.iter().zip(&self.targets) {
            for value in sweep.draw.extremes().into_iter().chain(sweep.draw.between()) {
                let sets: Result<Vec<_>, _> =
                    targets.iter().map(|target| set(target, &value)).collect();
                let found = match sets.and_then(|sets| self.base.scenario(&sets)) {
                    Ok(scenario) => {
                        self.tables.extend(tables::contents(&scenario));
                        continue;
                    }
                    Err(found) => found,
                };
                for fault in found.0 {
                    let message = format!("sweep `{}` at {value}: {}", sweep.name, fault.message);
                    faults.push(Fault { message, place: Some(sweep.place.clone()), ..fault });
                }
            }
        }
    }
}

/// What lays this value over a scenario at a path, times the factor.
fn set((path, factor): &(String, f64), value: &Input) -> Result<Table, Faults> {
    match value {
        Input::Number(x) => set_number(path, x * factor, false),
        Input::Text(text) => parse_set(&format!("{path}={text}")),
    }
}

/// The numbers that a sweep sets, and what its value is multiplied by.
fn targets(sweep: &Sweep, resolved: &Json, faults: &mut Vec<Fault>) -> Vec<(String, f64)> {
    if !sweep.relative {
        return sweep.paths.iter().map(|path| (path.clone(), 1.0)).collect();
    }
    let mut targets = Vec::new();
    for path in &sweep.paths {
        let mut parts = path.split('.');
        let found = parts.try_fold(resolved, |at, part| match at {
            Json::Array(items) => items.get(part.parse::<usize>().ok()?),
            other => other.get(part),
        });
        let number = |path: &str, x: &Json| (path.to_owned(), x.as_f64().unwrap_or(1.0));
        let found: Vec<(String, f64)> = match found {
            Some(x @ Json::Number(_)) => vec![number(path, x)],
            Some(Json::Object(axes)) if axes.values().all(Json::is_number) => {
                axes.iter().map(|(axis, x)| number(&format!("{path}.{axis}"), x)).collect()
            }
            _ => Vec::new(),
        };
        if found.is_empty() {
            let message = format!("`{path}` is no number that could be multiplied");
            let help = "`stormpetrel explain` names the settings of each block";
            faults.push(Fault::new(&sweep.place, message).help(help));
        } else if found.iter().all(|(_, x)| *x == 0.0) {
            let message = format!("`{path}` is 0: no factor changes it");
            let help = "give it another value, or leave out `relative`";
            faults.push(Fault::new(&sweep.place, message).help(help));
        }
        targets.extend(found);
    }
    targets
}

/// Combinations of grids and lists.
fn combinations(sweeps: &[Sweep]) -> u64 {
    sweeps.iter().filter_map(|sweep| sweep.draw.count()).fold(1, u64::saturating_mul)
}

/// How many flights: what is asked for, or every combination.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a whole number by rule
fn count(sweeps: &[Sweep], size: Size<f64>, place: Option<&Node>, faults: &mut Vec<Fault>) -> u64 {
    const MOST: u64 = 100_000_000;
    let asked = size.flights as u64;
    let cells = combinations(sweeps);
    let drawn = sweeps.iter().any(|s| s.draw.count().is_none());
    let fault = |message: String, help: &str| {
        match place {
            Some(node) => Fault::new(&node.place, message),
            None => Fault::general(message),
        }
        .help(help)
    };
    if asked == 0 && (drawn || sweeps.is_empty()) {
        faults.push(fault(
            "`campaign.flights` is missing".into(),
            "say how many flights to draw: campaign = { flights = 1000 }",
        ));
    }
    let flights = if asked == 0 { cells } else { asked };
    if flights > MOST {
        faults.push(fault(
            format!("{flights} flights: a campaign has at most {MOST}"),
            "use fewer values in the grids",
        ));
    }
    flights
}

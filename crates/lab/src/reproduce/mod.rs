//! The article reproduced: every shipped article scenario flown, judged and compared.

pub mod article;
mod html;
pub mod sweep;
mod tables;

pub use html::{HEADLINES, html};
pub use tables::{Table, row, tables};

use crate::fly::{Outcome, fly_told_apart, on_all_cores};
use crate::scenario::Scenario;
use crate::scenario::expect::Expectation;
use crate::scenario::fault::Faults;
use crate::sensitivity::{Spread, spreads};
use crate::shipped::{SHIPPED, shipped};
use crate::trace::Trace;
use sweep::Survival;

/// One flight with all that is told of it.
#[derive(Clone, Debug)]
pub struct Flown {
    /// What was flown.
    pub scenario: Scenario,
    /// What it came to.
    pub outcome: Outcome,
    /// Present where the flight is sensitive.
    pub spread: Option<Spread>,
    /// Its course.
    pub trace: Trace,
}

impl Flown {
    /// Expectations of its file that it does not meet, with what it shows in their place. A sensitive
    /// flight shows no number, so it cannot meet one.
    pub fn unmet(&self) -> Vec<(String, String)> {
        let unmet = |e: &&Expectation| {
            let value = self.outcome.get(&e.metric);
            self.spread.is_some() || !value.is_some_and(|value| e.holds(value))
        };
        let expect = self.scenario.expect.iter().filter(unmet);
        expect
            .map(|e| (format!("{} must be {}", e.metric, e.describe()), self.shown(&e.metric)))
            .collect()
    }

    /// The metric in words, or why it is absent.
    fn shown(&self, metric: &str) -> String {
        match self.outcome.get(metric) {
            Some(value) => format!("is {value:.6e}"),
            None if metric.ends_with(".late_max") => {
                format!("no sample after run.late = {} s", self.scenario.run.late)
            }
            None if metric == "tilt.inverted_at" => "the tilt never passed 90 deg".to_owned(),
            None => "the flight does not have it".to_owned(),
        }
    }

    /// Whether the flight failed, from its start or from one of those beside it, although its scenario
    /// does not allow it.
    pub fn failed(&self) -> bool {
        let beside = self.spread.as_ref().is_some_and(|spread| spread.failures() > 0);
        (self.outcome.failure.is_some() || beside) && !self.scenario.may_fail()
    }

    /// Name of the variant; of the scenario where it has none.
    pub fn variant(&self) -> &str {
        self.scenario.variant.as_deref().unwrap_or(&self.scenario.name)
    }
}

/// All flights of one article file.
#[derive(Clone, Debug)]
pub struct Group {
    /// Name of the file, such as `article/consistent`.
    pub name: &'static str,
    /// Its title.
    pub title: String,
    /// What it shows.
    pub about: String,
    /// Its flights.
    pub flights: Vec<Flown>,
}

impl Group {
    /// The flight of that variant.
    pub fn get(&self, variant: &str) -> Option<&Flown> {
        self.flights.iter().find(|flown| flown.variant() == variant)
    }
}

/// Everything that the report tells.
#[derive(Clone, Debug)]
pub struct Story {
    /// All article files, in the order of the program.
    pub groups: Vec<Group>,
    /// The largest disturbance that each variant survives.
    pub survival: Vec<Survival>,
}

impl Story {
    /// The group of that file; empty where there is none.
    pub fn group(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// Every flight of every group.
    pub fn flights(&self) -> impl Iterator<Item = &Flown> {
        self.groups.iter().flat_map(|group| &group.flights)
    }
}

/// Points of a trace: enough for a figure.
const POINTS: u64 = 2000;

/// Flies everything; `done` is told after each flight and each survival search, with the total.
///
/// # Errors
/// A fault in a shipped scenario file.
pub fn reproduce(done: impl Fn(usize) + Sync + Send) -> Result<Story, Faults> {
    let mut files = Vec::new();
    for (name, _) in SHIPPED.iter().filter(|(name, _)| name.starts_with("article/")) {
        if let Some(file) = shipped(name) {
            files.push((*name, file?));
        }
    }
    let plan = sweep::plan(&files);
    let scenarios: Vec<Scenario> =
        files.iter().flat_map(|(_, file)| file.scenarios.iter().cloned()).collect();
    let total = scenarios.len() + plan.len();
    let flown = on_all_cores(&scenarios, |scenario| {
        let mut trace = Trace::new(scenario.ticks(), POINTS);
        let outcome = fly_told_apart(scenario, |seen| trace.push(seen));
        done(total);
        (outcome, trace)
    });
    let mut flights = scenarios
        .iter()
        .zip(flown)
        .zip(spreads(&scenarios))
        .map(|((scenario, (outcome, trace)), spread)| Flown {
            scenario: scenario.clone(),
            outcome,
            spread,
            trace,
        })
        .collect::<Vec<_>>()
        .into_iter();
    let survival = on_all_cores(&plan, |entry| {
        let found = sweep::search(entry);
        done(total);
        found
    });
    let groups = files
        .into_iter()
        .map(|(name, file)| Group {
            name,
            title: file.title,
            about: file.about,
            flights: flights.by_ref().take(file.scenarios.len()).collect(),
        })
        .collect();
    Ok(Story { groups, survival })
}

//! Flying scenarios: one by one, or eight side by side.

use std::collections::BTreeMap;

use stormpetrel_control::real::Real;
use stormpetrel_control::record::Record as _;
use stormpetrel_plant::actuation::Actuate as _;
use stormpetrel_plant::actuation::battery::Gauge;
pub use stormpetrel_plant::dispatch::LANES;
use stormpetrel_plant::dispatch::Width;
use stormpetrel_plant::disturbance::MOST;
use stormpetrel_plant::dynamics::Push;
pub use stormpetrel_plant::flight::Cause;
use stormpetrel_plant::flight::Tick;

use crate::batch::fly_alike;
use crate::metric::{Distribution, Errors, Setting, Sums, metrics};
use crate::scenario::Scenario;

/// Why and when a flight ended early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// Time since the start, s.
    pub time: f64,
    /// The limit that was passed.
    pub cause: Cause,
}

/// What a flight came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Metrics by flat name, in a fixed order.
    pub metrics: Vec<(&'static str, f64)>,
    /// Present where the flight failed.
    pub failure: Option<Failure>,
}

impl Outcome {
    /// The metric of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.metrics.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

/// What does not change during this flight.
pub(crate) fn setting<T: Real>(scenario: &Scenario) -> Setting<T> {
    Setting {
        dt: T::lit(scenario.run.control_step),
        late: T::lit(scenario.run.late),
        gravity: T::lit(scenario.model.gravity),
        has_attitude: scenario.has_attitude(),
    }
}

/// The failure with this code after so many ticks.
pub(crate) fn failure(cause: f64, flown: f64, dt: f64) -> Option<Failure> {
    Cause::from_code(cause).map(|cause| Failure { time: flown * dt, cause })
}

/// One tick of a flight and what belongs to it.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The tick.
    pub tick: &'a Tick<f64>,
    /// How far it is from where it should be.
    pub errors: &'a Errors<f64>,
    /// True force (N, world) and torque (N m, body) of each disturbance, in the order of the scenario.
    pub sources: &'a [Push<f64>],
    /// The battery, where there is one.
    pub battery: Option<Gauge<f64>>,
}

/// Flies one scenario; `each` sees every tick with its errors.
pub fn fly(scenario: &Scenario, mut each: impl FnMut(&Tick<f64>, &Errors<f64>)) -> Outcome {
    fly_seen(scenario, false, &mut |seen| each(seen.tick, seen.errors))
}

/// [`fly`], where each disturbance is told apart: for logs and figures.
pub fn fly_told_apart(scenario: &Scenario, mut each: impl FnMut(&Seen<'_>)) -> Outcome {
    fly_seen(scenario, true, &mut each)
}

/// The whole loop is inlined here: once for all callers, not once for each.
fn fly_seen(scenario: &Scenario, apart: bool, each: &mut dyn FnMut(&Seen<'_>)) -> Outcome {
    let mut flight = scenario.flight();
    let mut distribution = Distribution::new(scenario.has_attitude());
    let setting = setting(scenario);
    let mut sums = Sums::new();
    let mut sources = [Push::default(); MOST];
    let told = if apart { scenario.disturbance.len() } else { 0 };
    for _ in 0..scenario.ticks() {
        if flight.alive == 0.0 {
            break;
        }
        let before = apart.then_some(flight.disturbance);
        let tick = flight.decide();
        if let Some(before) = before {
            sources = flight.attributed(before);
        }
        let errors = sums.push(&tick, &setting, flight.alive);
        distribution.push(&errors);
        let sources = sources.get(..told).unwrap_or_default();
        // A log ends before numbers that are none: the flight fails at this tick.
        if !apart || tick.finite() {
            let battery = flight.actuation.battery();
            each(&Seen { tick: &tick, errors: &errors, sources, battery });
        }
        flight.advance(&tick);
    }
    Outcome {
        metrics: metrics(&sums, &distribution),
        failure: failure(flight.cause, flight.flown, scenario.run.control_step),
    }
}

/// Flies scenarios eight side by side, on the widest registers of the machine; each outcome has the
/// bits of a single flight. Flights of one structure share the lanes.
pub fn fly_batch(scenarios: &[Scenario]) -> Vec<Outcome> {
    fly_batch_at(scenarios, Width::widest())
}

/// [`fly_batch`] at a given width.
pub fn fly_batch_at(scenarios: &[Scenario], width: Width) -> Vec<Outcome> {
    Workspace::default().fly(scenarios, width, true)
}

/// [`fly_batch`] with the metrics of the position only: attitude metrics cost as much as a law.
pub fn fly_batch_position(scenarios: &[Scenario]) -> Vec<Outcome> {
    Workspace::default().fly(scenarios, Width::widest(), false)
}

/// Memory that a batch of flights leaves for the next one.
#[derive(Debug, Default)]
pub struct Workspace {
    pub(crate) distributions: Vec<Distribution>,
}

impl Workspace {
    /// [`fly_batch`] at a given width; without `attitude` as [`fly_batch_position`].
    pub fn fly(&mut self, scenarios: &[Scenario], width: Width, attitude: bool) -> Vec<Outcome> {
        let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (row, scenario) in scenarios.iter().enumerate() {
            groups.entry(scenario.structure()).or_default().push(row);
        }
        let mut outcomes = vec![None; scenarios.len()];
        for rows in groups.values() {
            let flown = match rows.as_slice() {
                [alone] if attitude => vec![fly(&scenarios[*alone], |_, _| {})],
                rows => {
                    let alike: Vec<&Scenario> = rows.iter().map(|row| &scenarios[*row]).collect();
                    fly_alike(&alike, width, attitude, self)
                }
            };
            for (row, outcome) in rows.iter().zip(flown) {
                outcomes[*row] = Some(outcome);
            }
        }
        outcomes.into_iter().flatten().collect()
    }
}

/// Maps over the items on all cores, in order.
#[cfg(feature = "parallel")]
pub fn on_all_cores<A: Sync, B: Send>(items: &[A], f: impl Fn(&A) -> B + Sync + Send) -> Vec<B> {
    use rayon::prelude::*;
    items.par_iter().map(f).collect()
}

/// Maps over the items one after the other.
#[cfg(not(feature = "parallel"))]
pub fn on_all_cores<A: Sync, B: Send>(items: &[A], f: impl Fn(&A) -> B + Sync + Send) -> Vec<B> {
    items.iter().map(f).collect()
}

//! Flying scenarios: one by one, or eight side by side.

use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::RecordExt;
use stormpetrel_plant::dispatch::{Width, Work};
use stormpetrel_plant::flight::{Cause, Flight, Tick};

use crate::metric::{Distribution, Errors, Setting, Sums, metrics};
use crate::scenario::Scenario;

/// Vehicles in one batch.
pub const LANES: usize = 8;

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
    pub metrics: Vec<(String, f64)>,
    /// Present where the flight failed.
    pub failure: Option<Failure>,
}

impl Outcome {
    /// The metric of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.metrics.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}

fn setting<T: Real>(scenario: &Scenario) -> Setting<T> {
    Setting {
        dt: T::lit(scenario.run.control_step),
        late: T::lit(scenario.run.late),
        gravity: T::lit(scenario.model.gravity),
        has_attitude: scenario.has_attitude(),
    }
}

/// The loop that every flight runs: decide, measure, move.
#[inline(always)]
fn run<T: Real>(
    flight: &mut Flight<T>,
    ticks: u64,
    setting: &Setting<T>,
    mut each: impl FnMut(&Tick<T>, &Errors<T>, T) -> bool,
) -> Sums<T> {
    let mut sums = Sums::new();
    for _ in 0..ticks {
        let tick = flight.decide();
        let errors = sums.push(&tick, setting, flight.alive);
        if !each(&tick, &errors, flight.alive) {
            break;
        }
        flight.advance(&tick);
    }
    sums
}

fn failure(cause: f64, flown: f64, dt: f64) -> Option<Failure> {
    Cause::from_code(cause).map(|cause| Failure { time: flown * dt, cause })
}

/// Flies one scenario; `each` sees every tick with its errors.
pub fn fly(scenario: &Scenario, mut each: impl FnMut(&Tick<f64>, &Errors<f64>)) -> Outcome {
    fly_seen(scenario, &mut each)
}

/// The whole loop is inlined here: once for all callers, not once for each.
fn fly_seen(scenario: &Scenario, each: &mut dyn FnMut(&Tick<f64>, &Errors<f64>)) -> Outcome {
    let mut flight = scenario.flight();
    let mut distribution = Distribution::new(scenario.has_attitude());
    let setting = setting(scenario);
    let sums = run(&mut flight, scenario.ticks(), &setting, |tick, errors, alive| {
        if alive > 0.0 {
            distribution.push(errors);
            each(tick, errors);
        }
        alive > 0.0
    });
    Outcome {
        metrics: metrics(&sums, &distribution),
        failure: failure(flight.cause, flight.flown, scenario.run.control_step),
    }
}

/// Flies scenarios eight side by side, on the widest registers of the machine; each outcome has the
/// bits of a single flight. Neighbours of one structure share a batch.
pub fn fly_batch(scenarios: &[Scenario]) -> Vec<Outcome> {
    fly_batch_at(scenarios, Width::widest())
}

/// [`fly_batch`] at a given width.
pub fn fly_batch_at(scenarios: &[Scenario], width: Width) -> Vec<Outcome> {
    batches(scenarios, width, true)
}

/// [`fly_batch`] with the metrics of the position only: attitude metrics cost as much as a law.
pub fn fly_batch_position(scenarios: &[Scenario]) -> Vec<Outcome> {
    batches(scenarios, Width::widest(), false)
}

fn batches(scenarios: &[Scenario], width: Width, attitude: bool) -> Vec<Outcome> {
    let mut outcomes = Vec::with_capacity(scenarios.len());
    for group in scenarios.chunk_by(|a, b| a.structure() == b.structure()) {
        for batch in group.chunks(LANES) {
            match batch {
                [alone] if attitude => outcomes.push(fly(alone, |_, _| {})),
                batch => outcomes.extend(width.run(Batch::new(batch, attitude))),
            }
        }
    }
    outcomes
}

/// Up to eight flights of one structure, side by side.
struct Batch {
    count: usize,
    ticks: u64,
    steps: [f64; LANES],
    setting: Setting<Lanes<f64, LANES>>,
    flight: Flight<Lanes<f64, LANES>>,
    distributions: Vec<Distribution>,
}

impl Batch {
    fn new(batch: &[Scenario], attitude: bool) -> Self {
        // Missing vehicles are doubles of the last: their results are dropped.
        let last = batch.len() - 1;
        let row = |i: usize| &batch[if i < last { i } else { last }];
        let flights: [Flight<f64>; LANES] = std::array::from_fn(|i| row(i).flight());
        let each = |f: fn(&Scenario) -> f64| Lanes(std::array::from_fn(|i| f(row(i))));
        let setting = Setting {
            dt: each(|s| s.run.control_step),
            late: each(|s| s.run.late),
            gravity: each(|s| s.model.gravity),
            has_attitude: attitude && row(0).has_attitude(),
        };
        Self {
            count: batch.len(),
            ticks: row(0).ticks(),
            steps: setting.dt.0,
            setting,
            flight: RecordExt::<f64>::gather(std::array::from_fn(|i| &flights[i])),
            distributions: vec![Distribution::new(setting.has_attitude); batch.len()],
        }
    }
}

impl Work for Batch {
    type Output = Vec<Outcome>;

    #[inline(always)]
    fn run(self) -> Vec<Outcome> {
        let Self { count, ticks, steps, setting, mut flight, mut distributions } = self;
        let sums = run(&mut flight, ticks, &setting, |_, errors, alive| {
            let mut any = false;
            for (i, distribution) in distributions.iter_mut().enumerate() {
                if alive.lane(i) > 0.0 {
                    distribution.push(&errors.pick(i));
                    any = true;
                }
            }
            any
        });
        let outcome = |i: usize| Outcome {
            metrics: metrics(&sums.pick(i), &distributions[i]),
            failure: failure(flight.cause.lane(i), flight.flown.lane(i), steps[i]),
        };
        (0..count).map(outcome).collect()
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

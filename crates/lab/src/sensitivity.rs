//! Whether a flight is a number or a throw of dice.
//!
//! A flight is sensitive if its position IAE moves by more than 1 % when its start moves by 1e-9 m.
//! Of such a flight no single number means anything: its metrics are given as median and range over
//! 32 starts within 1e-9 m.

use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;

use crate::fly::{Failure, LANES, Outcome, fly_batch, fly_batch_position, on_all_cores};
use crate::scenario::Scenario;

/// How far a start is moved, m.
const NUDGE: f64 = 1e-9;
/// Relative change of the position IAE that counts as sensitive.
const TOLERANCE: f64 = 0.01;
/// Number of starts in the spread.
pub const STARTS: usize = 32;

/// A metric over all starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest.
    pub min: f64,
    /// Median.
    pub median: f64,
    /// Largest.
    pub max: f64,
}

/// Outcomes of a sensitive flight from starts that nobody could tell apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// One outcome a start.
    pub outcomes: Vec<Outcome>,
}

impl Spread {
    /// The metric over all starts from which it is a finite number; `None` where there is none.
    pub fn range(&self, name: &str) -> Option<Range> {
        let mut values: Vec<f64> = self.outcomes.iter().filter_map(|o| o.get(name)).collect();
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        let (min, max) = (*values.first()?, *values.last()?);
        let middle = values.len() / 2;
        let median = if values.len() % 2 == 1 {
            values[middle]
        } else {
            0.5 * (values[middle - 1] + values[middle])
        };
        Some(Range { min, median, max })
    }

    /// Number of starts that ended in a failure.
    pub fn failures(&self) -> usize {
        self.outcomes.iter().filter(|outcome| outcome.failure.is_some()).count()
    }

    /// The failure that came first; `None` where no start failed.
    pub fn first_failure(&self) -> Option<Failure> {
        let all = self.outcomes.iter().filter_map(|outcome| outcome.failure);
        all.min_by(|a, b| a.time.total_cmp(&b.time))
    }
}

/// Start `i` moved by 1e-9 m, each in another direction, evenly over the sphere.
fn nudged(scenario: &Scenario, i: usize) -> Scenario {
    let height = 1.0 - (2.0 * i as f64 + 1.0) / STARTS as f64;
    let (sin, cos) = Real::sin_cos(2.399_963_229_728_653 * i as f64); // the golden angle
    let radius = Real::sqrt(1.0 - height * height);
    let mut moved = scenario.clone();
    moved.start.offset += Vec3::new(radius * cos, radius * sin, height) * NUDGE;
    moved
}

/// The spread of every sensitive flight; `None` for a flight that is a number. Each scenario is flown
/// twice, from its start and from 1e-9 m beside it; pairs of one structure share the lanes.
pub fn spreads(scenarios: &[Scenario]) -> Vec<Option<Spread>> {
    let mut order: Vec<usize> = (0..scenarios.len()).collect();
    order.sort_by_cached_key(|i| scenarios[*i].structure());
    let same = |a: &usize, b: &usize| scenarios[*a].structure() == scenarios[*b].structure();
    let batches: Vec<&[usize]> =
        order.chunk_by(same).flat_map(|group| group.chunks(LANES / 2)).collect();
    let probed = on_all_cores(&batches, |batch| {
        let pair = |i: &usize| [scenarios[*i].clone(), nudged(&scenarios[*i], 0)];
        let pairs: Vec<Scenario> = batch.iter().flat_map(pair).collect();
        fly_batch_position(&pairs)
    });
    let mut sensitive = vec![false; scenarios.len()];
    for (i, pair) in order.iter().zip(probed.concat().chunks(2)) {
        sensitive[*i] = pair.first().zip(pair.last()).is_some_and(|(a, b)| differ(a, b));
    }
    let all: Vec<_> = scenarios.iter().zip(sensitive).collect();
    let spread =
        |(scenario, sensitive): &(&Scenario, bool)| sensitive.then(|| over_starts(scenario));
    on_all_cores(&all, spread)
}

/// The spread of one flight; `None` where it is a number.
pub fn spread(scenario: &Scenario) -> Option<Spread> {
    spreads(std::slice::from_ref(scenario)).pop().flatten()
}

/// Whether two outcomes differ by more than the tolerance, or one alone failed.
fn differ(a: &Outcome, b: &Outcome) -> bool {
    let iae = |outcome: &Outcome| outcome.get("position.iae").unwrap_or(0.0);
    // Below a nanometre over a second there is nothing to compare.
    (iae(a) - iae(b)).abs() > TOLERANCE * Real::max(iae(a), 1e-6)
        || a.failure.map(|f| f.cause) != b.failure.map(|f| f.cause)
}

/// All metrics from 32 starts that nobody could tell apart.
fn over_starts(scenario: &Scenario) -> Spread {
    let starts: Vec<_> = (0..STARTS).map(|i| nudged(scenario, i)).collect();
    let batches: Vec<_> = starts.chunks(LANES).collect();
    Spread { outcomes: on_all_cores(&batches, |batch| fly_batch(batch)).concat() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fly::Cause;
    use crate::output::metrics_json;

    #[test]
    fn a_flight_fails_with_the_starts_beside_it() {
        let fell = Failure { time: 0.5, cause: Cause::PositionError };
        let flown = |rms: f64, failure| Outcome { metrics: vec![("rms", rms)], failure };
        let spread = Spread {
            outcomes: vec![flown(1.0, None), flown(f64::NAN, Some(fell)), flown(3.0, None)],
        };
        assert_eq!((spread.failures(), spread.first_failure()), (1, Some(fell)));
        let told = metrics_json(&flown(1.0, None), Some(&spread));
        assert_eq!((&told["failed"], &told["starts.failed"]), (&true.into(), &1.into()));
        assert_eq!((&told["rms.min"], &told["rms.max"]), (&1.0.into(), &3.0.into()));
    }
}

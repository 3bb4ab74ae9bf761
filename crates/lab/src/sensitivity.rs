//! Whether a flight is a number or a throw of dice.
//!
//! A flight is sensitive if its position IAE moves by more than 1 % when its start moves by 1e-9 m.
//! Of such a flight no single number means anything: its metrics are given as median and range over
//! 32 starts within 1e-9 m.

use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;

use crate::fly::{LANES, Outcome, fly_batch, fly_batch_position};
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
    /// The metric over all starts; `None` where no flight has it.
    pub fn range(&self, name: &str) -> Option<Range> {
        let mut values: Vec<f64> = self.outcomes.iter().filter_map(|o| o.get(name)).collect();
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

/// The spread of a sensitive flight; `None` where the flight is a number.
pub fn spread(scenario: &Scenario) -> Option<Spread> {
    let mut first = vec![scenario.clone()];
    first.extend((0..LANES - 1).map(|i| nudged(scenario, i)));
    let probe = fly_batch_position(&first);
    let iae = |outcome: &Outcome| outcome.get("position.iae").unwrap_or(0.0);
    let nominal = iae(&probe[0]);
    let steady = probe.iter().all(|outcome| {
        (iae(outcome) - nominal).abs() <= TOLERANCE * Real::max(nominal, 1e-6)
            && outcome.failure.map(|f| f.cause) == probe[0].failure.map(|f| f.cause)
    });
    if steady {
        return None;
    }
    let starts: Vec<_> = (0..STARTS).map(|i| nudged(scenario, i)).collect();
    let batches: Vec<_> = starts.chunks(LANES).collect();
    let outcomes = crate::fly::on_all_cores(&batches, |batch| fly_batch(batch));
    Some(Spread { outcomes: outcomes.concat() })
}

//! What a campaign teaches, learnt flight by flight in bounded memory.
//!
//! Counts are of every flight. What needs many flights at once (medians, correlations, figures) is
//! taken from a sample that depends on the indices alone, so that it is the same however the flights
//! were made.

mod rank;
mod sample;
mod wilson;

use std::cell::OnceCell;
use std::cmp::Ordering;

use stormpetrel_plant::flight::Cause;

use super::result::{Columns, Row};
use crate::fly::Failure;
use sample::Sample;

pub use rank::spearman;
pub use sample::{SAMPLE, Sampled};
pub use wilson::{Interval, wilson};

/// The metric by which flights are compared.
pub const SCORE: &str = "position.iae";
/// The metrics that are looked at closely, where the flights have them.
pub const KEY_METRICS: [&str; 3] = [SCORE, "position.max", "attitude.angle.iae"];
/// Name of a correlation with whether the flight was flown to its end.
pub const SUCCESS: &str = "success";

/// What is known of a campaign so far. Of the flights that are kept, only the [`KEY_METRICS`] are.
#[derive(Clone, Debug)]
pub struct Summary {
    /// What is kept of a flight.
    columns: Columns,
    /// Where the kept metrics stand in a flight.
    places: Vec<usize>,
    score: Option<usize>,
    flights: u64,
    failures: Vec<(Cause, u64)>,
    room: usize,
    worst: Vec<Row>,
    sample: Sample,
    /// Once someone has asked.
    correlations: OnceCell<Vec<Correlation>>,
}

/// How the order of one quantity goes with the order of another.
#[derive(Clone, Debug, PartialEq)]
pub struct Correlation {
    /// Name of the drawn input.
    pub input: String,
    /// Metric by flat name, or [`SUCCESS`].
    pub with: &'static str,
    /// Spearman's rank correlation, -1 to 1; NaN where one of the two never changes.
    pub rank: f64,
    /// Flights it was taken from.
    pub flights: usize,
}

impl Summary {
    /// Nothing flown yet, of flights with these columns; the `worst` worst ones will be kept.
    pub fn new(columns: &Columns, worst: usize) -> Self {
        let all = &columns.metrics;
        let find = |name: &str| all.iter().position(|known| known == name);
        let places: Vec<usize> = KEY_METRICS.into_iter().filter_map(find).collect();
        let metrics: Vec<String> = places.iter().map(|at| all[*at].clone()).collect();
        Self {
            score: metrics.iter().position(|name| name == SCORE),
            columns: Columns { inputs: columns.inputs.clone(), metrics },
            flights: 0,
            failures: Vec::new(),
            room: worst,
            worst: Vec::with_capacity(worst + 1),
            sample: Sample::new(SAMPLE, columns.inputs.len(), places.len()),
            correlations: OnceCell::new(),
            places,
        }
    }

    /// Adds a flight. The flights come in the order of their indices.
    pub fn push(&mut self, row: &Row) {
        self.flights += 1;
        if let Some(failure) = row.failure {
            match self.failures.iter_mut().find(|(cause, _)| *cause == failure.cause) {
                Some((_, count)) => *count += 1,
                None => self.failures.push((failure.cause, 1)),
            }
        }
        let value = |at: &usize| row.metrics.get(*at).copied().unwrap_or(f64::NAN);
        let metrics: Vec<f64> = self.places.iter().map(value).collect();
        self.sample.push(row, &metrics);
        self.correlations.take();
        let standing = self.standing(row.index, row.failure, &metrics);
        let worse = |other: &Row| {
            self.standing(other.index, other.failure, &other.metrics).cmp(&standing).is_lt()
        };
        let place = self.worst.partition_point(worse);
        if place < self.room {
            self.worst.insert(place, Row { inputs: row.inputs.clone(), metrics, ..*row });
            self.worst.truncate(self.room);
        }
    }

    fn standing(&self, index: u64, failure: Option<Failure>, metrics: &[f64]) -> Standing {
        let score = self.score.and_then(|at| metrics.get(at)).copied();
        Standing { failed: failure.map(|failure| failure.time), score, index }
    }

    /// The columns of the rows that are kept.
    pub fn columns(&self) -> &Columns {
        &self.columns
    }

    /// Flights, failed ones with them.
    pub fn flights(&self) -> u64 {
        self.flights
    }

    /// Flights that were flown to their end.
    pub fn flown(&self) -> u64 {
        self.flights - self.failures.iter().map(|(_, count)| count).sum::<u64>()
    }

    /// How many flights failed by each cause, the most frequent first.
    pub fn failures(&self) -> Vec<(Cause, u64)> {
        let mut failures = self.failures.clone();
        failures.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.describe().cmp(b.0.describe())));
        failures
    }

    /// Share of the flights that were flown to their end, NaN while there are none, with its 95 %
    /// interval as if every flight had been drawn for itself.
    pub fn success(&self) -> (f64, Interval) {
        (self.flown() as f64 / self.flights as f64, wilson(self.flown(), self.flights))
    }

    /// The worst flights, the worst first: failed ones, the earliest failure first, then the others
    /// by falling `position.iae`.
    pub fn worst(&self) -> &[Row] {
        &self.worst
    }

    /// The flights of the sample, in the order of their indices.
    pub fn sample(&self) -> impl Iterator<Item = Sampled<'_>> {
        self.sample.rows()
    }

    /// How many flights the sample has.
    pub fn sampled(&self) -> usize {
        self.sample.len()
    }

    /// At most `count` flights of the sample, for a figure.
    pub fn few(&self, count: usize) -> impl Iterator<Item = Sampled<'_>> {
        self.sample.at_most(count)
    }

    /// One flight in that many is in the sample.
    pub fn sampled_every(&self) -> u64 {
        self.sample.every()
    }

    /// The flight of the sample with the median `position.iae` among those flown to their end (of an
    /// even number the better of the two in the middle); empty where there are none.
    pub fn median(&self) -> Option<Sampled<'_>> {
        let score = |at: usize| {
            let row = self.sample.row(at).filter(|row| !row.failed)?;
            row.metric(self.score?)
        };
        let mut places: Vec<usize> =
            (0..self.sampled()).filter(|at| score(*at).is_some()).collect();
        // The worst first; of equally bad ones the first in the order of their indices.
        let order = |a: &usize, b: &usize| {
            let values = score(*a).zip(score(*b));
            values.map_or(Ordering::Equal, |(a, b)| b.total_cmp(&a)).then(a.cmp(b))
        };
        places.sort_unstable_by(order);
        places.get(places.len() / 2).and_then(|at| self.sample.row(*at))
    }

    /// The values of a metric over the flights of the sample that were flown to their end, with the
    /// flights; flights that do not have it, or not as a finite number, are left out.
    pub fn metric(&self, name: &str) -> impl Iterator<Item = (Sampled<'_>, f64)> + use<'_> {
        let at = self.columns.metrics.iter().position(|known| known == name);
        let flown = self.sample().filter(|row| !row.failed);
        flown.filter_map(move |row| {
            let value = row.metric(at?)?;
            value.is_finite().then_some((row, value))
        })
    }

    /// Positions and names of the inputs that are numbers.
    pub fn numeric_inputs(&self) -> Vec<(usize, &str)> {
        let Some(first) = self.sample().next() else { return Vec::new() };
        let inputs = self.columns.inputs.iter().enumerate();
        let numeric = inputs.filter(|(at, _)| first.number(*at).is_some());
        numeric.map(|(at, name)| (at, name.as_str())).collect()
    }

    /// Rank correlation of each numeric input with each of the [`KEY_METRICS`] that the flights have
    /// (over the sampled flights that were flown to their end) and with success (over all sampled).
    pub fn correlations(&self) -> &[Correlation] {
        self.correlations.get_or_init(|| self.correlate())
    }

    fn correlate(&self) -> Vec<Correlation> {
        let mut all = Vec::new();
        for (at, input) in self.numeric_inputs() {
            for with in KEY_METRICS.into_iter().filter(|name| self.has(name)) {
                let values = self.metric(with);
                let pairs = values.filter_map(|(row, value)| Some((row.number(at)?, value)));
                let (rank, flights) = spearman(pairs);
                all.push(Correlation { input: input.into(), with, rank, flights });
            }
            let success = |row: &Sampled| if row.failed { 0.0 } else { 1.0 };
            let pairs = self.sample().filter_map(|row| Some((row.number(at)?, success(&row))));
            let (rank, flights) = spearman(pairs);
            all.push(Correlation { input: input.into(), with: SUCCESS, rank, flights });
        }
        all
    }

    /// Whether the metric is kept.
    pub fn has(&self, metric: &str) -> bool {
        self.columns.metrics.iter().any(|name| name == metric)
    }
}

/// How bad a flight was; the least is the worst: failed ones by the time of failure (s), then the others
/// by falling score, one without score last. Equally bad flights are in the order of their indices.
#[derive(Clone, Copy, Debug)]
struct Standing {
    failed: Option<f64>,
    score: Option<f64>,
    index: u64,
}

impl Standing {
    fn cmp(&self, other: &Self) -> Ordering {
        let badness =
            |one: &Self| one.score.filter(|score| !score.is_nan()).unwrap_or(f64::NEG_INFINITY);
        let worse = match (self.failed, other.failed) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => badness(other).total_cmp(&badness(self)),
        };
        worse.then(self.index.cmp(&other.index))
    }
}

#[cfg(test)]
mod tests;

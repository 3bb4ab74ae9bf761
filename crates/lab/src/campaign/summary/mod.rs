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

use super::result::{Columns, Input, Row};
use sample::Sample;

pub use rank::spearman;
pub use sample::SAMPLE;
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
            places,
            flights: 0,
            failures: Vec::new(),
            room: worst,
            worst: Vec::with_capacity(worst + 1),
            sample: Sample::new(SAMPLE),
            correlations: OnceCell::new(),
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
        let metrics = self.places.iter().filter_map(|at| row.metrics.get(*at).copied());
        let row = Row { metrics: metrics.collect(), inputs: row.inputs.clone(), ..*row };
        self.keep_if_bad(&row);
        self.sample.push(row);
        self.correlations.take();
    }

    fn keep_if_bad(&mut self, row: &Row) {
        let place = self.worst.partition_point(|other| self.compare(other, row).is_lt());
        if place < self.room {
            self.worst.insert(place, row.clone());
            self.worst.truncate(self.room);
        }
    }

    /// The worse flight first: failed ones by the time of failure, then the others by their score.
    /// Equally bad flights are in the order of their indices; one without score is the least bad.
    fn compare(&self, a: &Row, b: &Row) -> Ordering {
        let by_failure = match (a.failure, b.failure) {
            (Some(a), Some(b)) => a.time.total_cmp(&b.time),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => self.badness(b).total_cmp(&self.badness(a)),
        };
        by_failure.then(a.index.cmp(&b.index))
    }

    fn badness(&self, row: &Row) -> f64 {
        let score = self.score.and_then(|at| row.metrics.get(at)).copied();
        score.filter(|score| !score.is_nan()).unwrap_or(f64::NEG_INFINITY)
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
    pub fn sample(&self) -> &[Row] {
        self.sample.rows()
    }

    /// At most `count` flights of the sample, for a figure.
    pub fn few(&self, count: usize) -> Vec<&Row> {
        self.sample.at_most(count)
    }

    /// One flight in that many is in the sample.
    pub fn sampled_every(&self) -> u64 {
        self.sample.every()
    }

    /// The flight of the sample with the median `position.iae` among those flown to their end (of an
    /// even number the better of the two in the middle); empty where there are none.
    pub fn median(&self) -> Option<&Row> {
        let mut flown: Vec<&Row> = self.sample().iter().filter(|r| r.failure.is_none()).collect();
        flown.retain(|row| self.badness(row) > f64::NEG_INFINITY);
        flown.sort_by(|a, b| self.compare(a, b));
        flown.get(flown.len() / 2).copied()
    }

    /// The values of a metric over the flights of the sample that were flown to their end, with the
    /// flights; flights that do not have it, or not as a finite number, are left out.
    pub fn metric<'a>(&'a self, name: &str) -> impl Iterator<Item = (&'a Row, f64)> + use<'a> {
        let at = self.columns.metrics.iter().position(|known| known == name);
        let flown = self.sample().iter().filter(|row| row.failure.is_none());
        flown.filter_map(move |row| {
            let value = *row.metrics.get(at?)?;
            value.is_finite().then_some((row, value))
        })
    }

    /// Positions and names of the inputs that are numbers.
    pub fn numeric_inputs(&self) -> Vec<(usize, &str)> {
        let Some(first) = self.sample().first() else { return Vec::new() };
        let inputs = first.inputs.iter().zip(&self.columns.inputs).enumerate();
        let numeric = inputs.filter(|(_, (input, _))| matches!(input, Input::Number(_)));
        numeric.map(|(at, (_, name))| (at, name.as_str())).collect()
    }

    /// Rank correlation of each numeric input with each of the [`KEY_METRICS`] that the flights have
    /// (over the sampled flights that were flown to their end) and with success (over all sampled).
    pub fn correlations(&self) -> &[Correlation] {
        self.correlations.get_or_init(|| self.correlate())
    }

    fn correlate(&self) -> Vec<Correlation> {
        let mut all = Vec::new();
        for (at, input) in self.numeric_inputs() {
            let mut add = |with, pairs: &[(f64, f64)]| {
                let rank = spearman(pairs);
                all.push(Correlation { input: input.into(), with, rank, flights: pairs.len() });
            };
            for metric in KEY_METRICS.iter().filter(|name| self.has(name)) {
                let values = self.metric(metric);
                let pairs = values.filter_map(|(row, value)| Some((number(row, at)?, value)));
                add(metric, &pairs.collect::<Vec<_>>());
            }
            let success = |row: &Row| if row.failure.is_none() { 1.0 } else { 0.0 };
            let pairs =
                self.sample().iter().filter_map(|row| Some((number(row, at)?, success(row))));
            add(SUCCESS, &pairs.collect::<Vec<_>>());
        }
        all
    }

    /// Whether the metric is kept.
    pub fn has(&self, metric: &str) -> bool {
        self.columns.metrics.iter().any(|name| name == metric)
    }
}

/// The input at that place, where it is a number.
pub fn number(row: &Row, at: usize) -> Option<f64> {
    match row.inputs.get(at)? {
        Input::Number(x) => Some(*x),
        Input::Text(_) => None,
    }
}

#[cfg(test)]
mod tests;

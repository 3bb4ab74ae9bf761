//! A part of the flights that stands for all.

use crate::campaign::random::{key, named};
use crate::campaign::result::{Input, Row};

/// At most that many flights are kept. A rank correlation of so many independent pairs scatters by 0.008.
pub const SAMPLE: usize = 1 << 14;

/// Keeps one flight in k, k doubling when there are too many.
///
/// Which ones depends on nothing but their indices: those whose scrambled index k divides. Every k-th
/// index itself would not do: in a grid whose inner loop has k values all of one value would be kept.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    room: usize,
    every: u64,
    flights: Vec<Flight>,
    /// Inputs and metrics of one flight after the other. An input that is a name is its place in `texts`.
    values: Vec<f64>,
    /// For each input its names; none where it is a number.
    texts: Vec<Vec<String>>,
    metrics: usize,
}

/// Twice the index, and one more where it failed: there are many of them.
#[derive(Clone, Copy, Debug)]
struct Flight(u64);

impl Flight {
    fn new(index: u64, failed: bool) -> Self {
        Self(index << 1 | u64::from(failed))
    }

    fn index(self) -> u64 {
        self.0 >> 1
    }

    fn failed(self) -> bool {
        self.0 & 1 == 1
    }
}

/// A flight of the sample.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'a> {
    /// Position in the plan, from zero.
    pub index: u64,
    /// Whether it ended early.
    pub failed: bool,
    values: &'a [f64],
    texts: &'a [Vec<String>],
}

impl<'a> Sampled<'a> {
    /// The input at that place, where it is a number.
    pub fn number(&self, at: usize) -> Option<f64> {
        let number = self.texts.get(at)?.is_empty();
        self.values.get(at).copied().filter(|_| number)
    }

    /// The input at that place, where it is a name.
    pub fn text(&self, at: usize) -> Option<&'a str> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place")]
        let place = *self.values.get(at)? as usize;
        self.texts.get(at)?.get(place).map(String::as_str)
    }

    /// The metric at that place of the kept ones; empty where the flight does not have it.
    pub fn metric(&self, at: usize) -> Option<f64> {
        self.values.get(self.texts.len() + at).copied().filter(|value| !value.is_nan())
    }
}

impl Sample {
    /// Keeps at most `room` flights of that many inputs and metrics.
    pub fn new(room: usize, inputs: usize, metrics: usize) -> Self {
        Self {
            room,
            every: 1,
            // Whole from the start: growing would leave copies behind, and untouched memory takes none.
            flights: Vec::with_capacity(room),
            values: Vec::with_capacity(room * (inputs + metrics)),
            texts: vec![Vec::new(); inputs],
            metrics,
        }
    }

    /// Adds a flight of which these metrics are kept, or leaves it.
    pub fn push(&mut self, row: &Row, metrics: &[f64]) {
        if !kept(row.index, self.every) {
            return;
        }
        while self.flights.len() >= self.room && self.every < 1 << 63 {
            self.thin();
        }
        if !kept(row.index, self.every) {
            return;
        }
        self.flights.push(Flight::new(row.index, row.failure.is_some()));
        for (texts, input) in self.texts.iter_mut().zip(&row.inputs) {
            self.values.push(match input {
                Input::Number(x) => *x,
                Input::Text(text) => place(texts, text) as f64,
            });
        }
        self.values.extend_from_slice(metrics);
        // Whatever the row has: the next one begins at its place.
        self.values.resize(self.flights.len() * self.width(), f64::NAN);
    }

    fn width(&self) -> usize {
        self.texts.len() + self.metrics
    }

    /// Keeps every other flight.
    fn thin(&mut self) {
        self.every *= 2;
        let (width, mut count) = (self.width(), 0);
        for at in 0..self.flights.len() {
            if kept(self.flights[at].index(), self.every) {
                self.flights[count] = self.flights[at];
                self.values.copy_within(at * width..(at + 1) * width, count * width);
                count += 1;
            }
        }
        self.flights.truncate(count);
        self.values.truncate(count * width);
    }

    /// The flight at that place.
    pub fn row(&self, at: usize) -> Option<Sampled<'_>> {
        let flight = self.flights.get(at)?;
        let width = self.width();
        Some(Sampled {
            index: flight.index(),
            failed: flight.failed(),
            values: &self.values[at * width..(at + 1) * width],
            texts: &self.texts,
        })
    }

    /// In the order of their indices.
    pub fn rows(&self) -> impl Iterator<Item = Sampled<'_>> {
        (0..self.len()).filter_map(|at| self.row(at))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.flights.len()
    }

    /// At most `count` of them, thinned on in the same way.
    pub fn at_most(&self, count: usize) -> impl Iterator<Item = Sampled<'_>> {
        let left = |every| self.flights.iter().filter(|flight| kept(flight.index(), every)).count();
        let mut every = self.every;
        while left(every) > count && every < 1 << 63 {
            every *= 2;
        }
        self.rows().filter(move |row| kept(row.index, every))
    }

    /// One flight in that many is kept.
    pub fn every(&self) -> u64 {
        self.every
    }
}

fn kept(index: u64, every: u64) -> bool {
    key(named(0, "sample"), index).is_multiple_of(every)
}

/// The place of a text among others, at their end where it is new.
fn place(texts: &mut Vec<String>, text: &str) -> usize {
    texts.iter().position(|known| known == text).unwrap_or_else(|| {
        texts.push(text.to_owned());
        texts.len() - 1
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fly::Failure;
    use stormpetrel_plant::flight::Cause;

    fn indices(room: usize, pushed: impl Iterator<Item = u64>) -> (u64, Vec<u64>) {
        let mut sample = Sample::new(room, 0, 0);
        for index in pushed {
            let row = Row { index, seed: 0, inputs: vec![], failure: None, metrics: vec![] };
            sample.push(&row, &[]);
        }
        (sample.every, sample.rows().map(|row| row.index).collect())
    }

    #[test]
    fn a_small_campaign_is_kept_whole() {
        assert_eq!(indices(100, 0..100), (1, (0..100).collect()));
        assert_eq!(indices(100, 0..101).0, 2);
    }

    /// Also after the thinning has moved them.
    #[test]
    fn a_flight_keeps_what_is_its_own() {
        let laws = ["rate/pid", "rate/indi", "rate/none"];
        let law = |index: u64| laws[(index % 3) as usize];
        let mut sample = Sample::new(50, 2, 2);
        for index in 0..1000 {
            let x = index as f64;
            let row = Row {
                index,
                seed: 0,
                inputs: vec![Input::Text(law(index).into()), Input::Number(0.5 * x)],
                failure: (index % 2 == 1).then_some(Failure { time: x, cause: Cause::Tilt }),
                metrics: vec![],
            };
            sample.push(&row, &[2.0 * x, f64::NAN]);
        }
        assert!(sample.len() > 10);
        for row in sample.rows() {
            let x = row.index as f64;
            assert_eq!((row.text(0), row.number(0)), (Some(law(row.index)), None));
            assert_eq!((row.text(1), row.number(1)), (None, Some(0.5 * x)));
            assert_eq!((row.metric(0), row.metric(1), row.metric(2)), (Some(2.0 * x), None, None));
            assert_eq!(row.failed, row.index % 2 == 1);
        }
    }

    #[test]
    fn the_order_of_arrival_does_not_matter() {
        let (every, rising) = indices(50, 0..3000);
        let (same, mut falling) = indices(50, (0..3000).rev());
        falling.reverse();
        assert_eq!((every, &rising), (same, &falling));
        assert!(rising.len() <= 50 && rising.len() > 10, "{}", rising.len());
    }

    /// Every value of an inner loop stays in proportion, also where its length is a power of two.
    #[test]
    fn a_grid_is_not_distorted() {
        let (every, kept) = indices(2000, 0..64_000);
        assert!(every >= 32);
        for value in 0..8 {
            let share = kept.iter().filter(|i| **i % 8 == value).count() as f64 / kept.len() as f64;
            assert!((share - 0.125).abs() < 0.04, "{value}: {share}");
        }
    }
}

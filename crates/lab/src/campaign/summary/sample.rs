//! A part of the flights that stands for all.

use crate::campaign::random::{key, named};
use crate::campaign::result::Row;

/// At most that many flights are kept.
pub const SAMPLE: usize = 20_000;

/// Keeps one flight in k, k doubling when there are too many.
///
/// Which ones depends on nothing but their indices: those whose scrambled index k divides. Every k-th
/// index itself would not do: in a grid whose inner loop has k values all of one value would be kept.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    room: usize,
    every: u64,
    rows: Vec<Row>,
}

impl Sample {
    pub fn new(room: usize) -> Self {
        Self { room, every: 1, rows: Vec::new() }
    }

    pub fn push(&mut self, row: Row) {
        if !kept(row.index, self.every) {
            return;
        }
        while self.rows.len() >= self.room && self.every < 1 << 63 {
            self.every *= 2;
            let every = self.every;
            self.rows.retain(|row| kept(row.index, every));
        }
        if kept(row.index, self.every) {
            self.rows.push(row);
        }
    }

    /// In the order of their indices.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// At most `count` of them, thinned on in the same way.
    pub fn at_most(&self, count: usize) -> Vec<&Row> {
        let (mut every, mut rows) = (self.every, self.rows.iter().collect::<Vec<_>>());
        while rows.len() > count && every < 1 << 63 {
            every *= 2;
            rows.retain(|row| kept(row.index, every));
        }
        rows
    }

    /// One flight in that many is kept.
    pub fn every(&self) -> u64 {
        self.every
    }
}

fn kept(index: u64, every: u64) -> bool {
    key(named(0, "sample"), index).is_multiple_of(every)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn indices(room: usize, pushed: impl Iterator<Item = u64>) -> (u64, Vec<u64>) {
        let mut sample = Sample::new(room);
        for index in pushed {
            sample.push(Row { index, seed: 0, inputs: vec![], failure: None, metrics: vec![] });
        }
        (sample.every, sample.rows.iter().map(|row| row.index).collect())
    }

    #[test]
    fn a_small_campaign_is_kept_whole() {
        assert_eq!(indices(100, 0..100), (1, (0..100).collect()));
        assert_eq!(indices(100, 0..101).0, 2);
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

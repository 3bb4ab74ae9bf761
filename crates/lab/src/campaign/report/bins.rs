//! Values into bins.

use stormpetrel_control::real::Real;

use crate::plot::Scale;

/// The value that the share `q` (0 to 1) of the sorted values does not pass; empty without values.
pub(super) fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to the length")]
    let rank = (q * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied()
}

/// Logarithmic where the sorted values are positive and span more than two decades.
pub(super) fn scale_of_results(sorted: &[f64]) -> Scale {
    match sorted {
        [low, .., high] if *low > 0.0 && *high > 100.0 * low => Scale::Log,
        _ => Scale::Linear,
    }
}

/// Logarithmic where the sorted values are positive, span more than a decade and crowd at the low end of
/// a linear axis: drawn evenly from 0 to 15, the least of many is tiny and yet no logarithm is wanted.
pub(super) fn scale_of_inputs(sorted: &[f64]) -> Scale {
    let (Some(low), Some(middle), Some(high)) =
        (quantile(sorted, 0.0), quantile(sorted, 0.5), quantile(sorted, 1.0))
    else {
        return Scale::Linear;
    };
    let crowded = middle - low < 0.2 * (high - low);
    if crowded && low > 0.0 && high > 10.0 * low { Scale::Log } else { Scale::Linear }
}

/// Bins of equal width on an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bins {
    low: f64,
    width: f64,
    count: usize,
    scale: Scale,
}

impl Bins {
    /// That many bins from the smallest of the sorted values to the largest; empty without values.
    pub fn new(sorted: &[f64], scale: Scale, count: usize) -> Option<Self> {
        let (low, high) = (*sorted.first()?, *sorted.last()?);
        if high <= low {
            // One column around the only value.
            let half = 0.05 * if low == 0.0 { 1.0 } else { low.abs() };
            let (low, scale) = (low - half, Scale::Linear);
            return Some(Self { low, width: 2.0 * half, count: 1, scale });
        }
        let (low, high) = (to_axis(low, scale), to_axis(high, scale));
        Some(Self { low, width: (high - low) / count as f64, count, scale })
    }

    /// Scale of the axis.
    pub fn scale(&self) -> Scale {
        self.scale
    }

    /// How many bins there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The bin of a value.
    pub fn of(&self, value: f64) -> usize {
        let share = (to_axis(value, self.scale) - self.low) / self.width;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let bin = share as usize;
        bin.min(self.count - 1)
    }

    /// Lower and upper edge of a bin.
    pub fn edges(&self, bin: usize) -> (f64, f64) {
        let edge = |i: usize| match self.scale {
            Scale::Linear => self.low + self.width * i as f64,
            Scale::Log => Real::exp(self.low + self.width * i as f64),
        };
        (edge(bin), edge(bin + 1))
    }
}

fn to_axis(value: f64, scale: Scale) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log => Real::ln(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_were_there() {
        let values: Vec<f64> = (1..=100).map(f64::from).collect();
        let found = [0.0, 0.05, 0.5, 0.95, 1.0].map(|q| quantile(&values, q));
        assert_eq!(found, [1.0, 5.0, 50.0, 95.0, 100.0].map(Some));
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn every_value_has_a_bin_that_holds_it() {
        for values in [vec![-1.0, 0.0, 2.5, 3.0], vec![1e-3, 0.5, 7.0, 99.0], vec![4.0; 3]] {
            let bins = Bins::new(&values, scale_of_results(&values), 7).expect("values");
            for value in values {
                let (from, to) = bins.edges(bins.of(value));
                assert!(from <= value + 1e-12 && value <= to + 1e-12, "{value}");
            }
        }
        assert!(Bins::new(&[], Scale::Log, 7).is_none());
    }

    #[test]
    fn more_than_two_decades_are_logarithmic() {
        assert_eq!(scale_of_results(&[1.0, 101.0]), Scale::Log);
        assert_eq!(scale_of_results(&[1.0, 99.0]), Scale::Linear);
        assert_eq!(scale_of_results(&[0.0, 1e6]), Scale::Linear);
        assert_eq!(scale_of_results(&[]), Scale::Linear);
    }

    #[test]
    fn what_was_drawn_evenly_is_shown_evenly() {
        let even: Vec<f64> = (1..1000).map(|i| 0.015 * f64::from(i)).collect();
        let by_ratio: Vec<f64> = even.iter().map(|x| Real::exp(*x)).collect();
        assert_eq!(scale_of_inputs(&even), Scale::Linear);
        assert_eq!(scale_of_inputs(&by_ratio), Scale::Log);
    }
}

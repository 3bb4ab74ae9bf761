//! How the errors of a flight are distributed, taken on line.

use super::Errors;

/// Collects the distribution of the error signals of one flight.
#[derive(Debug, Default)]
pub struct Distribution(pub(super) Vec<Histogram>);

impl Distribution {
    /// Nothing flown yet.
    pub fn new(has_attitude: bool) -> Self {
        let mut new = Self::default();
        new.clear(has_attitude);
        new
    }

    /// Begins another flight in the same memory.
    pub fn clear(&mut self, has_attitude: bool) {
        self.0.resize_with(if has_attitude { 8 } else { 4 }, Histogram::new);
        self.0.iter_mut().for_each(Histogram::clear);
    }

    /// Adds the errors of one tick.
    #[inline(always)]
    pub fn push(&mut self, errors: &Errors<f64>) {
        let Errors { position, axis, angle, euler, tilt, yaw } = *errors;
        let all = [position, axis.x, axis.y, axis.z, angle, euler, tilt, yaw];
        for (histogram, e) in self.0.iter_mut().zip(all) {
            histogram.push(e);
        }
    }
}

/// Logarithmic histogram of one error signal: 64 bins an octave from 2^-30 to 2^10.
#[derive(Debug)]
pub(super) struct Histogram {
    bins: Vec<u32>,
    count: u64,
}

const BINS: usize = 64;
const OCTAVES: usize = 40;
const LOWEST_EXPONENT: u64 = 1023 - 30;

impl Histogram {
    fn new() -> Self {
        Self { bins: vec![0; OCTAVES * BINS], count: 0 }
    }

    fn clear(&mut self) {
        self.bins.fill(0);
        self.count = 0;
    }

    #[inline(always)]
    fn push(&mut self, e: f64) {
        // Exponent and the six leading bits of the mantissa number the bins.
        let bits = (e.to_bits() & (u64::MAX >> 1)) >> 46;
        let bin = bits.saturating_sub(LOWEST_EXPONENT << 6);
        let last = self.bins.len() - 1;
        let bin = usize::try_from(bin).unwrap_or(last);
        if let Some(count) = self.bins.get_mut(if bin < last { bin } else { last }) {
            *count += 1;
        }
        self.count += 1;
    }

    /// The value below which 95 % of the samples lie: the middle of its bin.
    pub fn p95(&self) -> f64 {
        let wanted = self.count - self.count / 20;
        let mut seen = 0;
        for (octave, bins) in self.bins.chunks(BINS).enumerate() {
            let whole = seen + bins.iter().map(|count| u64::from(*count)).sum::<u64>();
            // Not in this octave.
            if whole < wanted {
                seen = whole;
                continue;
            }
            for (bin, count) in bins.iter().enumerate() {
                seen += u64::from(*count);
                if seen >= wanted && seen > 0 {
                    let edge = |bin: u64| f64::from_bits((bin + (LOWEST_EXPONENT << 6)) << 46);
                    let bin = (octave * BINS + bin) as u64;
                    // The lowest bin holds everything down to zero.
                    return if bin == 0 { 0.0 } else { 0.5 * (edge(bin) + edge(bin + 1)) };
                }
            }
        }
        0.0
    }
}

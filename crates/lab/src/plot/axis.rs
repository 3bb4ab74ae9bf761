//! From values to axis units, and from axis units to pixels.

use super::Scale;

/// Values beyond this are treated as missing: their differences would overflow.
const LARGEST: f64 = 1e300;

/// An interval in axis units: the values themselves, or their decimal logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub lo: f64,
    pub hi: f64,
}

impl Range {
    /// The smallest interval that holds all usable values.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        values.filter(|v| v.is_finite()).fold(None, |range: Option<Self>, v| {
            let Some(Self { lo, hi }) = range else { return Some(Self { lo: v, hi: v }) };
            Some(Self { lo: if v < lo { v } else { lo }, hi: if v > hi { v } else { hi } })
        })
    }

    /// Length in axis units.
    pub fn span(self) -> f64 {
        self.hi - self.lo
    }

    /// The interval that also holds `v`.
    pub fn with(self, v: f64) -> Self {
        Self::of([self.lo, self.hi, v].into_iter()).unwrap_or(self)
    }

    /// An interval that can be drawn: never empty, with `margin` of its length on each side.
    pub fn settled(range: Option<Self>, scale: Scale, margin: f64) -> Self {
        let Self { lo, hi } = range.unwrap_or(Self { lo: 0.0, hi: 1.0 });
        let (middle, size) = (0.5 * lo + 0.5 * hi, if -lo > hi { -lo } else { hi });
        let (least, half) = match scale {
            // A constant with rounding noise on it is still a constant.
            Scale::Linear if size < 1e-290 => (1e-290, 1.0),
            Scale::Linear => (1e-9 * size, 0.1 * size),
            // Less than this and no two labelled ticks would fit.
            Scale::Log => (0.8, 0.4),
        };
        if hi - lo <= least {
            return Self { lo: middle - half, hi: middle + half };
        }
        let extra = margin * (hi - lo);
        Self { lo: lo - extra, hi: hi + extra }
    }
}

/// The value in axis units; NaN when it cannot be drawn.
pub(super) fn unit(v: f64, scale: Scale) -> f64 {
    match scale {
        Scale::Linear if v.abs() <= LARGEST => v,
        Scale::Log if v > 0.0 && v.is_finite() => v.log10(),
        _ => f64::NAN,
    }
}

/// A range laid onto pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub range: Range,
    /// Pixel of the lower end.
    pub from: f64,
    /// Pixel of the upper end.
    pub to: f64,
}

impl Axis {
    /// Pixel of a value in axis units.
    pub fn at(&self, v: f64) -> f64 {
        self.from + (v - self.range.lo) / self.range.span() * (self.to - self.from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_values_do_not_widen_the_range() {
        let values = [1.0, f64::NAN, 3.0, f64::INFINITY, 1e305].map(|v| unit(v, Scale::Linear));
        assert_eq!(Range::of(values.into_iter()), Some(Range { lo: 1.0, hi: 3.0 }));
        assert!(unit(0.0, Scale::Log).is_nan() && unit(-1.0, Scale::Log).is_nan());
    }

    #[test]
    fn every_range_can_be_drawn() {
        for v in [0.0, 1.0, -7.0, 1e-300, 1e299] {
            let range = Range::settled(Some(Range { lo: v, hi: v }), Scale::Linear, 0.05);
            assert!(range.lo < v && v < range.hi, "{v}");
        }
        assert!(Range::settled(None, Scale::Log, 0.05).span() > 0.0);
        let range = Range::settled(Some(Range { lo: 0.0, hi: 10.0 }), Scale::Linear, 0.05);
        assert_eq!(range, Range { lo: -0.5, hi: 10.5 });
    }

    #[test]
    fn pixels_follow_the_range() {
        let axis = Axis { range: Range { lo: 0.0, hi: 4.0 }, from: 300.0, to: 100.0 };
        assert!((axis.at(1.0) - 250.0).abs() < 1e-12);
    }
}

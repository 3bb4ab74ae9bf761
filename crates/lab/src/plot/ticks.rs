//! Tick values: 1, 2 or 5 times a power of ten, kept as integers so that labels carry no noise.

use super::Scale;
use super::axis::Range;
use super::text::{decimal, power, scientific};

/// One labelled tick; `at` is in axis units (the decimal logarithm on a logarithmic axis).
#[derive(Debug)]
pub(super) struct Tick {
    pub at: f64,
    pub label: String,
}

/// The ticks of an axis.
#[derive(Debug)]
pub(super) struct Ticks {
    pub major: Vec<Tick>,
    /// Unlabelled positions between the decades.
    pub minor: Vec<f64>,
    /// "×10⁶" when the labels are to be multiplied, else empty.
    pub factor: String,
}

impl Ticks {
    /// About `count` ticks for a range in axis units.
    pub fn new(range: Range, scale: Scale, count: u32) -> Self {
        match scale {
            Scale::Linear => linear(range, count),
            Scale::Log => logarithmic(range),
        }
    }

    /// One tick for each of so many rows, numbered from zero.
    pub fn rows(count: usize) -> Self {
        let major = (0..count).map(|row| Tick { at: row as f64, label: row.to_string() });
        Self { major: major.collect(), minor: Vec::new(), factor: String::new() }
    }
}

/// `mantissa`·10^`exponent` rounded once, which multiplying by a computed power would not be.
fn exact(mantissa: i64, exponent: i32) -> f64 {
    format!("{mantissa}e{exponent}").parse().unwrap_or(0.0)
}

#[expect(clippy::cast_possible_truncation, reason = "the conversion saturates, which is wanted")]
fn whole(v: f64) -> i64 {
    v as i64
}

/// The step 1, 2 or 5 times a power of ten that is nearest to `raw` in ratio.
fn step(raw: f64) -> (i64, i32) {
    let (digits, exponent) = scientific(raw);
    match digits.parse().unwrap_or(1.0) {
        m if m < 1.5 => (1, exponent),
        m if m < 3.2 => (2, exponent),
        m if m < 7.1 => (5, exponent),
        _ => (1, exponent + 1),
    }
}

fn linear(range: Range, count: u32) -> Ticks {
    let (mantissa, exponent) = step(range.span() / f64::from(count));
    let size = exact(mantissa, exponent);
    // A flight of 20 s ends at 19.999 s: a tick less than a pixel outside is still wanted.
    let slack = 1e-3 * range.span();
    let first = whole(((range.lo - slack) / size).ceil());
    let last = whole(((range.hi + slack) / size).floor());
    let (_, decade) = scientific(if range.hi.abs() > range.lo.abs() { range.hi } else { range.lo });
    let shared = if (-3..6).contains(&decade) { 0 } else { decade };
    let major = (first..=last).map(|n| Tick {
        at: exact(n * mantissa, exponent),
        label: decimal(n * mantissa, exponent - shared),
    });
    let factor = if shared == 0 { String::new() } else { format!("\u{d7}{}", power(shared)) };
    Ticks { major: major.collect(), minor: Vec::new(), factor }
}

fn logarithmic(range: Range) -> Ticks {
    let first = decade(range.lo.floor());
    let last = decade(range.hi.floor());
    let inside = |at: &f64| *at >= range.lo - 1e-9 && *at <= range.hi + 1e-9;
    let all = |mantissas: &'static [i64]| {
        (first..=last)
            .flat_map(move |d| mantissas.iter().map(move |m| (*m, d, exact(*m, d).log10())))
            .filter(move |(_, _, at)| inside(at))
    };
    let decades = all(&[1]).count();
    // With one decade line or none the reader could not tell the scale: label 2 and 5 as well.
    let labelled: &[i64] = if decades < 2 { &[1, 2, 5] } else { &[1] };
    let stride = i32::try_from(decades.div_ceil(8)).unwrap_or(1);
    let plain = first >= -3 && last <= 4;
    let major = all(labelled)
        .filter(|(_, d, _)| stride < 2 || d.rem_euclid(stride) == 0)
        .map(|(m, d, at)| Tick { at, label: log_label(m, d, plain) });
    let between: &[i64] = if decades > 6 { &[1] } else { &[2, 3, 4, 5, 6, 7, 8, 9] };
    let minor = all(between).map(|(_, _, at)| at);
    Ticks { major: major.collect(), minor: minor.collect(), factor: String::new() }
}

/// A decade as a number, held inside the range of the format.
fn decade(v: f64) -> i32 {
    i32::try_from(whole(v)).unwrap_or(0).clamp(-320, 308)
}

fn log_label(mantissa: i64, exponent: i32, plain: bool) -> String {
    match mantissa {
        _ if plain => decimal(mantissa, exponent),
        1 => power(exponent),
        m => format!("{m}\u{b7}{}", power(exponent)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(lo: f64, hi: f64, scale: Scale, count: u32) -> Vec<String> {
        let ticks = Ticks::new(Range { lo, hi }, scale, count);
        ticks.major.into_iter().map(|t| t.label).collect()
    }

    #[test]
    fn linear_ticks_are_nice_and_without_noise() {
        assert_eq!(labels(0.0, 10.0, Scale::Linear, 5), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(0.0, 0.3, Scale::Linear, 3), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(
            labels(-1.0, 1.0, Scale::Linear, 4),
            ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]
        );
        assert_eq!(labels(0.7, 1.9, Scale::Linear, 3), ["1.0", "1.5"]);
    }

    #[test]
    fn rows_are_counted_from_zero() {
        let labels: Vec<_> = Ticks::rows(3).major.into_iter().map(|t| t.label).collect();
        assert_eq!(labels, ["0", "1", "2"]);
    }

    #[test]
    fn extreme_ranges_share_a_factor() {
        let ticks = Ticks::new(Range { lo: 0.0, hi: 4e9 }, Scale::Linear, 4);
        assert_eq!(ticks.factor, "\u{d7}10\u{2079}");
        assert_eq!(ticks.major.last().map(|t| t.label.as_str()), Some("4"));
        let ticks = Ticks::new(Range { lo: 0.0, hi: 3e-12 }, Scale::Linear, 3);
        assert_eq!(ticks.factor, "\u{d7}10\u{207b}\u{b9}\u{b2}");
        assert_eq!(labels(1e6, 1e6 + 0.2, Scale::Linear, 2).len(), 3);
    }

    #[test]
    fn logarithmic_ticks_are_decades() {
        assert_eq!(labels(-2.1, 1.2, Scale::Log, 5), ["0.01", "0.1", "1", "10"]);
        assert_eq!(
            labels(-5.0, -3.0, Scale::Log, 5),
            ["10\u{207b}\u{2075}", "10\u{207b}\u{2074}", "10\u{207b}\u{b3}"]
        );
        assert_eq!(labels(0.1, 0.9, Scale::Log, 5), ["2", "5"]);
        assert!(labels(-30.0, 30.0, Scale::Log, 5).len() <= 9);
    }
}

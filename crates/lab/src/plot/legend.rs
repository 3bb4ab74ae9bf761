//! Labels that must not cover each other: the legend above a plot and names beside its edge.

use super::page::{LEFT, Page};
use super::style::look;
use super::text::{fit, width};

/// Length of the piece of line shown for a series, in pixels.
const SAMPLE: f64 = 30.0;
/// Height of a legend row in pixels.
pub(super) const ROW: f64 = 16.0;

/// Draws entries (label, style) from `x` on, in rows between `left` and `right`.
///
/// `y` is the baseline of the first row; gives the baseline of the last one.
pub(super) fn draw<'a>(
    page: &mut Page,
    entries: impl Iterator<Item = (&'a str, usize)>,
    (mut x, mut y): (f64, f64),
    (left, right): (f64, f64),
) -> f64 {
    for (label, style) in entries.filter(|(label, _)| !label.is_empty()) {
        let label = fit(label, LEFT.size, right - left - SAMPLE - 6.0);
        let length = SAMPLE + 6.0 + width(&label, LEFT.size);
        if x + length > right && x > left {
            (x, y) = (left, y + ROW);
        }
        let (colour, dash) = look(style);
        page.line((x, y - 4.0), (x + SAMPLE, y - 4.0), colour, 2.0, dash);
        page.text((x + SAMPLE + 6.0, y), &label, LEFT);
        x += length + 18.0;
    }
    y
}

/// Moves sorted positions apart to at least `gap`, within `lo` and `hi` as far as they fit.
pub(super) fn spread(places: &mut [f64], gap: f64, (lo, hi): (f64, f64)) {
    let mut free = lo;
    for place in places.iter_mut() {
        *place = if *place < free { free } else { *place };
        free = *place + gap;
    }
    let mut free = hi;
    for place in places.iter_mut().rev() {
        *place = if *place > free { free } else { *place };
        free = *place - gap;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_move_apart() {
        let mut places = [10.0, 11.0, 98.0, 99.0];
        spread(&mut places, 12.0, (0.0, 100.0));
        assert!(places.windows(2).all(|w| matches!(w, [a, b] if b - a >= 12.0)));
        assert!(places.iter().all(|p| (0.0..=100.0).contains(p)));
    }

    #[test]
    fn a_full_row_starts_another() {
        let mut page = Page::default();
        let entries = [("first series", 0), ("second series", 1), ("", 2)];
        let y = draw(&mut page, entries.into_iter(), (0.0, 10.0), (0.0, 160.0));
        assert!((y - 26.0).abs() < 1e-9);
    }
}

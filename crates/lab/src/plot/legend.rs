//! Labels that must not cover each other: the legend above a plot and names beside its edge.

use super::Mark;
use super::page::{EDGE, Font, LEFT, MIDDLE, Page};
use super::style::{GREY, WIDTH, look};
use super::text::{fit, width};

/// Length of the piece of line shown for a series, in pixels.
const SAMPLE: f64 = 30.0;
/// Height of a legend row in pixels.
pub(super) const ROW: f64 = 16.0;

/// Draws entries (label, style, mark) from `x` on, in rows between `left` and `right`.
///
/// `y` is the baseline of the first row; gives the baseline of the last one.
pub(super) fn draw<'a>(
    page: &mut Page,
    entries: impl Iterator<Item = (&'a str, usize, Mark)>,
    (mut x, mut y): (f64, f64),
    (left, right): (f64, f64),
) -> f64 {
    for (label, style, mark) in entries.filter(|(label, ..)| !label.is_empty()) {
        let label = fit(label, LEFT.size, right - left - SAMPLE - 6.0);
        let length = SAMPLE + 6.0 + width(&label, LEFT.size);
        if x + length > right && x > left {
            (x, y) = (left, y + ROW);
        }
        let (colour, dash) = look(style);
        let middle = (x + 0.5 * SAMPLE, y - 4.0);
        match mark {
            Mark::Line => page.line((x, y - 4.0), (x + SAMPLE, y - 4.0), colour, 2.0, dash),
            Mark::Dots => page.dots(&[middle], style),
            Mark::Crosses => page.crosses(&[middle], style),
        }
        page.text((x + SAMPLE + 6.0, y), &label, LEFT);
        x += length + 18.0;
    }
    y
}

/// Writes the names of vertical lines above the plot, each over its place in pixels, in as many rows
/// as needed; gives the top of the plot. The places rise.
pub(super) fn above(page: &mut Page, marks: &[(f64, &str)], top: f64) -> f64 {
    let mut rows: Vec<f64> = Vec::new();
    for (at, label) in marks {
        let label = fit(label, 10.0, WIDTH - 2.0 * EDGE);
        let half = 0.5 * width(&label, 10.0);
        let middle = if at - half < EDGE { EDGE + half } else { *at };
        let end = WIDTH - EDGE - half;
        let middle = if middle > end { end } else { middle };
        let row = rows.iter().position(|right| middle - half > right + 10.0);
        let row = row.unwrap_or(rows.len());
        rows.resize(rows.len().max(row + 1), 0.0);
        if let Some(right) = rows.get_mut(row) {
            *right = middle + half;
        }
        let y = top + 10.0 + 13.0 * row as f64;
        page.text((middle, y), &label, Font { size: 10.0, fill: GREY, ..MIDDLE });
    }
    top + if rows.is_empty() { 0.0 } else { 2.0 + 13.0 * rows.len() as f64 }
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
        let entries = entries.map(|(label, style)| (label, style, Mark::Line));
        let y = draw(&mut page, entries.into_iter(), (0.0, 10.0), (0.0, 160.0));
        assert!((y - 26.0).abs() < 1e-9);
    }
}

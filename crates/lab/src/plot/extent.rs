//! How far the axes of a panel reach.

use super::Scale;
use super::axis::{Range, unit};
use super::figure::{Limit, Mark, Panel, Series};

/// The points of a series in axis units; infinite where a cross lies at the upper edge.
pub(super) fn points<'a>(
    series: &Series<'a>,
    panel: &Panel<'_>,
) -> impl Iterator<Item = (f64, f64)> + use<'a> {
    let (x_scale, scale, crosses) = (panel.x_scale, panel.scale, series.mark == Mark::Crosses);
    series.x.iter().zip(series.y).map(move |(x, y)| {
        let edge = crosses && *y == f64::INFINITY;
        (unit(*x, x_scale), if edge { *y } else { unit(*y, scale) })
    })
}

/// The horizontal and the vertical range of a panel.
pub(super) fn ranges(panel: &Panel<'_>) -> (Range, Range) {
    // Only points that will be drawn count, or a lone value without a partner widens the range.
    let drawn = |(x, y): &(f64, f64)| x.is_finite() && !y.is_nan();
    let pairs = || panel.series.iter().flat_map(|s| points(s, panel)).filter(drawn);
    let edges = panel.columns.iter().flat_map(|c| [c.from, c.to]);
    let edges = edges.chain(panel.x_range.into_iter().flat_map(|(lo, hi)| [lo, hi]));
    let edges = edges.map(|v| unit(v, panel.x_scale));
    let x = Range::of(pairs().map(|p| p.0).chain(edges));
    // A line may end at the frame, a symbol on it would be cut in two.
    let symbols = |s: &Series<'_>| s.mark != Mark::Line || !s.spans.is_empty();
    let margin = if panel.series.iter().any(symbols) { 0.02 } else { 0.0 };
    let x = Range::settled(x, panel.x_scale, margin);
    let rows = (panel.y_rows > 0).then(|| (-0.6, panel.y_rows as f64 - 0.4));
    let ends = rows.or(panel.y_range).map(|(lo, hi)| [lo, hi].map(|v| unit(v, panel.scale)));
    let given = ends.and_then(|ends| Range::of(ends.into_iter())).filter(|r| r.span() > 0.0);
    (x, given.unwrap_or_else(|| height(panel, pairs().map(|p| p.1))))
}

/// The vertical range that the values ask for.
fn height(panel: &Panel<'_>, values: impl Iterator<Item = f64>) -> Range {
    let scale = panel.scale;
    let columns = panel.columns.iter().flat_map(|c| [0.0, c.height]);
    let spans = panel.series.iter().flat_map(|s| s.spans.iter().flat_map(|s| [s.0, s.1]));
    let data = Range::of(values.chain(columns.chain(spans).map(|v| unit(v, scale))));
    let mut settled = Range::settled(reach(data, &panel.limits, scale), scale, 0.05);
    if panel.series.iter().any(|s| points(s, panel).any(|p| p.1 == f64::INFINITY)) {
        // Crosses at the upper edge have a strip of their own.
        settled.hi += 0.06 * settled.span();
    }
    // Columns stand on the lower edge, unless something lies below.
    let stands = !panel.columns.is_empty() && data.is_some_and(|r| r.lo == 0.0);
    if stands { Range { lo: 0.0, ..settled } } else { settled }
}

/// The range of the data, widened to the limits that leave the data an eighth of the height.
fn reach(data: Option<Range>, limits: &[Limit], scale: Scale) -> Option<Range> {
    let mut places: Vec<f64> = limits.iter().map(|l| unit(l.value, scale)).collect();
    places.retain(|v| v.is_finite());
    let Some(data) = data else { return Range::of(places.into_iter()) };
    // A constant has no height to lose.
    let (lo, hi) = (data.lo.abs(), data.hi.abs());
    let constant = data.span() <= 1e-9 * if lo > hi { lo } else { hi };
    let fits = |v: &f64| constant || data.with(*v).span() <= 8.0 * data.span();
    Some(places.into_iter().filter(fits).fold(data, Range::with))
}
